//! Rays against the eight boxes of a node, never missing a box whose contents could be hit.
//!
//! Boxes are exact but the arithmetic isn't, and the triangle test works on vertices sheared with
//! rounding: a ray that meets a sheared triangle may pass its box by a little. Ize 2013 ("Robust BVH
//! ray traversal", JCGT 2(2)) widens distances by their relative error, which covers the slabs' own
//! rounding only. Here boxes grow by an absolute bound on all of it. With u the unit roundoff and R a
//! bound on |v − o| over axes and all vertices v of the scene, for a ray from o:
//!
//! - a sheared coordinate (v_x − o_x) − (d_x/d_z)(v_z − o_z), |d_x| ≤ |d_z|, is off by at most
//!   u|v_x − o_x| + 3u|v_z − o_z| + 2uR ≤ 6uR, so the true triangle's box, grown by that much, meets the ray;
//! - a slab's distance (b − o)·(1/d) has a relative error of 3u, as if b had moved by 3uR.
//!
//! So boxes grow by 16uR ≥ 9uR. That costs nothing: the near planes are tested against an origin
//! moved by it along the ray's octant, the far ones against one moved the other way. Another 2u|o|
//! make up for the rounding of the moved origins, when the scene is far from the world's.

use bytemuck::cast_ref;

use super::lanes::{Load, MOST, Mask};
use super::ray::Ray;
use crate::blob::format::{Node, WIDTH};
use crate::real::{Real, UNIT_ROUNDOFF, Vec3};

/// Components of the direction are at least this large, so that inverses are finite: a box is then
/// never 0·∞. Over the scene's reach the ray moves by less than boxes have grown.
const LEAST_DIRECTION: Real = 1e-18;

/// A box around everything, from which a ray's reach follows.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    center: Vec3,
    half: Vec3,
}

impl Bounds {
    /// Around nothing.
    pub const NOTHING: Self = Self {
        center: Vec3::ZERO,
        half: Vec3::ZERO,
    };

    /// Around the children of the root; empty slots don't count.
    pub fn of(root: &Node) -> Self {
        let mut low = Vec3::splat(Real::INFINITY);
        let mut high = Vec3::splat(Real::NEG_INFINITY);
        for i in 0..WIDTH {
            low = low.min(crate::real::vec3([
                root.low[0][i],
                root.low[1][i],
                root.low[2][i],
            ]));
            high = high.max(crate::real::vec3([
                root.high[0][i],
                root.high[1][i],
                root.high[2][i],
            ]));
        }
        if low.x <= high.x {
            // Halved before they are added, or the sum of large ones overflows.
            Self {
                center: low * 0.5 + high * 0.5,
                half: high * 0.5 - low * 0.5,
            }
        } else {
            Self::NOTHING
        }
    }

    /// R: no coordinate of the scene is farther from the point's. NaN or infinite if that is what the point is.
    #[inline(always)]
    fn reach(&self, point: Vec3) -> Real {
        let far = (point - self.center).abs() + self.half;
        // A NaN in any component must survive.
        let sum = far.x + far.y + far.z;
        if sum < Real::INFINITY {
            far.max_element()
        } else {
            Real::INFINITY
        }
    }
}

/// A ray as the box test wants it.
#[derive(Clone, Copy)]
pub struct Slabs {
    /// Rows of a node, seen as eight rows of eight, that hold the planes the ray enters by and leaves by.
    near: [usize; 3],
    far: [usize; 3],
    /// The origin as seen from these planes.
    near_origin: [Real; 3],
    far_origin: [Real; 3],
    inverse: [Real; 3],
    t_min: Real,
}

impl Slabs {
    /// `None` if the origin isn't finite or too far away to tell: then nothing is met.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: &Bounds) -> Option<Self> {
        let reach = bounds.reach(ray.origin);
        if reach >= Real::MAX {
            return None;
        }
        let grown = (16.0 * reach + 2.0 * ray.origin.abs().max_element()) * UNIT_ROUNDOFF;
        let mut slabs = Self {
            near: [0; 3],
            far: [0; 3],
            near_origin: [0.0; 3],
            far_origin: [0.0; 3],
            inverse: [0.0; 3],
            // Above −0, which would sort as the farthest of keys.
            t_min: if ray.t_min > 0.0 { ray.t_min } else { 0.0 },
        };
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            let least = if d.abs() > LEAST_DIRECTION {
                d.abs()
            } else {
                LEAST_DIRECTION
            };
            let backward = 3 * usize::from(d.is_sign_negative());
            let moved = grown.copysign(d);
            slabs.inverse[axis] = (1.0 / least).copysign(d);
            slabs.near[axis] = axis + backward;
            slabs.far[axis] = axis + 3 - backward;
            slabs.near_origin[axis] = o + moved;
            slabs.far_origin[axis] = o - moved;
        }
        Some(slabs)
    }

    /// Which children the ray may meet before `t_max` (bit i: child i), and where it enters each.
    #[inline(always)]
    pub fn test<L: Load<WIDTH>>(
        &self,
        token: L::Token,
        node: &Node,
        t_max: Real,
    ) -> (u32, [Real; MOST]) {
        let rows = cast_ref(node);
        let [nx, ny, nz] = self.distances::<L>(token, rows, &self.near, &self.near_origin);
        let [fx, fy, fz] = self.distances::<L>(token, rows, &self.far, &self.far_origin);
        // t_min comes last, so that a −0 can't win against a +0.
        let entry = nx.max(ny).max(nz.max(L::splat(token, self.t_min)));
        let exit = fx.min(fy).min(fz.min(L::splat(token, t_max)));
        (entry.le(exit).bits(), entry.spill())
    }

    /// Along the ray to one plane per axis and child.
    #[inline(always)]
    fn distances<L: Load<WIDTH>>(
        &self,
        token: L::Token,
        rows: &[[f32; WIDTH]; 8],
        planes: &[usize; 3],
        origin: &[Real; 3],
    ) -> [L; 3] {
        let [x, y, z] = *planes;
        let [ox, oy, oz] = origin.map(|o| L::splat(token, o));
        let [ix, iy, iz] = self.inverse.map(|i| L::splat(token, i));
        [
            (L::load(token, &rows[x & 7]) - ox) * ix,
            (L::load(token, &rows[y & 7]) - oy) * iy,
            (L::load(token, &rows[z & 7]) - oz) * iz,
        ]
    }
}
