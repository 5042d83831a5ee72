//! Which part of a mesh each texel of a light map covers: texture coordinates cut by the texels' grid.

use crate::description::Mesh;
use glam::DVec2;

/// Overlap that counts, of the smaller piece: above what rounding makes of edges that two triangles share.
const OVERLAP: f64 = 1e-3;
/// Pieces below this part of a texel are left out.
const LEAST: f64 = 1e-9;

/// Why a mesh can't have a light map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AtlasError {
    /// Texture coordinates are missing.
    #[error("has no texture coordinates, expected (u, v) at every vertex")]
    Missing,
    /// One lies outside the map.
    #[error("vertex {vertex} has texture coordinates ({:?}, {:?}), expected both in [0, 1]", .uv[0], .uv[1])]
    Outside {
        /// Which.
        vertex: u32,
        /// Where it is.
        uv: [f32; 2],
    },
    /// No triangle has an area, on the map and in space.
    #[error(
        "its triangles have no area on the map, expected texture coordinates that spread them out"
    )]
    Flat,
    /// Two triangles share a part of the map.
    #[error(
        "triangles {first} and {second} overlap on the map at ({u:.4}, {v:.4}), expected texture coordinates of their own for each"
    )]
    Overlap {
        /// One of them.
        first: u32,
        /// The other one.
        second: u32,
        /// Where.
        u: f64,
        /// Where.
        v: f64,
    },
}

/// A triangle that is part of a texel and of one triangle of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// The mesh's triangle.
    pub triangle: u32,
    /// Its corners: barycentric weights of the mesh triangle's vertices 1 and 2.
    pub corners: [DVec2; 3],
    /// Areas on the map of this piece and those before it, over the texel's.
    pub until: f64,
}

/// The pieces of all texels.
#[derive(Clone, Debug)]
pub(super) struct Atlas {
    pieces: Vec<Piece>,
    /// Where each texel's pieces begin, row by row; one more at the end.
    first: Vec<u32>,
    width: u32,
}

/// A convex part of one texel.
struct Part {
    texel: u32,
    triangle: u32,
    corners: Vec<DVec2>,
    area: f64,
}

impl Atlas {
    /// Of `mesh` on a map of `size`. Row 0 is at v = 0, as textures have it.
    ///
    /// # Errors
    /// Texture coordinates that are missing, outside the map, without area, or that overlap.
    pub fn new(mesh: &Mesh, size: [u32; 2]) -> Result<Self, AtlasError> {
        let uvs = mesh.uvs.as_ref().ok_or(AtlasError::Missing)?;
        for (vertex, &uv) in (0u32..).zip(uvs) {
            if !uv.iter().all(|x| (0.0..=1.0).contains(x)) {
                return Err(AtlasError::Outside { vertex, uv });
            }
        }
        let scale = DVec2::new(size[0].into(), size[1].into());
        let mut parts = Vec::new();
        for (triangle, index) in (0u32..).zip(&mesh.triangles) {
            let at = |i: u32| {
                let [u, v] = uvs.get(i as usize).copied().unwrap_or_default();
                DVec2::new(u.into(), v.into()) * scale
            };
            if normal(mesh, index).is_some() {
                cut(triangle, index.map(at), size, &mut parts);
            }
        }
        if parts.is_empty() {
            return Err(AtlasError::Flat);
        }
        parts.sort_by_key(|p| (p.texel, p.triangle));
        let mut atlas = Self {
            pieces: Vec::new(),
            first: vec![0],
            width: size[0],
        };
        let mut rest = parts.as_slice();
        for texel in 0..size[0] * size[1] {
            let count = rest.iter().take_while(|p| p.texel == texel).count();
            let (own, others) = rest.split_at(count);
            rest = others;
            apart(own, scale)?;
            atlas.add(own, mesh, uvs, scale);
        }
        Ok(atlas)
    }

