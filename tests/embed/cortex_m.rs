//! A microcontroller: the same bits on an emulated Cortex-M4F, in 64 KB of RAM.

use crate::bits::expected;
use crate::tools::{cross, have, have_library, run, target, text};
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";

/// Most bytes of scratch, film and stack together.
const RAM: usize = 64 * 1024;

/// Most bytes of the smallest useful build: `path`, surfaces, RGB.
const TEXT: usize = 64 * 1024;

#[test]
fn a_microcontroller_renders_the_same_bits_in_little_memory() {
    if !have_library(TARGET) || !have("qemu-system-arm") {
        return;
    }
    let folder = target("cortex-m");
    run(cross("kernel/examples/cortex-m", &folder, TARGET).args(["--release", "--bin", "suite"]));
    let program = folder.join(TARGET).join("release/suite");
    let output = run(Command::new("timeout")
        .args(["300", "qemu-system-arm", "-cpu", "cortex-m4"])
        .args(["-machine", "mps2-an386", "-nographic"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(program));
    let printed = text(&output);
    let (hashes, memory) = printed
        .split_once("RAM: ")
        .expect("how much memory it used");
    assert_eq!(hashes, expected());
    print!("{memory}");
    let parts = memory
        .split_whitespace()
        .filter_map(|w| w.parse::<usize>().ok());
    let used: usize = parts.sum();
    assert!(used > 5000 && used <= RAM, "{memory}");
}

#[test]
fn the_smallest_build_fits_into_little_flash() {
    if !have_library(TARGET) || !have("size") {
        return;
    }
    let folder = target("cortex-m");
    run(cross("kernel/examples/cortex-m", &folder, TARGET).args([
        "--profile",
        "small",
        "--bin",
        "smallest",
        "--no-default-features",
    ]));
    let program = folder.join(TARGET).join("small/smallest");
    let printed = text(&run(Command::new("size").arg(program)));
    let size: usize = printed
        .lines()
        .nth(1)
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap()
        .parse()
        .unwrap();
    println!("{size} bytes");
    assert!(size <= TEXT, "{size} bytes of text and constants");
}
