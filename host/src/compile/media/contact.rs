//! Boundaries of media that lie in other surfaces. A ray meets one of the two, whichever: behind it, it would go on in the wrong medium, or
//! on the other side of a wall. They are set apart before anything else is made of them, by a little more than the distance from surfaces
//! at which rays start: enough for a ray to meet both, one after the other, and far less than anything that can be seen.

use super::objects::sides;
use crate::compile::bvh::{Bounds, Boxes};
use crate::compile::geometry::key;
use crate::description::{Description, Geometry, Mesh, Model, Shape};
use etendue::real::Vec3;
use etendue::shape::triangle_offset;
use glam::DVec3;
use std::collections::HashMap;

/// Of several in one place each pass sets at least one apart.
const PASSES: usize = 8;
/// Distances of surfaces in units of that at which rays start: what is as close lies in one place,
const SAME: f64 = 2.0;
/// and what has been set apart is as far from it, so that half of it and more is left before the second.
const APART: f64 = 3.0;

/// Sets boundaries of `d` apart: what they are then, if any had to move, and what has to be said of those that couldn't.
pub fn set_apart(d: &Description) -> (Option<Description>, Vec<String>) {
    let mut moved: Option<Description> = None;
    let mut warnings = Vec::new();
    if d.shapes.iter().all(|s| sides(s).is_none()) {
        return (moved, warnings);
    }
    for _ in 0..PASSES {
        let contacts = Contacts::of(moved.as_ref().unwrap_or(d));
        warnings = contacts.warnings;
        if contacts.moves.is_empty() {
            break;
        }
        let next = moved.get_or_insert_with(|| d.clone());
        for (id, s) in next.shapes.iter_mut().enumerate() {
            if let Geometry::Mesh(mesh) = &mut s.geometry {
                for p in &mut mesh.positions {
                    if let Some(by) = contacts.moves.get(&(id, key(*p))) {
                        *p = (DVec3::from(p.map(f64::from)) + by).as_vec3().to_array();
                    }
                }
            }
        }
    }
    (moved, warnings)
}

/// A triangle that has an area.
struct Face {
    shape: usize,
    positions: [[f32; 3]; 3],
    corners: [DVec3; 3],
    normal: DVec3,
    area: f64,
    /// How far off it rays start, at its most: at a corner.
    offset: f64,
}

impl Face {
    fn of(shape: usize, mesh: &Mesh, t: &[u32; 3]) -> Option<Self> {
        let positions = mesh.vertices(t)?;
        let corners @ [a, b, c] = mesh.corners(t)?;
        let edges = [b - a, c - b, a - c];
        let cross = edges[0].cross(edges[1]);
        let longest = edges.iter().map(|e| e.length()).fold(0.0, f64::max);
        let area = cross.length();
        // Of positions that aren't finite, something else speaks.
        if !area.is_finite() || area <= 1e-12 * longest * longest {
            return None;
        }
        let at = positions.map(Vec3::from);
        let offset = at.map(|p| f64::from(triangle_offset(p, at)));
        Some(Self {
            shape,
            positions,
            corners,
            normal: cross / area,
            area,
            offset: offset.into_iter().fold(0.0, f64::max),
        })
    }

    /// The box around all that may lie in it.
    fn bounds(&self) -> Bounds {
        let by = DVec3::splat(SAME * self.offset);
        let [a, b, c] = self.corners;
        Bounds {
            low: (a.min(b).min(c) - by).as_vec3().to_array(),
            high: (a.max(b).max(c) + by).as_vec3().to_array(),
        }
    }

    /// Whether it is the same, or one of the same object that faces the same way.
    fn faces(&self, other: &Self) -> bool {
        self.shape == other.shape && self.normal.dot(other.normal) >= 0.0
    }

    /// Whether a part of one lies in the other: their plane is the same, and no line in it parts them.
    fn lies_in(&self, other: &Self) -> bool {
        let near = SAME * self.offset.max(other.offset);
        let (wide, small) = match self.area >= other.area {
            true => (self, other),
            false => (other, self),
        };
        let off = |p: &DVec3| (*p - wide.corners[0]).dot(wide.normal).abs();
        if !small.corners.iter().all(|p| off(p) <= near) {
            return false;
        }
        let parts = |face: &Self, i: usize| {
            let edge = face.corners[(i + 1) % 3] - face.corners[i];
            let across = edge.cross(wide.normal).normalize_or_zero();
            let range = |f: &Self| {
                let along = f.corners.map(|p| (p - wide.corners[0]).dot(across));
                let [a, b, c] = along;
                [a.min(b).min(c), a.max(b).max(c)]
            };
            let ([from, to], [low, high]) = (range(wide), range(small));
            to.min(high) - from.max(low) <= 2.0 * near
        };
        !(0..3).any(|i| parts(wide, i) || parts(small, i))
    }
}

