//! Closed rooms, form factors, surfaces that light each other.

use super::{Ask, as_large_as, ask, ask_by, batches, check, lamp, polygon};
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{Geometry, Mesh};
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, V};

/// Closed rooms, as the oracles name them, each with a ray that starts inside.
pub const ROOMS: [(&str, Ask); 3] = [
    ("sphere", Ask::Ray([0.1, 0.2, 0.0], [0.3, 0.4, 0.5])),
    ("box", Ask::Ray([1.0, 0.5, 1.5], [0.3, -0.4, 0.5])),
    ("non-convex", Ask::Ray([0.5, 0.5, 0.5], [1.0, 0.3, 0.2])),
];

/// One of them, whose walls reflect `rho` and emit `emission`.
pub fn inside(room: &str, rho: f32, emission: f32) -> AlignedBlob {
    let mut b = Builder::new();
    let wall = Some(b.diffuse([rho; 3]));
    let s = match room {
        "sphere" => b.shape(
            Geometry::Sphere {
                center: [0.0; 3],
                radius: 1.0,
                flipped: true,
            },
            wall,
        ),
        "box" => b.cuboid([0.0, 0.0, 0.0], [2.0, 1.0, 3.0], true, wall),
        _ => b.shape(Geometry::Mesh(l_room()), wall),
    };
    s.emission = Some([emission; 3]);
    blob(&b.description)
}

#[test]
fn enclosures() {
    for (name, ray) in ROOMS {
        for (rho, n) in [(0.18, 200), (0.5, 400), (0.9, 400)] {
            let id = format!("encl_{name}_Le1.0_rho{rho}");
            ask(&inside(name, rho, 1.0), &id, ray, n, None, 0.01);
        }
    }
    let (name, ray) = ROOMS[0];
    for (rho, bounces) in [(0.5, 1), (0.9, 10), (0.9, 50)] {
        let id = format!("encl_trunc_rho{rho}_nb{bounces}");
        let edges = Some(bounces + 1);
        ask(&inside(name, rho, 1.0), &id, ray, 300, edges, 0.01);
    }
}

/// Two boxes in the shape of an L, extruded; normals inwards.
fn l_room() -> Mesh {
    let plan = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let mut mesh = Mesh::default();
    for z in [0.0, 1.0] {
        mesh.positions.extend(plan.map(|[x, y]| [x, y, z]));
    }
    for i in 0..6u32 {
        let j = (i + 1) % 6;
        mesh.triangles.extend([[i, i + 6, j], [j, i + 6, j + 6]]);
    }
    for t in [[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]] {
        mesh.triangles.push(t);
        mesh.triangles.push([t[0] + 6, t[2] + 6, t[1] + 6]);
    }
    mesh
}

/// A black lamp and a black hole in a white sphere. Both are closed by flat discs: seen from inside, a cap of uniform radiance
/// is its disc. Corners stand a little outside the sphere, so that nothing is seen past the disc.
#[test]
fn integrating_spheres() {
    for (rho, lamp, port) in [
        ("0.9", "0.01", "0.0"),
        ("0.99", "0.01", "0.01"),
        ("0.8", "0.1", "0.1"),
        ("0.98", "0.001", "0.0"),
    ] {
        let reflectance: f32 = rho.parse().unwrap();
        let mut b = Builder::new();
        let wall = Some(b.diffuse([reflectance; 3]));
        b.shape(
            Geometry::Sphere {
                center: [0.0; 3],
                radius: 1.0,
                flipped: true,
            },
            wall,
        );
        for (share, down) in [(lamp, true), (port, false)] {
            let share: f64 = share.parse().unwrap();
            if share == 0.0 {
                continue;
            }
            // The cap's share of the sphere is (1 − cos)/2.
            let cos = 1.0 - 2.0 * share;
            let radius = (1.0 - cos * cos).sqrt() / (std::f64::consts::PI / 1024.0).cos();
            let z = if down { cos } else { -cos };
            let disc = polygon([0.0, 0.0, z as f32], radius, down);
            let s = b.shape(Geometry::Mesh(disc), None);
            // The wall's radiance is ρ/π of its irradiance, which the oracle gives.
            s.emission = down.then_some([std::f32::consts::PI / reflectance; 3]);
        }
        let bytes = blob(&b.description);
        let id = format!("isphere_rho{rho}_f{lamp}_port{port}");
        let ray = Ask::Ray([0.0, 0.0, 0.1], [1.0, 0.3, 0.2]);
        ask_by(&[Estimator::Path], &bytes, &id, ray, 200, None, 0.02);
        ask_by(
            &[Estimator::Bidirectional],
            &bytes,
            &id,
            ray,
            20,
            None,
            0.04,
        );
    }
}

