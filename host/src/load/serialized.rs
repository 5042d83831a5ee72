//! Mitsuba's `.serialized`, versions 3 and 4: zlib-packed meshes, a table of offsets at the end.

use super::RawMesh;
use super::error::{LoadError, read};
use flate2::read::ZlibDecoder;
use std::io::Read;
use std::path::Path;

const MAGIC: u16 = 0x041C;
const NORMALS: u32 = 0x0001;
const UVS: u32 = 0x0002;
const COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;
/// Deflate can't do better than about 1032 to 1: a file that promises more lies.
const MOST_PACKED: u64 = 1040;

/// Reads mesh `index` of a file.
pub fn load(path: &Path, index: usize) -> Result<RawMesh, LoadError> {
    parse(&read(path)?, path, index)
}

/// Reads mesh `index` of a file's bytes; `path` is for messages.
pub fn parse(bytes: &[u8], path: &Path, index: usize) -> Result<RawMesh, LoadError> {
    one(bytes, index).map_err(|text| LoadError::malformed(path, 0, text))
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes
        .get(at..at.checked_add(2)?)?
        .try_into()
        .ok()
        .map(u16::from_le_bytes)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes
        .get(at..at.checked_add(4)?)?
        .try_into()
        .ok()
        .map(u32::from_le_bytes)
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes
        .get(at..at.checked_add(8)?)?
        .try_into()
        .ok()
        .map(u64::from_le_bytes)
}

fn one(bytes: &[u8], index: usize) -> Result<RawMesh, String> {
    let short = || {
        format!(
            "file of {} bytes ends too early, expected a serialized mesh",
            bytes.len()
        )
    };
    let magic = u16_at(bytes, 0).ok_or_else(short)?;
    if magic != MAGIC {
        return Err(format!(
            "starts with {magic:#06x}, expected {MAGIC:#06x} (a serialized mesh)"
        ));
    }
    let version = u16_at(bytes, 2).ok_or_else(short)?;
    if !(3..=4).contains(&version) {
        return Err(format!("version {version}, expected 3 or 4"));
    }
    let tail = bytes.len().checked_sub(4).ok_or_else(short)?;
    let start = if index == 0 {
        0
    } else {
        let count = u32_at(bytes, tail).ok_or_else(short)? as usize;
        if index >= count {
            return Err(format!(
                "shape_index {index}, expected less than {count}, the number of meshes in the file"
            ));
        }
        let entry = if version == 4 { 8 } else { 4 };
        let at = tail
            .checked_sub(entry * (count - index))
            .ok_or_else(short)?;
        let offset = if version == 4 {
            u64_at(bytes, at)
        } else {
            u32_at(bytes, at).map(u64::from)
        };
        usize::try_from(offset.ok_or_else(short)?).map_err(|_| short())?
    };
    let version = u16_at(bytes, start.saturating_add(2)).ok_or_else(short)?;
    if u16_at(bytes, start) != Some(MAGIC) || !(3..=4).contains(&version) {
        return Err(format!(
            "no mesh at offset {start}, expected the one the table at the end promises"
        ));
    }
    let packed = &bytes[start + 4..];
    let mut stream = Stream {
        zlib: ZlibDecoder::new(packed),
        packed: packed.len() as u64,
    };
    stream.mesh(version)
}

struct Stream<'a> {
    zlib: ZlibDecoder<&'a [u8]>,
    packed: u64,
}

impl Stream<'_> {
    fn bytes(&mut self, count: u64, what: &str) -> Result<Vec<u8>, String> {
        let short = || format!("ends within its {what}, expected {count} bytes of them");
        if count > self.packed.saturating_mul(MOST_PACKED) {
            return Err(short());
        }
        let mut out = Vec::new();
        let got = (&mut self.zlib).take(count).read_to_end(&mut out);
        let got = got.map_err(|e| format!("{what} can't be unpacked: {e}, expected zlib data"))?;
        if got as u64 == count {
            Ok(out)
        } else {
            Err(short())
        }
    }

    fn number<const N: usize>(&mut self) -> Result<u64, String> {
        let mut bytes = [0; N];
        self.zlib.read_exact(&mut bytes).map_err(|e| {
            format!("header can't be unpacked: {e}, expected {N} more bytes of zlib data")
        })?;
        Ok(bytes.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b)))
    }

    fn floats<const N: usize>(
        &mut self,
        count: u64,
        double: bool,
        what: &str,
    ) -> Result<Vec<[f32; N]>, String> {
        let size = if double { 8 } else { 4 };
        let bytes = self.bytes(count.saturating_mul(size * N as u64), what)?;
        let one = |b: &[u8]| match b.try_into() {
            Ok(b) => f64::from_le_bytes(b) as f32,
            Err(_) => b.try_into().map_or(f32::NAN, f32::from_le_bytes),
        };
        let size = size as usize;
        let record = |r: &[u8]| std::array::from_fn(|i| one(&r[i * size..(i + 1) * size]));
        Ok(bytes.chunks_exact(size * N).map(record).collect())
    }

    fn mesh(&mut self, version: u16) -> Result<RawMesh, String> {
        let flags = self.number::<4>()? as u32;
        if version == 4 {
            while self.number::<1>()? != 0 {}
        }
        let vertices = self.number::<8>()?;
        let triangles = self.number::<8>()?;
        let most = u64::from(u32::MAX);
        if vertices > most || triangles > most {
            return Err(format!(
                "{vertices} vertices and {triangles} triangles, expected less than 2^32"
            ));
        }
        let double = flags & DOUBLE != 0;
        let positions = self.floats(vertices, double, "positions")?;
        let normals = (flags & NORMALS != 0)
            .then(|| self.floats(vertices, double, "normals"))
            .transpose()?;
        let uvs = (flags & UVS != 0)
            .then(|| self.floats(vertices, double, "texture coordinates"))
            .transpose()?;
        if flags & COLORS != 0 {
            let _unused: Vec<[f32; 3]> = self.floats(vertices, double, "colours")?;
        }
        let indices = self.bytes(triangles * 12, "triangles")?;
        let index = |b: &[u8], i: usize| {
            b[4 * i..4 * i + 4]
                .try_into()
                .map_or(u32::MAX, u32::from_le_bytes)
        };
        Ok(RawMesh {
            positions,
            normals,
            uvs,
            triangles: indices
                .chunks_exact(12)
                .map(|b| std::array::from_fn(|i| index(b, i)))
                .collect(),
            face_normals: flags & FACE_NORMALS != 0,
        })
    }
}
