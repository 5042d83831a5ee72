//! The estimators agree with each other: every block of every scene, whatever the sensor, the lights and the scale.
//!
//! Each estimate is the mean of [`BATCHES`] independent batches; two agree if |z| < [`Z`] in each of 4 × 4 blocks
//! and three channels. There are about 20,000 such comparisons here; with some 120 degrees of freedom
//! P(|t| > 5.9) = 3e-8, so the suite fails by chance about once in 1500 runs, and errors are a few parts in a thousand.

mod media;
mod scenes;
mod weights;

use etendue::{Estimator, Heuristic, Scene, Settings};
use etendue_host::description::Description;
use etendue_tests::render::{Estimate, blob, double, single};
use rayon::prelude::*;

const Z: f64 = 5.9;
const BATCHES: u64 = 64;
const BLOCKS: u32 = 4;

/// What can make all light of a scene.
#[derive(Clone, Copy, PartialEq)]
enum Complete {
    /// Path and bidirectional.
    FromSensor,
    /// Light tracing as well: no Dirac surface is seen.
    FromLight,
}

fn estimates(
    d: &Description,
    estimator: Estimator,
    heuristic: Heuristic,
    max_edges: Option<u32>,
    passes: u64,
) -> Vec<Estimate> {
    let bytes = blob(d);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let settings = Settings {
        estimator,
        heuristic,
        max_edges,
        seed: 7,
        ..Settings::default()
    };
    single::blocks::<32>(&scene, &settings, BLOCKS, passes, BATCHES)
}

fn assert_agree(what: &str, a: &[Estimate], b: &[Estimate]) {
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        let z = x.z(y);
        assert!(
            z.abs() < Z,
            "{what}: block {} channel {}: {x:?} against {y:?}: z = {z:.1}",
            i / 3,
            i % 3
        );
    }
    let total = |e: &[Estimate]| {
        (
            e.iter().map(|e| e.mean).sum::<f64>(),
            e.iter().map(|e| e.error.powi(2)).sum::<f64>().sqrt(),
        )
    };
    let ((m, e), (n, f)) = (total(a), total(b));
    assert!(m > 0.0, "{what}: nothing is seen");
    assert!(
        (e * e + f * f).sqrt() < 0.012 * m,
        "{what}: too noisy to tell: {m} ± {e} against {n} ± {f}"
    );
}

/// Path against light against bidirectional by each heuristic.
fn agree(name: &str, d: &Description, complete: Complete, max_edges: Option<u32>) {
    // Seen where one of the estimates itself fails.
    println!("{name}");
    let path = estimates(d, Estimator::Path, Heuristic::Power, max_edges, 40);
    let heuristics = [
        Heuristic::Balance,
        Heuristic::Power,
        Heuristic::Cutoff,
        Heuristic::Maximum,
    ];
    heuristics.par_iter().for_each(|&h| {
        let both = estimates(d, Estimator::Bidirectional, h, max_edges, 12);
        assert_agree(&format!("{name}: path, bidirectional {h:?}"), &path, &both);
    });
    if complete == Complete::FromLight {
        let light = estimates(d, Estimator::Light, Heuristic::Power, max_edges, 24);
        assert_agree(&format!("{name}: path, light"), &path, &light);
    }
}

#[test]
fn objects() {
    scenes::objects()
        .iter()
        .for_each(|(name, d, complete)| agree(name, d, *complete, None));
}

#[test]
fn lights() {
    scenes::lights()
        .iter()
        .for_each(|(name, d, complete)| agree(name, d, *complete, None));
}

#[test]
fn sensors() {
    scenes::sensors()
        .iter()
        .for_each(|(name, d, complete)| agree(name, d, *complete, None));
}

