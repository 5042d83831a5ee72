//! Irradiance under lights of every shape, through water, glass plates and balls, at any scale.

use super::{Ask, BATCHES, ORACLES, as_large_as, ask, batches, check, lamp, polygon};
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
        let disc = polygon([0.0, 0.0, z], as_large_as(f64::from(radius)), true);
        b.shape(Geometry::Mesh(disc), None).emission = Some([1.0; 3]);
        let ask_for = Ask::Irradiance([x, 0.0, 0.0], up);
        ask(&blob(&b.description), id, ask_for, 3000, None, 0.03);
    };
    disc("disclight_0", 1.0, 1.0, 0.0);
    disc("disclight_5", 10.0, 1.0, 0.0);
    disc("disclight_6", 1.0, 0.1, 0.9);
    // Far off the axis few directions meet the lamp: a floor that draws points of it.
    let floor = |id: &str, b: &mut Builder, p: V, n: V| {
        let normal = glam::Vec3::from(n).normalize();
        let u = normal.any_orthonormal_vector() * 0.02;
        let v = normal.cross(u);
        let corner = glam::Vec3::from(p) - 0.5 * (u + v);
        let white = b.diffuse([1.0; 3]);
        b.quad(corner.into(), u.into(), v.into(), Some(white));
        let eye = glam::Vec3::from(p) + 0.01 * normal;
        let down = Ask::Ray(eye.into(), (-normal).into());
        ask(&blob(&b.description), id, down, 3000, Some(2), 0.01);
    };
    // Radiance π makes a white floor's radiance the irradiance under a lamp of radiance 1.
    let bright = Some([std::f32::consts::PI; 3]);
    for (id, radius, x) in [("disclight_3", 1.0, 3.0), ("disclight_4", 0.1, 0.7)] {
        let mut b = Builder::new();
        let disc = polygon([0.0, 0.0, 1.0], as_large_as(radius), true);
        b.shape(Geometry::Mesh(disc), None).emission = bright;
        floor(id, &mut b, [x, 0.0, 0.0], up);
    }
    let mut b = Builder::new();
    b.quad([0.0, 0.0, 0.5], [0.0, 3.0, 0.0], [0.1, 0.0, 0.0], None)
        .emission = bright;
    floor("rectlight_8", &mut b, [0.05, -1.0, 0.0], [0.0, 0.6, 0.8]);
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
    // Partly below the horizon; small and far.
    let below = [0.946_300_1, 0.0, -0.323_289_57];
    sphere("spherelight_6", below, 0.5, 1.0, 3000);
    let far = [2.955_202, 0.0, 9.553_365];
    sphere("spherelight_7", far, 0.01, 1.0, 200);
    let near = [0.841_471, 0.0, 0.540_302_3];
    sphere("spherelight_9", near, 0.001, 1.0, 200);
    // It all but touches the floor.
    sphere(
        "sphere_light_touching",
        [0.0, 0.0, 1.0],
        0.999_999,
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
    for n in ["1.3", "1.5", "2.4"] {
        for cos in ["1.0", "0.7", "0.2", "0.02"] {
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

/// Below a plate of diamond, under a sky that shines from above only.
#[test]
fn a_plate_under_a_bright_sky() {
    let mut b = Builder::new();
    let diamond = Some(b.glass(2.4));
    b.cuboid([-500.0, -500.0, 0.0], [500.0, 500.0, 1.0], false, diamond);
    // Radiance 1/π: the irradiance is the share of the flux that is transmitted.
    b.quad([-1e4, -1e4, 3.0], [0.0, 2e4, 0.0], [2e4, 0.0, 0.0], None)
        .emission = Some([std::f32::consts::FRAC_1_PI; 3]);
    let below = Ask::Irradiance([0.3, 0.2, -1.0], [0.0, 0.0, 1.0]);
    ask(
        &blob(&b.description),
        "plate_diffuse_n2.4",
        below,
        1000,
        None,
        0.01,
    );
}

/// A white or grey floor under a coat of glass: what a sky of uniform radiance sends back, all orders of reflection between the two.
#[test]
fn a_varnished_floor() {
    for (n, rho) in [
        ("1.3", "0.5"),
        ("1.3", "0.9"),
        ("1.3", "1.0"),
        ("1.5", "0.9"),
        ("2.4", "0.9"),
        ("2.4", "1.0"),
    ] {
        let mut b = Builder::new();
        let floor = Some(b.diffuse([rho.parse().unwrap(); 3]));
        let coat = Some(b.glass(n.parse().unwrap()));
        let half = 1e4;
        for (z, material) in [(-1.0, floor), (0.0, coat)] {
            let side = 2.0 * half;
            b.quad(
                [-half, -half, z],
                [side, 0.0, 0.0],
                [0.0, side, 0.0],
                material,
            );
        }
        // Radiance 1/π: the irradiance of a plane that faces the floor is the share of the flux that comes back.
        let radiance = [std::f32::consts::FRAC_1_PI; 3];
        b.light(EmitterKind::Constant { radiance });
        let facing = Ask::Irradiance([0.3, 0.2, 0.5], [0.0, 0.0, -1.0]);
        let id = format!("varnish_n{n}_rho{rho}");
        ask(&blob(&b.description), &id, facing, 300, None, 0.01);
    }
}

/// Radiance of a small square as an orthographic camera beside it sees it; by light tracing, the only way there.
pub fn seen_by_light(
    b: Builder,
    id: &str,
    factor: f64,
    max_edges: Option<u32>,
    passes: u64,
    precision: f64,
) {
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    for estimator in [Estimator::Light, Estimator::Bidirectional] {
        let settings = Settings {
            estimator,
            max_edges,
            ..Settings::default()
        };
        let passes = etendue_tests::samples(passes);
        let mean = single::blocks::<32>(&scene, &settings, 1, passes, BATCHES)[1];
        let e = Estimate {
            mean: mean.mean * factor,
            error: mean.error * factor,
        };
        check(id, &format!("{estimator:?}"), e, precision);
    }
}

/// A camera at `eye` that sees a square of half-width `half` in direction `forward`.
pub fn orthographic(b: &mut Builder, eye: V, forward: V, right: V, down: V, half: f32) {
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
        (1.5, 2.0, 0.5, 3.0, "n1.5_H2_h0.5_r3.0"),
        (2.4, 2.0, 1.0, 1.0, "n2.4_H2_h1_r1.0"),
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
            40,
            0.01,
        );
    }
}

#[test]
fn the_caustic_of_a_ball() {
    // Two refractions are four edges. With all internal reflections the disc must be nearly black: what it reflects comes back.
    let refracted = ("refr_only", Some(4), 1.0f32);
    let all = ("all", None, 1e-3);
    for (n, d, r, tag, (which, max_edges, reflectance)) in [
        (1.5f32, 1.5f32, 0.1f32, "n1.5_d1.5_r0.1", refracted),
        (1.5, 1.5, 0.1, "n1.5_d1.5_r0.1", all),
        (1.5, 1.5, 0.02, "n1.5_d1.5_r0.02", refracted),
        (1.5, 1.5, 0.02, "n1.5_d1.5_r0.02", all),
        (1.33, 2.0, 0.1, "n1.33_d2.0_r0.1", refracted),
        (1.33, 2.0, 0.1, "n1.33_d2.0_r0.1", all),
        (1.5, 1.01, 0.5, "n1.5_d1.01_r0.5", refracted),
        (1.5, 1.01, 0.5, "n1.5_d1.01_r0.5", all),
        (2.4, 1.05, 0.2, "n2.4_d1.05_r0.2", refracted),
        (2.4, 1.05, 0.2, "n2.4_d1.05_r0.2", all),
    ] {
        let mut b = Builder::new();
        let (white, glass) = (b.diffuse([reflectance; 3]), b.glass(n));
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
        // Flux/π = mean irradiance over the square · 4r²/π = π·radiance/ρ · 4r²/π.
        let factor = 4.0 * f64::from(r * r) / f64::from(reflectance);
        let id = format!("ballcaustic_{tag}_{which}");
        seen_by_light(b, &id, factor, max_edges, 40, 0.01);
    }
}

#[test]
fn scale_and_place_do_not_matter() {
    for (scale, name) in [(1e-4f32, "0.0001"), (1.0, "1")] {
        // A million away coordinates are a sixteenth apart: the oracle allows 1 there, and asks for no more than light.
        for (offset, tag) in [(0.0f32, "0"), (1000.0, "1000"), (1e6, "1e+06")] {
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
