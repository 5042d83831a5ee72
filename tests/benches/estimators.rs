//! µs per sample and efficiency of `path` and `bidirectional`, with independent numbers and Sobol' points: `cargo bench --bench estimators`, or `-- SCENE…` for some of the scenes.
//!
//! n·relMSE = n × mean over pixels and channels of (x−ref)²/(ref² + 0.01·m²), m the mean of ref, the reference's
//! own noise taken off; efficiency = 1/(n·relMSE × CPU seconds per sample of every pixel).
//! One thread. Each row is the median of five renders with different seeds, because machines are shared.
//!
//! Budget, scene 4, bidirectional: 5.9 closest-hit and 8.7 shadow rays per pair of walks in SmallVCM.
//!
//! What others reach, one thread. SmallVCM's bpt on scenes 4, 5, 6, by g++ 12, on the core and in the minutes in which `bidirectional` took 3.1, 3.5 and
//! 3.7 µs, and 3.5, 4.0 and 4.3 with Sobol' points: 4.3, 4.6, 4.7 µs per pair (`-O3`) and 3.7, 3.8, 3.9 (`-O3 -march=native`); n·relMSE 0.26, 1.31, 1.80,
//! the mean of 8 renders of 32 samples like ours.
//! Where the time goes on scene 4, by callgrind: 31 000 instructions per pair of walks, of which traversal is 28 %, arithmetic on vectors and colours that
//! is inlined everywhere 20 %, walks, connections and weights 13 %, surfaces 10 %, film and filter 3 %, random numbers 3 %. No place has more than 8 %: what is
//! left is fewer rays, or better ones, as Sobol' points make them.
//!
//! Of other machines only ratios say something: Mitsuba 3.9 on cornell_diffuse 2.29 (scalar) and 1.31 (llvm) µs per sample.

use etendue::random::Sequence;
use etendue::{Estimator, Scene, Settings};
use etendue_host::develop::read;
use etendue_host::render::{Budget, Device, Options, render};
use etendue_host::scene::{Changes, prepare};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A scene, the noise of its reference as relMSE, and samples per pixel of one render.
const SCENES: [(&str, f64, u64); 4] = [
    ("cornell_diffuse", 4.45e-4, 64),
    ("scene4_empty", 4.2e-4, 32),
    ("scene5_small_mirror_glass", 1.7e-3, 32),
    ("scene6_large_glass", 2.5e-3, 32),
];

fn main() {
    let folder = match std::env::var("ETENDUE_BENCH_SCENES") {
        Ok(folder) => folder.into(),
        Err(_) => Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes"),
    };
    println!(
        "scene                        estimator      sampler      µs/sample  rays/sample  n·relMSE  efficiency"
    );
    // Cargo adds options of its own.
    let some: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    let wanted = |name: &str| some.is_empty() || some.iter().any(|s| s == name);
    for (name, noise, passes) in SCENES.into_iter().filter(|(name, ..)| wanted(name)) {
        for estimator in [Estimator::Path, Estimator::Bidirectional] {
            let find = |suffix: &str| {
                let places = [folder.clone(), folder.join("own"), folder.join("smallvcm")];
                places
                    .into_iter()
                    .map(|p| p.join(suffix.replace('@', name)))
                    .find(|p| p.exists())
            };
            let (Some(file), Some(reference)) = (find("@.xml"), find("ref/@.exr")) else {
                println!("{name:<28} not found in {}", folder.display());
                continue;
            };
            for sequence in [Sequence::Independent, Sequence::Sobol] {
                measure(name, &file, &reference, noise, passes, estimator, sequence);
            }
        }
    }
}

fn measure(
    name: &str,
    file: &Path,
    reference: &Path,
    noise: f64,
    passes: u64,
    estimator: Estimator,
    sequence: Sequence,
) {
    let reference = read(reference).unwrap_or_else(|e| panic!("{e}"));
    let prepared = prepare(file, &[], Changes::default()).unwrap_or_else(|e| panic!("{e}"));
    let scene = Scene::open(prepared.blob.bytes()).unwrap_or_else(|e| panic!("{e}"));
    let mut rows: Vec<[f64; 3]> = (0..5)
        .map(|seed| {
            let options = Options {
                settings: Settings {
                    estimator,
                    sequence,
                    seed,
                    max_edges: prepared.advice.max_depth,
                    ..Settings::default()
                },
                budget: Budget::Passes(passes),
                threads: 1,
                device: Device::Cpu,
            };
            let r = render(&scene, &options, &AtomicBool::new(false), &|_| ())
                .unwrap_or_else(|e| panic!("{e}"));
            let samples = (passes * r.image.len() as u64) as f64;
            let rays = r.counters.rays() as f64;
            let error =
                (relative_mse(&r.image, r.size, &reference) - noise).max(0.0) * passes as f64;
            [r.seconds / samples, rays / samples, error]
        })
        .collect();
    let mut median = |column: usize| {
        rows.sort_by(|a, b| a[column].total_cmp(&b[column]));
        rows[2][column]
    };
    let (seconds, rays, error) = (median(0), median(1), median(2));
    let [w, h] = scene.size();
    let efficiency = 1.0 / (error * seconds * f64::from(w * h));
    println!(
        "{name:<28} {estimator:<14?} {sequence:<11?} {:>10.3} {rays:>12.2} {error:>9.3} {efficiency:>11.2}",
        seconds * 1e6
    );
}

/// relMSE.
fn relative_mse(
    image: &[[f32; 3]],
    size: [u32; 2],
    reference: &etendue_host::develop::Linear,
) -> f64 {
    assert_eq!(size, reference.size, "the reference has another size");
    let n = (3 * reference.pixels.len()) as f64;
    let mean = reference
        .pixels
        .as_flattened()
        .iter()
        .map(|&x| f64::from(x))
        .sum::<f64>()
        / n;
    let pairs = image
        .as_flattened()
        .iter()
        .zip(reference.pixels.as_flattened());
    pairs
        .map(|(&a, &b)| (f64::from(a), f64::from(b)))
        .map(|(a, b)| (a - b) * (a - b) / (b * b + 0.01 * mean * mean))
        .sum::<f64>()
        / n
}
