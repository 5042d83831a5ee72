//! What single scattering between microfacets loses: `cargo bench --bench energy [-- PICTURE.png]`. The albedo of white conducting facets over their roughness α, as they are
//! and compensated; where light comes from all sides it is the furnace's brightness. A chart where a picture is named.
//!
//! Budget: what is compensated loses, or makes, 1 % at most. (`tests/truth/bsdf/loss.rs` holds the table behind it to quadrature.)

use etendue::real::Vec3;
use etendue::{Scene, Scratch, Settings};
use etendue_host::chart::plot::{Plot, SIZE, Series, png};
use etendue_host::description::{ColorSource, Distribution, Facets, Masking, Model};
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;

/// Samples of an albedo: its error is below 1e-3.
const SAMPLES: u64 = 1 << 16;

const ALPHAS: [f32; 10] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0];

/// Straight down, and by 75 degrees from that.
const DOWN: f64 = 1.0;
const SLANT: f64 = 0.258_819_045_102_520_8;

/// The radiance along a ray that meets a plate of facets under a white sky, as a share of the sky's: the albedo for light that arrives in its direction, by
/// Helmholtz's law. `cosine` is the ray's; 0 takes all directions, each as often as diffuse light arrives from it.
fn albedo(facets: Facets, cosine: f64) -> f64 {
    let mut b = Builder::new();
    let model = Model::RoughConductor {
        spectra: None,
        eta: [0.0; 3],
        k: [1.0; 3],
        reflectance: ColorSource::Constant([1.0; 3]),
        facets,
    };
    let plate = b.material(model);
    b.quad(
        [-1.0, -1.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        Some(plate),
    );
    b.light(etendue_host::description::EmitterKind::Constant { radiance: [1.0; 3] });
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).expect("a scene");
    let settings = Settings {
        max_edges: Some(2),
        ..Settings::default()
    };
    let mut scratch = Scratch::<8>::new();
    let sum: f64 = (0..SAMPLES)
        .map(|i| {
            let z = match cosine {
                0.0 => ((i as f64 + 0.5) / SAMPLES as f64).sqrt(),
                cosine => cosine,
            };
            let down = Vec3::new((1.0 - z * z).sqrt() as f32, 0.0, -z as f32);
            let value = scene.radiance(&settings, -down, down, 0, i, &mut scratch);
            f64::from(value.g)
        })
        .sum();
    sum / SAMPLES as f64
}

fn main() {
    let kinds = [
        ("GGX, straight down", Distribution::Ggx, false, DOWN),
        ("GGX, by 75 degrees", Distribution::Ggx, false, SLANT),
        ("GGX, all directions", Distribution::Ggx, false, 0.0),
        (
            "Beckmann, all directions",
            Distribution::Beckmann,
            false,
            0.0,
        ),
        (
            "GGX compensated, all directions",
            Distribution::Ggx,
            true,
            0.0,
        ),
    ];
    println!(
        "{:<32}{}",
        "albedo, by roughness",
        ALPHAS.map(|a| format!("{a:>7}")).concat()
    );
    let mut series = Vec::new();
    for (number, (name, distribution, compensated, cosine)) in kinds.into_iter().enumerate() {
        let albedos = ALPHAS.map(|alpha| {
            let facets = Facets {
                alpha: [alpha; 2],
                distribution,
                masking: Masking::Correlated,
                compensated,
            };
            albedo(facets, cosine)
        });
        println!(
            "{name:<32}{}",
            albedos.map(|a| format!("{a:>7.4}")).concat()
        );
        let points = ALPHAS.iter().zip(albedos).map(|(&alpha, albedo)| {
            let loss = (1.0 - albedo).abs().max(1e-5);
            [f64::from(alpha), loss, loss, loss]
        });
        series.push(Series {
            name: name.into(),
            number,
            points: points.collect(),
            hollow: vec![false; ALPHAS.len()],
        });
    }
    let Some(picture) = std::env::args().skip(1).find(|a| a.ends_with(".png")) else {
        return;
    };
    let plot = Plot {
        title: "What single scattering between facets loses".into(),
        x: "roughness".into(),
        y: "|1 - albedo| of a white conductor".into(),
        series,
        slope: None,
        marks: true,
    };
    let pixels = png(&plot).expect("a plot");
    let bytes = pixels.into_iter().flatten().collect();
    image::RgbImage::from_raw(SIZE.0, SIZE.1, bytes)
        .expect("as many pixels")
        .save(&picture)
        .unwrap_or_else(|e| panic!("{picture}: {e}"));
}
