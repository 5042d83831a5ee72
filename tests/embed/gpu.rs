//! A GPU: the module that the host carries is that of the sources, and where there is a GPU it gives the same bits.

use crate::tools::{have, run, target, text};
use etendue::{Estimator, Scene, Settings};
use etendue_host::render::{Budget, Device, Options, render};
use etendue_host::scene::{Changes, prepare};
use etendue_tests::place::root;
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// `sh kernel/ptx/build` makes it anew.
#[test]
fn the_module_is_that_of_the_sources() {
    // Debian's compiler and its library's source, from which `core` is built.
    let compiler = "/usr/bin/rustc";
    let source = "/usr/lib/rustlib/src/rust/library/core/Cargo.toml";
    let tools = [
        compiler,
        source,
        "llvm-link-22",
        "opt-22",
        "llc-22",
        "gzip",
        "awk",
    ];
    if !tools.iter().all(|tool| have(tool)) {
        return;
    }
    let made = run(Command::new("sh")
        .arg(root().join("kernel/ptx/build"))
        .arg("-")
        .env("CARGO_TARGET_DIR", target("ptx")));
    let known = run(Command::new("gzip")
        .arg("-dc")
        .arg(root().join("kernel/ptx/etendue.ptx.gz")));
    assert!(
        made.stdout == known.stdout,
        "kernel/ptx/etendue.ptx.gz is not what the sources give: run sh kernel/ptx/build"
    );
    let module = text(&known);
    for entry in ["etd_open", "etd_render"] {
        assert!(module.contains(&format!(".visible .entry {entry}(")));
    }
    // Nothing undefined, nothing contracted, nothing approximated, nothing flushed.
    for word in [".extern", "fma.", ".approx", ".ftz"] {
        assert!(!module.contains(word), "{word}");
    }
}

#[test]
fn without_a_gpu_it_says_so_and_with_one_the_bits_are_the_same() {
    let size = Changes {
        width: Some(64),
        ..Changes::default()
    };
    let cornell = prepare(&root().join("host/scenes/cornell-box.xml"), &[], size).unwrap();
    let scene = Scene::open(cornell.blob.bytes()).unwrap();
    let render = |device, estimator| {
        let options = Options {
            settings: Settings {
                estimator,
                ..Settings::default()
            },
            budget: Budget::Passes(8),
            threads: 2,
            device,
        };
        render(&scene, &options, &AtomicBool::new(false), &|_| ())
    };
    let there = std::path::Path::new("/dev/nvidiactl").exists();
    for estimator in [Estimator::Path, Estimator::Light, Estimator::Bidirectional] {
        match render(Device::Cuda, estimator) {
            Ok(rendered) => {
                let expected = render(Device::Cpu, estimator).unwrap();
                let same = rendered.image == expected.image;
                assert!(same, "{estimator:?}: the GPU's bits differ");
            }
            Err(e) => {
                let said = e.to_string();
                assert!(!there && said.contains("no NVIDIA driver"), "{said}");
            }
        }
    }
}
