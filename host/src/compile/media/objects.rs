//! What objects say of the media around them, and what light may do there.

use super::space::Matter;
use crate::compile::geometry::key;
use crate::description::{ColorSource, Description, Geometry, Model, Shape};
use glam::DVec3;
use std::collections::HashMap;

/// What a shape says of the media on its two sides, interior and exterior: nothing, if it doesn't part any.
pub fn sides(s: &Shape) -> Option<[Matter; 2]> {
    (s.interior.is_some() || s.exterior.is_some()).then_some([s.interior, s.exterior])
}

/// Media before and behind a crossing.
pub fn along(s: &Shape, front: bool) -> Option<[Matter; 2]> {
    sides(s).map(|[interior, exterior]| {
        if front {
            [exterior, interior]
        } else {
            [interior, exterior]
        }
    })
}

/// Whether no light that comes from the side of the normal, or from the other, gets through.
pub fn blocks(d: &Description, shape: &Shape, front: bool) -> bool {
    let material = if front { shape.front } else { shape.back };
    shape.opacity.is_none() && !material.is_some_and(|m| lets_through(d, m, DEEPEST))
}

pub fn each_point(geometry: &Geometry, mut each: impl FnMut(DVec3)) {
    match geometry {
        Geometry::Mesh(mesh) => {
            for p in &mesh.positions {
                each(DVec3::from(p.map(f64::from)));
            }
        }
        Geometry::Sphere { center, radius, .. } => {
            let center = DVec3::from(center.map(f64::from));
            each(center - f64::from(*radius));
            each(center + f64::from(*radius));
        }
    }
}

/// Whether some edge of a mesh has a triangle on one side only; vertices at the same place are the same.
pub fn is_open(geometry: &Geometry) -> bool {
    let Geometry::Mesh(mesh) = geometry else {
        return false;
    };
    let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    for t in &mesh.triangles {
        let Some([a, b, c]) = mesh.vertices(t).map(|t| t.map(key)) else {
            continue;
        };
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from < to {
                *edges.entry([from, to]).or_default() += 1;
            } else if to < from {
                *edges.entry([to, from]).or_default() -= 1;
            }
        }
    }
    edges.values().any(|&n| n != 0)
}

/// Blends of blends that are looked into: whatever is within more of them may let light pass.
const DEEPEST: u32 = 8;

/// Whether light that meets the material may come out on the other side.
fn lets_through(d: &Description, material: usize, depth: u32) -> bool {
    let Some(material) = d.materials.get(material) else {
        return false;
    };
    let some = |c: &ColorSource| *c != ColorSource::Constant([0.0; 3]);
    match &material.model {
        Model::Diffuse { transmittance, .. } => some(transmittance),
        Model::Phong {
            transmittance,
            diffuse_transmittance,
            ..
        } => some(transmittance) || some(diffuse_transmittance),
        Model::Mirror { .. }
        | Model::Conductor { .. }
        | Model::RoughConductor { .. }
        | Model::Plastic { .. } => false,
        Model::Blend { parts, .. } => {
            depth == 0 || parts.iter().any(|&part| lets_through(d, part, depth - 1))
        }
        Model::Dielectric { .. }
        | Model::Dispersive { .. }
        | Model::RoughDielectric { .. }
        | Model::Null
        | Model::Sheet { .. } => true,
    }
}
