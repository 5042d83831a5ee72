//! Irradiance under lights of every shape, through water, glass plates and balls, at any scale.

use super::{Ask, BATCHES, ORACLES, ask, batches, check, lamp};
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::description::{EmitterKind, Geometry, Mesh, Projection};
use etendue_tests::render::{Estimate, blob, single};
use etendue_tests::scenes::{Builder, V};

#[test]
fn irradiance_under_rectangles_discs_and_spheres() {
    let up = [0.0, 0.0, 1.0];
    let rectangle = |id: &str, size: [f32; 2], z: f32, p: V, n: V| {
        let mut b = Builder::new();
        lamp(
            &mut b,
            [0.0, 0.0, z],
            [0.0, size[1], 0.0],
            [size[0], 0.0, 0.0],
        );
        ask(
            &blob(&b.description),
            id,
            Ask::Irradiance(p, n),
            3000,
            None,
            0.03,
        );
    };
    rectangle("rectlight_0", [1.0, 1.0], 1.0, [0.5, 0.5, 0.0], up);
    rectangle("rectlight_1", [1.0, 1.0], 1.0, [0.0; 3], up);
    rectangle("rectlight_2", [1.0, 1.0], 1.0, [2.0, 0.5, 0.0], up);
    rectangle("rectlight_3", [2.0, 0.5], 0.3, [1.7, 0.1, 0.0], up);
    rectangle("rectlight_5", [1.0, 1.0], 0.1, [0.5, 0.5, 0.0], up);
    let disc = |id: &str, radius: f32, z: f32, x: f32| {
        let mut b = Builder::new();
        let n = 1024u32;
        // As large as the disc: the polygon's area is (n/2π)·sin(2π/n) times that of its circle.
        let step = 2.0 * std::f64::consts::PI / f64::from(n);
        let r = f64::from(radius) * (step / step.sin()).sqrt();
        let mut mesh = Mesh {
            positions: vec![[0.0, 0.0, z]],
            ..Mesh::default()
        };
        for i in 0..n {
            let phi = f64::from(i) * step;
            mesh.positions
                .push([(r * phi.cos()) as f32, (r * phi.sin()) as f32, z]);
            mesh.triangles.push([0, 1 + (i + 1) % n, 1 + i]);
        }
        b.shape(Geometry::Mesh(mesh), None).emission = Some([1.0; 3]);
        ask(
            &blob(&b.description),
            id,
            Ask::Irradiance([x, 0.0, 0.0], up),
            3000,
            None,
            0.03,
        );
    };
    disc("disclight_0", 1.0, 1.0, 0.0);
    disc("disclight_5", 10.0, 1.0, 0.0);
    let sphere = |id: &str, center: V, radius: f32, emission: f32, n: u64| {
        let mut b = Builder::new();
        b.sphere(center, radius, None).emission = Some([emission; 3]);
        let white = b.diffuse([1.0; 3]);
        b.quad(
            [-0.05, -0.05, 0.0],
            [0.1, 0.0, 0.0],
            [0.0, 0.1, 0.0],
            Some(white),
        );
        // A white floor's radiance times π: sphere lights are sampled there as path tracing does it.
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        for estimator in [Estimator::Path, Estimator::Bidirectional] {
            let mut scratch = Scratch::<32>::new();
            let settings = Settings {
                estimator,
                max_edges: Some(2),
                ..Settings::default()
            };
            let origin = glam::Vec3::new(
                0.0,
                0.0,
                0.02 * center[2].abs().max(1e-3) * (1.0 - radius).max(1e-7),
            );
            let e = batches(n, |b, i| {
                f64::from(
                    scene
                        .radiance(&settings, origin, -glam::Vec3::Z, b, i, &mut scratch)
                        .g,
                ) * std::f64::consts::PI
            });
            check(id, &format!("{estimator:?} from a floor"), e, 0.01);
        }
    };
    sphere("spherelight_2", [0.0, 0.0, 1.0], 0.9, 1.0, 500);
    sphere("spherelight_8", [0.0, 0.0, 1.0], 0.999, 1.0, 500);
    sphere(
        "spherelight_3",
        [0.717_356_1, 0.0, 0.696_706_7],
        0.5,
        1.0,
        500,
    );
    let one_watt = |r: f32| 1.0 / (4.0 * std::f32::consts::PI.powi(2) * r * r);
    sphere(
        "tiny_sphere_light_0.001",
        [0.0, 0.0, 1.0],
        1e-3,
        one_watt(1e-3),
        200,
    );
    sphere(
        "tiny_sphere_light_1e-05",
        [0.0, 0.0, 1.0],
        1e-5,
        one_watt(1e-5),
        200,
    );
}

