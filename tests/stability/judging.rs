//! What the judge lets pass and what not, on made-up measurements: each way of being wrong has one that is caught.

use etendue::Estimator;
use etendue_host::stability::{
    Beside, Case, Expectation, Expected, Found, Measured, Outcome, Truth, judge,
};
use etendue_host::statistics::{Estimate, Tail};

const LIMIT: f64 = 1e-7;
const BATCHES: usize = 32;

/// Batches of this mean with errors of a relative 1 %, the same for all who ask.
fn batches(mean: f64) -> Vec<f64> {
    let wave = |i: usize| (2.4 * i as f64).sin();
    (0..BATCHES)
        .map(|i| mean * (1.0 + 0.01 * wave(i)))
        .collect()
}

fn measured(mean: f64) -> Measured {
    let all = batches(mean);
    Measured {
        mean: [Estimate::of(&all); 3],
        batches: [all.clone(), all.clone(), all],
        tail: Tail {
            samples: 10_000,
            alive: 10_000,
            index: 9.0,
            largest: 3.0,
            share: 3e-4,
            top: 0.02,
        },
        ..Measured::default()
    }
}

fn found(single: f64, double: f64) -> Found {
    Found {
        single: measured(single),
        double: measured(double),
        clipped: [batches(single), batches(double)],
        channels: 1,
        ..Found::default()
    }
}

fn heavy(single: f64, double: f64) -> Found {
    let mut found = found(single, double);
    (found.single.tail.index, found.single.tail.top) = (1.0, 0.5);
    found
}

fn expected(what: Expectation) -> Expected {
    let wrong = matches!(what, Expectation::Biased { .. } | Expectation::Heavy);
    Expected {
        estimator: Estimator::Path,
        what,
        beside: None,
        why: "test".into(),
        warns: wrong.then(|| "the cure".into()),
        factor: 1.0,
        rounding: 1e-4,
    }
}

/// What differs, of a case whose truth is 1.
fn differs(expected: &Expected, found: Found, warning: &str) -> (Outcome, Vec<String>) {
    let case = Case {
        name: "test".into(),
        about: "test".into(),
        scene: "test".into(),
        added: None,
        defines: Vec::new(),
        samples: 1,
        truth: Truth {
            value: vec![1.0],
            uncertainty: 1e-6,
            source: "test".into(),
        },
        expected: vec![expected.clone()],
    };
    let row = judge(&case, expected, found, &[warning.into()], LIMIT);
    (row.outcome, row.differs)
}

fn passes(expected: &Expected, found: Found) -> bool {
    differs(expected, found, "take the cure").1.is_empty()
}

const TENTH: Expectation = Expectation::Biased {
    by: -0.1,
    within: 0.01,
};

#[test]
fn a_bias_is_what_it_is_said_to_be() {
    let e = expected(TENTH);
    assert!(passes(&e, found(0.9, 0.9)));
    assert!(passes(&e, found(0.905, 0.905)));
    // Vanished, turned around, grown, shrunk.
    for mean in [1.0, 1.1, 0.8, 0.95] {
        assert!(!passes(&e, found(mean, mean)), "{mean}");
    }
    assert!(!passes(&expected(Expectation::Right), found(0.9, 0.9)));
}

/// Errors of 1 % hide a bias of 0.2 %; the same random numbers without what makes it don't.
#[test]
fn a_small_bias_is_seen_beside_what_has_none() {
    let what = Expectation::Biased {
        by: -0.002,
        within: 0.001,
    };
    assert!(!passes(&expected(what), found(0.998, 0.998)));
    let e = Expected {
        beside: Some(Beside::Double),
        ..expected(what)
    };
    assert!(passes(&e, found(0.998, 1.0)));
    assert!(!passes(&e, found(1.0, 1.0)), "vanished");
    assert!(!passes(&e, found(0.99, 1.0)), "grown");
    assert!(!passes(&e, found(0.898, 0.9)), "f64 is wrong as well");
    let e = Expected {
        beside: Some(Beside::Plain),
        ..expected(what)
    };
    let beside = |plain: f64, single: f64| Found {
        plain: measured(plain),
        ..found(single, single)
    };
    assert!(passes(&e, beside(1.0, 0.998)));
    assert!(!passes(&e, beside(1.0, 1.0)), "vanished");
    assert!(
        !passes(&e, beside(0.9, 0.898)),
        "the plain scene is wrong as well"
    );
}

#[test]
fn what_is_wrong_needs_a_warning_and_what_is_right_none() {
    for (what, found) in [
        (TENTH, found(0.9, 0.9)),
        (Expectation::Heavy, heavy(1.0, 1.0)),
    ] {
        let e = expected(what);
        assert!(differs(&e, found.clone(), "take the cure").1.is_empty());
        assert_eq!(differs(&e, found, "it may rain").1.len(), 1, "{what:?}");
    }
    let right = expected(Expectation::Right);
    assert!(passes(&right, found(1.0, 1.0)));
    let alarmed = Found {
        warnings: vec!["few samples carry this image".into()],
        ..found(1.0, 1.0)
    };
    assert!(!passes(&right, alarmed));
}

/// Where few samples carry the image its mean may be off by much, in either precision: what they have in common shows by contributions that are clipped.
#[test]
fn precisions_are_compared_where_few_samples_carry_it_all() {
    let e = expected(Expectation::Heavy);
    let with = |clipped: [f64; 2]| Found {
        clipped: clipped.map(batches),
        ..heavy(0.3, 0.7)
    };
    assert!(passes(&e, with([0.1, 0.1])));
    assert!(passes(&e, with([0.0, 0.0])));
    let (outcome, differs) = differs(&e, with([0.101, 0.1]), "take the cure");
    assert_eq!((outcome, differs.len()), (Outcome::Heavy, 1), "{differs:?}");
}

#[test]
fn precisions_are_compared_everywhere_else() {
    assert!(!passes(&expected(Expectation::Right), found(1.001, 1.0)));
    assert!(!passes(&expected(TENTH), found(0.901, 0.9)));
}

/// The mean of a grey image is right by construction, wherever chains go.
#[test]
fn chains_go_where_the_light_is() {
    let e = expected(Expectation::Right);
    let with = |chains: [f64; 4], samples: [f64; 4]| {
        let parts = |means: [f64; 4]| means.map(|m| Estimate::of(&batches(m)));
        Found {
            parts: Some([parts(chains), parts(samples)]),
            ..found(1.0, 1.0)
        }
    };
    let there = [0.1, 0.2, 0.3, 0.4];
    assert!(passes(&e, with(there, there)));
    assert!(!passes(&e, with([0.1, 0.3, 0.2, 0.4], there)));
}

#[test]
fn energy_has_an_interval() {
    let case = Case {
        truth: Truth {
            value: vec![2.0],
            uncertainty: 0.0,
            source: String::new(),
        },
        name: String::new(),
        about: String::new(),
        scene: String::new(),
        added: None,
        defines: Vec::new(),
        samples: 1,
        expected: Vec::new(),
    };
    let energy = found(1.0, 1.0).energy(&case).unwrap();
    assert!((energy.value - 0.5).abs() < 0.002, "{energy:?}");
    assert!(energy.low < 0.5 && energy.high > 0.5, "{energy:?}");
    assert!(energy.high - energy.low < 0.005, "{energy:?}");
    assert!(Found::default().energy(&case).is_none());
}
