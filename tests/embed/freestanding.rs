//! The static library without an operating system: links with nothing undefined, holds no panic, gives the same bits.

use crate::bits::{data, expected};
use crate::tools::{cargo, cross, have, have_library, run, target, text};
use etendue::{Estimator, Scene, Settings};
use etendue_host::render::{Budget, Device, Options, render};
use etendue_host::scene::{Changes, prepare};
use etendue_tests::bits::hash;
use etendue_tests::place::root;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

/// Builds `libetendue.a` whose panic handler calls what nobody defines, with what else is asked for.
fn library(name: &str, extra: &[&str]) -> PathBuf {
    let folder = target(name);
    let mut command = cargo("kernel/capi", &folder);
    run(command.args(["--features", "prove-no-panic"]).args(extra));
    folder.join("release/libetendue.a")
}

fn link(compiler: &str, source: &Path, library: &Path, out: &Path) -> Command {
    let mut command = Command::new(compiler);
    command
        .args(["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror"])
        .args(["-ffreestanding", "-fno-builtin", "-fno-stack-protector"])
        .args([
            "-fno-tree-loop-distribute-patterns",
            "-nostdlib",
            "-static",
            "-no-pie",
        ])
        .arg("-I")
        .arg(root().join("kernel/include"))
        .arg(source)
        .arg(library)
        .args(["-Wl,--gc-sections", "-o"])
        .arg(out);
    command
}

/// The Cornell box as a blob, and the hash of its render.
static CORNELL: LazyLock<(PathBuf, u64)> = LazyLock::new(|| {
    let size = Changes {
        width: Some(64),
        ..Changes::default()
    };
    let cornell = prepare(&root().join("host/scenes/cornell-box.xml"), &[], size).unwrap();
    let file = target("freestanding").join("cornell.etd");
    std::fs::write(&file, cornell.blob.bytes()).unwrap();
    let scene = Scene::open(cornell.blob.bytes()).unwrap();
    let options = Options {
        settings: Settings {
            estimator: Estimator::Bidirectional,
            ..Settings::default()
        },
        budget: Budget::Passes(16),
        threads: 2,
        device: Device::Cpu,
    };
    let native = render(&scene, &options, &AtomicBool::new(false), &|_| ()).unwrap();
    (file, hash(native.image.as_flattened()))
});

/// Links the example with nothing but the library, sees that nothing is undefined, runs it and compares its bits.
fn build_and_run(compiler: &str, library: &Path, emulator: Option<&str>, folder: &Path) {
    let (cornell, hash) = &*CORNELL;
    let program = folder.join("main");
    let source = root().join("kernel/examples/freestanding/main.c");
    run(link(compiler, &source, library, &program)
        .arg(format!("-DBLOBS=\"{}\"", data("bits").display()))
        .arg(format!("-DCORNELL=\"{}\"", cornell.display())));
    let undefined = text(&run(Command::new("nm").arg("-u").arg(&program)));
    assert_eq!(undefined.trim(), "", "undefined symbols");
    let mut command = match emulator {
        Some(emulator) => {
            let mut command = Command::new(emulator);
            command.arg(&program);
            command
        }
        None => Command::new(&program),
    };
    let printed = text(&run(command.current_dir(folder)));
    assert_eq!(printed, format!("{}cornell {hash:016x}\n", expected()));
    let picture = std::fs::read(folder.join("cornell.ppm")).unwrap();
    assert_eq!(picture.len(), 13 + 3 * 64 * 64);
}

#[test]
fn without_a_system_it_renders_the_same_bits_and_cannot_panic() {
    if !have("gcc") || !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        return;
    }
    build_and_run("gcc", &library("capi", &[]), None, &target("freestanding"));
}

#[test]
fn the_same_on_aarch64() {
    const TARGET: &str = "aarch64-unknown-linux-gnu";
    let tools = ["aarch64-linux-gnu-gcc", "qemu-aarch64"];
    if !have_library(TARGET) || !tools.iter().all(|tool| have(tool)) {
        return;
    }
    let folder = target("aarch64");
    run(cross("kernel/capi", &folder, TARGET).args(["--release", "--features", "prove-no-panic"]));
    let library = folder.join(TARGET).join("release/libetendue.a");
    build_and_run(tools[0], &library, Some(tools[1]), &folder);
}

/// The proof finds a panic where there is one.
#[test]
fn a_planted_panic_does_not_link() {
    if !have("gcc") || !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        return;
    }
    let folder = target("planted");
    let source = folder.join("main.c");
    std::fs::write(
        &source,
        "unsigned char etd_planted_panic(unsigned long);\n\
         void _start(void) { etd_planted_panic((unsigned long)&_start); }\n",
    )
    .unwrap();
    // The least of a kernel will do.
    let least = ["--no-default-features", "--features", "plant-a-panic"];
    let library = library("planted", &least);
    let output = link("gcc", &source, &library, &folder.join("main"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        !output.status.success() && said.contains("etd_panic_is_reachable"),
        "{said}"
    );
}
