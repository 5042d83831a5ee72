//! Bytes as a mesh file.

use super::xml::{named, opens};
use crate::scenes::Builder;
use etendue_host::description::{Geometry, Mesh};
use etendue_host::load::{RawMesh, obj, ply, serialized};
use std::path::Path;

/// The first byte picks the format, the rest is the file.
///
/// **Property:** any bytes are refused with an error that names the file, or are a mesh whose indices are in range and
/// whose numbers are finite, which compiles to a blob that opens.
pub fn mesh(bytes: &[u8]) {
    let Some((&format, bytes)) = bytes.split_first() else {
        return;
    };
    let at = Path::new("some/mesh");
    let raw = match format % 4 {
        0 => obj::parse(bytes, at, format & 4 != 0, &mut Vec::new()),
        1 => ply::parse(bytes, at),
        _ => serialized::parse(bytes, at, usize::from(format >> 4)),
    };
    let checked = raw.and_then(|raw| raw.check(at).map(|()| raw));
    match checked {
        Ok(raw) => usable(raw),
        Err(e) => named(&e.to_string(), at),
    }
}

fn usable(raw: RawMesh) {
    let count = raw.positions.len();
    for attribute in [
        raw.normals.as_ref().map(Vec::len),
        raw.uvs.as_ref().map(Vec::len),
    ] {
        assert!(attribute.is_none_or(|n| n == count));
    }
    let mut b = Builder::new();
    let white = Some(b.diffuse([0.5; 3]));
    let mesh = Mesh {
        positions: raw.positions,
        normals: raw.normals,
        uvs: raw.uvs,
        triangles: raw.triangles,
    };
    b.shape(Geometry::Mesh(mesh), white);
    opens(&b.description);
}
