//! The C headers are those of the sources.
//!
//! `ETENDUE_BLESS=1 cargo test --release -p etendue-tests --test embed headers` writes them anew.

use etendue_tests::place::root;
use std::path::{Path, PathBuf};

fn check(file: &Path, made: &str) {
    if std::env::var_os("ETENDUE_BLESS").is_some() {
        std::fs::write(file, made).unwrap();
    }
    let known = std::fs::read_to_string(file).unwrap_or_default();
    assert!(
        known == made,
        "{} is not what the sources say",
        file.display()
    );
}

#[test]
fn the_kernels_header_is_that_of_the_sources() {
    let kernel = root().join("kernel");
    let files = [
        "status", "hooks", "scene", "settings", "scratch", "estimate", "pilot", "chain", "film",
    ]
    .map(|name| kernel.join(format!("src/capi/{name}.rs")));
    let made = header(&kernel.join("capi/cbindgen.toml"), &files);
    check(&kernel.join("include/etendue.h"), &made);
}

#[test]
fn the_hosts_header_is_that_of_the_sources() {
    let host = root().join("host");
    let files = [
        "hooks", "blob", "builder", "camera", "surface", "object", "medium", "light", "load",
        "render",
    ]
    .map(|name| host.join(format!("capi/src/{name}.rs")));
    let made = header(&host.join("capi/cbindgen.toml"), &files);
    check(&host.join("include/etendue_host.h"), &made);
}

/// The header that `config` describes, from these Rust files in this order.
fn header(config: &Path, files: &[PathBuf]) -> String {
    let config = cbindgen::Config::from_file(config).unwrap();
    let builder = cbindgen::Builder::new().with_config(config);
    let builder = files.iter().fold(builder, |b, file| b.with_src(file));
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}
