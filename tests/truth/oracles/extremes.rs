//! Where single precision breaks: grazing light, lamps of a million, walls that hardly absorb.

use super::{Ask, ask, ask_by, lamp};
use etendue::Estimator;
use etendue_host::description::{EmitterKind, Geometry};
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
    for (rho, emission, n, id) in [
        (0.999, 1e-3, 100, "encl_sphere_Le0.001_rho0.999"),
        (0.9999, 1.0, 16, "enclosure_rho0.9999"),
    ] {
        let mut b = Builder::new();
        let wall = Some(b.diffuse([rho; 3]));
        let sphere = Geometry::Sphere {
            center: [0.0; 3],
            radius: 1.0,
            flipped: true,
        };
        b.shape(sphere, wall).emission = Some([emission; 3]);
        let bytes = blob(&b.description);
        let ray = Ask::Ray([0.1, 0.2, 0.0], [0.3, 0.4, 0.5]);
        ask_by(&[Estimator::Path], &bytes, id, ray, n, None, 0.03);
        if rho < 0.9995 {
            ask_by(&[Estimator::Bidirectional], &bytes, id, ray, 1, None, 0.08);
        }
    }
}
