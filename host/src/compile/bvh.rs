//! Builds the tree over triangles and spheres that the blob holds.
//!
//! 1. A binary tree with one primitive per leaf: `obvhs`' PLOC (Meister & Bittner 2018), then its
//!    reinsertion (2018), which move subtrees to where they cost least.
//! 2. Its collapse to eight-wide nodes and leaves of whole packets, optimal for that binary tree under
//!    the surface area heuristic, by dynamic programming (Ylitie, Karras, Laine 2017, §3.1).
//! 3. Layout: nodes depth first, packets in the order in which their leaves are met.
//!
//! Builders from the bottom up can be led astray, by thousands of identical triangles for example:
//! neither their time nor their depth is bounded. Step 1 has a plain substitute, halving at the median.

mod binary;
mod boxes;
mod refit;
mod wide;

use etendue::blob::format::{LANES, MAX_DEPTH, NONE, Node, Packet};

pub(super) use boxes::Boxes;
pub use refit::{Tree, refit};
pub use wide::Quality;

/// A tree, ready for the blob's sections.
#[derive(Clone, Debug)]
pub struct Built {
    /// Nodes; the first is the root.
    pub nodes: Vec<Node>,
    /// Triangles by leaves.
    pub packets: Vec<Packet>,
    /// Which source triangle stands in a slot, [`NONE`] if none does.
    pub slots: Vec<u32>,
    /// Which source sphere is the i-th.
    pub sphere_order: Vec<u32>,
    /// Depth of the deepest leaf's parent, the root being at depth 0.
    pub depth: u32,
    /// How good it is.
    pub quality: Quality,
}

/// Why there is no tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// A coordinate is infinite or NaN.
    #[error("triangle {0} has a coordinate that is not finite")]
    Triangle(usize),
    /// A centre isn't finite, or a radius isn't finite and positive.
    #[error(
        "sphere {0} has a centre that is not finite, or a radius that is not finite and positive"
    )]
    Sphere(usize),
    /// More primitives than references can name.
    #[error("{0} primitives are more than a blob can hold")]
    TooMany(usize),
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub low: [f32; 3],
    pub high: [f32; 3],
}

impl Bounds {
    pub const EMPTY: Self = Self {
        low: [f32::INFINITY; 3],
        high: [f32::NEG_INFINITY; 3],
    };

    fn of_triangle(vertices: &[[f32; 3]; 3]) -> Self {
        let mut bounds = Self::EMPTY;
        for v in vertices {
            bounds = bounds.union(&Self { low: *v, high: *v });
        }
        bounds
    }

    /// Rounded outwards.
    pub fn of_sphere(center: [f32; 3], radius: f32) -> Self {
        Self {
            low: center.map(|c| (c - radius).next_down()),
            high: center.map(|c| (c + radius).next_up()),
        }
    }

    pub fn union(&self, other: &Self) -> Self {
        let mut bounds = *self;
        for axis in 0..3 {
            bounds.low[axis] = bounds.low[axis].min(other.low[axis]);
            bounds.high[axis] = bounds.high[axis].max(other.high[axis]);
        }
        bounds
    }

    /// Whether they have a point in common.
    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|a| self.low[a] <= other.high[a] && other.low[a] <= self.high[a])
    }

    /// In double precision, so that huge scenes don't overflow.
    fn half_area(&self) -> f64 {
        let [x, y, z] =
            core::array::from_fn(|axis| f64::from(self.high[axis]) - f64::from(self.low[axis]));
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    fn is_finite(&self) -> bool {
        self.low.iter().chain(&self.high).all(|x| x.is_finite())
    }
}

/// What the tree is built over.
#[derive(Clone, Copy, Debug)]
struct Primitive {
    bounds: Bounds,
    /// Index into triangles, or into spheres.
    source: u32,
    sphere: bool,
}

/// A tree over triangles and spheres (centre, radius). Triangles without area can't be hit and are left out.
pub fn build(
    triangles: &[[[f32; 3]; 3]],
    spheres: &[([f32; 3], f32)],
) -> Result<Built, BuildError> {
    let total = triangles.len() + spheres.len();
    // Even if every triangle had a packet of its own.
    if total > etendue::blob::format::child::START_MASK as usize {
        return Err(BuildError::TooMany(total));
    }
    let mut primitives = Vec::with_capacity(total);
    for (source, vertices) in triangles.iter().enumerate() {
        if !vertices.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(BuildError::Triangle(source));
        }
        if has_area(vertices) {
            let bounds = Bounds::of_triangle(vertices);
            primitives.push(Primitive {
                bounds,
                source: source as u32,
                sphere: false,
            });
        }
    }
    for (source, &(center, radius)) in spheres.iter().enumerate() {
        let bounds = Bounds::of_sphere(center, radius);
        if !(bounds.is_finite() && radius > 0.0) {
            return Err(BuildError::Sphere(source));
        }
        primitives.push(Primitive {
            bounds,
            source: source as u32,
            sphere: true,
        });
    }

    let wide = wide::collapse(&binary::clustered(&primitives), &primitives);
    let wide = if wide.depth <= MAX_DEPTH {
        wide
    } else {
        wide::collapse(&binary::halved(&primitives), &primitives)
    };
    Ok(pack(wide, triangles))
}

/// Whether any component of (v₁−v₀)×(v₂−v₀) differs from 0.
fn has_area([a, b, c]: &[[f32; 3]; 3]) -> bool {
    let edge = |v: &[f32; 3]| -> [f64; 3] {
        core::array::from_fn(|axis| f64::from(v[axis]) - f64::from(a[axis]))
    };
    let (e, f) = (edge(b), edge(c));
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        e[i] * f[j] != e[j] * f[i]
    })
}

/// Fills the packets.
fn pack(wide: wide::Wide, triangles: &[[[f32; 3]; 3]]) -> Built {
    let packets = wide
        .slots
        .chunks(LANES)
        .map(|slots| {
            // An empty lane has v₀ = v₁ on an edge of the first triangle: no area, and the signs of its
            // edge functions differ for all rays but those in its line, so the test never dwells on it.
            let first = triangles[slots[0] as usize];
            let mut packet = Packet {
                v: [[[0.0; LANES]; 3]; 3],
            };
            for (lane, &source) in slots.iter().enumerate() {
                let vertices = match source {
                    NONE => [first[0], first[0], first[1]],
                    _ => triangles[source as usize],
                };
                for (i, vertex) in vertices.iter().enumerate() {
                    for (axis, x) in vertex.iter().enumerate() {
                        packet.v[i][axis][lane] = *x;
                    }
                }
            }
            packet
        })
        .collect();
    Built {
        nodes: wide.nodes,
        packets,
        slots: wide.slots,
        sphere_order: wide.sphere_order,
        depth: wide.depth,
        quality: wide.quality,
    }
}
