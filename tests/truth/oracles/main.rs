//! Closed forms and deterministic quadrature (`tests/data/transport.json`) against the estimators, in both precisions.
//!
//! Every value is the mean of 64 batches: |estimate − truth| ≤ [`Z`]·(standard error) + the oracle's uncertainty + [`ROUNDING`].
//! With 63 degrees of freedom P(|t| > 5) = 5e-6; about 300 values make one false alarm in 700 runs. And the standard error must
//! be below a stated share of the truth, or the test says nothing.

mod light;

use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{ColorSource, EmitterKind, Geometry, Mesh, Model};
use etendue_tests::render::{Estimate, blob};
use etendue_tests::scenes::{Builder, V};
use std::sync::LazyLock;

const Z: f64 = 5.0;
/// What the rounding of coordinates and of a few thousand operations may do to a value, relatively.
const ROUNDING: f64 = 5e-6;
const BATCHES: u64 = 64;

static ORACLES: LazyLock<serde_json::Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../../data/transport.json")).unwrap());

fn check(id: &str, what: &str, estimate: Estimate, precision: f64) {
    let oracle = &ORACLES[id];
    let truth = oracle["value"]
        .as_f64()
        .unwrap_or_else(|| panic!("no oracle {id}"));
    let allowed = Z * estimate.error + oracle["uncertainty"].as_f64().unwrap() + ROUNDING * truth;
    assert!(
        estimate.error <= precision * truth,
        "{id} {what}: {estimate:?} is too noisy to judge {truth}"
    );
    assert!(
        (estimate.mean - truth).abs() <= allowed,
        "{id} {what}: {estimate:?}, expected {truth}"
    );
}

/// What is asked: radiance along a ray, or irradiance at a point.
#[derive(Clone, Copy, Debug)]
enum Ask {
    Ray(V, V),
    Irradiance(V, V),
}

fn batches(n: u64, mut one: impl FnMut(u64, u64) -> f64) -> Estimate {
    let batch: Vec<f64> = (0..BATCHES)
        .map(|b| (0..n).map(|i| one(b, i)).sum::<f64>() / n as f64)
        .collect();
    Estimate::of(&batch)
}

/// `n` samples per batch, in both precisions, by every estimator that can answer.
fn ask(bytes: &AlignedBlob, id: &str, ask: Ask, n: u64, max_edges: Option<u32>, precision: f64) {
    let narrow = Scene::open(bytes.bytes()).unwrap();
    let wide = etendue_f64::Scene::open(bytes.bytes()).unwrap();
    let unit = |v: V| glam::DVec3::from(v.map(f64::from)).normalize();
    for estimator in [Estimator::Path, Estimator::Bidirectional] {
        let settings = Settings {
            estimator,
            max_edges,
            ..Settings::default()
        };
        let mut scratch = Scratch::<32>::new();
        let e = batches(n, |b, i| {
            match ask {
                Ask::Ray(o, d) => {
                    narrow.radiance(&settings, o.into(), unit(d).as_vec3(), b, i, &mut scratch)
                }
                Ask::Irradiance(p, m) => {
                    narrow.irradiance(&settings, p.into(), unit(m).as_vec3(), b, i, &mut scratch)
                }
            }
            .g
            .into()
        });
        check(id, &format!("{estimator:?} single"), e, precision);
        let estimator = if estimator == Estimator::Path {
            etendue_f64::Estimator::Path
        } else {
            etendue_f64::Estimator::Bidirectional
        };
        let settings = etendue_f64::Settings {
            estimator,
            max_edges,
            ..etendue_f64::Settings::default()
        };
        let mut scratch = etendue_f64::Scratch::<32>::new();
        let wide_v = |v: V| glam::DVec3::from(v.map(f64::from));
        let e = batches(n, |b, i| match ask {
            Ask::Ray(o, d) => wide.radiance(&settings, wide_v(o), unit(d), b, i, &mut scratch),
            Ask::Irradiance(p, m) => wide.irradiance(&settings, wide_v(p), unit(m), b, i, &mut scratch),
        }.g);
        check(id, &format!("{estimator:?} double"), e, precision);
    }
}

fn sky(b: &mut Builder) {
    b.light(EmitterKind::Constant { radiance: [1.0; 3] });
}

