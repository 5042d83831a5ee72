//! Light of a point, scattered once on the way to a wall (`tests/data/airlight.json`): values, and the errors of the rule itself.

use etendue_host::blob::AlignedBlob;
use etendue_host::description::EmitterKind;
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, phase};
use glam::{DVec3, Vec3};
use serde_json::Value;
use std::sync::LazyLock;

static DATA: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../data/airlight.json")).unwrap());

struct Found {
    single: f64,
    double: f64,
}

fn number(o: &Value, name: &str) -> f64 {
    o[name].as_f64().unwrap_or_else(|| panic!("{o}: no {name}"))
}

/// Fog around the light and the wall.
fn scene(o: &Value) -> AlignedBlob {
    let mut b = Builder::new();
    let (sigma, albedo, g) = (number(o, "sigma_t"), number(o, "albedo"), number(o, "g"));
    let phase = phase(g as f32);
    let fog = b.medium([sigma as f32; 3], [albedo as f32; 3], phase);
    b.fog([-40.0; 3], [40.0; 3], fog);
    if let Some(x) = o["wall"].as_f64() {
        let x = x as f32;
        // Small: it ends the ray, and must not stand between the light and what the ray passes.
        b.quad([x, -1e-6, -1e-6], [0.0, 2e-6, 0.0], [0.0, 0.0, 2e-6], None);
    }
    b.light(EmitterKind::Point {
        position: [0.0, number(o, "light") as f32, 0.0],
        intensity: [1.0; 3],
    });
    b.description.emitters.last_mut().unwrap().medium = Some(fog);
    blob(&b.description)
}

/// Radiance from the line of sight through [`scene`], by `steps` steps.
fn radiance(bytes: &AlignedBlob, o: &Value, steps: u16, shift: Option<u64>) -> Found {
    let eye = number(o, "eye");
    let index = shift.unwrap_or(0);
    let single = {
        let settings = etendue::Settings {
            estimator: etendue::Estimator::Quadrature,
            rule: etendue::estimate::Rule {
                steps,
                shift: shift.is_some(),
                ..etendue::estimate::Rule::default()
            },
            ..etendue::Settings::default()
        };
        let scene = etendue::Scene::open(bytes.bytes()).unwrap();
        let mut scratch = etendue::Scratch::<8>::new();
        let eye = Vec3::new(eye as f32, 0.0, 0.0);
        scene
            .radiance(&settings, eye, Vec3::X, 0, index, &mut scratch)
            .g
    };
    let settings = etendue_f64::Settings {
        estimator: etendue_f64::Estimator::Quadrature,
        rule: etendue_f64::estimate::Rule {
            steps,
            shift: shift.is_some(),
            ..etendue_f64::estimate::Rule::default()
        },
        ..etendue_f64::Settings::default()
    };
    let scene = etendue_f64::Scene::open(bytes.bytes()).unwrap();
    let mut scratch = etendue_f64::Scratch::<8>::new();
    let eye = DVec3::new(eye, 0.0, 0.0);
    let double = scene
        .radiance(&settings, eye, DVec3::X, 0, index, &mut scratch)
        .g;
    Found {
        single: single.into(),
        double,
    }
}

/// With 16384 steps the rule's own error is below 1e-5 of the value; blobs have single precision's parameters, the values 1e-7 of error by that.
#[test]
fn values_are_met_by_fine_steps() {
    for o in DATA["airlight"].as_array().unwrap() {
        let found = radiance(&scene(o), o, 16384, None);
        let truth = number(o, "value");
        let off = |x: f64| (x / truth - 1.0).abs();
        let id = &o["id"];
        assert!(
            off(found.double) < 2e-5,
            "{id}: {} for {truth}",
            found.double
        );
        assert!(
            off(found.single) < 2e-3,
            "{id}: {} for {truth}",
            found.single
        );
    }
}

/// As fog thins out, single scattering per σ_s tends to what it is without attenuation, which takes less than 1.5e-4 here.
#[test]
fn fog_that_hardly_dims() {
    let o = &DATA["vacuum"];
    let found = radiance(&scene(o), o, 16384, None);
    let truth = number(o, "value") * number(o, "sigma_t");
    let [single, double] = [found.single, found.double].map(|x| 1.0 - x / truth);
    assert!((0.0..1.5e-4).contains(&double), "{double}");
    assert!(single.abs() < 2e-3, "{single}");
}

/// The rule's error is that of the trapezoid rule in the angle, number by number, and of order 2.
#[test]
fn errors_are_those_of_the_trapezoid_rule() {
    for o in DATA["orders"].as_array().unwrap() {
        let truth = number(o, "value");
        let bytes = scene(o);
        for (steps, error) in o["errors"].as_object().unwrap() {
            let steps: u16 = steps.parse().unwrap();
            let error = error.as_f64().unwrap();
            let found = radiance(&bytes, o, steps, None).double - truth;
            // The blob's parameters are rounded to single precision.
            let allowed = 1e-3 * error.abs() + 3e-7 * truth;
            assert!(
                (found - error).abs() < allowed,
                "{} by {steps} steps: error {found:e}, expected {error:e}",
                o["id"]
            );
        }
    }
}

/// A random shift takes the bias away: the mean of 4096 samples of 4 steps.
#[test]
fn shifted_steps_are_unbiased() {
    for o in DATA["orders"].as_array().unwrap() {
        let truth = number(o, "value");
        let bytes = scene(o);
        let one = |i| radiance(&bytes, o, 4, Some(i)).double;
        let samples: Vec<f64> = (0..4096).map(one).collect();
        let e = etendue_tests::render::Estimate::of(&samples);
        let z = (e.mean - truth) / e.error;
        // P(|z| > 5) = 6e-7, three times.
        assert!(
            z.abs() < 5.0 && e.error < 0.02 * truth,
            "{}: {e:?} for {truth}",
            o["id"]
        );
    }
}

/// Ray trees of one level, by flights: what is sent back per flight is as 1/d² at most, which has a variance where the line of sight doesn't come close
/// to the light. P(|z| > 5) = 6e-7, six times.
#[test]
fn ray_trees_meet_the_values() {
    let records = DATA["airlight"].as_array().unwrap();
    let mut seen = 0;
    for o in records.iter().filter(|o| number(o, "light") >= 0.3) {
        let scattered = number(o, "sigma_t") * number(o, "albedo");
        if scattered < 1e-3 {
            // No flight of thousands ends in so thin a fog.
            continue;
        }
        seen += 1;
        let bytes = scene(o);
        let scene = etendue::Scene::open(bytes.bytes()).unwrap();
        let settings = etendue::Settings {
            estimator: etendue::Estimator::Distributed,
            tree: etendue::estimate::Tree {
                branching: [1, 0, 0, 0, 0, 0, 0, 0],
                lights: 1,
            },
            ..etendue::Settings::default()
        };
        let mut scratch = etendue::Scratch::<8>::new();
        let eye = Vec3::new(number(o, "eye") as f32, 0.0, 0.0);
        let samples: Vec<f64> = (0..200_000)
            .map(|i| {
                let l = scene.radiance(&settings, eye, Vec3::X, 1, i, &mut scratch);
                f64::from(l.g)
            })
            .collect();
        let e = etendue_tests::render::Estimate::of(&samples);
        let truth = number(o, "value");
        let off = (e.mean - truth).abs();
        println!("{}: {e:?} for {truth}", o["id"]);
        assert!(
            off < 5.0 * e.error + 1e-5 * truth && e.error < 0.03 * truth,
            "{}: {e:?} for {truth}",
            o["id"]
        );
    }
    assert!(seen >= 4, "{seen}");
}