#[test]
fn form_factors() {
    // The mean irradiance of the receiver, over π, from points all over it; `place` spreads the unit square on it.
    let mean = |bytes: &AlignedBlob, id: &str, place: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let scene = Scene::open(bytes.bytes()).unwrap();
        let mut scratch = Scratch::<32>::new();
        let settings = Settings {
            estimator: Estimator::Bidirectional,
            ..Settings::default()
        };
        let e = batches(1 << 12, |b, i| {
            // Additive recurrence: any points that fill the receiver evenly.
            let k = (b << 12 | i) as f64;
            let spread = [0.754_877_666_246_69, 0.569_840_290_998_05].map(|a| (k * a).fract());
            let [x, y] = place(spread).map(|x| x as f32);
            let p = [x, y, 0.0];
            f64::from(
                scene
                    .irradiance(&settings, p.into(), glam::Vec3::Z, b, i, &mut scratch)
                    .g,
            ) / std::f64::consts::PI
        });
        check(id, "by bidirectional", e, 0.02);
    };
    for (x, y) in [(2.0f32, 2.0f32), (0.5, 0.5), (4.0, 1.0), (0.1, 0.1)] {
        let mut b = Builder::new();
        lamp(&mut b, [0.0, 0.0, 1.0], [0.0, y, 0.0], [x, 0.0, 0.0]);
        mean(
            &blob(&b.description),
            &format!("ff_parallel_X{x}_Y{y}"),
            &|[s, t]| [s * f64::from(x), t * f64::from(y)],
        );
    }
    for (h, w) in [(1.0f32, 1.0f32), (2.0, 1.0), (0.2, 0.2), (5.0, 5.0)] {
        let mut b = Builder::new();
        lamp(&mut b, [0.0; 3], [0.0, 0.0, h], [1.0, 0.0, 0.0]);
        mean(
            &blob(&b.description),
            &format!("ff_perp_H{h}_W{w}"),
            &|[s, t]| [s, t * f64::from(w)],
        );
    }
    for (receiver, emitter, id) in [
        (1.0, 1.0, "ff_discs_r1_1_h1"),
        (0.5, 2.0, "ff_discs_r0.5_2_h1"),
    ] {
        let mut b = Builder::new();
        let disc = polygon([0.0, 0.0, 1.0], as_large_as(emitter), true);
        b.shape(Geometry::Mesh(disc), None).emission = Some([1.0; 3]);
        mean(&blob(&b.description), id, &|[s, t]| {
            let (sin, cos) = (2.0 * std::f64::consts::PI * t).sin_cos();
            [receiver * s.sqrt() * cos, receiver * s.sqrt() * sin]
        });
    }
}