/// The same through what fills space.
fn all_agree(scenes: Vec<(&'static str, Description, Complete)>) {
    for (name, d, complete) in &scenes {
        agree(name, d, *complete, None);
    }
}

#[test]
fn fogs() {
    all_agree(media::fogs());
}

#[test]
fn grids() {
    all_agree(media::grids());
}

#[test]
fn boundaries_of_media() {
    all_agree(media::boundaries());
}

#[test]
fn lights_in_media() {
    all_agree(media::lights());
}

#[test]
fn flames() {
    all_agree(media::flames());
}

#[test]
fn sensors_in_media() {
    all_agree(media::sensors());
}

#[test]
fn depths() {
    let d = scenes::plain();
    for edges in 1..=4 {
        agree(
            &format!("at most {edges} edges"),
            &d,
            Complete::FromLight,
            Some(edges),
        );
    }
}

/// Radiance doesn't notice how large a scene is, or where.
#[test]
fn scale_and_place() {
    let reference = estimates(
        &scenes::plain(),
        Estimator::Path,
        Heuristic::Power,
        None,
        40,
    );
    for (k, by) in [
        (1e-3, [0.0; 3]),
        (1e3, [0.0; 3]),
        (1.0, [1000.0, -500.0, 250.0]),
        (1e-3, [0.5, 0.5, -0.5]),
    ] {
        let d = scenes::transformed(k, by);
        agree(
            &format!("scaled by {k}, moved by {by:?}"),
            &d,
            Complete::FromLight,
            None,
        );
        let here = estimates(&d, Estimator::Bidirectional, Heuristic::Power, None, 12);
        assert_agree(
            &format!("scaled by {k}, moved by {by:?}, against where it was"),
            &reference,
            &here,
        );
    }
}

/// A sphere and its fine mesh with smooth normals.
#[test]
fn spheres_and_their_meshes() {
    let (exact, mesh) = scenes::sphere_and_mesh();
    let a = estimates(&exact, Estimator::Bidirectional, Heuristic::Power, None, 24);
    let b = estimates(&mesh, Estimator::Bidirectional, Heuristic::Power, None, 24);
    assert_agree("sphere against mesh", &a, &b);
}

/// Single against double precision, which share their random numbers.
#[test]
fn precisions() {
    for (name, d, _) in scenes::objects().iter().chain(&scenes::lights()) {
        let bytes = blob(d);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let wide = etendue_f64::Scene::open(bytes.bytes()).unwrap();
        for (narrow, e) in [
            (Estimator::Path, etendue_f64::Estimator::Path),
            (
                Estimator::Bidirectional,
                etendue_f64::Estimator::Bidirectional,
            ),
        ] {
            let settings = Settings {
                estimator: narrow,
                ..Settings::default()
            };
            let a = single::blocks::<32>(&scene, &settings, BLOCKS, 4, BATCHES);
            let settings = etendue_f64::Settings {
                estimator: e,
                ..etendue_f64::Settings::default()
            };
            let b = double::blocks::<32>(&wide, &settings, BLOCKS, 4, BATCHES);
            for (i, (x, y)) in a.iter().zip(&b).enumerate() {
                assert!(
                    (x.mean - y.mean).abs() < Z * x.error.hypot(y.error) + 2e-6 * y.mean + 1e-12,
                    "{name} {narrow:?}, block {i}: {x:?} in single, {y:?} in double precision"
                );
            }
        }
    }
}

/// The storage of the light walk bounds the strategies, not the answer.
#[test]
fn any_capacity_is_unbiased() {
    let d = scenes::plain();
    let bytes = blob(&d);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let reference = estimates(&d, Estimator::Path, Heuristic::Power, None, 40);
    for heuristic in [Heuristic::Power, Heuristic::Balance, Heuristic::Maximum] {
        let settings = Settings {
            estimator: Estimator::Bidirectional,
            heuristic,
            ..Settings::default()
        };
        let results = [
            single::blocks::<1>(&scene, &settings, BLOCKS, 12, BATCHES),
            single::blocks::<2>(&scene, &settings, BLOCKS, 12, BATCHES),
            single::blocks::<3>(&scene, &settings, BLOCKS, 12, BATCHES),
            single::blocks::<8>(&scene, &settings, BLOCKS, 12, BATCHES),
        ];
        for r in &results {
            assert_agree(&format!("small storage, {heuristic:?}"), &reference, r);
        }
    }
}

/// Irradiance is π times the radiance of a white patch, whoever estimates it.
#[test]
fn irradiance_is_what_a_white_patch_reflects() {
    use etendue::Scratch;
    use etendue::real::Vec3;
    let bytes = blob(&scenes::plain());
    let scene = Scene::open(bytes.bytes()).unwrap();
    let (position, normal) = (Vec3::new(0.2, -0.7, 0.0), Vec3::Z);
    let estimate = |estimator| {
        let mut scratch = Scratch::<32>::new();
        let settings = Settings {
            estimator,
            ..Settings::default()
        };
        let batch = |b: u64| {
            (0..32_000)
                .map(|i| {
                    f64::from(
                        scene
                            .irradiance(&settings, position, normal, b, i, &mut scratch)
                            .g,
                    )
                })
                .sum::<f64>()
                / 32_000.0
        };
        Estimate::of(&(0..BATCHES).map(batch).collect::<Vec<_>>())
    };
    let path = estimate(Estimator::Path);
    assert!(path.error < 0.005 * path.mean, "{path:?}");
    for other in [Estimator::Light, Estimator::Bidirectional] {
        let e = estimate(other);
        assert!(path.z(&e).abs() < Z, "{path:?} by path, {e:?} by {other:?}");
    }
    // The floor reflects 0.7 of it, diffusely.
    let mut scratch = Scratch::<32>::new();
    let batch = |b: u64| {
        let one = |i| {
            f64::from(
                scene
                    .radiance(
                        &Settings::default(),
                        Vec3::new(0.2, -0.7, 0.5),
                        -Vec3::Z,
                        b,
                        i,
                        &mut scratch,
                    )
                    .g,
            )
        };
        (0..32_000).map(one).sum::<f64>() / 32_000.0 * std::f64::consts::PI / 0.7
    };
    let seen = Estimate::of(&(0..BATCHES).map(batch).collect::<Vec<_>>());
    assert!(
        path.z(&seen).abs() < Z,
        "{path:?} as irradiance, {seen:?} from the floor's radiance"
    );
}
