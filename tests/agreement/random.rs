//! `path` and `bidirectional` on scenes that nobody thought of: lights, sensors, surfaces, media and depths put together at random.
//!
//! |z| < [`Z`] in 2 × 2 blocks and three channels of [`SCENES`] scenes: with 62 degrees of freedom P(|t| > 6) = 1.1e-7, one false alarm in 8000 runs.

use etendue::random::{Pcg, Purpose, Sampler};
use etendue::{Estimator, Scene, Settings};
use etendue_host::description::{Color, EmitterKind, Projection};
use etendue_tests::render::{blob, single};
use etendue_tests::scenes::{Builder, phase};

const SCENES: u64 = 96;
const BATCHES: u64 = 32;
const PASSES: u64 = 24;
const Z: f64 = 6.0;

struct Dice(Pcg);

impl Dice {
    fn number(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.one(Purpose::Choice)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.number(0.0, n as f32) as usize).min(n - 1)
    }

    fn color(&mut self, low: f32, high: f32) -> Color {
        [0; 3].map(|_| self.number(low, high))
    }
}

/// A scene, and what it is made of.
fn scene(seed: u64) -> (Builder, String) {
    let dice = &mut Dice(Pcg::from_seed(seed));
    let mut said = Vec::new();
    let mut b = Builder::new().camera(
        [0.1, -3.3, 1.2],
        [0.0, 0.0, 0.6],
        [0.0, 0.0, 1.0],
        50.0,
        [12, 12],
    );
    match dice.below(3) {
        0 => said.push("perspective"),
        1 => {
            said.push("orthographic");
            b.description.sensor.projection = Projection::Orthographic {
                half_extent: [1.5; 2],
            };
        }
        _ => {
            said.push("panorama");
            b.description.sensor.projection = Projection::Panorama;
        }
    }
    // Walks from the sensor don't meet what has no size: no glass where there is such a light.
    let smooth = dice.below(2) == 0;
    for _ in 0..=dice.below(2) {
        match dice.below(if smooth { 2 } else { 4 }) {
            0 => {
                said.push("sky");
                b.light(EmitterKind::Constant {
                    radiance: dice.color(0.1, 0.9),
                });
                break;
            }
            1 => {
                said.push("lamp");
                let center = [dice.number(-1.0, 1.0), dice.number(-1.0, 1.0), 2.0];
                b.sphere(center, 0.3, None).emission = Some([9.0, 7.0, 5.0]);
                break;
            }
            2 => {
                said.push("point");
                let position = [dice.number(-1.0, 1.0), dice.number(-1.0, 1.0), 1.8];
                b.light(EmitterKind::Point {
                    position,
                    intensity: [5.0, 4.0, 3.0],
                });
            }
            _ => {
                said.push("sun");
                let direction = [dice.number(-0.4, 0.4), dice.number(-0.4, 0.4), -1.0];
                let length = direction.iter().map(|x: &f32| x * x).sum::<f32>().sqrt();
                let direction = direction.map(|x| x / length);
                b.light(EmitterKind::Directional {
                    direction,
                    irradiance: [3.0, 3.0, 2.0],
                });
            }
        }
    }
    let air = (dice.below(4) == 0 && !said.contains(&"sun")).then(|| {
        said.push("in fog");
        let albedo = dice.color(0.3, 0.95);
        let air = b.medium([0.1, 0.2, 0.15], albedo, phase(0.6));
        b.fog([-4.0; 3], [4.0; 3], air);
        air
    });
    if dice.below(4) > 0 {
        said.push("floor");
        let floor = Some(b.diffuse(dice.color(0.1, 0.9)));
        b.quad([-2.5, -2.5, 0.0], [5.0, 0.0, 0.0], [0.0, 5.0, 0.0], floor);
    }
    for i in 0..=dice.below(3) {
        let center = [-1.2 + 1.2 * i as f32, dice.number(-0.5, 0.5), 0.6];
        let material = match dice.below(if smooth { 3 } else { 1 }) {
            0 => b.diffuse(dice.color(0.1, 0.9)),
            1 => b.mirror(0.9),
            _ => b.glass(1.4),
        };
        if dice.below(2) == 0 {
            said.push("ball");
            b.sphere(center, 0.5, Some(material));
            continue;
        }
        let size = dice.number(0.1, 4.0);
        let sigma_t = [
            size,
            size * dice.number(0.1, 1.0),
            size * dice.number(1.0, 3.0),
        ];
        let medium = b.medium(
            sigma_t,
            dice.color(0.0, 0.95),
            phase([0.0, 0.5, -0.5][dice.below(3)]),
        );
        let behind = match smooth && dice.below(2) == 0 {
            true => b.glass(1.3),
            false => b.null(),
        };
        said.push("matter");
        let shape = match dice.below(2) {
            0 => b.ball(center, 0.5, behind, medium),
            _ => {
                let [low, high] = [-0.4, 0.4].map(|by| center.map(|x| x + by));
                let shape = b.cuboid(low, high, false, Some(behind));
                shape.interior = Some(medium);
                shape
            }
        };
        shape.exterior = air;
    }
    (b, said.join(", "))
}

#[test]
fn of_scenes_that_nobody_thought_of() {
    let mut wrong = Vec::new();
    for seed in 0..SCENES {
        let (b, said) = scene(seed);
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let max_edges = [Some(2), Some(3), Some(5), None][seed as usize % 4];
        let [path, bidirectional] = [Estimator::Path, Estimator::Bidirectional].map(|estimator| {
            let settings = Settings {
                estimator,
                max_edges,
                seed: 7 + u64::from(estimator == Estimator::Path),
                ..Settings::default()
            };
            single::blocks::<32>(&scene, &settings, 2, PASSES, BATCHES)
        });
        let worst = path.iter().zip(&bidirectional).map(|(p, q)| (p.z(q), p, q));
        let (z, p, q) = worst
            .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
            .unwrap();
        println!("{seed}: z = {z:.1}, {max_edges:?}: {said}");
        if z.abs() > Z {
            wrong.push(format!(
                "{seed} ({said}): path {p:?}, bidirectional {q:?}, z = {z:.1}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
