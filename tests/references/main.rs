//! Scenes against converged references by other renderers (`tests/data/scenes`; with ETENDUE_SCENES=FOLDER those of a folder too).
//!
//! Each render is 64 independent ones, so that every block's standard error is measured. Two tests:
//! the image's mean is within 0.5 % plus 3 standard errors; and in each of 8 × 8 blocks and three channels
//! |z| < [`Z`]. A render makes 192 z-values and there are at most 16, so with Student's t of 63
//! degrees of freedom (P(|t| > 5.9) = 1.5e-7) the whole suite fails by chance once in 2000 runs.

use etendue::{Estimator, Scene, Settings};
use etendue_host::develop::{Linear, read};
use etendue_host::render::{Budget, Device, Options, render};
use etendue_host::scene::{Changes, prepare};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

const Z: f64 = 5.9;
const SEEDS: u64 = 64;
const BLOCKS: usize = 8;

/// Block means, block by block, channel by channel.
fn blocks(pixels: &[[f32; 3]], size: [u32; 2]) -> Vec<f64> {
    let [w, h] = size.map(|n| n as usize);
    let mut sums = vec![0.0; BLOCKS * BLOCKS * 3];
    let mut counts = vec![0.0; BLOCKS * BLOCKS];
    for (i, p) in pixels.iter().enumerate() {
        let block = (i / w * BLOCKS / h) * BLOCKS + i % w * BLOCKS / w;
        counts[block] += 1.0;
        for c in 0..3 {
            sums[block * 3 + c] += f64::from(p[c]);
        }
    }
    sums.iter()
        .enumerate()
        .map(|(i, s)| s / counts[i / 3])
        .collect()
}

/// The variance of the reference's block means: from its noise image, or from its relMSE.
fn noise(reference: &Linear, folder: &Path, name: &str, relative: f64) -> Vec<f64> {
    let per_block = reference.pixels.len() as f64 / (BLOCKS * BLOCKS) as f64;
    let file = folder.join(format!("ref/{name}_noise.exr"));
    let variance: Vec<[f32; 3]> = match read(&file) {
        Ok(noise) => noise.pixels.iter().map(|p| p.map(|x| x * x)).collect(),
        Err(_) => {
            let all = reference.pixels.as_flattened();
            let m = all.iter().sum::<f32>() / all.len() as f32;
            let variance = |x: f32| relative as f32 * (x * x + 0.01 * m * m);
            reference.pixels.iter().map(|p| p.map(variance)).collect()
        }
    };
    blocks(&variance, reference.size)
        .iter()
        .map(|v| v / per_block)
        .collect()
}

struct Case<'a> {
    folder: &'a Path,
    name: &'a str,
    /// relMSE of a reference that has no noise image.
    relative_noise: f64,
    estimator: Estimator,
    /// Samples per pixel of each of the renders if tests are deep.
    passes: u64,
    /// Whether blocks are tested: not where single samples are so bright that 64 means aren't normal.
    by_block: bool,
}

