//! Albedos to be met: P23 (Phong), P24 (microfacets), P20's varnish (plastic).

use super::compiled::{materials, surface};
use super::energy::albedo;
use super::kernel::real::{Real, Vec3};
use super::kernel::spectrum::{Rgb, Spectrum};
use super::kernel::surface::curve::Curve;
use super::kernel::surface::microfacet::Masking;
use super::kernel::surface::{Local, Mode, Outlined, Plastic, RoughConductor, Surface};
use super::zoo::{All, Random, Specimen, channels, direction, facets};
use etendue_host::description::{ColorSource, Model};
use etendue_tests::oracles::{Oracle, oracles};
use etendue_tests::statistics::{Family, Moments, chi_square};
use std::f64::consts::{PI, TAU};

fn specimen(surface: Surface<Rgb>) -> Specimen {
    Specimen {
        name: "oracle",
        surface,
        lossless: false,
        glossy: true,
        reciprocal: Some(1.0),
    }
}

/// A lobe of exponent n, and how much more than Phong's is the normalisation: (n+2)/2π is the modified one's, (n+1)/2π the thesis's.
fn phong(n: f64, modified: bool) -> Surface<Rgb> {
    let constant = |c: f32| ColorSource::Constant([c; 3]);
    let all = materials(|b| {
        b.material(Model::Phong {
            diffuse_reflectance: constant(0.0),
            reflectance: constant(1.0),
            transmittance: constant(0.0),
            diffuse_transmittance: constant(0.0),
            exponent: n as f32,
            modified,
            ior: 1.0,
            fresnel: false,
        });
    });
    surface(&all[0])
}

/// The albedo by the normalisation: that of the table is the modified one.
fn scaled(albedo: f64, n: f64, modified: bool) -> f64 {
    if modified {
        albedo
    } else {
        albedo * (n + 1.0) / (n + 2.0)
    }
}

/// By draws, which works for any exponent: what they carry, and how many stay above the surface.
#[test]
fn phong_albedos() {
    const DRAWS: u64 = 100_000;
    let mut random = Random::new(20);
    let mut family = Family::new();
    let looks = |oracle: &Oracle| direction((oracle.parameter("degrees") * PI / 180.0).cos(), 0.3);
    for modified in [true, false] {
        for oracle in oracles("P23_phong", "phong_albedo") {
            let n = oracle.parameter("n");
            let (lobe, w) = (phong(n, modified), looks(&oracle));
            let mut moments = Moments::default();
            for _ in 0..DRAWS {
                let s = random.scatter(&lobe, w, Mode::Radiance);
                moments.add(s.map_or(0.0, |s| channels(s.weight)[0]));
            }
            // Of a cosine at 89° single precision has 2e-6.
            let p = moments.against(scaled(oracle.value, n, modified), 1e-5);
            family.add(p, format!("{}, modified: {modified}", oracle.id));
        }
    }
    for oracle in oracles("P23_phong", "phong_lobe_above") {
        let (lobe, w) = (phong(oracle.parameter("n"), true), looks(&oracle));
        let above = (0..DRAWS)
            .filter(|_| random.scatter(&lobe, w, Mode::Radiance).is_some())
            .count() as u64;
        let share = oracle.value.clamp(1e-7, 1.0 - 1e-7);
        let expected = [share, 1.0 - share].map(|s| s * DRAWS as f64);
        family.add(chi_square(&[above, DRAWS - above], &expected), &oracle.id);
    }
    family.judge();
}

/// The same by `eval`, where the quadrature sees the lobe.
#[test]
fn phong_albedos_by_quadrature() {
    for oracle in oracles("P23_phong", "phong_albedo") {
        let n = oracle.parameter("n");
        if n > 200.0 {
            continue;
        }
        let w = direction((oracle.parameter("degrees") * PI / 180.0).cos(), 0.3);
        for modified in [true, false] {
            let got = albedo(&specimen(phong(n, modified)), w)[0];
            let truth = scaled(oracle.value, n, modified);
            assert!((got - truth).abs() < 1e-4, "{}: {got}", oracle.id);
        }
    }
}

