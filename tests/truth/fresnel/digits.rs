//! Relative errors in units of the last place, against double precision at the same (rounded) arguments.

use super::kernel::real::Real;
use super::kernel::surface::fresnel;
use etendue_tests::fresnel as textbook;

const INDICES: [f64; 8] = [1.0001, 1.01, 1.1, 1.3333, 1.5, 2.4, 4.0, 0.75];

/// The textbook's own rounding near 1 and at grazing angles, in double precision.
const DOUBLE: f64 = 1e-11;

fn cosines() -> impl Iterator<Item = Real> {
    let grazing = (0..60).map(|i| 10f64.powf(-0.1 * f64::from(i)));
    let even = (1..100).map(|i| f64::from(i) / 100.0);
    grazing.chain(even).map(|cos| cos as Real)
}

/// Within `ulps`, relatively.
#[track_caller]
fn assert_close(got: Real, truth: f64, ulps: f64, context: &str) {
    let limit = (ulps * Real::EPSILON as f64).max(DOUBLE);
    assert!(
        (got as f64 - truth).abs() <= limit * truth.abs(),
        "{context}: {got} for {truth}"
    );
}

#[test]
fn dielectric_keeps_its_digits() {
    let mut checked = 0;
    for ior in INDICES.map(|n| n as Real) {
        for (from, to) in [(1.0, ior), (ior, 1.0)] {
            for cos in cosines() {
                let (n1, n2, c) = (from as f64, to as f64, cos as f64);
                let b = fresnel::dielectric(from, to, cos);
                let context = format!("{n1} to {n2} under {c}: {b:?}");
                // Near the critical angle cos²_t is a difference, whose rounding is not the formulas'.
                let cos_t_squared = n2 * n2 - n1 * n1 + n1 * n1 * c * c;
                let lost = (n1 * n1 * c * c / cos_t_squared.abs()).max(1.0);
                let (r, cos_t) = textbook::dielectric(n1, n2, c);
                if lost > 100.0 {
                    continue;
                }
                checked += 1;
                assert_close(b.reflected, r, 10.0 * lost, &context);
                assert_close(b.cos_t, cos_t, 4.0 * lost, &context);
                if r < 1.0 {
                    let t = textbook::transmitted(n1, n2, c);
                    assert_close(b.transmitted, t, 10.0 * lost, &context);
                } else {
                    assert_eq!(b.transmitted, 0.0, "{context}");
                }
                assert!((b.reflected + b.transmitted - 1.0).abs() <= Real::EPSILON);
            }
        }
    }
    assert!(checked > 2000, "{checked}: this would test nothing");
}

#[test]
fn schlick_keeps_its_digits() {
    for ior in INDICES.map(|n| n as Real) {
        for cos in cosines() {
            let (n, c) = (ior as f64, cos as f64);
            if n < 1.0 {
                continue; // seen from the denser side: below
            }
            let b = fresnel::schlick(1.0, ior, cos);
            let context = format!("1 to {n} under {c}: {b:?}");
            assert_close(b.reflected, textbook::schlick(1.0, n, c), 10.0, &context);
            let t = (1.0 - ((n - 1.0) / (n + 1.0)).powi(2)) * -(5.0 * (-c).ln_1p()).exp_m1();
            if c < 1.0 {
                assert_close(b.transmitted, t, 10.0, &context);
            }
            // The same from the other side of the same ray.
            let back = fresnel::schlick(ior, 1.0, b.cos_t);
            let apart = (back.reflected - b.reflected).abs();
            // What rounding does to the cosine on the way back, times the slope of the fifth power.
            let lost = 5.0 * n * n / c;
            assert!(
                (apart as f64) < 8.0 * Real::EPSILON as f64 * lost,
                "{context}: {back:?}"
            );
        }
    }
}

#[test]
fn conductor_keeps_its_digits() {
    // Gold, silver, aluminium, chromium, nearly nothing, extreme, a dielectric.
    for (eta, k) in [
        (0.143, 3.983),
        (0.05, 4.2),
        (1.2, 7.3),
        (3.2, 3.3),
        (1.0, 0.001),
        (0.01, 30.0),
        (1.5, 0.0),
    ] {
        let (eta, k) = (eta as Real, k as Real);
        for cos in cosines() {
            let r = fresnel::conductor(eta, k, cos);
            let (eta, k, cos) = (eta as f64, k as f64, cos as f64);
            let truth = textbook::conductor(eta, k, cos);
            let context = format!("{eta} + {k}i under {cos}");
            // Where nearly nothing reflects, R is the square of a difference.
            let lost = if truth < 1e-3 { 1e3 } else { 1.0 };
            assert_close(r, truth, 10.0 * lost, &context);
            // Silver absorbs a hundredth: its digits count.
            let absorbed = (1.0 - truth) as Real as f64;
            let off = (1.0 - r as f64) - absorbed;
            assert!(
                off.abs() < 4.0 * Real::EPSILON as f64 + DOUBLE,
                "{context}: {r} for {truth}"
            );
        }
    }
}

/// Without absorption a conductor is a dielectric.
#[test]
fn conductor_of_no_absorption_is_dielectric() {
    for ior in [0.75, 1.3333, 1.5, 2.4].map(|n| n as Real) {
        for cos in cosines() {
            let (a, b) = (
                fresnel::conductor(ior, 0.0, cos),
                fresnel::dielectric(1.0, ior, cos).reflected,
            );
            let off = (a - b).abs() as f64;
            assert!(
                off < 32.0 * Real::EPSILON as f64,
                "{ior} under {cos}: {a}, {b}"
            );
        }
    }
}

#[test]
fn degenerate_arguments_are_finite() {
    let cosines = [0.0, 1e-38, 1e-20, 1e-7, 0.5, 1.0, 1.0 + Real::EPSILON];
    let indices = [1e-3, 0.5, 1.0, 1.0 + Real::EPSILON, 1.5, 100.0, 1e4];
    let whole = |x: Real| (0.0..=1.0 + 4.0 * Real::EPSILON).contains(&x);
    for n in indices {
        for cos in cosines {
            for (from, to) in [(1.0, n), (n, 1.0)] {
                for b in [
                    fresnel::dielectric(from, to, cos),
                    fresnel::schlick(from, to, cos),
                ] {
                    let sane = whole(b.reflected) && whole(b.transmitted) && whole(b.cos_t);
                    assert!(sane, "{from} to {to} under {cos}: {b:?}");
                }
            }
            for k in [0.0, 1e-6, 1.0, 1e4] {
                let r = fresnel::conductor(n, k, cos);
                assert!(whole(r), "{n} + {k}i under {cos}: {r}");
            }
        }
    }
}
