//! A blob in owned memory, aligned as [`etendue::Scene::open`] wants it.

use std::io::{self, Read};
use std::path::Path;

/// Bytes that start at a multiple of 16. Files are read into it, not mapped: one that changes under
/// a map can't be caught.
#[derive(Clone, Debug, Default)]
pub struct AlignedBlob {
    words: Vec<u128>,
    length: usize,
}

impl AlignedBlob {
    /// `length` zero bytes.
    pub fn zeroed(length: usize) -> Self {
        Self {
            words: vec![0; length.div_ceil(16)],
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
        bytemuck::cast_slice(&self.words)
            .split_at(self.length)
            .0
    }

    /// The bytes, to write.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.words)
            .split_at_mut(self.length)
            .0
    }
}