/// Those of a shape.
fn faces(d: &Description, id: usize) -> impl Iterator<Item = Face> + '_ {
    let mesh = match &d.shapes[id].geometry {
        Geometry::Mesh(mesh) => Some(mesh),
        Geometry::Sphere { .. } => None,
    };
    let of = move |mesh: &'_ Mesh| -> Vec<Face> {
        let triangles = mesh.triangles.iter();
        triangles.filter_map(|t| Face::of(id, mesh, t)).collect()
    };
    mesh.into_iter().flat_map(of)
}

/// What lies in one place, and where to it has to go.
#[derive(Default)]
struct Contacts {
    /// By shape and place.
    moves: HashMap<(usize, [u32; 3]), DVec3>,
    warnings: Vec<String>,
}

impl Contacts {
    fn of(d: &Description) -> Self {
        let mut out = Self::default();
        let parting = |id: &usize| sides(&d.shapes[*id]).is_some();
        let boundaries: Vec<Face> = (0..d.shapes.len())
            .filter(parting)
            .flat_map(|id| faces(d, id))
            .collect();
        let tree = Boxes::over(boundaries.iter().map(Face::bounds));
        for id in 0..d.shapes.len() {
            // What does nothing on either side may be met or not.
            if !parting(&id) && is_null(d, &d.shapes[id]) {
                continue;
            }
            for face in faces(d, id) {
                tree.meeting(&face.bounds(), |i| {
                    let boundary = &boundaries[i];
                    // Each two boundaries once: the later one is to move.
                    let once = !parting(&id) || boundary.shape >= id;
                    if once && !boundary.faces(&face) && boundary.lies_in(&face) {
                        out.meet(d, &face, boundary);
                    }
                });
            }
        }
        out
    }

    /// `boundary` lies in `face`: it moves, or the other does.
    fn meet(&mut self, d: &Description, face: &Face, boundary: &Face) {
        let [first, second] = [face, boundary].map(|f| &d.shapes[f.shape]);
        // Media behind a surface and before it, along the face's normal.
        let Some(mut there) = sides(second) else {
            return;
        };
        if face.normal.dot(boundary.normal) < 0.0 {
            there.reverse();
        }
        let Some(here) = sides(first) else {
            // A wall: it stays outside. What refracts and touches it is as its owner said.
            if is_null(d, second) {
                self.push(face, boundary, -boundary.normal);
            }
            return;
        };
        // Where each of them says the media of both, either may be met.
        if here == there {
            return;
        }
        // The medium between them is said by both, if they are met in their order. An object can't be moved against itself.
        let way = if face.shape == boundary.shape {
            DVec3::ZERO
        } else if here[1] == there[0] {
            face.normal
        } else if here[0] == there[1] {
            -face.normal
        } else {
            DVec3::ZERO
        };
        // What can be is drawn in, never let out: of several on one plane each then moves one way only. Between two that refract a gap
        // would be seen.
        let moves = |f: &Face, s: &Shape, way: DVec3| is_null(d, s) && way.dot(f.normal) < 0.0;
        if way == DVec3::ZERO || !(is_null(d, first) || is_null(d, second)) {
            self.warn(first, second);
        } else if moves(boundary, second, way) || !(moves(face, first, -way) || is_null(d, first)) {
            self.push(face, boundary, way);
        } else {
            self.push(boundary, face, -way);
        }
    }

    fn warn(&mut self, first: &Shape, second: &Shape) {
        let both = match std::ptr::eq(first, second) {
            true => format!("two parts of {}", first.name),
            false => format!("{} and {}", first.name, second.name),
        };
        let text = format!(
            "{both} part media in one place: a ray meets one of the two boundaries, and may go on in the wrong medium; give the one that is to be met both media, or leave a gap"
        );
        if !self.warnings.contains(&text) {
            self.warnings.push(text);
        }
    }

    /// Moves the corners of `face` along `way`, until they are apart from `fixed`; those of its shape's other faces that are in the same
    /// place go with them.
    fn push(&mut self, fixed: &Face, face: &Face, way: DVec3) {
        let apart = APART * fixed.offset.max(face.offset);
        for (corner, p) in face.corners.iter().zip(&face.positions) {
            let by = self.moves.entry((face.shape, key(*p))).or_default();
            let missing = apart - (corner - fixed.corners[0] + *by).dot(way);
            *by += way * missing.max(0.0);
        }
    }
}

/// Whether nothing happens at a surface but that media change.
fn is_null(d: &Description, s: &Shape) -> bool {
    let null = |m: Option<usize>| {
        let material = m.and_then(|m| d.materials.get(m));
        material.is_some_and(|m| matches!(m.model, Model::Null))
    };
    null(s.front) && null(s.back)
}
