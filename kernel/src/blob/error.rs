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

/// The kinds of what can be wrong with a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Problem {
    /// The bytes don't start at a multiple of 16.
    Misaligned,
    /// Shorter than the header says, or than a header is.
    Truncated,
    /// Not a blob at all.
    Magic,
    /// A version that this kernel doesn't read.
    Version,
    /// A need that this kernel doesn't know, or was built without.
    Needs,
    /// A section is missing, double, unknown, overlapping, outside the blob or of another record size.
    Section,
    /// A reserved field isn't zero.
    Reserved,
    /// A number is not finite, or outside its range.
    Range,
    /// An id points to nothing, or to the wrong thing.
    Reference,
    /// A kind or flag that this kernel doesn't know.
    Kind,
    /// The nodes are not a tree of the stated depth.
    Tree,
    /// Two numbers that must agree don't.
    Mismatch,
}

impl core::fmt::Display for BlobError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        const NAMES: [&str; 16] = [
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
        ];
        let name = NAMES
            .get(self.section as usize)
            .unwrap_or(&"unknown section");
        write!(f, "{} ({name}, record {})", self.rule.text(), self.index)
    }
}

impl core::error::Error for BlobError {}
