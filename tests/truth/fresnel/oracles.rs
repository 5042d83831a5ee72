//! Numbers made elsewhere: P19, P22, P30.

use super::kernel::real::Real;
use super::kernel::surface::fresnel;
use etendue_tests::oracles::{Oracle, oracles};

/// How far rounding may move R: `condition` times an ulp of 1, on top of the oracle's own uncertainty.
fn bound(oracle: &Oracle, condition: f64) -> f64 {
    oracle.uncertainty + 8.0 * Real::EPSILON as f64 * condition
}

#[test]
fn reflectance_from_outside() {
    for oracle in oracles("P19_fresnel", "fr_") {
        let (n, cos) = (oracle.parameter("n"), oracle.parameter("cos"));
        let b = fresnel::dielectric(1.0, n as Real, cos as Real);
        // n − 1 is as exact as n is, and R changes with it.
        let off = (b.reflected as f64 - oracle.value).abs();
        assert!(off < bound(&oracle, n / (n - 1.0)), "{oracle:?}: {b:?}");
        let off = (b.transmitted as f64 - (1.0 - oracle.value)).abs();
        assert!(off < bound(&oracle, n / (n - 1.0)), "{oracle:?}: {b:?}");
    }
}

#[test]
fn total_internal_reflection() {
    for critical in oracles("P22_TIR", "tir_cosc") {
        let n = critical.parameter("n");
        let around = |k: f64| {
            let cos = (critical.value * (1.0 + k)) as Real;
            fresnel::dielectric(n as Real, 1.0, cos)
        };
        let ulps = 4.0 * Real::EPSILON as f64;
        assert_eq!(around(-ulps).reflected, 1.0);
        assert_eq!(around(-ulps).transmitted, 0.0);
        assert!(around(ulps).transmitted > 0.0);
    }
    for n in ["1.3", "1.5", "2.4", "1.0001"] {
        for oracle in oracles("P22_TIR", &format!("tir_n{n}_")) {
            let (n, cos) = (oracle.parameter("n"), oracle.parameter("cos"));
            let b = fresnel::dielectric(n as Real, 1.0, cos as Real);
            // cos²_t = n²cos² − (n² − 1): R is a function of its root, and rounding n or cos moves it by as much as
            // it is small.
            let cos_t_squared = n * n * cos * cos - (n * n - 1.0);
            let condition = (n * cos / cos_t_squared.abs().sqrt()).powi(2).max(1.0)
                * (1.0 - oracle.value).max(1e-12)
                + (n / (n - 1.0)).powi(2) * 1e-2;
            let off = (b.reflected as f64 - oracle.value).abs();
            assert!(off < bound(&oracle, condition), "{oracle:?}: {b:?}");
            let off = (b.transmitted as f64 - (1.0 - oracle.value)).abs();
            assert!(off < bound(&oracle, condition), "{oracle:?}: {b:?}");
        }
    }
}

/// Relative to 1 − R, however small.
#[test]
fn what_passes_at_grazing_angles() {
    for oracle in oracles("P30_hard_f32", "grazing_fresnel") {
        let (n, cos) = (oracle.parameter("n"), oracle.parameter("cos"));
        let b = fresnel::dielectric(1.0, n as Real, cos as Real);
        let off = (b.transmitted as f64 / oracle.value - 1.0).abs();
        let rounding = 8.0 * Real::EPSILON as f64 * n / (n - 1.0);
        assert!(off < rounding, "{oracle:?}: {b:?}");
    }
}