    /// Adds a texel's parts as triangles.
    fn add(&mut self, parts: &[Part], mesh: &Mesh, uvs: &[[f32; 2]], scale: DVec2) {
        let whole: f64 = parts.iter().map(|p| p.area).sum();
        let mut until = 0.0;
        for part in parts {
            let [a, b, c] = mesh.triangles[part.triangle as usize].map(|i| {
                let [u, v] = uvs[i as usize];
                DVec2::new(u.into(), v.into()) * scale
            });
            let (e1, e2) = (b - a, c - a);
            let inverse = 1.0 / e1.perp_dot(e2);
            let weights = |p: DVec2| DVec2::new((p - a).perp_dot(e2), e1.perp_dot(p - a)) * inverse;
            for i in 1..part.corners.len() - 1 {
                let corners = [part.corners[0], part.corners[i], part.corners[i + 1]];
                until += area(&corners) / whole;
                self.pieces.push(Piece {
                    triangle: part.triangle,
                    corners: corners.map(weights),
                    until,
                });
            }
        }
        self.first.push(self.pieces.len() as u32);
    }

    /// The pieces of a texel; none where no triangle is.
    pub fn texel(&self, [x, y]: [u32; 2]) -> &[Piece] {
        let at = (y * self.width + x) as usize;
        &self.pieces[self.first[at] as usize..self.first[at + 1] as usize]
    }
}

/// The unit normal of a triangle in space, if it has an area.
pub(super) fn normal(mesh: &Mesh, index: &[u32; 3]) -> Option<glam::DVec3> {
    let [a, b, c] = mesh.corners(index)?;
    (b - a).cross(c - a).try_normalize()
}

/// Twice the signed area is the sum of cross products.
fn signed(polygon: &[DVec2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon
        .iter()
        .zip(next)
        .map(|(a, b)| a.perp_dot(*b))
        .sum::<f64>()
}

fn area(polygon: &[DVec2]) -> f64 {
    // About a corner: coordinates may be large against the polygon.
    let Some(&first) = polygon.first() else {
        return 0.0;
    };
    let moved: Vec<DVec2> = polygon.iter().map(|&p| p - first).collect();
    signed(&moved).abs()
}

/// What of a convex polygon lies on the side of the line through `p` where `inwards` points (Sutherland & Hodgman 1974).
fn half(polygon: &[DVec2], p: DVec2, inwards: DVec2) -> Vec<DVec2> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (da, db) = ((a - p).dot(inwards), (b - p).dot(inwards));
        if da >= 0.0 {
            out.push(a);
        }
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            out.push(a + (b - a) * (da / (da - db)));
        }
    }
    out
}

/// Cuts a triangle into the texels that it covers.
fn cut(triangle: u32, mut corners: [DVec2; 3], size: [u32; 2], parts: &mut Vec<Part>) {
    if signed(&corners) < 0.0 {
        corners.swap(1, 2);
    }
    let low = corners[0].min(corners[1]).min(corners[2]);
    let high = corners[0].max(corners[1]).max(corners[2]);
    let range = |low: f64, high: f64, n: u32| low as u32..(high.ceil() as u32).min(n);
    for y in range(low.y, high.y, size[1]) {
        let row = half(&corners, DVec2::new(0.0, y.into()), DVec2::Y);
        let row = half(&row, DVec2::new(0.0, f64::from(y) + 1.0), -DVec2::Y);
        for x in range(low.x, high.x, size[0]) {
            let part = half(&row, DVec2::new(x.into(), 0.0), DVec2::X);
            let corners = half(&part, DVec2::new(f64::from(x) + 1.0, 0.0), -DVec2::X);
            let area = area(&corners);
            if area > LEAST {
                let texel = y * size[0] + x;
                parts.push(Part {
                    texel,
                    triangle,
                    corners,
                    area,
                });
            }
        }
    }
}

