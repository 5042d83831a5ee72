//! Fog so thin that nothing but single scattering is left: what a slab returns of a beam along its normal, and what it keeps
//! (`tests/data/slabs.json`, P30). One minus what gets through would lose all digits in single precision; the line of sight through it doesn't.

use etendue_host::blob::AlignedBlob;
use etendue_host::description::EmitterKind;
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, phase};
use serde_json::Value;
use std::f64::consts::PI;
use std::sync::LazyLock;

static DATA: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../data/slabs.json")).unwrap());

/// Half a wide slab's width: the line of sight that grazes most, [`NODES`]'s, is inside it.
const HALF: f32 = 1000.0;
/// Nodes of the sum over directions.
const NODES: u32 = 400;

/// 0 < z < 1, of optical thickness 1e-6 along the normal, with the sun above.
fn slab(albedo: f32, g: f32) -> AlignedBlob {
    let mut b = Builder::new();
    let phase = phase(g);
    let fog = b.medium([1e-6; 3], [albedo; 3], phase);
    b.fog([-HALF, -HALF, 0.0], [HALF, HALF, 1.0], fog);
    b.light(EmitterKind::Directional {
        direction: [0.0, 0.0, -1.0],
        irradiance: [1.0; 3],
    });
    blob(&b.description)
}

macro_rules! found {
    ($name:ident, $kernel:ident, $real:ty) => {
        mod $name {
            use super::{NODES, PI};
            use $kernel::estimate::Rule;
            use $kernel::real::Vec3;
            use $kernel::{Estimator, Scene, Scratch, Settings};

            fn settings() -> Settings {
                Settings {
                    estimator: Estimator::Quadrature,
                    rule: Rule {
                        steps: 64,
                        ..Rule::default()
                    },
                    ..Settings::default()
                }
            }

            /// What leaves the slab upwards (or downwards), scattered once: 2π ∫ L µ dµ by the midpoint rule in the angle, whose error is of
            /// order 2, at two numbers of nodes.
            pub fn scattered(bytes: &[u8], up: bool) -> f64 {
                let scene = Scene::open(bytes).unwrap();
                let mut scratch = Scratch::<8>::new();
                let z: $real = if up { 2.0 } else { -1.0 };
                let mut by = |nodes: u32| {
                    let step = 0.5 * PI / f64::from(nodes);
                    let one = |i: u32| {
                        let (sin, cos) = ((f64::from(i) + 0.5) * step).sin_cos();
                        // The direction of sight is against that of the light.
                        let towards = if up { -cos } else { cos };
                        let direction = Vec3::new(sin as $real, 0.0, towards as $real).normalize();
                        let from = Vec3::new(-(sin / cos) as $real, 0.0, z);
                        let l = scene.radiance(&settings(), from, direction, 0, 0, &mut scratch);
                        2.0 * PI * f64::from(l.g) * cos * sin * step
                    };
                    (0..nodes).map(one).sum::<f64>()
                };
                // Richardson.
                (4.0 * by(NODES) - by(NODES / 2)) / 3.0
            }

            /// What gets through without being scattered.
            pub fn direct(bytes: &[u8]) -> f64 {
                let scene = Scene::open(bytes).unwrap();
                let mut scratch = Scratch::<8>::new();
                let below = Vec3::new(0.0, 0.0, -1.0);
                let e = scene.irradiance(&settings(), below, Vec3::Z, 0, 0, &mut scratch);
                e.g.into()
            }
        }
    };
}

found!(single, etendue, f32);
found!(double, etendue_f64, f64);

fn truth(id: &str) -> f64 {
    DATA[id]["value"].as_f64().unwrap()
}

/// Double scattering is 6e-6 of the values; the rest is the rule's error. In single precision a ray leaves a triangle 2000 wide by 1.2e-4, at either side.
#[test]
fn what_comes_back() {
    for (id, albedo, g) in [
        ("thin_tau1e-6_a1.0_g0.0_UR1", 1.0, 0.0),
        ("thin_tau1e-6_a0.5_g0.9_UR1", 0.5, 0.9),
    ] {
        let bytes = slab(albedo, g);
        let value = truth(id);
        for (precision, found, allowed) in [
            ("single", single::scattered(bytes.bytes(), true), 4e-4),
            ("double", double::scattered(bytes.bytes(), true), 3e-5),
        ] {
            let off = found / value - 1.0;
            assert!(
                off.abs() < allowed,
                "{id} {precision}: {found:e}, off by {off:e}"
            );
        }
    }
}

/// In double precision: single precision's 1 − 1e-6 has one digit of the loss, and that one is right.
#[test]
fn what_is_kept() {
    let bytes = slab(0.5, 0.9);
    let value = truth("thin_tau1e-6_a0.5_g0.9_lossT");
    let [up, down] = [true, false].map(|up| double::scattered(bytes.bytes(), up));
    let loss = 1.0 - double::direct(bytes.bytes()) - up - down;
    let off = loss / value - 1.0;
    assert!(off.abs() < 1e-4, "{loss:e}, off by {off:e}");
    let dimmed = 1.0 - single::direct(bytes.bytes());
    let half_a_digit = f64::from(f32::EPSILON) / 2.0;
    assert!((dimmed - 1e-6).abs() < half_a_digit, "{dimmed:e}");
}
