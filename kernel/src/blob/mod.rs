//! The scene as bytes: the format, the gate that checks it, and the view that the rest reads.

mod check;
pub mod format;
mod scene;

pub use check::{BlobError, Problem};
pub use scene::Scene;