/// Where cosines near 1 have no digits left in single precision: lobes of exponents 10⁴ and 10⁵ are (n+2)/2π high, half as high at the half-power
/// angle; and half of all draws lie within the angle of ξ = 1/2.
#[test]
#[allow(clippy::useless_conversion)] // not useless in single precision
fn narrow_lobes_of_phong() {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let at = |angle: f64| direction(angle.cos(), 0.0);
    for oracle in oracles("P23_phong", "phong_pdf_peak") {
        let n = oracle.parameter("n");
        let surface = phong(n, true);
        let lobe = |w| channels(surface.of::<All>().eval(up, w))[0];
        let peak = (n + 2.0) / TAU;
        let [top, half] = [lobe(up), lobe(at(oracle.value))].map(|f| f / peak);
        // An angle of 4e-3 is a step of 6e-8 in single precision's sine: 3e-5 of the square of it, times n·angle² = 2 ln 2.
        assert!((top - 1.0).abs() < 1e-5, "{}: {top}", oracle.id);
        assert!((half - 0.5).abs() < 5e-5, "{}: {half}", oracle.id);
    }
    for oracle in oracles("P23_phong", "phong_sample") {
        let surface = phong(oracle.parameter("n"), true);
        let xi = oracle.parameter("xi") as Real;
        let drawn = surface
            .of::<All>()
            .sample(up, Mode::Radiance, 0.5, [xi, 0.25]);
        let wi = drawn.unwrap().wi;
        // 1 − cos by the sine, which has its digits.
        let sin2 = f64::from(wi.x).powi(2) + f64::from(wi.y).powi(2);
        let found = sin2 / (1.0 + (1.0 - sin2).sqrt());
        assert!(
            (found / oracle.value - 1.0).abs() < 1e-5,
            "{}: {found}",
            oracle.id
        );
    }
}

fn microfacets(id: &str, n: f64, alpha: f64) -> Surface<Rgb> {
    let (beckmann, masking) = match id.split('_').nth(1) {
        Some("gcorr") => (false, Masking::Correlated),
        Some("gsep") => (false, Masking::Separable),
        Some("bcorr") => (true, Masking::Correlated),
        Some("bV") => (true, Masking::Cavities),
        other => panic!("{other:?}"),
    };
    let (eta, k) = if n > 0.0 { (n, 0.0) } else { (0.0, 1.0) };
    Surface::Outlined(Outlined::RoughConductor(RoughConductor {
        facets: facets(alpha as Real, beckmann, masking),
        eta: Rgb::grey(eta as Real),
        k: Rgb::grey(k as Real),
        reflectance: Rgb::WHITE,
        mean: Rgb::BLACK,
        loss: Curve::ZERO,
    }))
}

#[test]
fn microfacet_albedos() {
    let mut random = Random::new(21);
    let mut family = Family::new();
    for oracle in oracles("P24_microfacet", "mf_") {
        let (n, alpha) = (oracle.parameter("n"), oracle.parameter("alpha"));
        let surface = microfacets(&oracle.id, n, alpha);
        let w = direction(oracle.parameter("cos"), 0.3);
        let mut moments = Moments::default();
        for _ in 0..40_000 {
            let s = random.scatter(&surface, w, Mode::Radiance);
            moments.add(s.map_or(0.0, |s| channels(s.weight)[0]));
        }
        family.add(moments.against(oracle.value, 1e-5), &oracle.id);
        if alpha >= 0.2 {
            let got = albedo(&specimen(surface), w)[0];
            assert!((got - oracle.value).abs() < 3e-4, "{}: {got}", oracle.id);
        }
    }
    family.judge();
}

/// Over the hemisphere a varnished Lambertian reflects what Saunderson says.
#[test]
fn varnish() {
    for oracle in oracles("P20_diffuse_fresnel", "varnish") {
        let (n, rho) = (oracle.parameter("n"), oracle.parameter("rho"));
        // ρ_i by the midpoint rule: 1 − (1 − ρ_e)/n².
        const STEPS: u32 = 512;
        let hemisphere = |f: &dyn Fn(f64) -> f64| -> f64 {
            (0..STEPS)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(STEPS);
                    4.0 * t.powi(3) * f(t * t) / f64::from(STEPS)
                })
                .sum()
        };
        let enters = hemisphere(&|cos| {
            let boundary = super::kernel::surface::fresnel::dielectric(1.0, n as Real, cos as Real);
            boundary.transmitted as f64
        });
        let inside = 1.0 - enters / (n * n);
        let plastic = specimen(Surface::Outlined(Outlined::Plastic(Plastic {
            base: Rgb::grey((rho / (n * n * (1.0 - rho * inside))) as Real),
            reflectance: Rgb::WHITE,
            ior: n as Real,
        })));
        const NODES: u32 = 24;
        let got: f64 = (0..NODES)
            .map(|i| {
                let t = (f64::from(i) + 0.5) / f64::from(NODES);
                let cos = t * t;
                4.0 * t.powi(3) * albedo(&plastic, direction(cos, 0.3))[0] / f64::from(NODES)
            })
            .sum();
        assert!((got - oracle.value).abs() < 2e-3, "{}: {got}", oracle.id);
    }
}