#[test]
fn radiosity() {
    let concentric =
        |r: f32, rho: [f32; 2], emission: [f32; 2], point: &str, origin: V, direction: V| {
            let mut b = Builder::new();
            for (i, (radius, flipped)) in [(r, false), (1.0, true)].into_iter().enumerate() {
                let wall = Some(b.diffuse([rho[i]; 3]));
                b.shape(
                    Geometry::Sphere {
                        center: [0.0; 3],
                        radius,
                        flipped,
                    },
                    wall,
                )
                .emission = Some([emission[i]; 3]);
            }
            ask(
                &blob(&b.description),
                point,
                Ask::Ray(origin, direction),
                1500,
                None,
                0.01,
            );
        };
    let gap = |r: f32| [0.5 + 0.5 * r, 0.0, 0.0];
    concentric(
        0.5,
        [0.5, 0.5],
        [1.0, 0.0],
        "concentric_0.5_1_0.5_0.5_10_inner",
        gap(0.5),
        [-1.0, 0.1, 0.0],
    );
    concentric(
        0.5,
        [0.5, 0.5],
        [1.0, 0.0],
        "concentric_0.5_1_0.5_0.5_10_outer",
        gap(0.5),
        [1.0, 0.1, 0.0],
    );
    concentric(
        0.9,
        [0.3, 0.7],
        [0.0, 1.0],
        "concentric_0.9_1_0.3_0.7_01_inner",
        gap(0.9),
        [-1.0, 0.1, 0.0],
    );
    concentric(
        0.9,
        [0.3, 0.7],
        [0.0, 1.0],
        "concentric_0.9_1_0.3_0.7_01_outer",
        gap(0.9),
        [1.0, 0.1, 0.0],
    );
    for (rho1, rho2) in [(0.5f32, 0.5f32), (0.9, 0.3)] {
        let mut b = Builder::new();
        let (m1, m2, mirror) = (b.diffuse([rho1; 3]), b.diffuse([rho2; 3]), b.mirror(1.0));
        b.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], Some(m1))
            .emission = Some([1.0; 3]);
        b.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], Some(m2));
        for (corner, a) in [
            ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
            ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
        ] {
            b.quad(corner, a, [0.0, 0.0, 1.0], Some(mirror));
        }
        ask(
            &blob(&b.description),
            &format!("plates_{rho1}_{rho2}"),
            Ask::Ray([0.5, 0.5, 0.5], [0.1, 0.2, 1.0]),
            1500,
            None,
            0.01,
        );
    }
    for (d, rho1, rho2, tag) in [
        (0.5f32, 0.8f32, 0.8f32, "0.5_0.8_0.8"),
        (2.0, 0.3, 0.7, "2.0_0.3_0.7"),
    ] {
        let mut b = Builder::new();
        let (m1, m2) = (b.diffuse([rho1; 3]), b.diffuse([rho2; 3]));
        let one = b.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], Some(m1));
        (one.emission, one.back) = (Some([1.0; 3]), None);
        b.quad([0.0, 0.0, d], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], Some(m2))
            .back = None;
        let bytes = blob(&b.description);
        // Just inside the edges: a ray that meets one may miss.
        for (x, y, point) in [
            (0.5, 0.5, "centre"),
            (2e-5, 2e-5, "corner"),
            (0.5, 2e-5, "edge_mid"),
        ] {
            let id = format!("squares_d{tag}_L2_{point}");
            let up = Ask::Ray([x, y, 0.5 * d], [0.0, 0.0, 1.0]);
            ask(&bytes, &id, up, 3000, None, 0.01);
        }
        for (square, z) in [("L1", -1.0), ("L2", 1.0)] {
            let scene = Scene::open(bytes.bytes()).unwrap();
            let mut scratch = Scratch::<32>::new();
            let e = batches(3000, |b, i| {
                let k = (b * 3000 + i) as f64;
                let [x, y] = [0.754_877_666_246_69, 0.569_840_290_998_05].map(|a| (k * a).fract());
                let origin = glam::Vec3::new(x as f32, y as f32, 0.5 * d);
                let towards = glam::Vec3::Z * z;
                let settings = Settings::default();
                f64::from(
                    scene
                        .radiance(&settings, origin, towards, b, i, &mut scratch)
                        .g,
                )
            });
            check(&format!("squares_d{tag}_{square}_mean"), "by path", e, 0.01);
        }
    }
}
