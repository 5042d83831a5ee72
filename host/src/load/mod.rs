//! Scene files to descriptions: one file per format. Every refusal says file, line, what was found
//! and what was expected; what is accepted but would look different elsewhere is a warning.

pub mod bitmap;
pub mod error;
mod mesh;
pub mod mitsuba;
pub mod obj;
pub mod ply;
pub mod serialized;
pub mod volume;

#[cfg(test)]
mod tests;

pub use error::{LoadError, Problem};
pub use mesh::RawMesh;

use crate::description::Description;
use std::path::Path;

/// A scene and what its reader should know about it.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The scene.
    pub description: Description,
    /// What was left out or is drawn differently from what the file says, one line each.
    pub warnings: Vec<String>,
}

/// Loads a scene file (Mitsuba 3 XML). `defines` are values for `$names`; they win over `<default>`s.
pub fn load(path: &Path, defines: &[(String, String)]) -> Result<Loaded, LoadError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some(e) if e.eq_ignore_ascii_case("xml") => mitsuba::load(path, defines),
        other => Err(LoadError::file(
            path,
            Problem::Unknown {
                what: "scene format",
                found: format!("\"{}\"", other.unwrap_or("")),
                expected: "a Mitsuba 3 scene named *.xml".into(),
            },
        )),
    }
}
