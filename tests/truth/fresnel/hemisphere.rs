//! Reflectance over all angles: P20, and what Schlick's approximation costs: P21.

use super::kernel::real::Real;
use super::kernel::surface::fresnel;
use etendue_tests::oracles::oracles;

/// Rounding of one R, which a mean over angles can't exceed, and the rule's own error.
const ROUNDING: f64 = 8.0 * Real::EPSILON as f64 + 1e-9;

/// ∫₀¹ f by Gauss–Legendre of five points on panels that shrink towards 0, where R is steepest.
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    const PANELS: u32 = 64;
    let edge = |i: u32| (f64::from(i) / f64::from(PANELS)).powi(3);
    (0..PANELS)
        .map(|i| {
            let (middle, half) = (0.5 * (edge(i + 1) + edge(i)), 0.5 * (edge(i + 1) - edge(i)));
            let sum: f64 = NODES.iter().map(|(x, w)| w * f(middle + half * x)).sum();
            sum * half
        })
        .sum()
}

fn exact(n: f64, cos: f64) -> f64 {
    fresnel::dielectric(1.0, n as Real, cos as Real).reflected as f64
}

fn schlick(n: f64, cos: f64) -> f64 {
    fresnel::schlick(1.0, n as Real, cos as Real).reflected as f64
}

/// ∫ R 2cos dcos.
fn external(n: f64) -> f64 {
    integral(|cos| 2.0 * cos * exact(n, cos))
}

/// The same from inside: all beyond the critical angle, and the rest by the cosine outside, in which R is smooth:
/// 2cos_i dcos_i = 2cos_t dcos_t/n².
fn internal(n: f64) -> f64 {
    let inside = |cos_t: f64| (1.0 - (1.0 - cos_t * cos_t) / (n * n)).sqrt();
    let rest = integral(|cos_t| {
        let b = fresnel::dielectric(n as Real, 1.0, inside(cos_t) as Real);
        2.0 * cos_t * b.reflected as f64
    });
    1.0 - 1.0 / (n * n) + rest / (n * n)
}

#[track_caller]
fn assert_met(got: f64, id: &str, value: f64, bound: f64) {
    assert!((got - value).abs() < bound, "{id}: {got} for {value}");
}

#[test]
fn hemispherical_reflectance() {
    for o in oracles("P20_diffuse_fresnel", "dfr_ext") {
        assert_met(external(o.parameter("n")), &o.id, o.value, ROUNDING);
    }
    for o in oracles("P20_diffuse_fresnel", "dfr_int") {
        // Near the critical angle rounding of the cosine costs half the digits.
        let bound = ROUNDING + (Real::EPSILON as f64).sqrt() * 1e-2;
        assert_met(internal(o.parameter("n")), &o.id, o.value, bound);
    }
    // A Lambertian base under a smooth coat, all orders of reflection between them (Saunderson 1942).
    for o in oracles("P20_diffuse_fresnel", "varnish") {
        let (n, rho) = (o.parameter("n"), o.parameter("rho"));
        let (e, i) = (external(n), internal(n));
        let got = e + (1.0 - e) * (1.0 - i) * rho / (1.0 - rho * i);
        let bound = 4.0 * (ROUNDING + (Real::EPSILON as f64).sqrt() * 1e-2);
        assert_met(got, &o.id, o.value, bound);
    }
}

#[test]
fn error_of_schlick() {
    for n in [1.5, 2.4] {
        let error = |cos: f64| schlick(n, cos) - exact(n, cos);
        for o in oracles("P21_schlick_error", &format!("schlick_n{n}_")) {
            let got = match o.id.rsplit_once(&format!("n{n}_")) {
                Some((_, "max_abs_err")) => (0..=20_000)
                    .map(|i| error(f64::from(i) / 20_000.0).abs())
                    .fold(0.0, f64::max),
                // The kinks where the error changes sign cost the rule some digits.
                Some((_, "mean_abs_err")) => integral(|cos| error(cos).abs()),
                Some((_, "cosw_signed_err")) => integral(|cos| 2.0 * cos * error(cos)),
                _ => panic!("{}: unknown", o.id),
            };
            assert_met(got, &o.id, o.value, ROUNDING + 1e-6);
        }
    }
}

/// From the denser side the cosine is that of the transmitted ray: all is reflected at the critical angle. With the incident one
/// the polynomial would fall short by what the oracle says.
#[test]
fn schlick_from_the_denser_side() {
    for o in oracles("P21_schlick_error", "schlick_internal") {
        let n = o.parameter("n");
        let cos = (1.0 - 1.0 / (n * n)).sqrt();
        let r0 = ((n - 1.0) / (n + 1.0)).powi(2);
        let of_the_incident = r0 + (1.0 - r0) * (1.0 - cos).powi(5);
        // Just off it, so that the answer isn't the exact one of total reflection; R has changed there by 5(1 − r₀)cos_t at most.
        let off = 64.0 * Real::EPSILON as f64;
        let cos_t = (2.1 * off * (n * n - 1.0)).sqrt();
        let b = fresnel::schlick(n as Real, 1.0, (cos * (1.0 + off)) as Real);
        assert!(b.transmitted > 0.0, "{}: {b:?}", o.id);
        let got = b.reflected as f64 - of_the_incident;
        assert_met(got, &o.id, o.value, ROUNDING + 5.0 * cos_t);
    }
}