fn check(case: &Case<'_>) {
    let prepared = prepare(
        &case.folder.join(format!("{}.xml", case.name)),
        &[],
        Changes::default(),
    );
    let prepared = match prepared {
        // Other people's scenes may have what there is not yet: ours may not.
        Err(e) if case.folder != data() && e.contains("not supported yet") => {
            println!("skipped: {e}");
            return;
        }
        other => other.unwrap_or_else(|e| panic!("{e}")),
    };
    let scene = Scene::open(prepared.blob.bytes()).unwrap_or_else(|e| panic!("{e}"));
    let reference =
        read(&case.folder.join(format!("ref/{}.exr", case.name))).unwrap_or_else(|e| panic!("{e}"));
    let renders: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| {
            let settings = Settings {
                estimator: case.estimator,
                max_edges: prepared.advice.max_depth,
                seed,
                ..Settings::default()
            };
            let options = Options {
                settings,
                budget: Budget::Passes(etendue_tests::samples(case.passes)),
                threads: 0,
                device: Device::Cpu,
            };
            let r = render(&scene, &options, &AtomicBool::new(false), &|_| ()).unwrap();
            assert_eq!(
                (r.counters.rejected, r.refused.saturated, r.refused.invalid),
                (0, 0, 0)
            );
            assert_eq!(r.size, reference.size);
            blocks(&r.image, r.size)
        })
        .collect();
    let (truth, noise) = (
        blocks(&reference.pixels, reference.size),
        noise(&reference, case.folder, case.name, case.relative_noise),
    );
    let what = format!("{} by {:?}", case.name, case.estimator);
    let n = SEEDS as f64;
    let spread = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / n;
        (
            mean,
            (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0) / n).sqrt(),
        )
    };
    let (mut worst, mut squares) = (0.0f64, 0.0);
    for i in 0..truth.len() {
        let values: Vec<f64> = renders.iter().map(|r| r[i]).collect();
        let (mean, error) = spread(&values);
        // Where nothing but a sky of one colour is seen there is no noise: what remains is that the reference was summed in
        // single precision: off by up to 1.3e-5 of it in those blocks.
        let rounding = 4e-6 * truth[i];
        let total = (error * error + noise[i] + rounding * rounding).sqrt();
        let z = if total > 0.0 {
            (mean - truth[i]) / total
        } else {
            0.0
        };
        worst = if z.abs() > worst.abs() { z } else { worst };
        squares += z * z / truth.len() as f64;
        let (block, channel) = (i / 3, i % 3);
        assert!(
            !case.by_block || z.abs() < Z,
            "{what}: block {block} channel {channel}: {mean} ± {error}, expected {} ± {}: z = {z:.1}",
            truth[i],
            noise[i].sqrt()
        );
    }
    for c in 0..3 {
        let of = |r: &[f64]| r.iter().skip(c).step_by(3).sum::<f64>() / (BLOCKS * BLOCKS) as f64;
        let (mean, error) = spread(&renders.iter().map(|r| of(r)).collect::<Vec<_>>());
        let expected = of(&truth);
        println!(
            "{what}: channel {c}: {mean:.5} ± {error:.5}, expected {expected:.5} ({:+.3} %)",
            100.0 * (mean / expected - 1.0)
        );
        assert!(
            (mean - expected).abs() <= 0.005 * expected + 3.0 * error,
            "{what}: channel {c}: {mean} ± {error}, expected {expected}"
        );
    }
    println!("{what}: worst z {worst:.2}, mean z² {squares:.2}");
}

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes")
}

fn own(name: &str, relative_noise: f64, passes: u64, path_by_block: bool) {
    let folder = data();
    let case = |estimator, passes, by_block| Case {
        folder: &folder,
        name,
        relative_noise,
        estimator,
        passes,
        by_block,
    };
    check(&case(Estimator::Path, 2 * passes, path_by_block));
    check(&case(Estimator::Bidirectional, passes, true));
}

#[test]
fn cornell_diffuse() {
    own("cornell_diffuse", 0.0, 8, true);
}

#[test]
fn cornell_spheres() {
    own("cornell_spheres", 0.0, 8, false);
}

#[test]
fn cornell_glossy() {
    own("cornell_glossy", 0.0, 8, true);
}

#[test]
fn smallvcm_mirror_over_phong() {
    own("scene1_large_mirror_phong_floor", 4.7e-3, 2, false);
}

#[test]
fn smallvcm_empty_box() {
    own("scene4_empty", 4.2e-4, 2, true);
}

#[test]
fn smallvcm_small_mirror_and_glass() {
    own("scene5_small_mirror_glass", 1.7e-3, 2, false);
}

#[test]
fn smallvcm_large_glass() {
    own("scene6_large_glass", 2.5e-3, 2, false);
}

/// Homogeneous media: a null cube around a room seen from outside; camera and lamp inside; the lamp outside; a sun through the boundary.
#[test]
fn fog_cornell() {
    own("fog_cornell", 0.0, 4, true);
}

#[test]
fn fog_point() {
    own("fog_point", 0.0, 4, false);
}

#[test]
fn fog_spot() {
    own("fog_spot", 0.0, 4, false);
}

#[test]
fn fog_directional() {
    own("fog_directional", 0.0, 4, true);
}

/// A grid.
#[test]
fn smoke() {
    own("smoke", 0.0, 4, true);
}

/// A medium behind a smooth dielectric.
#[test]
fn sss_smooth() {
    own("sss_smooth", 0.0, 4, true);
}

/// Other people's scenes, read where they are.
#[test]
fn scenes_of_a_folder() {
    let Some(folder) = std::env::var_os("ETENDUE_SCENES").map(PathBuf::from) else {
        println!("skipped: ETENDUE_SCENES names no folder of scenes");
        return;
    };
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut names: Vec<String> = entries
        .filter_map(|e| e.ok()?.path().file_stem()?.to_str().map(str::to_owned))
        .filter(|n| {
            folder.join(format!("{n}.xml")).exists() && folder.join(format!("ref/{n}.exr")).exists()
        })
        .collect();
    names.sort();
    names.dedup();
    for name in &names {
        for estimator in [Estimator::Path, Estimator::Bidirectional] {
            check(&Case {
                folder: &folder,
                name,
                relative_noise: 0.0,
                estimator,
                passes: 4,
                by_block: true,
            });
        }
    }
}
