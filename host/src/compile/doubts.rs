//! What compiles but can't be rendered well, from the geometry alone: each a warning that names the cure.

use super::geometry::key;
use crate::description::{Description, Geometry};
use glam::DVec3;
use std::collections::HashMap;

/// A triangle that is longer than this many times its height is a sliver: its barycentric coordinates lose digits, and rays that
/// leave it meet it again.
const SLIVER: f64 = 100.0;
/// Coordinates may be this many times larger than an object before its shape is lost in rounding: at 2^13 a thousandth of it is left.
const FAR: f64 = 8192.0;

/// All doubts about a scene.
pub fn doubts(d: &Description) -> Vec<String> {
    let mut out = Vec::new();
    slivers(d, &mut out);
    far(d, &mut out);
    twins(d, &mut out);
    out
}

fn slivers(d: &Description, out: &mut Vec<String>) {
    let (mut number, mut worst, mut name) = (0u64, 0.0, "");
    for s in &d.shapes {
        let Geometry::Mesh(mesh) = &s.geometry else {
            continue;
        };
        for [a, b, c] in mesh.triangles.iter().filter_map(|t| mesh.corners(t)) {
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let double_area = (b - a).cross(c - a).length();
            let ratio = longest * longest / double_area;
            // What has no area is never met.
            if double_area > 1e-12 * longest * longest && ratio > SLIVER {
                number += 1;
                if ratio > worst {
                    (worst, name) = (ratio, &s.name);
                }
            }
        }
    }
    if number > 0 {
        out.push(format!(
            "{number} triangles are slivers, the worst of them ({name}) {worst:.0} times longer than high: rays that leave one may meet it again, and it comes out too dark; cut them into shorter ones"
        ));
    }
}

fn far(d: &Description, out: &mut Vec<String>) {
    let mut worst: Option<(f64, &str)> = None;
    for s in &d.shapes {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        match &s.geometry {
            Geometry::Mesh(mesh) => {
                for p in &mesh.positions {
                    let p = DVec3::from(p.map(f64::from));
                    (low, high) = (low.min(p), high.max(p));
                }
            }
            Geometry::Sphere { center, radius, .. } => {
                let c = DVec3::from(center.map(f64::from));
                (low, high) = (c - f64::from(*radius), c + f64::from(*radius));
            }
        }
        let size = (high - low).max_element();
        let ratio = low.abs().max(high.abs()).max_element() / size;
        if size > 0.0 && ratio.is_finite() && worst.is_none_or(|(w, _)| ratio > w) {
            worst = Some((ratio, &s.name));
        }
    }
    if let Some((ratio, name)) = worst.filter(|(r, _)| *r > FAR) {
        out.push(format!(
            "{name} is {ratio:.0} times its own size from the origin: in single precision its points are off by up to {:.0e} of it; move the scene to the origin",
            ratio * f64::from(f32::EPSILON)
        ));
    }
}

/// Emitting triangles and spheres of different shapes in one place.
fn twins(d: &Description, out: &mut Vec<String>) {
    let mut seen: HashMap<Vec<[u32; 3]>, &str> = HashMap::new();
    for s in d.shapes.iter().filter(|s| s.emission.is_some()) {
        let mut keys: Vec<Vec<[u32; 3]>> = Vec::new();
        match &s.geometry {
            Geometry::Mesh(mesh) => keys.extend(mesh.triangles.iter().filter_map(|t| {
                let mut key = mesh.vertices(t)?.map(key).to_vec();
                key.sort_unstable();
                Some(key)
            })),
            Geometry::Sphere { center, radius, .. } => {
                keys.push(vec![key(*center), key([*radius, 0.0, 0.0])])
            }
        }
        for key in keys {
            if let Some(other) = seen.insert(key, &s.name) {
                out.push(format!(
                    "{other} and {} emit from one place: rays meet one of them, samples of lights find both, so that estimators disagree about their sum; leave one out",
                    s.name
                ));
                return;
            }
        }
    }
}
