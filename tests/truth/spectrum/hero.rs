//! What colours stand for, and the four wavelengths of a path.

use super::kernel::real::Real;
use super::kernel::spectrum::{FIRST, Hero, LAST, Spectrum, interpolate, seen};

/// The mean over ξ of what `value` makes of a path's wavelengths, in linear sRGB. The integrand is smooth between the table's rows:
/// equal steps err by less than 2e-5.
fn mean(value: impl Fn(&<Hero as Spectrum>::Waves) -> Hero) -> [f64; 3] {
    const STEPS: u32 = 20_000;
    let mut sum = [0.0; 3];
    for i in 0..STEPS {
        let xi = (f64::from(i) + 0.5) / f64::from(STEPS);
        let (waves, _) = Hero::draw(xi as Real);
        let rgb = value(&waves).to_rgb(&waves).to_array();
        for (s, c) in sum.iter_mut().zip(rgb) {
            *s += c as f64 / f64::from(STEPS);
        }
    }
    sum
}

fn near(found: [f64; 3], truth: [f64; 3], tolerance: f64) {
    let off = found.iter().zip(truth).map(|(a, b)| (a - b).abs());
    assert!(
        off.fold(0.0, f64::max) < tolerance,
        "{found:?} for {truth:?}"
    );
}

const COLORS: [[f32; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.2, 0.7, 0.4],
    [30.0, 2.0, 0.0],
];

/// Light of a colour is seen in that colour, and white light from a surface of a colour too.
#[test]
fn colours_are_what_they_stand_for() {
    for rgb in COLORS {
        let truth = rgb.map(f64::from);
        let tolerance = 5e-5 * truth.iter().fold(1.0, |a: f64, b| a.max(*b));
        near(mean(|w| Hero::light(rgb, w)), truth, tolerance);
        near(
            mean(|w| Hero::light([1.0; 3], w) * Hero::lift(rgb, w)),
            truth,
            tolerance,
        );
    }
}

/// A reflectance stays one, grey is the same at all wavelengths, and lifting is linear.
#[test]
fn lifts_keep_their_bounds() {
    for i in 0..1000 {
        let (waves, lead) = Hero::draw(i as Real / 1000.0);
        assert_eq!(lead, 0);
        for rgb in COLORS {
            let most = rgb.iter().fold(0.0, |a: f32, b| a.max(*b)) as Real;
            for x in Hero::lift(rgb, &waves).0 {
                assert!(
                    (0.0..=most * (1.0 + 4.0 * Real::EPSILON)).contains(&x),
                    "{rgb:?}: {x}"
                );
            }
        }
        for x in Hero::lift([0.3; 3], &waves).0 {
            assert!((x / 0.3f32 as Real - 1.0).abs() < 4.0 * Real::EPSILON);
        }
    }
}

/// In range, spread as they say, and each but a quarter further than the one before.
#[test]
fn wavelengths_are_spread() {
    let mut below = [0u32; 4];
    const STEPS: u32 = 4000;
    for i in 0..STEPS {
        let xi = (i as Real + 0.5) / STEPS as Real;
        let (waves, _) = Hero::draw(xi);
        let (later, _) = Hero::draw(if xi < 0.75 { xi + 0.25 } else { xi - 0.75 });
        let (now, then) = (Hero::wavelengths(&waves).0, Hero::wavelengths(&later).0);
        for k in 0..4 {
            assert!((FIRST..=LAST).contains(&now[k]));
            assert!(
                (then[k] - now[(k + 1) % 4]).abs() < 0.05,
                "{now:?} {then:?}"
            );
            below[k] += u32::from(now[k] < 505.0);
        }
    }
    // Of the logistic distribution between 380 and 780 nm, what lies below its middle.
    let logistic = |x: f64| 1.0 / (1.0 + ((505.0 - x) / 80.0).exp());
    let share = (0.5 - logistic(380.0)) / (logistic(780.0) - logistic(380.0));
    for n in below {
        assert!((f64::from(n) / f64::from(STEPS) - share).abs() < 1e-3);
    }
}

/// A spectrum given as a table, sampled, is seen as it is by integration.
#[test]
fn tables_are_seen() {
    let rows = [[400.0f32, 0.0], [450.0, 2.0], [600.0, 0.5], [650.0, 3.0]];
    let words = rows.map(|row| row.map(f32::to_bits));
    for (nm, value) in [(300.0, 0.0), (425.0, 1.0), (525.0, 1.25), (700.0, 3.0)] {
        assert!((interpolate(&words, nm) - value).abs() < 1e-5);
    }
    assert_eq!(interpolate(&[], 500.0), 0.0);
    let truth = seen(|nm| interpolate(&words, nm))
        .to_array()
        .map(|c| c as f64);
    near(mean(|w| Hero::tabulated(&words, w).unwrap()), truth, 3e-4);
}
