//! WebAssembly: one small module without imports, the same bits in node and in a browser's workers, a page in one file.

use crate::bits::{data, expected};
use crate::c::{cornell, hello};
use crate::tools::{have, have_library, run, target, text};
use etendue::{Estimator, Scene, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::render::{Budget, Device, Options, render};
use etendue_tests::bits::hash;
use etendue_tests::place::root;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

const TARGET: &str = "wasm32-unknown-unknown";

/// Most bytes of the module.
const SIZE: usize = 140_000;

/// The folder with the page, the module and the scenes, built as a user would.
static BUILT: LazyLock<PathBuf> = LazyLock::new(|| build("page", ""));

/// The same with all features.
static WHOLE: LazyLock<PathBuf> = LazyLock::new(|| build("whole", "whole"));

fn build(folder: &str, features: &str) -> PathBuf {
    let folder = target("web").join(folder);
    let script = root().join("kernel/examples/web/build");
    run(Command::new("sh")
        .arg(script)
        .arg(&folder)
        .env("CARGO_TARGET_DIR", target("web"))
        .env("FEATURES", features)
        .env_remove("RUSTFLAGS"));
    folder
}

fn module() -> PathBuf {
    BUILT.join("etendue.wasm")
}

fn node(script: &str) -> Command {
    let mut command = Command::new("node");
    command.arg(root().join(script));
    command
}

/// The numbers of a module's sections.
fn sections(module: &[u8]) -> Vec<u8> {
    let mut ids = Vec::new();
    let mut rest = &module[8..];
    while let [id, tail @ ..] = rest {
        ids.push(*id);
        // LEB128: seven bits a byte, lowest first.
        let bytes = tail.iter().take_while(|b| *b & 0x80 != 0).count() + 1;
        let digits = tail[..bytes].iter().enumerate();
        let size: usize = digits.map(|(i, b)| usize::from(b & 0x7f) << (7 * i)).sum();
        rest = &tail[bytes + size..];
    }
    ids
}

#[test]
fn the_module_is_small_and_imports_nothing() {
    if !have_library(TARGET) {
        return;
    }
    let bytes = std::fs::read(module()).unwrap();
    println!("{} bytes", bytes.len());
    assert!(bytes.len() < SIZE, "{} bytes", bytes.len());
    const IMPORTS: u8 = 2;
    const CODE: u8 = 10;
    let sections = sections(&bytes);
    assert!(sections.contains(&CODE) && !sections.contains(&IMPORTS));
}

#[test]
fn webassembly_gives_the_same_bits() {
    if !have_library(TARGET) || !have("node") {
        return;
    }
    let suite = node("tests/embed/bits.mjs")
        .arg(WHOLE.join("etendue.wasm"))
        .arg(data("bits"))
        .output()
        .unwrap();
    assert!(suite.status.success(), "{suite:?}");
    assert_eq!(text(&suite), expected());
}

#[test]
fn hello_irradiance_prints_what_c_prints() {
    if !have_library(TARGET) || !have("node") || !have("gcc") {
        return;
    }
    let folder = target("hello-web");
    let (file, _) = cornell(&folder, 64);
    let point = ["278", "0", "279", "0", "1", "0"];
    let c = text(&run(Command::new(hello(&folder)).arg(&file).args(point)));
    let script = "kernel/examples/web/hello_irradiance.mjs";
    let js = text(&run(node(script).arg(module()).arg(&file).args(point)));
    assert_eq!(js, c);
    assert!(js.ends_with(" W/m2\n"), "{js}");
    let broken = node(script)
        .arg(module())
        .arg(root().join("Cargo.toml"))
        .args(point)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&broken.stderr).into_owned();
    assert!(
        !broken.status.success() && said == "not an Étendue blob\n",
        "{said}"
    );
}

#[test]
fn damaged_blobs_are_errors_not_traps() {
    if !have_library(TARGET) || !have("node") {
        return;
    }
    let printed = text(&run(node("tests/embed/broken.mjs")
        .arg(WHOLE.join("etendue.wasm"))
        .arg(data("bits"))));
    let counts: Vec<u32> = printed
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    // Some are refused, some are scenes all the same.
    assert!(
        matches!(counts[..], [a, b] if a > 100 && b > 10),
        "{printed}"
    );
}

/// What the page says at its end, opened as a file with these wishes; `dropped` is a file that is dropped on it then.
fn visit(wishes: &str, screenshot: &Path, dropped: Option<&Path>) -> BTreeMap<String, String> {
    let url = format!("file://{}#{wishes}", BUILT.join("etendue.html").display());
    let mut command = node("tests/embed/chromium.mjs");
    command.arg(url).arg(screenshot).args(dropped);
    text(&run(&mut command))
        .lines()
        .filter_map(|line| line.split_once(' '))
        .map(|(name, value)| (name.to_owned(), value.to_owned()))
        .collect()
}

/// The hash of the image that the host renders from the page's blob.
fn native(scene: &str, estimator: Estimator, passes: u32) -> String {
    let blob = AlignedBlob::read(&BUILT.join(format!("{scene}.etd"))).unwrap();
    let scene = Scene::open(blob.bytes()).unwrap();
    let options = Options {
        settings: Settings {
            estimator,
            ..Settings::default()
        },
        budget: Budget::Passes(passes.into()),
        threads: 2,
        device: Device::Cpu,
    };
    let native = render(&scene, &options, &AtomicBool::new(false), &|_| ()).unwrap();
    format!("{:016x}", hash(native.image.as_flattened()))
}

#[test]
fn the_page_renders_the_same_bits_with_any_number_of_workers() {
    if !have_library(TARGET) || !have("node") || !have("chromium") {
        return;
    }
    let screenshot = BUILT.join("screenshot.png");
    for (scene, name, estimator, passes) in [
        ("cornell-box", "path", Estimator::Path, 5),
        (
            "glass-and-gold",
            "bidirectional",
            Estimator::Bidirectional,
            2,
        ),
    ] {
        let expected = native(scene, estimator, passes);
        for workers in [1, 3] {
            let wishes = format!("scene={scene}&estimator={name}&spp={passes}&workers={workers}");
            let said = visit(&wishes, &screenshot, None);
            let has = |key: &str, value: &str| said.get(key).is_some_and(|v| v == value);
            assert!(
                has("state", "done") && has("hash", &expected) && has("error", ""),
                "{wishes}: {said:?}, natively {expected}"
            );
        }
    }
    // The picture that it shows, not an empty page.
    let shown = etendue_host::develop::read(&screenshot).unwrap();
    let colors: BTreeSet<_> = shown.pixels.iter().map(|p| p.map(f32::to_bits)).collect();
    assert_eq!(shown.size, [1280, 800]);
    assert!(colors.len() > 1000, "{} colours", colors.len());
}

/// A file that is no blob is said to be none, in a line, and the page goes on.
#[test]
fn the_page_says_what_is_wrong_with_a_dropped_file() {
    if !have_library(TARGET) || !have("node") || !have("chromium") {
        return;
    }
    let wishes = "scene=cornell-box&estimator=path&spp=1";
    let screenshot = BUILT.join("broken.png");
    let said = visit(wishes, &screenshot, Some(&root().join("Cargo.toml")));
    let error = said.get("error").map(String::as_str);
    let expected = "Cargo.toml: not an Étendue blob";
    assert_eq!(error, Some(expected), "{said:?}");
    assert!(!said.contains_key("exception"), "{said:?}");
}
