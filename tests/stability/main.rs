//! The atlas of scenes at which methods break, at a small budget: everything has to come out as it is written down
//! (`host/scenes/stability/manifest.json`), with the seed that the program has by default.

mod judging;

use etendue::Estimator;
use etendue_host::reach::unreachable;
use etendue_host::render::{Budget as Passes, Crew, doubts, render_with};
use etendue_host::stability::{
    Budget, Expectation, estimators, manifest, name, prepare, run, settings,
};
use std::sync::atomic::AtomicBool;

/// Nothing is compared with a truth that nobody can have been told; every estimator has an outcome in every case; and none that can't be missed.
#[test]
fn the_manifest_says_why() {
    let cases = manifest().unwrap();
    for case in &cases {
        assert!(
            !case.about.is_empty() && !case.truth.source.is_empty(),
            "{}",
            case.name
        );
        let same = cases.iter().filter(|c| c.name == case.name).count();
        assert_eq!(same, 1, "{}", case.name);
        for e in &case.expected {
            let place = format!("{}, {}", case.name, name(e.estimator));
            assert!(!e.why.is_empty(), "{place}");
            if let Expectation::Biased { by, within } = e.what {
                assert!(by.abs() > within, "{place}: no bias would do as well");
            }
            let wrong = matches!(e.what, Expectation::Biased { .. } | Expectation::Heavy);
            assert_eq!(
                wrong,
                e.warns.is_some(),
                "{place}: a cure, if there is anything wrong"
            );
        }
        for (estimator, name) in estimators() {
            let said = case.expected.iter().filter(|e| e.estimator == estimator);
            assert_eq!(said.count(), 1, "{}, {name}", case.name);
        }
    }
}

#[test]
fn everything_comes_out_as_written_down() {
    let ready = prepare(manifest().unwrap()).unwrap();
    let budget = Budget {
        scale: 0.5,
        seed: 0,
    };
    let rows = run(&ready, &budget, &|_, _| ()).unwrap();
    let differ: Vec<_> = rows
        .iter()
        .filter(|r| !r.is_met())
        .map(|r| format!("{}, {}: {}", r.case.name, r.name(), r.differs.join("; ")))
        .collect();
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

/// Where light paths are missing the program names them, and where an estimator makes all there are it names none.
#[test]
fn what_is_missing_is_named() {
    for ready in prepare(manifest().unwrap()).unwrap() {
        let scene = etendue::Scene::open(ready.blob.bytes()).unwrap();
        for e in &ready.case.expected {
            let named = unreachable(&scene, &settings(e.estimator, ready.max_edges, 0));
            let place = format!("{}, {}: {named:?}", ready.case.name, name(e.estimator));
            if e.what == Expectation::Misses {
                assert!(!named.is_empty(), "{place}");
            }
            // A walk from the sensor meets every light that has a size.
            if e.estimator == Estimator::Path && e.what == Expectation::Right {
                assert!(named.is_empty(), "{place}");
            }
        }
    }
}

/// A render whose samples are few that carry it all, or whose rules are too coarse, says so at its end, with the cure; one of the estimator that is
/// right there says nothing.
#[test]
fn renders_doubt_themselves() {
    let (mut warned, mut silent) = (0, 0);
    for ready in prepare(manifest().unwrap()).unwrap() {
        let scene = etendue::Scene::open(ready.blob.bytes()).unwrap();
        let size = scene.size().map(u64::from);
        for e in &ready.case.expected {
            let passes = (0.5 * ready.case.samples as f64 * e.factor).max(32.0) as u64;
            // Chains have their own numbers of samples, at least 8192: enough for those that are heavy, long for the others.
            let costly = e.estimator == Estimator::Metropolis && e.what != Expectation::Heavy;
            if costly || size[0] * size[1] * passes < 1024 {
                continue;
            }
            let settings = settings(e.estimator, ready.max_edges, 0);
            let warns = match e.what {
                Expectation::Heavy => true,
                Expectation::Biased { .. } => ready.warnings.is_empty(),
                Expectation::Right if e.estimator == Estimator::Quadrature => false,
                _ => continue,
            };
            let (budget, never) = (Passes::Passes(passes), AtomicBool::new(false));
            let crew = Crew::Own(0);
            let rendered = render_with(&scene, settings, budget, crew, &never, &|_| ()).unwrap();
            let said = doubts(&scene, &settings, &rendered);
            let place = format!("{}, {}: {said:?}", ready.case.name, name(e.estimator));
            if warns {
                let cure = e.warns.as_deref().unwrap();
                assert!(said.iter().any(|w| w.contains(cure)), "{place}");
                warned += 1;
            } else {
                assert!(said.is_empty(), "{place}");
                silent += 1;
            }
        }
    }
    assert!(warned >= 20 && silent >= 10, "{warned} {silent}");
}
