//! The trapezoid rule in media, not shifted: single scattering in homogeneous media and on grids, what glows on grids, and all of it beside
//! the rest by path tracing. A line of sight is deterministic then, so that the rule's own error can be told from noise.

use super::{BATCHES, Z};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{EmitterKind, Grid, Medium, Phase};
use etendue_tests::render::{Estimate, blob};
use etendue_tests::scenes::{Builder, grid};

type V = [f64; 3];

/// A scene, lines of sight (origin, direction) and how many edges the paths have that the rule makes.
struct Case {
    name: &'static str,
    bytes: AlignedBlob,
    lines: Vec<[V; 2]>,
    edges: u32,
}

/// A floor, and what `furnish` puts over it.
fn open(furnish: impl FnOnce(&mut Builder)) -> AlignedBlob {
    let mut b = Builder::new();
    let grey = Some(b.diffuse([0.5; 3]));
    b.quad([-4.0, -4.0, -1.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], grey);
    furnish(&mut b);
    blob(&b.description)
}

fn point(b: &mut Builder, position: [f32; 3], medium: Option<usize>) {
    b.light(EmitterKind::Point {
        position,
        intensity: [3.0, 2.0, 1.0],
    });
    b.description.emitters.last_mut().unwrap().medium = medium;
}

const HG: Phase = Phase::HenyeyGreenstein { g: 0.5 };

/// Chromatic fog in a cube.
fn fog(b: &mut Builder) -> usize {
    let fog = b.medium([0.4, 0.7, 1.1], [0.9, 0.8, 0.6], HG);
    b.fog([-1.0; 3], [1.0, 1.0, 0.9], fog);
    fog
}

/// Smooth smoke, thickest in the middle, empty at the faces.
fn clouds() -> Grid {
    let hill = |x: f32| (4.0 * x * (1.0 - x)).powi(2);
    grid([6, 5, 4], |[x, y, z]| {
        hill(x) * hill(y) * hill(z) * (1.0 + x)
    })
}

fn smoke(b: &mut Builder, glows: bool) {
    let smoke = Medium {
        sigma_t: [3.0, 2.0, 1.0],
        albedo: [0.9, 0.7, 0.5],
        emission: if glows { [1.0, 2.0, 3.0] } else { [0.0; 3] },
        phase: vec![HG.into()],
        ..Medium::default()
    };
    let (low, high) = ([-1.0; 3], [1.0, 1.0, 0.9]);
    let smoke = b.smoke(low, high, clouds(), smoke);
    if glows {
        let grids = b.description.media[smoke].grids.as_mut().unwrap();
        grids.emission = Some(clouds());
    }
    b.fog(low, high, smoke);
}

fn cases() -> Vec<Case> {
    // Through the cube beside the middle, and down to the floor.
    let lines = vec![
        [[-3.0, 0.1, 0.2], [1.0, 0.05, 0.0]],
        [[-2.0, -2.0, 1.2], [0.7, 0.7, -0.4]],
    ];
    let case = |name, bytes| Case {
        name,
        bytes,
        lines: lines.clone(),
        edges: 2,
    };
    let globe = open(|b| {
        let glass = b.glass(1.4);
        let juice = b.medium([0.5, 1.0, 1.5], [0.8; 3], HG);
        b.ball([0.0; 3], 0.9, glass, juice);
        point(b, [0.1, -0.3, 0.3], Some(juice));
    });
    vec![
        case(
            "a point in fog",
            open(|b| {
                let fog = fog(b);
                point(b, [0.2, -0.4, 0.4], Some(fog));
            }),
        ),
        case(
            "a spot into fog",
            open(|b| {
                fog(b);
                // Wide: where its cone ends the rule has no order.
                b.light(EmitterKind::Spot {
                    position: [0.3, -0.5, 2.5],
                    direction: [0.0, 0.0, -1.0],
                    intensity: [9.0, 6.0, 3.0],
                    cutoff: 1.4,
                    beam_width: 1.3,
                });
            }),
        ),
        case(
            "the sun over fog",
            open(|b| {
                fog(b);
                b.light(EmitterKind::Directional {
                    direction: [0.48, 0.0, -0.8772684],
                    irradiance: [3.0, 2.5, 2.0],
                });
            }),
        ),
        case(
            "a point beside smoke",
            open(|b| {
                smoke(b, false);
                point(b, [0.2, -1.3, 0.5], None);
            }),
        ),
        // What glows is seen directly; that it is scattered is the path tracer's.
        Case {
            edges: 1,
            ..case("smoke that burns", open(|b| smoke(b, true)))
        },
        Case {
            name: "a point in juice in glass",
            bytes: globe,
            lines: vec![[[-3.0, 0.1, 0.2], [1.0, 0.05, 0.0]]],
            edges: 3,
        },
    ]
}

