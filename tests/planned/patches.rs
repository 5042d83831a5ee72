//! Irradiance in media: under and within what absorbs, closed forms; in fog, what estimators say to each other.

use super::{BATCHES, Z, by, tree};
use etendue::real::Vec3;
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{EmitterKind, Phase};
use etendue_tests::matrix::media;
use etendue_tests::render::{Estimate, blob};
use etendue_tests::scenes::Builder;
use std::f64::consts::PI;

const SIGMA: [f32; 3] = [0.2, 1.0, 3.0];

/// 0 < z < 1 is full of what absorbs, so wide that a ray that leaves at the side brings nothing.
fn slab(light: EmitterKind) -> AlignedBlob {
    let mut b = Builder::new();
    let ink = b.medium(SIGMA, [0.0; 3], Phase::Isotropic);
    b.fog([-100.0, -100.0, 0.0], [100.0, 100.0, 1.0], ink);
    b.light(light);
    blob(&b.description)
}

fn irradiance(bytes: &AlignedBlob, at: Vec3, settings: &Settings, samples: u64) -> [Estimate; 3] {
    let scene = Scene::open(bytes.bytes()).unwrap();
    let mut scratch = Scratch::<16>::new();
    let mut means: [Vec<f64>; 3] = Default::default();
    for batch in 0..BATCHES {
        let mut sums = [0.0; 3];
        for index in 0..samples {
            let e = scene.irradiance(settings, at, Vec3::Z, batch, index, &mut scratch);
            for (sum, e) in sums.iter_mut().zip(e.to_array()) {
                *sum += f64::from(e);
            }
        }
        for (means, sum) in means.iter_mut().zip(sums) {
            means.push(sum / samples as f64);
        }
    }
    assert_eq!(scratch.counters.rejected, 0);
    means.map(|m| Estimate::of(&m))
}

/// Below the slab, and within it under three quarters of it.
const PLACES: [(f32, f64); 2] = [(-0.5, 1.0), (0.25, 0.75)];

/// Under a uniform sky it is 2π E₃(τ) = 2π ∫ µ e^(−τ/µ) dµ.
fn the_sky(estimator: Estimator, (z, thickness): (f32, f64)) {
    let bytes = slab(EmitterKind::Constant { radiance: [1.0; 3] });
    let found = irradiance(&bytes, Vec3::new(0.1, 0.2, z), &by(estimator), 1000);
    for (e, sigma) in found.into_iter().zip(SIGMA) {
        const STEPS: u32 = 10_000;
        let step = |i: u32| {
            let mu = (f64::from(i) + 0.5) / f64::from(STEPS);
            mu * (-f64::from(sigma) * thickness / mu).exp()
        };
        let truth = 2.0 * PI * (0..STEPS).map(step).sum::<f64>() / f64::from(STEPS);
        let off = (e.mean - truth).abs();
        assert!(
            off < Z * e.error + 1e-5 * truth && e.error < 0.02 * truth,
            "{estimator:?} at {z}, σ {sigma}: {e:?} for {truth}"
        );
    }
}

/// 8 · 3 means of 64: P(|t| > 5.9) = 1.5e-7 each.
#[test]
fn the_sky_through_what_absorbs() {
    let [below, within] = PLACES;
    for estimator in [
        Estimator::Path,
        Estimator::Distributed,
        Estimator::QuadratureAndPath,
    ] {
        the_sky(estimator, below);
        the_sky(estimator, within);
    }
    for estimator in [Estimator::Light, Estimator::Bidirectional] {
        the_sky(estimator, below);
    }
}

#[test]
fn the_sky_by_light_walks_within_what_absorbs() {
    let [_, within] = PLACES;
    the_sky(Estimator::Light, within);
    the_sky(Estimator::Bidirectional, within);
}

/// A point at height 2: I cos/d² e^(−σℓ) over the length ℓ of the way through the slab. Quadrature has no noise; the others draw which channel leads.
/// In single precision a ray leaves a triangle 200 wide by 1e-5 or so on either side, at this angle 4e-5 of the way.
#[test]
fn a_point_through_what_absorbs() {
    let bytes = slab(EmitterKind::Point {
        position: [0.9, 0.2, 2.0],
        intensity: [2.0, 3.0, 4.0],
    });
    for (z, thickness) in PLACES {
        let at = Vec3::new(0.1, 0.2, z);
        let height = f64::from(2.0 - z);
        let d = height.hypot(0.8);
        for estimator in [
            Estimator::Path,
            Estimator::Light,
            Estimator::Bidirectional,
            Estimator::Distributed,
            Estimator::Quadrature,
            Estimator::QuadratureAndPath,
        ] {
            let found = irradiance(&bytes, at, &by(estimator), 1000);
            for ((e, sigma), intensity) in found.into_iter().zip(SIGMA).zip([2.0, 3.0, 4.0]) {
                let through = (-f64::from(sigma) * thickness * d / height).exp();
                let truth = intensity * height / d.powi(3) * through;
                let noise = if estimator == Estimator::Quadrature {
                    1e-9
                } else {
                    0.01 * truth
                };
                assert!(
                    (e.mean - truth).abs() < Z * e.error + 3e-4 * truth && e.error <= noise,
                    "{estimator:?} at {z}, σ {sigma}: {e:?} for {truth}"
                );
            }
        }
    }
}

/// On the floor of rooms full of fog, of smoke, and with a flame. 3 · 4 · 3 comparisons, as above.
#[test]
fn estimators_agree_on_irradiance_in_fog() {
    let scenes = [
        media::fogs().swap_remove(1),
        media::grids().swap_remove(0),
        media::flames().swap_remove(0),
    ];
    let at = Vec3::new(0.2, -0.7, 0.0);
    for (name, d, _) in &scenes {
        let bytes = blob(d);
        let to = |max_edges, settings: Settings, samples| {
            let settings = Settings {
                max_edges,
                ..settings
            };
            irradiance(&bytes, at, &settings, etendue_tests::samples(samples))
        };
        let whole = to(None, by(Estimator::Path), 16_000);
        let short = to(Some(4), by(Estimator::Path), 16_000);
        for (truth, limit, settings, samples) in [
            (&whole, None, by(Estimator::Light), 16_000),
            (&whole, None, by(Estimator::Bidirectional), 8_000),
            (&whole, None, by(Estimator::QuadratureAndPath), 8_000),
            (&short, Some(4), tree([3, 2, 1, 0, 0, 0, 0, 0], 2), 4_000),
        ] {
            let found = to(limit, settings, samples);
            for (e, truth) in found.iter().zip(truth) {
                // Quadrature's rule across the lamp misses little from so far.
                let bound = match settings.estimator {
                    Estimator::QuadratureAndPath => 1e-3 * truth.mean,
                    _ => 0.0,
                };
                let off = (e.mean - truth.mean).abs();
                let what = format!("{name}, {:?}: {e:?} for {truth:?}", settings.estimator);
                assert!(off < Z * e.error.hypot(truth.error) + bound, "{what}");
                assert!(e.error < 0.02 * e.mean, "too noisy: {what}");
            }
        }
    }
}
