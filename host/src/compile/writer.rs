//! Sections to bytes.

use crate::blob::AlignedBlob;
use bytemuck::{NoUninit, Zeroable, bytes_of, cast_slice};
use etendue::blob::format::{Header, MAGIC, SECTION_ALIGN, Toc, VERSION};

/// Collects sections and lays them out.
#[derive(Default)]
pub(super) struct Writer {
    sections: Vec<(u32, u32, Vec<u8>)>,
}

impl Writer {
    /// Adds section `kind`.
    pub fn section<T: NoUninit>(&mut self, kind: u32, records: &[T]) {
        let stride = size_of::<T>() as u32;
        self.sections
            .push((kind, stride, cast_slice(records).to_vec()));
    }

    /// The blob.
    pub fn finish(self, needs: u32, film_exponent: i32) -> AlignedBlob {
        let align = |n: usize| n.next_multiple_of(SECTION_ALIGN as usize);
        let mut end = size_of::<Header>() + self.sections.len() * size_of::<Toc>();
        let mut table = Vec::new();
        for (kind, stride, bytes) in &self.sections {
            let offset = align(end);
            table.push(Toc {
                kind: *kind,
                stride: *stride,
                offset: offset as u64,
                count: (bytes.len() / *stride as usize) as u64,
                reserved: 0,
            });
            end = offset + bytes.len();
        }
        let length = align(end);
        let mut blob = AlignedBlob::zeroed(length);
        let out = blob.bytes_mut();
        let header = Header {
            magic: MAGIC,
            version: VERSION,
            section_count: table.len() as u32,
            length: length as u64,
            needs,
            film_exponent,
            ..Header::zeroed()
        };
        out[..size_of::<Header>()].copy_from_slice(bytes_of(&header));
        let after = size_of::<Header>();
        out[after..after + size_of_val(table.as_slice())].copy_from_slice(cast_slice(&table));
        for (entry, (_, _, bytes)) in table.iter().zip(&self.sections) {
            let start = entry.offset as usize;
            out[start..start + bytes.len()].copy_from_slice(bytes);
        }
        blob
    }
}
