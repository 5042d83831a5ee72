//! Bytes as a mesh or volume file.

use super::xml::{named, opens};
use crate::scenes::Builder;
use etendue_host::description::{EmitterKind, Geometry, Grid, Grids, Medium, Mesh, Tracking};
use etendue_host::load::{RawMesh, obj, ply, serialized, volume};
use std::path::Path;

/// The first byte picks the format, the rest is the file.
///
/// **Property:** any bytes are refused with an error that names the file, or are a mesh whose indices are in range and
/// whose numbers are finite, or a volume, which compiles to a blob that opens.
pub fn mesh(bytes: &[u8]) {
    let Some((&format, bytes)) = bytes.split_first() else {
        return;
    };
    let at = Path::new("some/mesh");
    if format & 15 == VOLUME {
        return match volume::parse(bytes, at) {
            Ok(volume) => fills(volume.grid, format),
            Err(e) => named(&e.to_string(), at),
        };
    }
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

/// Of the numbers that would be serialized meshes too.
const VOLUME: u8 = 15;

/// A ball of a medium that the grid is of.
fn fills(grid: Grid, format: u8) {
    let (values, channels) = grid.values.flat();
    assert_eq!(
        values.len(),
        channels * grid.size.map(|n| n as usize).iter().product::<usize>()
    );
    assert!(values.iter().all(|v| *v >= 0.0 && v.is_finite()));
    let mut b = Builder::new();
    let mut to_grid = [[0.0; 4]; 3];
    for (i, row) in to_grid.iter_mut().enumerate() {
        (row[i], row[3]) = (0.5, 0.5);
    }
    let tracking = match format >> 4 & 3 {
        0 => Tracking::Regular,
        1 if channels == 1 => Tracking::Residual,
        _ => Tracking::Woodcock,
    };
    let medium = b.matter(Medium {
        sigma_t: [1.0, 2.0, 0.5],
        albedo: [0.5; 3],
        grids: Some(Grids {
            extinction: grid,
            albedo: None,
            emission: None,
            to_grid,
            tracking,
        }),
        ..Medium::default()
    });
    let null = b.null();
    b.ball([0.0; 3], 1.5, null, medium);
    b.light(EmitterKind::Constant { radiance: [1.0; 3] });
    opens(&b.description);
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
