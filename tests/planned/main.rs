//! Estimators that plan their work ahead, ray trees and quadrature, against path tracing and closed forms; light maps; the panorama.
//!
//! Where estimates are compared they are means of [`BATCHES`] batches, and |z| < [`Z`] in each of 4 × 4 blocks and three channels: with some 120
//! degrees of freedom P(|t| > 5.9) = 3e-8, and there are about 3000 such comparisons: one false alarm in 10,000 runs.

mod airlight;
mod bake;
mod panorama;
mod patches;
mod quadrature;
mod steps;
mod thin;
mod touching;
mod trees;

use etendue::estimate::{Rule, Tree};
use etendue::{Estimator, Scene, Settings};
use etendue_host::description::Description;
use etendue_tests::matrix::{media, scenes};
use etendue_tests::render::{Estimate, blob, single};

const Z: f64 = 5.9;
const BATCHES: u64 = 64;

/// Blocks of the image.
fn estimates(d: &Description, settings: Settings, passes: u64) -> Vec<Estimate> {
    let bytes = blob(d);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let passes = etendue_tests::samples(passes);
    single::blocks::<32>(&scene, &settings, 4, passes, BATCHES)
}

fn by(estimator: Estimator) -> Settings {
    Settings {
        estimator,
        seed: 7,
        ..Settings::default()
    }
}

/// By path tracing.
fn path(d: &Description, max_edges: Option<u32>) -> Vec<Estimate> {
    let settings = Settings {
        max_edges,
        ..by(Estimator::Path)
    };
    estimates(d, settings, 40)
}

/// By ray trees of these levels.
fn tree(branching: [u8; 8], lights: u8) -> Settings {
    Settings {
        tree: Tree { branching, lights },
        ..by(Estimator::Distributed)
    }
}

/// By quadrature.
fn rule(estimator: Estimator, order: u8, steps: u16, shift: bool) -> Settings {
    Settings {
        rule: Rule {
            order,
            steps,
            shift,
            ..Rule::default()
        },
        ..by(estimator)
    }
}

/// Whether two estimates agree but for `bound`, of the mean.
fn assert_agree(what: &str, a: &[Estimate], b: &[Estimate], bound: f64) {
    let sum = |e: &[Estimate]| e.iter().map(|e| e.mean).sum::<f64>();
    let noise = |e: &[Estimate]| e.iter().map(|e| e.error.powi(2)).sum::<f64>().sqrt();
    assert!(sum(a) > 0.0, "{what}: nothing is seen");
    assert!(
        noise(a).hypot(noise(b)) < etendue_tests::noise(0.015) * sum(a),
        "{what}: too noisy to tell"
    );
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        let allowed = Z * x.error.hypot(y.error) + bound * x.mean.max(y.mean);
        assert!(
            (x.mean - y.mean).abs() <= allowed,
            "{what}: block {} channel {}: {x:?} against {y:?}, z = {:.1}",
            i / 3,
            i % 3,
            x.z(y)
        );
    }
}
