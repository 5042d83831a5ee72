//! Bodies of the fuzz targets: each takes any bytes and panics if its property doesn't hold. `fuzz/` lets libFuzzer
//! look for such bytes; `fuzz/replay.rs` here runs what it found, and the seeds it began with, on stable Rust.
//!
//! A new target is one function here, one line in [`TARGETS`], one file in
//! `fuzz/fuzz_targets`, one `[[bin]]` in `fuzz/Cargo.toml` and a folder of seeds in `data/fuzz`.

mod blob;
mod capi;
mod estimates;
mod mesh;
mod scene;
mod source;
mod xml;

pub use blob::blob;
pub use capi::capi;
pub use estimates::estimates;
pub use mesh::mesh;
pub use scene::scene;
pub use xml::xml;

/// A body.
pub type Body = fn(&[u8]);

/// All targets, by name.
pub const TARGETS: [(&str, Body); 5] = [
    ("blob", blob),
    ("capi", capi),
    ("mesh", mesh),
    ("scene", scene),
    ("xml", xml),
];
