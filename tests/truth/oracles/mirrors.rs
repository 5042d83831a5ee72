//! Mirrors: a paraboloid's focus, a ball in the sun, a hall of two.

use super::light::{orthographic, seen_by_light};
use super::{Ask, ORACLES, ask, polygon};
use etendue_host::description::{EmitterKind, Geometry, Model};
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, round};
use glam::{DMat3, DVec3};

fn oracle(id: &str) -> f64 {
    ORACLES[id]["value"].as_f64().unwrap()
}

/// Rays from the focus leave a paraboloid parallel to its axis: a lamp far up, as wide as the mirror, is all they meet.
#[test]
fn the_focus_of_a_paraboloid() {
    for (rim, reflectance, radiance, samples, tag) in [
        (1.0f32, 1.0, 1.0, 1500, "a1_f1"),
        (2.0, 1.0, 1.0, 1500, "a2_f1"),
        (0.1, 0.8, 100.0, 8000, "a0.1_f1"),
    ] {
        let mut b = Builder::new();
        let mirror = Some(b.mirror(reflectance));
        let (rings, sectors) = (64u32, 512u32);
        let mesh = round(rings, sectors, |i, j| {
            // The innermost ring is a tiny hole that nobody sees through: nothing lies behind it.
            let r = rim * (i as f32 / rings as f32).max(1e-4);
            let (sin, cos) = (2.0 * std::f32::consts::PI * j as f32 / sectors as f32).sin_cos();
            let slope = glam::Vec3::new(-0.5 * r * cos, -0.5 * r * sin, 1.0).normalize();
            ([r * cos, r * sin, 0.25 * r * r], slope.into())
        });
        b.shape(Geometry::Mesh(mesh), mirror);
        // A little wider than the mirror: facets and rounding spread the rays.
        let half = 1.05 * rim;
        b.quad(
            [-half, -half, 20.0],
            [0.0, 2.0 * half, 0.0],
            [2.0 * half, 0.0, 0.0],
            None,
        )
        .emission = Some([radiance; 3]);
        let focus = Ask::Irradiance([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
        ask(
            &blob(&b.description),
            &format!("paraboloid_{tag}"),
            focus,
            samples,
            None,
            0.02,
        );
    }
}

/// Flux that a unit mirror ball at the origin throws on a disc, from unit irradiance along −z: the rays of a fine grid, each
/// reflected and met with the disc's plane. `around` is where on the grid they matter, `half` how far.
fn thrown(center: DVec3, normal: DVec3, radius: f64, around: f64, half: f64) -> f64 {
    let n = 2000;
    let step = 2.0 * half / f64::from(n);
    let mut hits = 0u32;
    for i in 0..n {
        for j in 0..n {
            let x = around - half + (f64::from(i) + 0.5) * step;
            let y = -half + (f64::from(j) + 0.5) * step;
            // On the ball the point is its own normal.
            let p = DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
            let d = DVec3::NEG_Z + p * (2.0 * p.z);
            let t = (center - p).dot(normal) / d.dot(normal);
            let facing = d.dot(normal) < 0.0 && t > 0.0;
            hits += u32::from(facing && (p + d * t).distance_squared(center) < radius * radius);
        }
    }
    f64::from(hits) * step * step
}

/// A receiver that light passes from behind: only what comes from the ball meets it. Receivers have a size: what the law of reflection
/// says of that is checked against the oracle for a small one, and the estimators against it for a large one.
#[test]
fn a_ball_in_the_sun() {
    let distance = [(0.0, 1.0, "i0_s1"), (60.0, 5.0, "i60_s5")];
    for ((angle, s, tag), radius) in distance.into_iter().zip([0.25, 0.7]) {
        let id = format!("mirrorball_{tag}");
        let (sin, cos) = f64::to_radians(angle).sin_cos();
        let p = DVec3::new(sin, 0.0, cos);
        let away = DVec3::NEG_Z + p * (2.0 * p.z);
        let center = p + away * s;
        // The ball spreads light at least so much: twice where the receiver's rim sends the beam's grid.
        let reach = |radius: f64| (2.0 * radius / (1.0 + 2.0 * s * cos)).min(1.0 - sin);
        let mean =
            |r: f64| thrown(center, -away, r, sin, reach(r)) / (std::f64::consts::PI * r * r);
        assert!(
            (mean(0.02) / oracle(&id) - 1.0).abs() < 2e-3,
            "{id}: {}",
            mean(0.02)
        );
        let expected = mean(radius);
        let mut b = Builder::new();
        let (mirror, white, null) = (b.mirror(1.0), b.diffuse([1.0; 3]), b.material(Model::Null));
        b.sphere([0.0; 3], 1.0, Some(mirror));
        // A disc in the plane across the reflected ray, its front towards the ball.
        let right = away.cross(DVec3::Y).normalize();
        let frame = DMat3::from_cols(right, away.cross(right), away);
        let mut disc = polygon([0.0; 3], radius, true);
        for p in &mut disc.positions {
            *p = (frame * DVec3::from(p.map(f64::from)) + center)
                .as_vec3()
                .to_array();
        }
        let receiver = b.shape(Geometry::Mesh(disc), Some(white));
        receiver.back = Some(null);
        // The sun itself is kept off by a roof; where the receiver faces down there is no need.
        if away.z < 0.0 {
            let corner = center + DVec3::new(-1.0, -1.5, 1.5);
            let corner = corner.as_vec3().to_array();
            b.quad(corner, [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], None);
        }
        b.light(EmitterKind::Directional {
            direction: [0.0, 0.0, -1.0],
            irradiance: [1.0; 3],
        });
        let half = radius as f32;
        let columns = [center - away * (0.5 * s), away, right, away.cross(right)];
        let [eye, forward, right, down] = columns.map(|v| v.as_vec3().to_array());
        orthographic(&mut b, eye, forward, right, down, half);
        // The camera sees a square, of which the disc is π/4: E = π·radiance·4/π.
        let factor = 4.0 * oracle(&id) / expected;
        seen_by_light(b, &id, factor, Some(3), 100, 0.04);
    }
}

/// A lamp's images in two mirrors that face each other, n reflections away: all of them light the floor.
#[test]
fn a_hall_of_two_mirrors() {
    for (rho, lamp, at, height, tag) in [
        (0.9, 0.3, 0.3, 1.0, "0.9_0.3_0.3"),
        (0.5, 0.3, 0.8, 1.0, "0.5_0.3_0.8"),
        (0.99, 0.5, 0.1, 2.0, "0.99_0.5_0.1"),
    ] {
        let id = format!("mirrorhall_rho{tag}");
        let irradiance = |x: f64, y: f64| {
            let image = |position: f64, reflections: i32| {
                let square = (position - x).powi(2) + y * y + height * height;
                f64::powi(rho, reflections) * height / square.powf(1.5)
            };
            let far = |k: i32| {
                image(f64::from(2 * k) + lamp, (2 * k).abs())
                    + image(f64::from(2 * k) - lamp, (2 * k - 1).abs())
            };
            (-2000..=2000).map(far).sum::<f64>()
        };
        assert!(
            (irradiance(at, 0.0) / oracle(&id) - 1.0).abs() < 1e-6,
            "{id}"
        );
        let half = 0.09f32;
        // The mean over the receiver, by a midpoint rule.
        let offset = |i: i32| (f64::from(i) + 0.5) / 8.0 * f64::from(half);
        let grid = (-8..8).flat_map(|i| (-8..8).map(move |j| (i, j)));
        let mean = grid
            .map(|(i, j)| irradiance(at + offset(i), offset(j)))
            .sum::<f64>()
            / 256.0;
        let mut b = Builder::new();
        let (mirror, white) = (Some(b.mirror(rho as f32)), b.diffuse([1.0; 3]));
        for x in [0.0, 1.0] {
            b.quad([x, -2.0, -1.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], mirror);
        }
        let corner = [at as f32 - half, -half, 0.0];
        b.quad(
            corner,
            [2.0 * half, 0.0, 0.0],
            [0.0, 2.0 * half, 0.0],
            Some(white),
        )
        .back = None;
        b.light(EmitterKind::Point {
            position: [lamp as f32, 0.0, height as f32],
            intensity: [1.0; 3],
        });
        orthographic(
            &mut b,
            [at as f32, 0.0, 0.5],
            [0.0, 0.0, -1.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            half,
        );
        // Light that the receiver reflects goes up, for good: it has no roof.
        seen_by_light(
            b,
            &id,
            std::f64::consts::PI * oracle(&id) / mean,
            None,
            40,
            0.02,
        );
    }
}