#[test]
fn a_glass_plate_transmits_what_fresnel_says() {
    for n in ["1.3", "1.5"] {
        for cos in ["1.0", "0.7", "0.2"] {
            let id = format!("slab_T_n{n}_c{cos}");
            if ORACLES[&id].is_null() {
                continue;
            }
            let mut b = Builder::new();
            let glass = Some(b.glass(n.parse().unwrap()));
            b.cuboid([-500.0, -500.0, 0.0], [500.0, 500.0, 1.0], false, glass);
            lamp(&mut b, [-1e4, -1e4, -2.0], [2e4, 0.0, 0.0], [0.0, 2e4, 0.0]);
            let c: f32 = cos.parse().unwrap();
            let direction = [(1.0 - c * c).sqrt(), 0.0, -c];
            ask(
                &blob(&b.description),
                &id,
                Ask::Ray([-1.0, 0.3, 2.0], direction),
                3000,
                None,
                0.02,
            );
        }
    }
}

/// Radiance of a small square as an orthographic camera beside it sees it; by light tracing, the only way there.
fn seen_by_light(b: Builder, id: &str, factor: f64, max_edges: Option<u32>, precision: f64) {
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    for estimator in [Estimator::Light, Estimator::Bidirectional] {
        let settings = Settings {
            estimator,
            max_edges,
            ..Settings::default()
        };
        let mean = single::blocks::<32>(&scene, &settings, 1, 40, BATCHES)[1];
        let e = Estimate {
            mean: mean.mean * factor,
            error: mean.error * factor,
        };
        check(id, &format!("{estimator:?}"), e, precision);
    }
}

/// A camera at `eye` that sees a square of half-width `half` in direction `forward`.
fn orthographic(b: &mut Builder, eye: V, forward: V, right: V, down: V, half: f32) {
    let s = &mut b.description.sensor;
    s.projection = Projection::Orthographic {
        half_extent: [half; 2],
    };
    (s.origin, s.forward, s.right, s.down) = (eye, forward, right, down);
    s.clip = [0.0, 1e3];
    s.resolution = [32, 32];
}