/// Radiance along a line by the deterministic rule, in double precision.
fn by_rule(case: &Case, [origin, direction]: [V; 2], steps: u16) -> [f64; 3] {
    let scene = etendue_f64::Scene::open(case.bytes.bytes()).unwrap();
    let settings = etendue_f64::Settings {
        estimator: etendue_f64::Estimator::Quadrature,
        max_edges: Some(case.edges),
        rule: etendue_f64::estimate::Rule {
            steps,
            ..etendue_f64::estimate::Rule::default()
        },
        ..etendue_f64::Settings::default()
    };
    let mut scratch = etendue_f64::Scratch::<8>::new();
    let (origin, direction) = (glam::DVec3::from(origin), glam::DVec3::from(direction));
    let direction = direction.normalize();
    let mut at = |id, index| scene.radiance(&settings, origin, direction, id, index, &mut scratch);
    let found = at(0, 0);
    assert_eq!(
        found.to_array(),
        at(3, 5).to_array(),
        "{}: nothing is random",
        case.name
    );
    found.to_array()
}

/// The same by samples, in single precision.
fn by_samples(case: &Case, [origin, direction]: [V; 2], how: etendue::Settings) -> [Estimate; 3] {
    let samples = etendue_tests::samples(4000);
    let scene = etendue::Scene::open(case.bytes.bytes()).unwrap();
    let [origin, direction] = [origin, direction].map(|v| glam::Vec3::from(v.map(|x| x as f32)));
    let direction = direction.normalize();
    let mut scratch = etendue::Scratch::<8>::new();
    let mut means: [Vec<f64>; 3] = Default::default();
    for batch in 0..BATCHES {
        let mut sums = [0.0; 3];
        for index in 0..samples {
            let l = scene.radiance(&how, origin, direction, batch, index, &mut scratch);
            for (sum, l) in sums.iter_mut().zip(l.to_array()) {
                *sum += f64::from(l);
            }
        }
        for (means, sum) in means.iter_mut().zip(sums) {
            means.push(sum / samples as f64);
        }
    }
    means.map(|m| Estimate::of(&m))
}

/// So fine that what is left is nothing beside noise: errors of order 2 are 2⁻¹⁴ of those at 32 steps.
const FINE: u16 = 4096;

/// Below this share of the light, errors are those at the planes where smoke bends, any of which may cancel another.
const KINKS: f64 = 1e-3;

/// At 8 steps the error of each line and channel is less than a tenth of the light. It at least halves when steps double, and stays below a tenth
/// over the square of how many times as many steps there are.
#[test]
fn errors_halve_at_least() {
    for case in cases() {
        for &line in &case.lines {
            let truth = by_rule(&case, line, FINE);
            let mut before = truth.map(|l| 0.2 * l);
            for steps in [8, 16, 32, 64, 128] {
                let found = by_rule(&case, line, steps);
                let error: [f64; 3] = std::array::from_fn(|c| (found[c] - truth[c]).abs());
                for c in 0..3 {
                    let bound = 0.1 * (8.0 / f64::from(steps)).powi(2);
                    assert!(
                        error[c] <= (0.5 * before[c]).max(KINKS * truth[c])
                            && error[c] <= bound * truth[c],
                        "{}, channel {c}: {:e} by {steps} steps after {:e}, of {:e}",
                        case.name,
                        error[c],
                        before[c],
                        truth[c]
                    );
                }
                before = error;
            }
        }
    }
}

/// What the rule tends to is what samples of the same paths give; and with the rest by path tracing, light of all paths is off by the rule's own
/// error and nothing else, whatever the number of steps. 11 lines, 3 channels, 3 comparisons: P(|t| > 5.9) = 1.5e-7 each.
#[test]
fn the_rules_error_is_all_there_is() {
    let path = etendue::Settings {
        estimator: etendue::Estimator::Path,
        seed: 5,
        ..etendue::Settings::default()
    };
    for case in cases() {
        for &line in &case.lines {
            let truth = by_rule(&case, line, FINE);
            let single = etendue::Settings {
                max_edges: Some(case.edges),
                ..path
            };
            let sampled = by_samples(&case, line, single);
            let all = by_samples(&case, line, path);
            for c in 0..3 {
                let (e, name) = (sampled[c], case.name);
                // Single precision, of coordinates too, has 1e-5.
                let allowed = Z * e.error + 1e-4 * truth[c];
                assert!((e.mean - truth[c]).abs() < allowed, "{name}, {c}: {e:?}");
                assert!(e.error < 0.01 * e.mean, "{name}, {c}: too noisy, {e:?}");
            }
            for steps in [2, 8] {
                let found = by_rule(&case, line, steps);
                let settings = etendue::Settings {
                    estimator: etendue::Estimator::QuadratureAndPath,
                    rule: etendue::estimate::Rule {
                        steps,
                        ..etendue::estimate::Rule::default()
                    },
                    seed: 6,
                    ..etendue::Settings::default()
                };
                let both = by_samples(&case, line, settings);
                for c in 0..3 {
                    let off = both[c].mean - all[c].mean - (found[c] - truth[c]);
                    let allowed = Z * both[c].error.hypot(all[c].error) + 1e-4 * truth[c];
                    assert!(
                        off.abs() < allowed,
                        "{}, {steps} steps, {c}: {:?} for {:?}",
                        case.name,
                        both[c],
                        all[c]
                    );
                }
            }
        }
    }
}