#[test]
fn white_furnaces() {
    let furnace = |id: &str, material: &dyn Fn(&mut Builder) -> usize| {
        let mut b = Builder::new();
        let m = material(&mut b);
        b.sphere([0.0; 3], 1.0, Some(m));
        sky(&mut b);
        let bytes = blob(&b.description);
        for height in [0.0, 0.6, 0.95] {
            ask(
                &bytes,
                id,
                Ask::Ray([height, 0.1, 3.0], [0.0, 0.0, -1.0]),
                1500,
                None,
                5e-3,
            );
        }
    };
    furnace("furnace_lambert_white", &|b| b.diffuse([1.0; 3]));
    furnace("furnace_lambert_0.5", &|b| b.diffuse([0.5; 3]));
    furnace("furnace_lambert_0.18", &|b| b.diffuse([0.18; 3]));
    furnace("furnace_mirror_perfect", &|b| b.mirror(1.0));
    furnace("furnace_glass_2.4", &|b| b.glass(2.4));
    furnace("furnace_index1_interface", &|b| b.material(Model::Null));
    furnace("furnace_index1_interface", &|b| b.glass(1.0));
    // A sheet whose four parts add up to 1, as those of thin glass do.
    let part = |x: f32| ColorSource::Constant([x; 3]);
    furnace("furnace_thin_glass", &|b| {
        b.material(Model::Sheet {
            specular_reflectance: part(0.25),
            specular_transmittance: part(0.375),
            diffuse_reflectance: part(0.125),
            diffuse_transmittance: part(0.25),
        })
    });
}

#[test]
fn enclosures() {
    let inside = |shape: usize, rho: f32| {
        let mut b = Builder::new();
        let wall = Some(b.diffuse([rho; 3]));
        let s = match shape {
            0 => b.shape(
                Geometry::Sphere {
                    center: [0.0; 3],
                    radius: 1.0,
                    flipped: true,
                },
                wall,
            ),
            1 => b.cuboid([0.0, 0.0, 0.0], [2.0, 1.0, 3.0], true, wall),
            _ => b.shape(Geometry::Mesh(l_room()), wall),
        };
        s.emission = Some([1.0; 3]);
        blob(&b.description)
    };
    let rays: [[V; 2]; 3] = [
        [[0.1, 0.2, 0.0], [0.3, 0.4, 0.5]],
        [[1.0, 0.5, 1.5], [0.3, -0.4, 0.5]],
        [[0.5, 0.5, 0.5], [1.0, 0.3, 0.2]],
    ];
    for (shape, name) in ["sphere", "box", "non-convex"].into_iter().enumerate() {
        let [origin, direction] = rays[shape];
        for (rho, n) in [(0.18, 200), (0.5, 400), (0.9, 400)] {
            let id = format!("encl_{name}_Le1.0_rho{rho}");
            ask(
                &inside(shape, rho),
                &id,
                Ask::Ray(origin, direction),
                n,
                None,
                0.01,
            );
        }
    }
    let [origin, direction] = rays[0];
    for (rho, bounces) in [(0.5, 1), (0.9, 10), (0.9, 50)] {
        let id = format!("encl_trunc_rho{rho}_nb{bounces}");
        ask(
            &inside(0, rho),
            &id,
            Ask::Ray(origin, direction),
            300,
            Some(bounces + 1),
            0.01,
        );
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

/// A lamp of radiance 1: `corner` + s·`a` + t·`b` with normal a × b.
fn lamp(b: &mut Builder, corner: V, u: V, v: V) {
    b.quad(corner, u, v, None).emission = Some([1.0; 3]);
}

#[test]
fn form_factors() {
    // The mean irradiance of the receiver, over π, from points all over it.
    let mean = |bytes: &AlignedBlob, id: &str, size: [f32; 2]| {
        let scene = Scene::open(bytes.bytes()).unwrap();
        let mut scratch = Scratch::<32>::new();
        let settings = Settings {
            estimator: Estimator::Bidirectional,
            ..Settings::default()
        };
        let e = batches(1 << 12, |b, i| {
            // Additive recurrence: any points that fill the receiver evenly.
            let k = (b << 12 | i) as f64;
            let at = |a: f64, s: f32| ((k * a).fract() * f64::from(s)) as f32;
            let p = [
                at(0.754_877_666_246_69, size[0]),
                at(0.569_840_290_998_05, size[1]),
                0.0,
            ];
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
            [x, y],
        );
    }
    for (h, w) in [(1.0f32, 1.0f32), (2.0, 1.0), (5.0, 5.0)] {
        let mut b = Builder::new();
        lamp(&mut b, [0.0; 3], [0.0, 0.0, h], [1.0, 0.0, 0.0]);
        mean(
            &blob(&b.description),
            &format!("ff_perp_H{h}_W{w}"),
            [1.0, w],
        );
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
        let id = format!("squares_d{tag}_L2_centre");
        ask(
            &bytes,
            &id,
            Ask::Ray([0.5, 0.5, 0.5 * d], [0.0, 0.0, 1.0]),
            3000,
            None,
            0.01,
        );
    }
}
