//! What must hold of every scene that the gate lets in.

use etendue::blob::format::needs;
use etendue::estimate::{Chain, Rule, Tree};
use etendue::random::Sequence;
use etendue::real::Vec3;
use etendue::shape::IsaKind;
use etendue::spectrum::Spectrum;
use etendue::{Estimator, Heuristic, Rgb, Scene, Scratch, Settings};

/// Every estimator, every heuristic.
const ALL: [(Estimator, Heuristic); 10] = [
    (Estimator::Path, Heuristic::Power),
    (Estimator::Path, Heuristic::Maximum),
    (Estimator::Light, Heuristic::Power),
    (Estimator::Bidirectional, Heuristic::Balance),
    (Estimator::Bidirectional, Heuristic::Power),
    (Estimator::Bidirectional, Heuristic::Cutoff),
    (Estimator::Bidirectional, Heuristic::Maximum),
    (Estimator::Distributed, Heuristic::Power),
    (Estimator::Quadrature, Heuristic::Power),
    (Estimator::QuadratureAndPath, Heuristic::Power),
];

/// Longest path that is asked for: what a hostile scene costs grows with its square.
const EDGES: u32 = 6;

/// One estimate of each kind: its value, the sum of its splats, how many there were.
type Answers = Vec<([f32; 3], [f32; 3], u32)>;

/// Estimates a few pixels, a ray and a probe with everything.
///
/// # Panics
/// If anything isn't finite and, but for wavelengths, ≥ 0, if a splat misses the image, or if two instruction sets differ.
pub fn estimates(scene: &Scene<'_>, seed: u64) {
    let first = answers(&scene.with_isa(IsaKind::Scalar), seed);
    let best = answers(&scene.with_isa(IsaKind::best()), seed);
    assert_eq!(first, best, "instruction sets differ");
}

fn answers(scene: &Scene<'_>, seed: u64) -> Answers {
    let [width, height] = scene.size();
    let mut scratch = Scratch::<8>::new();
    let mut out = Vec::new();
    for (i, (estimator, heuristic)) in (0u32..).zip(ALL) {
        let settings = Settings {
            estimator,
            heuristic,
            max_edges: Some(EDGES),
            seed,
            sequence: if seed & 2 != 0 {
                Sequence::Sobol
            } else {
                Sequence::Independent
            },
            roulette: [0.5, 0.0, 1.0][(seed % 3) as usize],
            tree: Tree {
                branching: [2, 2, 1, 0, 0, 0, 0, 0],
                lights: 2,
            },
            rule: Rule {
                order: 2,
                steps: 4,
                depth: 3,
                shift: seed & 1 != 0,
            },
            ..Settings::default()
        };
        let pixel = [
            (width / 2 + i * 7919) % width,
            (height / 2 + i * 104_729) % height,
        ];
        let (mut splats, mut count) = (Rgb::BLACK, 0);
        let own = scene.estimate(&settings, pixel, 0, &mut scratch, &mut |[x, y], value| {
            assert!(x < width && y < height, "a splat at {x}, {y}");
            fine(scene, value, "splat");
            splats += value;
            count += 1;
        });
        fine(scene, own, "sample");
        out.push((own.to_array(), splats.to_array(), count));
    }
    let settings = Settings {
        max_edges: Some(EDGES),
        seed,
        ..Settings::default()
    };
    let center = Vec3::from(scene.world().center);
    let along = scene.radiance(&settings, center, Vec3::Z, 0, 0, &mut scratch);
    let around = scene.irradiance(&settings, center, Vec3::X, 0, 0, &mut scratch);
    for value in [along, around] {
        fine(scene, value, "probe");
        out.push((value.to_array(), [0.0; 3], 0));
    }
    chains(scene, &settings, &mut scratch, &mut out);
    out
}

/// A few steps of a few chains.
fn chains(scene: &Scene<'_>, settings: &Settings, scratch: &mut Scratch<8>, out: &mut Answers) {
    let [width, height] = scene.size();
    let mut chain = Chain::<4>::new();
    for path in 0..6 {
        let view = &mut scratch.view(scene);
        let (mut splats, mut count) = (Rgb::BLACK, 0);
        let mut splat = |[x, y]: [u32; 2], value| {
            assert!(x < width && y < height, "a splat at {x}, {y}");
            fine(scene, value, "splat of a chain");
            splats += value;
            count += 1;
        };
        let mut settings = *settings;
        settings.mutations.above = [0.0, 1e-3, 1e30][path as usize % 3];
        let mean = scene.bootstrap(&settings, path, view, &mut splat);
        assert!(mean.is_finite() && mean >= 0.0, "{mean}");
        chain.start(scene, &settings, path, path, view);
        chain.advance(scene, &settings, 1.0, 6, view, &mut splat);
        out.push(([mean; 3], splats.to_array(), count));
    }
}

fn fine(scene: &Scene<'_>, value: Rgb, what: &str) {
    // A single wavelength is beyond sRGB's gamut.
    let signed = scene.has(needs::SPECTRAL);
    let good = |x: &f32| x.is_finite() && (signed || *x >= 0.0);
    assert!(value.to_array().iter().all(good), "{what} {value:?}");
}