/// Makes sure that no two parts of a texel overlap.
fn apart(parts: &[Part], scale: DVec2) -> Result<(), AtlasError> {
    let bounds = |p: &Part| {
        let low = p
            .corners
            .iter()
            .copied()
            .reduce(DVec2::min)
            .unwrap_or_default();
        let high = p
            .corners
            .iter()
            .copied()
            .reduce(DVec2::max)
            .unwrap_or_default();
        (low, high)
    };
    // Along u: only those that begin before another ends can share anything with it.
    let mut order: Vec<_> = parts.iter().map(|p| (bounds(p), p)).collect();
    order.sort_by(|a, b| a.0.0.x.total_cmp(&b.0.0.x));
    for (i, ((low, high), a)) in order.iter().enumerate() {
        for ((other_low, other_high), b) in &order[i + 1..] {
            if other_low.x >= high.x {
                break;
            }
            if other_low.y >= high.y || other_high.y <= low.y {
                continue;
            }
            let mut shared = a.corners.clone();
            for (k, &p) in b.corners.iter().enumerate() {
                let edge = b.corners[(k + 1) % b.corners.len()] - p;
                shared = half(&shared, p, edge.perp());
            }
            if area(&shared) > OVERLAP * a.area.min(b.area) {
                let middle = shared.iter().sum::<DVec2>() / shared.len() as f64 / scale;
                let (u, v) = (middle.x, middle.y);
                let (first, second) = (a.triangle.min(b.triangle), a.triangle.max(b.triangle));
                return Err(AtlasError::Overlap {
                    first,
                    second,
                    u,
                    v,
                });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Atlas, AtlasError};
    use crate::description::Mesh;

    /// Triangles of a mesh that lies in the plane of its texture coordinates.
    fn flat(uvs: &[[f32; 2]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh {
            positions: uvs.iter().map(|&[u, v]| [u, v, 0.0]).collect(),
            normals: None,
            uvs: Some(uvs.to_vec()),
            triangles: triangles.to_vec(),
        }
    }

    const SQUARE: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn two_triangles_fill_a_map() {
        let atlas = Atlas::new(&flat(&SQUARE, &[[0, 1, 2], [0, 2, 3]]), [5, 3]).unwrap();
        for (x, y) in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))) {
            let pieces = atlas.texel([x, y]);
            let last = pieces.last().expect("covered").until;
            assert!((last - 1.0).abs() < 1e-12, "{last}");
            // In the plane of the map a piece's corners are in its texel, whichever way its triangle turns.
            for piece in pieces {
                let [a, b, c] = [[0u32, 1, 2], [0, 2, 3]][piece.triangle as usize]
                    .map(|i| glam::DVec2::from(SQUARE[i as usize].map(f64::from)));
                for w in piece.corners {
                    let p = (a + (b - a) * w.x + (c - a) * w.y) * glam::DVec2::new(5.0, 3.0);
                    let within = |p: f64, i: u32| (p - f64::from(i) - 0.5).abs() < 0.5 + 1e-9;
                    assert!(within(p.x, x) && within(p.y, y), "{p} in {x}, {y}");
                }
            }
        }
    }

    #[test]
    fn what_no_triangle_covers_is_empty() {
        let atlas = Atlas::new(&flat(&SQUARE, &[[0, 1, 3]]), [4, 4]).unwrap();
        assert!(atlas.texel([3, 3]).is_empty() && !atlas.texel([0, 0]).is_empty());
        // Mirrored ones count like others.
        assert!(Atlas::new(&flat(&SQUARE, &[[0, 3, 1]]), [4, 4]).is_ok());
    }

    #[test]
    fn bad_texture_coordinates_are_refused() {
        let refused = |mesh: &Mesh| Atlas::new(mesh, [8, 8]).unwrap_err();
        let good = flat(&SQUARE, &[[0, 1, 2], [0, 2, 3]]);
        let mut mesh = good.clone();
        mesh.uvs = None;
        assert_eq!(refused(&mesh), AtlasError::Missing);
        let mut mesh = good.clone();
        mesh.uvs.as_mut().unwrap()[2] = [1.5, 0.0];
        assert!(matches!(
            refused(&mesh),
            AtlasError::Outside { vertex: 2, .. }
        ));
        let mut mesh = good.clone();
        mesh.uvs.as_mut().unwrap()[2] = [f32::NAN, 0.0];
        assert!(matches!(
            refused(&mesh),
            AtlasError::Outside { vertex: 2, .. }
        ));
        mesh = flat(&[[0.5, 0.5]; 3], &[[0, 1, 2]]);
        assert_eq!(refused(&mesh), AtlasError::Flat);
        let overlapping = flat(&SQUARE, &[[0, 1, 2], [0, 1, 3]]);
        assert!(matches!(
            refused(&overlapping),
            AtlasError::Overlap {
                first: 0,
                second: 1,
                ..
            }
        ));
        let twice = flat(&SQUARE, &[[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert!(matches!(refused(&twice), AtlasError::Overlap { .. }));
    }
}
