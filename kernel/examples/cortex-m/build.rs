//! Puts memory.x where the linker looks.

use std::path::Path;

fn main() {
    let out = std::env::var("OUT_DIR").unwrap();
    std::fs::copy("memory.x", Path::new(&out).join("memory.x")).unwrap();
    println!("cargo::rustc-link-search={out}");
    println!("cargo::rustc-link-arg=-Tlink.x");
    println!("cargo::rerun-if-changed=memory.x");
}
