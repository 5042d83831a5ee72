//! Where single precision breaks: grazing light, lamps of a million, walls that hardly absorb.

use super::enclosures::{ROOMS, inside};
use super::{Ask, ask, ask_by, lamp};
use etendue::Estimator;
use etendue_host::description::{EmitterKind, Model};
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, V};

const UP: V = [0.0, 0.0, 1.0];
const DOWN: V = [0.0, 0.0, -1.0];

/// A floor in the plane z = 0 around the origin.
fn floor(b: &mut Builder, reflectance: f32) {
    let material = Some(b.diffuse([reflectance; 3]));
    b.quad(
        [-0.05, -0.05, 0.0],
        [0.1, 0.0, 0.0],
        [0.0, 0.1, 0.0],
        material,
    );
}

#[test]
fn light_that_grazes() {
    // A strip that stands on the floor's plane; radiance π, so that the floor's radiance is the oracle's irradiance.
    for (height, id) in [
        (1e-2f32, "grazing_strip_light_0.01"),
        (1e-4, "grazing_strip_light_0.0001"),
    ] {
        let mut b = Builder::new();
        floor(&mut b, 1.0);
        b.quad([1.0, -0.5, 0.0], [0.0, 0.0, height], [0.0, 1.0, 0.0], None)
            .emission = Some([std::f32::consts::PI; 3]);
        let from_above = Ask::Ray([0.0, 0.0, 0.01], DOWN);
        ask(&blob(&b.description), id, from_above, 3000, Some(2), 0.01);
    }
    let mut b = Builder::new();
    floor(&mut b, 0.8);
    let cos = 1e-4f32;
    b.light(EmitterKind::Directional {
        direction: [(1.0 - cos * cos).sqrt(), 0.0, -cos],
        irradiance: [1.0; 3],
    });
    let from_above = Ask::Ray([0.0, 0.0, 0.01], DOWN);
    ask(
        &blob(&b.description),
        "grazing_dir_lambert_0.0001",
        from_above,
        4,
        Some(2),
        0.01,
    );
}

#[test]
fn far_and_vast() {
    let mut b = Builder::new();
    floor(&mut b, 1.0);
    b.light(EmitterKind::Point {
        position: [0.0, 0.0, 1e6],
        intensity: [std::f32::consts::PI; 3],
    });
    let from_above = Ask::Ray([0.0, 0.0, 0.01], DOWN);
    ask(
        &blob(&b.description),
        "scale_point_1e+06",
        from_above,
        4,
        Some(2),
        0.01,
    );
    let mut b = Builder::new();
    let half = 1e6;
    lamp(
        &mut b,
        [-half, -half, 1.0],
        [0.0, 2.0 * half, 0.0],
        [2.0 * half, 0.0, 0.0],
    );
    ask(
        &blob(&b.description),
        "huge_rect_light_1e+06",
        Ask::Irradiance([0.0; 3], UP),
        200,
        None,
        0.01,
    );
}

#[test]
fn walls_that_hardly_absorb() {
    for (name, ray) in ROOMS {
        let id = format!("encl_{name}_Le0.001_rho0.999");
        let bytes = inside(name, 0.999, 1e-3);
        ask_by(&[Estimator::Path], &bytes, &id, ray, 100, None, 0.03);
        ask_by(&[Estimator::Bidirectional], &bytes, &id, ray, 1, None, 0.08);
    }
    let (name, ray) = ROOMS[0];
    let (id, bytes) = ("enclosure_rho0.9999", inside(name, 0.9999, 1.0));
    ask_by(&[Estimator::Path], &bytes, id, ray, 16, None, 0.03);
}

/// How long a ray is inside a unit sphere that it nearly misses. Half the digits of 1 − b are lost with b's own rounding, which is in the
/// question, and as many by the answer: with b as it is the chord must be right to ε/(1 − b²).
#[test]
fn chords_of_rays_that_graze() {
    let mut b = Builder::new();
    let null = b.material(Model::Null);
    b.sphere([0.0; 3], 1.0, Some(null));
    let bytes = blob(&b.description);
    let close = |id: &str, b: f64, chord: f64, epsilon: f64| {
        let truth = 2.0 * ((1.0 - b) * (1.0 + b)).sqrt();
        let bound = truth * 4.0 * epsilon / (1.0 - b * b) + 8.0 * epsilon;
        assert!((chord - truth).abs() < bound, "{id}: {chord} for {truth}");
        truth
    };
    for (id, gap) in [
        ("grazing_sphere_chord_1e-4", 1e-4),
        ("grazing_sphere_chord_1e-6", 1e-6),
        ("grazing_sphere_chord_1e-8", 1e-8),
    ] {
        let wide = {
            use etendue_f64::shape::{Ray, Scalar, Tracer as _};
            let scene = etendue_f64::Scene::open(bytes.bytes()).unwrap();
            let mut ray = Ray {
                origin: glam::DVec3::new(1.0 - gap, 0.0, -1.0),
                direction: glam::DVec3::Z,
                t_min: 0.0,
                t_max: f64::INFINITY,
            };
            let near = scene.tracer(Scalar).closest(&ray).unwrap().t;
            ray.t_min = near;
            scene.tracer(Scalar).closest(&ray).unwrap().t - near
        };
        let oracle = super::ORACLES[id]["value"].as_f64().unwrap();
        let truth = close(id, 1.0 - gap, wide, f64::EPSILON);
        // 1 − gap has been rounded: its last digits are a share of the gap.
        assert!((truth / oracle - 1.0).abs() < f64::EPSILON / gap, "{id}");
        // In single precision, where the last of them is 1, there is nothing but a touch.
        let b = (1.0 - gap) as f32;
        if b < 1.0 {
            use etendue::shape::{Ray, Scalar, Tracer as _};
            let scene = etendue::Scene::open(bytes.bytes()).unwrap();
            let mut ray = Ray {
                origin: glam::Vec3::new(b, 0.0, -1.0),
                direction: glam::Vec3::Z,
                t_min: 0.0,
                t_max: f32::INFINITY,
            };
            let near = scene.tracer(Scalar).closest(&ray).unwrap().t;
            ray.t_min = near;
            let chord = scene.tracer(Scalar).closest(&ray).unwrap().t - near;
            close(id, b.into(), chord.into(), f32::EPSILON.into());
        }
    }
}
