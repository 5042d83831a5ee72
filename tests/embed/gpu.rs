//! A GPU: the module that the host carries is that of the sources, and where there is a GPU it gives the same bits.

use crate::tools::{have, have_core, run, target, text};
use etendue_tests::header::root;
use std::process::Command;

/// `sh kernel/ptx/build` makes it anew.
#[test]
fn the_module_is_that_of_the_sources() {
    let tools = ["llvm-link-22", "opt-22", "llc-22", "gzip", "awk"];
    if !have_core() || !tools.iter().all(|tool| have(tool)) {
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
    let folder = target("cuda");
    run(Command::new(env!("CARGO"))
        .current_dir(root())
        .args(["build", "--release", "--locked", "-p", "etendue-host"])
        .args(["--features", "cuda", "--target-dir"])
        .arg(&folder));
    let render = |device: &str, estimator: &str| {
        let out = folder.join(format!("{device}.exr"));
        let _ = std::fs::remove_file(&out);
        let output = Command::new(folder.join("release/etendue"))
            .arg("render")
            .arg(root().join("host/scenes/cornell-box.xml"))
            .args(["--width", "64", "--spp", "8", "--device", device])
            .args(["--estimator", estimator, "--quiet", "-o"])
            .arg(&out)
            .output()
            .unwrap();
        (output, std::fs::read(&out).ok())
    };
    let there = std::path::Path::new("/dev/nvidiactl").exists();
    for estimator in ["path", "light", "bidirectional"] {
        let (output, image) = render("cuda", estimator);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        if there {
            let (_, expected) = render("cpu", estimator);
            assert!(output.status.success(), "{said}");
            assert!(
                image == expected && image.is_some(),
                "{estimator}: the GPU's bits differ"
            );
        } else {
            assert!(!output.status.success() && image.is_none());
            assert!(said.contains("no NVIDIA driver"), "{said}");
        }
    }
}
