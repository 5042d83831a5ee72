//! A blob in owned memory, aligned as [`etendue::Scene::open`] wants it.

use std::io::{self, Read};
use std::path::Path;

/// A cache line of bytes.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// Bytes that start at a multiple of 64: the kernel asks for 16, and nodes that don't straddle cache lines are faster. Files are read into it, not mapped: one that changes under
/// a map can't be caught.
#[derive(Clone, Debug, Default)]
pub struct AlignedBlob {
    lines: Vec<Line>,
    length: usize,
}

impl AlignedBlob {
    /// `length` zero bytes.
    pub fn zeroed(length: usize) -> Self {
        Self {
            lines: vec![Line([0; 64]); length.div_ceil(64)],
            length,
        }
    }

    /// A copy of `bytes`.
    pub fn copy_of(bytes: &[u8]) -> Self {
        let mut blob = Self::zeroed(bytes.len());
        blob.bytes_mut().copy_from_slice(bytes);
        blob
    }

    /// The whole of a file.
    ///
    /// # Errors
    /// What the file system says.
    pub fn read(path: &Path) -> io::Result<Self> {
        let mut bytes = Vec::new();
        std::fs::File::open(path)?.read_to_end(&mut bytes)?;
        Ok(Self::copy_of(&bytes))
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.lines).split_at(self.length).0
    }

    /// The bytes, to write.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.lines)
            .split_at_mut(self.length)
            .0
    }
}
