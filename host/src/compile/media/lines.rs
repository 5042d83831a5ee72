//! All that a line crosses, in double precision: unlike the kernel's tracer it finds every one of several surfaces that touch, and says
//! where it can't tell.

use etendue::blob::format::{LANES, NONE, Node, Packet, Sphere, Triangle, WIDTH, child};
use glam::DVec3;

/// The compiled tree and what stands in it.
pub struct Tree<'a> {
    pub nodes: &'a [Node],
    pub packets: &'a [Packet],
    pub triangles: &'a [Triangle],
    pub spheres: &'a [Sphere],
}

/// Where a line goes through a surface.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Distance from the line's origin.
    pub t: f64,
    /// By how much rounding may have shifted it.
    pub slack: f64,
    /// The shape.
    pub shape: u32,
    /// Whether the line comes from the side of the normal.
    pub front: bool,
}

/// A line from `origin` on.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub origin: DVec3,
    /// Unit.
    pub direction: DVec3,
    /// How far apart coordinates may lie that are meant to be the same.
    pub tolerance: f64,
}

/// Closer to an edge than this, in barycentric coordinates, nobody can say which of the triangles that share it is met.
const EDGE: f64 = 1e-6;

impl Tree<'_> {
    /// Every crossing, in order; `None` if the line comes too close to an edge or grazes a surface.
    pub fn crossings(&self, line: &Line) -> Option<Vec<Crossing>> {
        let mut out = Vec::new();
        let mut stack = vec![0u32];
        while let Some(reference) = stack.pop() {
            if reference & child::LEAF == 0 {
                let node = self.nodes.get(reference as usize)?;
                let children = (0..WIDTH).filter(|&i| node.children[i] != child::EMPTY);
                stack.extend(
                    children
                        .filter(|&i| meets(line, node, i))
                        .map(|i| node.children[i]),
                );
                continue;
            }
            let start = (reference & child::START_MASK) as usize;
            let count = (reference >> child::COUNT_SHIFT & 15) as usize + 1;
            if reference & child::SPHERES != 0 {
                for s in self.spheres.get(start..start + count)? {
                    ball(line, s, &mut out)?;
                }
            } else {
                for slot in start * LANES..(start + count) * LANES {
                    self.triangle(line, slot, &mut out)?;
                }
            }
        }
        out.sort_by(|a, b| a.t.total_cmp(&b.t));
        Some(out)
    }

    /// Möller and Trumbore's test (1997).
    fn triangle(&self, line: &Line, slot: usize, out: &mut Vec<Crossing>) -> Option<()> {
        let shape = self.triangles.get(slot)?.shape;
        if shape == NONE {
            return Some(());
        }
        let [a, b, c] = self
            .packets
            .get(slot / LANES)?
            .v
            .map(|axes| DVec3::from(axes.map(|lanes| f64::from(lanes[slot % LANES]))));
        let (ab, ac) = (b - a, c - a);
        let cross = ab.cross(ac);
        let double_area = cross.length();
        let longest = ab.length().max(ac.length()).max((c - b).length());
        // What has no area to speak of isn't there.
        if double_area <= 1e-12 * longest * longest {
            return Some(());
        }
        let normal = cross / double_area;
        let cosine = normal.dot(line.direction);
        let distance = normal.dot(a - line.origin);
        let t = distance / cosine;
        let slack = line.tolerance / cosine.abs();
        if cosine.abs() < 1e-9 {
            let near = distance.abs() <= line.tolerance + longest * 1e-6;
            return (!near).then_some(());
        }
        let p = line.origin + line.direction * t - a;
        let v = ab.cross(p).dot(normal) / double_area;
        let u = p.cross(ac).dot(normal) / double_area;
        let least = u.min(v).min(1.0 - u - v);
        if least.abs() < EDGE && t > -slack {
            return None;
        }
        if least > 0.0 && t > 0.0 {
            out.push(Crossing {
                t,
                slack,
                shape,
                front: cosine < 0.0,
            });
        }
        Some(())
    }
}

fn meets(line: &Line, node: &Node, i: usize) -> bool {
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (line.origin[axis], line.direction[axis]);
        let low = f64::from(node.low[axis][i]) - line.tolerance;
        let high = f64::from(node.high[axis][i]) + line.tolerance;
        if d == 0.0 {
            if o < low || o > high {
                return false;
            }
            continue;
        }
        let (a, b) = ((low - o) / d, (high - o) / d);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far
}

fn ball(line: &Line, s: &Sphere, out: &mut Vec<Crossing>) -> Option<()> {
    let center = DVec3::from(s.center.map(f64::from));
    let radius = f64::from(s.radius);
    let from = line.origin - center;
    let middle = -from.dot(line.direction);
    let closest = (from + line.direction * middle).length();
    if (closest - radius).abs() <= EDGE * radius {
        return None;
    }
    if closest > radius {
        return Some(());
    }
    let half = (radius * radius - closest * closest).sqrt();
    let slack = line.tolerance * radius / half;
    for (t, enters) in [(middle - half, true), (middle + half, false)] {
        if t > 0.0 {
            let front = enters == (s.flipped == 0);
            out.push(Crossing {
                t,
                slack,
                shape: s.shape,
                front,
            });
        }
    }
    Some(())
}