#[test]
fn a_point_light_refracted_by_water() {
    for (n, height, depth, r, tag) in [
        (1.33f64, 3.0f64, 1.0f64, 1.0f64, "n1.33_H3_h1_r1.0"),
        (1.33, 3.0, 1.0, 4.0, "n1.33_H3_h1_r4.0"),
    ] {
        let mut b = Builder::new();
        let (white, water) = (b.diffuse([1.0; 3]), b.glass(n as f32));
        let half = 0.04f32;
        // One-sided and small: what it reflects leaves through the surface for good.
        b.quad(
            [r as f32 - half, -half, 0.0],
            [2.0 * half, 0.0, 0.0],
            [0.0, 2.0 * half, 0.0],
            Some(white),
        )
        .back = None;
        b.quad(
            [-50.0, -50.0, depth as f32],
            [100.0, 0.0, 0.0],
            [0.0, 100.0, 0.0],
            Some(water),
        );
        // Where the refracted ray meets the surface: Snell, by bisection.
        let (mut low, mut high) = (0.0, r);
        for _ in 0..60 {
            let x = 0.5 * (low + high);
            let sin = |a: f64, b: f64| a / a.hypot(b);
            if sin(x, height - depth) < n * sin(r - x, depth) {
                low = x
            } else {
                high = x
            }
        }
        let aim = glam::DVec3::new(low, 0.0, depth - height)
            .normalize()
            .as_vec3();
        b.light(EmitterKind::Spot {
            position: [0.0, 0.0, height as f32],
            direction: aim.into(),
            intensity: [1.0; 3],
            cutoff: 0.06,
            beam_width: 0.059,
        });
        orthographic(
            &mut b,
            [r as f32, 0.0, 0.5],
            [0.0, 0.0, -1.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            half,
        );
        seen_by_light(
            b,
            &format!("pool_{tag}"),
            std::f64::consts::PI,
            Some(3),
            0.01,
        );
    }
}

#[test]
fn the_caustic_of_a_ball() {
    for (n, d, r, tag) in [
        (1.5f32, 1.5f32, 0.1f32, "n1.5_d1.5_r0.1"),
        (1.33, 2.0, 0.1, "n1.33_d2.0_r0.1"),
        (1.5, 1.01, 0.5, "n1.5_d1.01_r0.5"),
    ] {
        let mut b = Builder::new();
        let (white, glass) = (b.diffuse([1.0; 3]), b.glass(n));
        b.sphere([0.0; 3], 1.0, Some(glass));
        let count = 512u32;
        let mut mesh = Mesh {
            positions: vec![[d, 0.0, 0.0]],
            ..Mesh::default()
        };
        for i in 0..count {
            let phi = 2.0 * std::f32::consts::PI * i as f32 / count as f32;
            mesh.positions.push([d, r * phi.cos(), r * phi.sin()]);
            mesh.triangles.push([0, 1 + (i + 1) % count, 1 + i]);
        }
        b.shape(Geometry::Mesh(mesh), Some(white)).back = None;
        b.light(EmitterKind::Directional {
            direction: [1.0, 0.0, 0.0],
            irradiance: [1.0; 3],
        });
        // Between ball and disc, looking away from the ball.
        orthographic(
            &mut b,
            [0.5 * (1.0 + d), 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            r,
        );
        // Flux/π = mean irradiance over the square · 4r²/π = π·radiance·4r²/π. Two refractions: four edges.
        let factor = 4.0 * f64::from(r * r);
        seen_by_light(
            b,
            &format!("ballcaustic_{tag}_refr_only"),
            factor,
            Some(4),
            0.01,
        );
    }
}

#[test]
fn scale_and_place_do_not_matter() {
    for (scale, name) in [(1e-4f32, "0.0001"), (1.0, "1")] {
        for (offset, tag) in [(0.0f32, "0"), (1000.0, "1000")] {
            let id = format!("scale_{name}_off{tag}");
            if ORACLES[&id].is_null() {
                continue;
            }
            let at = |v: V| -> V { v.map(|x| (x + offset) * scale) };
            let mut b = Builder::new();
            let white = b.diffuse([1.0; 3]);
            lamp(
                &mut b,
                at([0.0, 0.0, 1.0]),
                [0.0, scale, 0.0],
                [scale, 0.0, 0.0],
            );
            b.quad(
                at([-1.0, -1.0, 0.0]),
                [3.0 * scale, 0.0, 0.0],
                [0.0, 3.0 * scale, 0.0],
                Some(white),
            );
            let bytes = blob(&b.description);
            // Irradiance from the floor's radiance, at most one reflection.
            let scene = Scene::open(bytes.bytes()).unwrap();
            let mut scratch = Scratch::<32>::new();
            for estimator in [Estimator::Path, Estimator::Bidirectional] {
                let settings = Settings {
                    estimator,
                    max_edges: Some(2),
                    ..Settings::default()
                };
                let e = batches(1000, |b, i| {
                    let v = scene.radiance(
                        &settings,
                        at([0.3, 0.4, 0.5]).into(),
                        -glam::Vec3::Z,
                        b,
                        i,
                        &mut scratch,
                    );
                    f64::from(v.g) * std::f64::consts::PI
                });
                check(&id, &format!("{estimator:?}"), e, 0.01);
            }
        }
    }
}

/// Rays from the focus leave a paraboloid parallel to its axis: a lamp far up, as wide as the mirror, is all they meet.
#[test]
fn the_focus_of_a_paraboloid() {
    for (rim, tag) in [(1.0f32, "a1_f1"), (2.0, "a2_f1")] {
        let mut b = Builder::new();
        let mirror = Some(b.mirror(1.0));
        let (rings, sectors) = (64u32, 512u32);
        let mut mesh = Mesh::default();
        let mut normals = Vec::new();
        for i in 0..=rings {
            // The innermost ring is a tiny hole that nobody sees through: nothing lies behind it.
            let r = rim * (i as f32 / rings as f32).max(1e-4);
            for j in 0..sectors {
                let (sin, cos) = (2.0 * std::f32::consts::PI * j as f32 / sectors as f32).sin_cos();
                mesh.positions.push([r * cos, r * sin, 0.25 * r * r]);
                let slope = glam::Vec3::new(-0.5 * r * cos, -0.5 * r * sin, 1.0).normalize();
                normals.push(slope.into());
            }
        }
        for i in 0..rings {
            for j in 0..sectors {
                let at = |i: u32, j: u32| i * sectors + j % sectors;
                mesh.triangles
                    .push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                mesh.triangles
                    .push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        mesh.normals = Some(normals);
        b.shape(Geometry::Mesh(mesh), mirror);
        // A little wider than the mirror: facets and rounding spread the rays.
        let half = 1.05 * rim;
        lamp(
            &mut b,
            [-half, -half, 20.0],
            [0.0, 2.0 * half, 0.0],
            [2.0 * half, 0.0, 0.0],
        );
        let focus = Ask::Irradiance([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
        ask(
            &blob(&b.description),
            &format!("paraboloid_{tag}"),
            focus,
            1500,
            None,
            0.01,
        );
    }
}
