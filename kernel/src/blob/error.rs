//! Why bytes are refused: one broken rule, and where it was found.

use super::rule::Rule;

/// Why bytes are not a scene, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlobError {
    /// Which rule is broken.
    pub rule: Rule,
    /// In which section ([`super::format::section`]); 0 is the header or the table of contents.
    pub section: u32,
    /// At which record.
    pub index: u32,
}

impl core::fmt::Display for BlobError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        const NAMES: [&str; 18] = [
            "header",
            "world",
            "sensor",
            "nodes",
            "packets",
            "triangles",
            "spheres",
            "normals",
            "uvs",
            "shapes",
            "materials",
            "textures",
            "texels",
            "emitters",
            "choices",
            "cells",
            "media",
            "grids",
        ];
        let name = NAMES
            .get(self.section as usize)
            .unwrap_or(&"unknown section");
        write!(f, "{} ({name}, record {})", self.rule.text(), self.index)
    }
}

impl core::error::Error for BlobError {}
