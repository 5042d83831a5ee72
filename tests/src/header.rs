//! The C headers, as cbindgen makes them from the sources.

use std::path::{Path, PathBuf};

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The header that `config` describes, from these Rust files in this order.
pub fn header(config: &Path, files: &[PathBuf]) -> String {
    let config = cbindgen::Config::from_file(config).unwrap();
    let builder = cbindgen::Builder::new().with_config(config);
    let builder = files.iter().fold(builder, |b, file| b.with_src(file));
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}
