//! Media and grids by hand, and a blob that holds them.

use bytemuck::{Pod, Zeroable};
use etendue::blob::format::{
    Grid, Header, Lobe, Medium, NONE, SECTION_ALIGN, Toc, medium, section,
};
use etendue_host::blob::AlignedBlob;

/// What fills volumes, to be put into a blob.
#[derive(Clone, Debug, Default)]
pub struct Matter {
    /// The media.
    pub media: Vec<Medium>,
    /// Their grids.
    pub grids: Vec<Grid>,
    /// The grids' texels and majorants; places count from the first of these words.
    pub words: Vec<f32>,
}

/// A medium that is the same everywhere, and scatters isotropically.
pub fn homogeneous(sigma_t: [f32; 3], albedo: [f32; 3]) -> Medium {
    Medium {
        kind: medium::HOMOGENEOUS,
        extinctions: NONE,
        albedos: NONE,
        emissions: NONE,
        emitter: NONE,
        cells: [0; 3],
        sigma_t,
        albedo,
        mean: sigma_t,
        phase: lobes(&[(medium::ISOTROPIC, 0.0, 1.0)]),
        to_grid: UNIT,
        ..Medium::zeroed()
    }
}

/// The grids' cube is the world's unit cube.
pub const UNIT: [[f32; 4]; 3] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

/// A phase function of parts (kind, g, share).
pub fn lobes(parts: &[(u32, f32, f32)]) -> [Lobe; 4] {
    let mut lobes = [Lobe::zeroed(); 4];
    for (lobe, &(kind, g, weight)) in lobes.iter_mut().zip(parts) {
        (lobe.kind, lobe.g, lobe.weight) = (kind, g, weight);
    }
    lobes
}

impl Matter {
    /// Adds a grid of three channels, or one if `value` has one.
    pub fn grid<const N: usize>(
        &mut self,
        size: [u32; 3],
        nearest: bool,
        value: impl Fn([u32; 3]) -> [f32; N],
    ) -> u32 {
        let texels = self.words.len() as u32;
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    self.words.extend(value([x, y, z]));
                }
            }
        }
        self.grids.push(Grid {
            nearest: nearest.into(),
            channels: N as u32,
            size,
            texels,
            reserved: [0; 2],
        });
        self.grids.len() as u32 - 1
    }

    /// The value of a texel.
    pub fn texel(&self, grid: &Grid, [x, y, z]: [u32; 3], channel: usize) -> f32 {
        let index = (z * grid.size[1] + y) * grid.size[0] + x;
        let channels = grid.channels as usize;
        self.words[grid.texels as usize + index as usize * channels + channel % channels]
    }

    /// Adds a medium whose extinction is `sigma_t` times a grid; majorants are the texels' largest over each of `cells` boxes.
    pub fn gridded(
        &mut self,
        extinctions: u32,
        sigma_t: [f32; 3],
        albedo: [f32; 3],
        cells: [u32; 3],
    ) -> usize {
        let grid = self.grids[extinctions as usize];
        let majorants = self.words.len() as u32;
        // The texels that matter somewhere in a box; trilinear ones from one more on either side.
        let span = |i: u32, axis: usize| {
            let (size, cells) = (grid.size[axis], cells[axis]);
            if grid.nearest == 1 {
                return i * size / cells..=((i + 1) * size).div_ceil(cells) - 1;
            }
            let low = (i * size / cells).saturating_sub(1);
            low..=((i + 1) * size / cells + 1).min(size - 1)
        };
        for z in 0..cells[2] {
            for y in 0..cells[1] {
                for x in 0..cells[0] {
                    let mut most = 0.0f32;
                    for k in span(z, 2) {
                        for j in span(y, 1) {
                            for i in span(x, 0) {
                                for (c, sigma) in sigma_t.iter().enumerate() {
                                    most = most.max(sigma * self.texel(&grid, [i, j, k], c));
                                }
                            }
                        }
                    }
                    self.words.push(most);
                }
            }
        }
        self.media.push(Medium {
            kind: medium::GRID,
            extinctions,
            majorants,
            cells,
            ..homogeneous(sigma_t, albedo)
        });
        self.media.len() - 1
    }

    /// `blob` with these media and grids in place of its own, its texels followed by theirs.
    pub fn put_into(&self, blob: &AlignedBlob) -> AlignedBlob {
        let texels = entry(blob, section::TEXELS).count as u32;
        let mut media = self.media.clone();
        let mut grids = self.grids.clone();
        media.iter_mut().for_each(|m| m.majorants += texels);
        grids.iter_mut().for_each(|g| g.texels += texels);
        let blob = replaced(blob, section::MEDIA, &media);
        let blob = replaced(&blob, section::GRIDS, &grids);
        let mut words: Vec<u32> = records(&blob, section::TEXELS);
        words.extend(self.words.iter().map(|x| x.to_bits()));
        replaced(&blob, section::TEXELS, &words)
    }
}

fn table(blob: &AlignedBlob) -> Vec<Toc> {
    let bytes = blob.bytes();
    let header: Header = bytemuck::pod_read_unaligned(&bytes[..size_of::<Header>()]);
    (0..header.section_count as usize)
        .map(|i| {
            let at = size_of::<Header>() + i * size_of::<Toc>();
            bytemuck::pod_read_unaligned(&bytes[at..at + size_of::<Toc>()])
        })
        .collect()
}

fn entry(blob: &AlignedBlob, kind: u32) -> Toc {
    let table = table(blob);
    *table.iter().find(|t| t.kind == kind).expect("a section")
}

fn section_bytes<'b>(blob: &'b AlignedBlob, toc: &Toc) -> &'b [u8] {
    let start = toc.offset as usize;
    &blob.bytes()[start..start + toc.count as usize * toc.stride as usize]
}

/// The records of a section.
pub fn records<T: Pod>(blob: &AlignedBlob, kind: u32) -> Vec<T> {
    bytemuck::pod_collect_to_vec(section_bytes(blob, &entry(blob, kind)))
}

/// `blob` with other records in one section.
pub fn replaced<T: Pod>(blob: &AlignedBlob, kind: u32, records: &[T]) -> AlignedBlob {
    let mut table = table(blob);
    let end = size_of::<Header>() + table.len() * size_of::<Toc>();
    let mut bytes = blob.bytes()[..end].to_vec();
    for toc in &mut table {
        let align = SECTION_ALIGN as usize;
        bytes.resize(bytes.len().next_multiple_of(align), 0);
        let offset = bytes.len() as u64;
        if toc.kind == kind {
            toc.count = records.len() as u64;
            bytes.extend_from_slice(bytemuck::cast_slice(records));
        } else {
            bytes.extend_from_slice(section_bytes(blob, toc));
        }
        toc.offset = offset;
    }
    let mut header: Header = bytemuck::pod_read_unaligned(&bytes[..size_of::<Header>()]);
    header.length = bytes.len() as u64;
    bytes[..size_of::<Header>()].copy_from_slice(bytemuck::bytes_of(&header));
    bytes[size_of::<Header>()..end].copy_from_slice(bytemuck::cast_slice(&table));
    AlignedBlob::copy_of(&bytes)
}
