//! What each feature costs, in instructions per sample: `cargo bench --bench features`. Needs valgrind; minutes, because the kernel is built once for each feature.
//!
//! Counts are differences of two numbers of samples, so that opening a scene isn't in them, and the same each time.
//!
//! Budget: a feature that a scene doesn't need costs it 1 % at most.

use etendue_host::description::Carry;
use etendue_host::scene::{Changes, prepare};
use etendue_tests::place::root;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Columns of the images.
const SIZE: u32 = 16;
const FEW: u64 = 1;
const MANY: u64 = 5;
const ESTIMATORS: [&str; 3] = ["path", "light", "bidirectional"];

/// Cargo features beside those of estimators, and those that rest on each.
const FEATURES: [(&str, &[&str]); 8] = [
    ("textures", &["textures"]),
    ("environment", &["environment"]),
    ("panorama", &["panorama"]),
    ("glossy", &["glossy", "spectral"]),
    ("media", &["media", "spectral"]),
    ("spectral", &["spectral"]),
    ("sobol", &["sobol"]),
    ("metropolis", &["metropolis"]),
];
const ALL: [&str; 12] = [
    "light",
    "bidirectional",
    "distributed",
    "quadrature",
    "textures",
    "environment",
    "panorama",
    "glossy",
    "media",
    "spectral",
    "sobol",
    "metropolis",
];

/// A way to render `tests/data/scenes`.
#[derive(Clone, Copy)]
struct Variant {
    scene: &'static str,
    carry: Carry,
    sobol: bool,
}

const PLAIN: Variant = Variant {
    scene: "cornell_diffuse",
    carry: Carry::Rgb,
    sobol: false,
};

/// One feature each, in the same room.
const HAVING: [(&str, Variant); 5] = [
    (
        "fog",
        Variant {
            scene: "fog_cornell",
            ..PLAIN
        },
    ),
    (
        "glossy",
        Variant {
            scene: "cornell_glossy",
            ..PLAIN
        },
    ),
    (
        "Dirac",
        Variant {
            scene: "cornell_spheres",
            ..PLAIN
        },
    ),
    (
        "wavelengths",
        Variant {
            carry: Carry::Wavelengths,
            ..PLAIN
        },
    ),
    (
        "Sobol' points",
        Variant {
            sobol: true,
            ..PLAIN
        },
    ),
];

fn main() {
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("valgrind is not installed: nothing is counted");
        return;
    }
    let root = &root();
    let work = tempfile::tempdir().expect("a temporary folder");
    let target = root.join("target/features");
    let everything = build(root, &target, &ALL);
    let prepared = |v: Variant| blob(root, work.path(), v);
    let plain = prepared(PLAIN);

    println!(
        "instructions per sample of what a scene doesn't need: cornell_diffuse, by a kernel with all features and by one without"
    );
    println!(
        "{:<16} {:<14} {:>10} {:>10} {:>8}",
        "feature", "estimator", "with", "without", "price"
    );
    for (feature, without) in FEATURES {
        let kept: Vec<&str> = ALL.into_iter().filter(|f| !without.contains(f)).collect();
        let less = build(root, &target, &kept);
        for estimator in ESTIMATORS {
            let with = count(&everything, &plain, estimator, false);
            let without = count(&less, &plain, estimator, false);
            row(feature, estimator, with, without);
        }
    }
    println!("\ninstructions per sample of what a scene needs, and of cornell_diffuse");
    for (what, variant) in HAVING {
        let having = prepared(variant);
        for estimator in ESTIMATORS {
            let with = count(&everything, &having, estimator, variant.sobol);
            let without = count(&everything, &plain, estimator, false);
            row(what, estimator, with, without);
        }
    }
}

fn row(what: &str, estimator: &str, with: f64, without: f64) {
    let price = 100.0 * (with / without - 1.0);
    println!("{what:<16} {estimator:<14} {with:>10.0} {without:>10.0} {price:>6.1} %");
}

/// The kernel's example `mean` with these features.
fn build(root: &Path, target: &Path, features: &[&str]) -> PathBuf {
    let status = Command::new(env!("CARGO"))
        .current_dir(root)
        .args([
            "build",
            "--quiet",
            "--release",
            "-p",
            "etendue",
            "--example",
            "mean",
        ])
        .args(["--no-default-features", "--features", &features.join(",")])
        .arg("--target-dir")
        .arg(target)
        .status()
        .expect("cargo runs");
    assert!(status.success(), "the kernel isn't built with {features:?}");
    let kept = target.join(format!("mean-{}", features.join("-")));
    std::fs::copy(target.join("release/examples/mean"), &kept).expect("the example is there");
    kept
}

/// A compiled scene.
fn blob(root: &Path, work: &Path, variant: Variant) -> PathBuf {
    let Variant { scene, carry, .. } = variant;
    let changes = Changes {
        width: Some(SIZE),
        carry,
        ..Changes::default()
    };
    let file = root.join(format!("tests/data/scenes/{scene}.xml"));
    let prepared = prepare(&file, &[], changes).unwrap_or_else(|e| panic!("{e}"));
    let path = work.join(format!("{scene} {carry:?}.etd"));
    std::fs::write(&path, prepared.blob.bytes()).expect("the blob is written");
    path
}

/// Instructions per sample.
fn count(program: &Path, blob: &Path, estimator: &str, sobol: bool) -> f64 {
    let total = |samples: u64| -> f64 {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(program)
            .arg(blob)
            .args([estimator, &samples.to_string()])
            .args(sobol.then_some("sobol"))
            .output()
            .expect("valgrind runs");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let line = text.lines().find_map(|l| l.split_once("Collected : "));
        let (_, number) = line.unwrap_or_else(|| panic!("no count: {text}"));
        number.trim().parse().expect("a number")
    };
    let pixels = f64::from(SIZE * SIZE);
    (total(MANY) - total(FEW)) / ((MANY - FEW) as f64 * pixels)
}
