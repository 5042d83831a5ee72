//! The estimators agree with each other: every block of every scene, whatever the sensor, the lights and the scale.
//!
//! Each estimate is the mean of [`BATCHES`] independent batches; two agree if |z| < [`Z`] in each of 4 × 4 blocks
//! and three channels. There are about 20,000 such comparisons here; with some 120 degrees of freedom
//! P(|t| > 5.9) = 3e-8, so the suite fails by chance about once in 1500 runs, and errors are a few parts in a thousand.

mod accuracy;
mod metropolis;
mod possible;
mod random;
mod roulette;
mod sequences;
mod spectra;
mod weights;

use etendue::{Estimator, Heuristic, Scene, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::Description;
use etendue_host::scene::{Changes, prepare};
use etendue_tests::matrix::everything::everything;
use etendue_tests::matrix::{Complete, Named, media, panes, scenes};
use etendue_tests::render::{Estimate, blob, double, single};
use etendue_tests::{noise, samples, some, takes};
use rayon::prelude::*;

const Z: f64 = 5.9;
const BATCHES: u64 = 64;
const BLOCKS: u32 = 4;

fn estimates(
    d: &Description,
    estimator: Estimator,
    heuristic: Heuristic,
    max_edges: Option<u32>,
    passes: u64,
) -> Vec<Estimate> {
    of_blob(&blob(d), estimator, heuristic, max_edges, passes)
}

fn of_blob(
    bytes: &AlignedBlob,
    estimator: Estimator,
    heuristic: Heuristic,
    max_edges: Option<u32>,
    passes: u64,
) -> Vec<Estimate> {
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

/// Up to which noise of the whole image's brightness a comparison is of use.
const NOISE: f64 = 0.012;

fn assert_agree(what: &str, a: &[Estimate], b: &[Estimate]) {
    assert_agree_up_to(NOISE, what, a, b);
}

fn assert_agree_up_to(most: f64, what: &str, a: &[Estimate], b: &[Estimate]) {
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
        (e * e + f * f).sqrt() < most * m,
        "{what}: too noisy to tell: {m} ± {e} against {n} ± {f}"
    );
}

/// Path against light against bidirectional by each heuristic; by half of the passes and two of the heuristics unless tests are to be deep.
fn agree(name: &str, d: &Description, complete: Complete, max_edges: Option<u32>) {
    // Seen where one of the estimates itself fails.
    println!("{name}");
    let of = |estimator, h, passes| estimates(d, estimator, h, max_edges, samples(passes));
    let compare = |what: String, a: &[Estimate], b: &[Estimate]| {
        assert_agree_up_to(noise(NOISE), &format!("{name}: path, {what}"), a, b);
    };
    let path = of(Estimator::Path, Heuristic::Power, 40);
    let heuristics = [
        Heuristic::Balance,
        Heuristic::Power,
        Heuristic::Cutoff,
        Heuristic::Maximum,
    ];
    let taken = (0..)
        .zip(heuristics)
        .filter(|(i, _)| takes(i + name.len(), 2));
    taken.par_bridge().for_each(|(_, h)| {
        let both = of(Estimator::Bidirectional, h, 12);
        compare(format!("bidirectional {h:?}"), &path, &both);
    });
    if complete == Complete::FromLight {
        let light = of(Estimator::Light, Heuristic::Power, 24);
        compare("light".into(), &path, &light);
    }
}

#[test]
fn objects() {
    scenes::objects()
        .iter()
        .for_each(|(name, d, complete)| agree(name, d, *complete, None));
}

#[test]
fn glossy() {
    scenes::glossy()
        .iter()
        .for_each(|(name, d, complete)| agree(name, d, *complete, None));
}

/// A blend shows the mixture of what its parts show alone, at first sight and by one light.
#[test]
fn blends_are_mixtures() {
    let with = |weight: f32| {
        let mut b = etendue_tests::scenes::Builder::new().camera(
            [0.0, -3.0, 1.6],
            [0.0, 0.0, 0.3],
            [0.0, 0.0, 1.0],
            40.0,
            [16, 16],
        );
        let parts = [b.diffuse([0.8, 0.2, 0.2]), b.diffuse([0.1, 0.3, 0.9])];
        let weight = etendue_host::description::ColorSource::Constant([weight; 3]);
        let blend = b.material(etendue_host::description::Model::Blend { parts, weight });
        let size = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        b.quad([-1.0, -1.0, 0.0], size[0], size[1], Some(blend));
        b.light(etendue_host::description::EmitterKind::Point {
            position: [0.7, -0.8, 1.5],
            intensity: [2.0; 3],
        });
        estimates(
            &b.description,
            Estimator::Path,
            Heuristic::Power,
            Some(2),
            40,
        )
    };
    let [first, second, mixed] = [0.0, 1.0, 0.3].map(with);
    for (i, mixed) in mixed.iter().enumerate() {
        let truth = 0.7 * first[i].mean + 0.3 * second[i].mean;
        let error = mixed.error.hypot(first[i].error).hypot(second[i].error);
        assert!(
            (mixed.mean - truth).abs() <= Z * error + 1e-6 * truth,
            "{i}: {mixed:?} for {truth}"
        );
    }
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
fn all_agree(scenes: Vec<Named>) {
    for (name, d, complete) in &scenes {
        agree(name, d, *complete, None);
    }
}

#[test]
fn fogs() {
    all_agree(media::fogs());
}

/// Every other one unless tests are to be deep: `medium` holds the ways of tracking against each other, and against truth.
#[test]
fn grids() {
    all_agree(some(media::grids(), 2));
}

#[test]
fn boundaries_of_media() {
    all_agree(media::boundaries());
}

#[test]
fn all_matter_in_one_scene() {
    all_agree(vec![everything()]);
}

#[test]
fn light_through_glass_behind_glass() {
    all_agree(panes::panes());
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
    for both in [vec![[exact, mesh]], media::spheres_and_meshes()].concat() {
        let [a, b] =
            both.map(|d| estimates(&d, Estimator::Bidirectional, Heuristic::Power, None, 24));
        assert_agree("sphere against mesh", &a, &b);
    }
}

/// Transforms that mirror: what is left goes right, and nothing else changes. What is said to be outside stays outside.
#[test]
fn mirrored_transforms() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("gem.obj"), scenes::GEM).unwrap();
    let image = |mirror: &str, estimator, passes| {
        let file = folder.path().join("scene.xml");
        std::fs::write(&file, scenes::MIRRORED.replace("<mirror/>", mirror)).unwrap();
        let made = prepare(&file, &[], Changes::default()).unwrap_or_else(|e| panic!("{e}"));
        of_blob(&made.blob, estimator, Heuristic::Power, None, passes)
    };
    let (path, both) = (Estimator::Path, Estimator::Bidirectional);
    let plain = image("", path, 40);
    assert_agree("as it is", &plain, &image("", both, 12));
    for (estimator, passes) in [(path, 40), (both, 12)] {
        let mirrored = image("<scale x=\"-1\"/>", estimator, passes);
        let rows = mirrored.chunks(3 * BLOCKS as usize);
        let back: Vec<Estimate> = rows
            .flat_map(|row| row.rchunks(3).flatten())
            .copied()
            .collect();
        assert_agree(&format!("mirrored, by {estimator:?}"), &plain, &back);
    }
}

/// Single against double precision, which share their random numbers.
#[test]
fn precisions() {
    let glossy = scenes::glossy();
    let (objects, lights) = (scenes::objects(), scenes::lights());
    for (name, d, _) in objects.iter().chain(&lights).chain(&glossy) {
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
