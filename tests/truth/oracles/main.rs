//! Closed forms and deterministic quadrature (`tests/data/transport.json`, `oracles.json`) against the estimators, in both precisions.
//!
//! Every value is the mean of 64 batches: |estimate − truth| ≤ [`Z`]·(standard error) + the oracle's uncertainty + [`ROUNDING`].
//! With 63 degrees of freedom P(|t| > 5) = 5e-6; about 300 values make one false alarm in 700 runs. And the standard error must
//! be below a stated share of the truth, or the test says nothing.

mod enclosures;
mod extremes;
mod light;
mod media;
mod mirrors;
mod volumes;

use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{ColorSource, EmitterKind, Mesh, Model};
use etendue_tests::render::{Estimate, blob};
use etendue_tests::scenes::{Builder, V};
use etendue_tests::{noise, samples};
use std::sync::LazyLock;

const Z: f64 = 5.0;
/// What the rounding of coordinates and of a few thousand operations may do to a value, relatively.
const ROUNDING: f64 = 5e-6;
const BATCHES: u64 = 64;

/// By id.
static ORACLES: LazyLock<serde_json::Value> = LazyLock::new(|| {
    let read = |text| serde_json::from_str::<serde_json::Value>(text).unwrap();
    let mut all = read(include_str!("../../data/transport.json"));
    for (id, record) in read(include_str!("../../data/slabs.json"))
        .as_object()
        .unwrap()
    {
        all[id] = record.clone();
    }
    for record in read(include_str!("../../data/oracles.json"))
        .as_array()
        .unwrap()
    {
        all[record["id"].as_str().unwrap()] = record.clone();
    }
    all
});

fn check(id: &str, what: &str, estimate: Estimate, precision: f64) {
    let oracle = &ORACLES[id];
    let truth = oracle["value"]
        .as_f64()
        .unwrap_or_else(|| panic!("no oracle {id}"));
    let allowed = Z * estimate.error + oracle["uncertainty"].as_f64().unwrap() + ROUNDING * truth;
    assert!(
        estimate.error <= noise(precision) * truth,
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
    let n = samples(n);
    let batch: Vec<f64> = (0..BATCHES)
        .map(|b| (0..n).map(|i| one(b, i)).sum::<f64>() / n as f64)
        .collect();
    Estimate::of(&batch)
}

/// `n` samples per batch, in both precisions, by every estimator that can answer.
fn ask(bytes: &AlignedBlob, id: &str, ask: Ask, n: u64, max_edges: Option<u32>, precision: f64) {
    let both = [Estimator::Path, Estimator::Bidirectional];
    ask_by(&both, bytes, id, ask, n, max_edges, precision);
}

/// Its mean by an estimator, in single precision.
fn mean_by(estimator: Estimator, bytes: &AlignedBlob, ask: Ask, n: u64) -> Estimate {
    let scene = Scene::open(bytes.bytes()).unwrap();
    let settings = Settings {
        estimator,
        ..Settings::default()
    };
    single_by(&scene, &settings, ask, n)
}

fn unit(v: V) -> glam::DVec3 {
    glam::DVec3::from(v.map(f64::from)).normalize()
}

fn single_by(scene: &Scene<'_>, settings: &Settings, ask: Ask, n: u64) -> Estimate {
    let mut scratch = Scratch::<32>::new();
    batches(n, |b, i| {
        match ask {
            Ask::Ray(o, d) => {
                scene.radiance(settings, o.into(), unit(d).as_vec3(), b, i, &mut scratch)
            }
            Ask::Irradiance(p, m) => {
                scene.irradiance(settings, p.into(), unit(m).as_vec3(), b, i, &mut scratch)
            }
        }
        .g
        .into()
    })
}

/// The same by some estimators.
fn ask_by(
    estimators: &[Estimator],
    bytes: &AlignedBlob,
    id: &str,
    ask: Ask,
    n: u64,
    max_edges: Option<u32>,
    precision: f64,
) {
    let narrow = Scene::open(bytes.bytes()).unwrap();
    let wide = etendue_f64::Scene::open(bytes.bytes()).unwrap();
    for &estimator in estimators {
        let settings = Settings {
            estimator,
            max_edges,
            ..Settings::default()
        };
        let e = single_by(&narrow, &settings, ask, n);
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

/// A lamp of radiance 1: `corner` + s·`a` + t·`b` with normal a × b.
fn lamp(b: &mut Builder, corner: V, u: V, v: V) {
    b.quad(corner, u, v, None).emission = Some([1.0; 3]);
}

/// A disc around `center`, facing along z (or against it): a polygon of `n` corners at `radius`.
fn polygon(center: V, radius: f64, down: bool) -> Mesh {
    let n = 1024u32;
    let mut mesh = Mesh {
        positions: vec![center],
        ..Mesh::default()
    };
    for i in 0..n {
        let (sin, cos) = (2.0 * std::f64::consts::PI * f64::from(i) / f64::from(n)).sin_cos();
        let [x, y] = [radius * cos, radius * sin].map(|x| x as f32);
        mesh.positions
            .push([center[0] + x, center[1] + y, center[2]]);
        let [a, b] = [1 + i, 1 + (i + 1) % n];
        mesh.triangles
            .push(if down { [0, b, a] } else { [0, a, b] });
    }
    mesh
}

/// The radius at which a polygon of 1024 corners has the area of a disc.
fn as_large_as(radius: f64) -> f64 {
    let step = 2.0 * std::f64::consts::PI / 1024.0;
    radius * (step / step.sin()).sqrt()
}
