//! Rays against triangles, several at once and without cracks (Woop, Benthin, Wald 2013, "Watertight
//! ray/triangle intersection", JCGT 2(1)).
//!
//! Space is sheared so that the ray runs along +z from the origin; a triangle is hit if the origin of
//! the xy-plane lies in its projection, which the signs of three edge functions tell. A vertex is
//! sheared by the same operations whichever triangle it belongs to, so if the signs are exact for the
//! sheared vertices, neighbours agree about their edge and a fan of triangles about its vertex: a ray
//! can't slip through either. Rounding is monotone, so a computed edge function that isn't 0 has the
//! exact sign; those that are 0, rarely, are decided by exact products. Edges belong to both sides.

use super::lanes::{Lanes, MOST, Mask};
use super::ray::Ray;
use crate::real::{Real, Vec3};

/// An axis: 0, 1 or 2.
#[derive(Clone, Copy)]
pub struct Axis(u8);

impl Axis {
    /// As an index, below 3.
    #[inline(always)]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The component of a vector, without a branch: which axis it is can't be predicted.
    #[inline(always)]
    fn of(self, v: Vec3) -> Real {
        [v.x, v.y, v.z, 0.0][usize::from(self.0 & 3)]
    }

    /// The axis after this one, in a circle.
    #[inline(always)]
    fn next(self) -> Self {
        Self([1, 2, 0, 0][usize::from(self.0 & 3)])
    }
}

/// A ray as the test wants it: axes renamed so that z is where the direction is largest, and the
/// shear that turns the direction into (0, 0, 1).
#[derive(Clone, Copy)]
pub struct Shear {
    /// Which axes are x, y and z.
    pub axes: [Axis; 3],
    origin: [Real; 3],
    x: Real,
    y: Real,
    z: Real,
}

impl Shear {
    /// The shear of a ray. A direction of length 0 or with a NaN meets nothing.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let size = d.abs();
        let last = Axis(if size.z >= size.x.max(size.y) {
            2
        } else {
            u8::from(size.y > size.x)
        });
        let axes = [last.next(), last.next().next(), last];
        let z = 1.0 / axes[2].of(d);
        Self {
            axes,
            origin: axes.map(|axis| axis.of(ray.origin)),
            x: axes[0].of(d) * z,
            y: axes[1].of(d) * z,
            z,
        }
    }
}

/// Triangles that a ray meets.
pub struct Met {
    /// Which lanes: bit i is lane i; not 0.
    pub lanes: u32,
    /// Distance.
    pub t: [Real; MOST],
    /// Barycentric weight of vertex 1.
    pub u: [Real; MOST],
    /// Barycentric weight of vertex 2.
    pub v: [Real; MOST],
}

/// Triangles to test, one per lane.
pub trait Triangles<L> {
    /// That coordinate of vertex `i` of each.
    fn coordinate(&self, i: usize, axis: Axis) -> L;
}

/// Vertex `i` of each triangle as seen from the ray.
#[inline(always)]
fn sheared<L: Lanes>(
    token: L::Token,
    shear: &Shear,
    triangles: &impl Triangles<L>,
    i: usize,
) -> (L, L, L) {
    let [ax, ay, az] = shear.axes;
    let [ox, oy, oz] = shear.origin;
    let z = triangles.coordinate(i, az) - L::splat(token, oz);
    let x = triangles.coordinate(i, ax) - L::splat(token, ox) - L::splat(token, shear.x) * z;
    let y = triangles.coordinate(i, ay) - L::splat(token, oy) - L::splat(token, shear.y) * z;
    (x, y, z)
}

/// Which triangles the ray meets at t_min < t ≤ t_max. At `t_max` itself, because of ties: the caller
/// knows what it already has there.
#[inline(always)]
pub fn intersect<L: Lanes>(
    token: L::Token,
    shear: &Shear,
    t_min: Real,
    t_max: Real,
    triangles: &impl Triangles<L>,
) -> Option<Met> {
    let (x0, y0, z0) = sheared(token, shear, triangles, 0);
    let (x1, y1, z1) = sheared(token, shear, triangles, 1);
    let (x2, y2, z2) = sheared(token, shear, triangles, 2);

    // Edge function i is twice the area that vertex i's weight is proportional to.
    let mut e0 = x2 * y1 - y2 * x1;
    let mut e1 = x0 * y2 - y0 * x2;
    let mut e2 = x1 * y0 - y1 * x0;
    // Inside unless two signs differ. A NaN (of huge coordinates) may drop out of min and max, which
    // errs towards inside; the determinant will tell.
    let zero = L::splat(token, 0.0);
    let inside = zero.le(e0.min(e1).min(e2)) | e0.max(e1).max(e2).le(zero);
    let mut lanes = inside.bits();
    if lanes == 0 {
        return None;
    }

    let mut determinant = e0 + e1 + e2;
    let size = determinant.max(zero - determinant);
    let fair = L::splat(token, FAIR.0).le(size) & size.le(L::splat(token, FAIR.1));
    let doubtful = (e0.eq(zero) | e1.eq(zero) | e2.eq(zero)).bits() | !fair.bits();
    if lanes & doubtful != 0 {
        let mut e = [e0.spill(), e1.spill(), e2.spill()];
        let x = [x0.spill(), x1.spill(), x2.spill()];
        let y = [y0.spill(), y1.spill(), y2.spill()];
        lanes = decide(lanes, lanes & doubtful, &mut e, &x, &y);
        if lanes == 0 {
            return None;
        }
        let [r0, r1, r2] = &e;
        e0 = L::gather(token, r0);
        e1 = L::gather(token, r1);
        e2 = L::gather(token, r2);
        determinant = e0 + e1 + e2;
    }

    // All weights have one sign: t is a mean of the vertices', nothing cancels.
    let inverse = L::splat(token, 1.0) / determinant;
    let t = (e0 * z0 + e1 * z1 + e2 * z2) * L::splat(token, shear.z) * inverse;
    lanes &= (L::splat(token, t_min).lt(t) & t.le(L::splat(token, t_max))).bits();
    if lanes == 0 {
        return None;
    }
    Some(Met {
        lanes,
        t: t.spill(),
        u: (e1 * inverse).spill(),
        v: (e2 * inverse).spill(),
    })
}

/// Determinants within these bounds have a finite inverse, and those of triangles that hold the ray
/// can be trusted; beyond, products may have under- or overflowed.
const FAIR: (Real, Real) = (1e-30, 1e30);

/// Decides the `doubtful` among the `lanes` by edge functions with exact signs, and returns which are
/// hit. Their edge functions are replaced by ones scaled to a sum of ±1, so that scale can't matter.
#[cold]
#[inline(never)]
fn decide(
    lanes: u32,
    doubtful: u32,
    e: &mut [[Real; MOST]; 3],
    x: &[[Real; MOST]; 3],
    y: &[[Real; MOST]; 3],
) -> u32 {
    let mut hit = lanes & !doubtful;
    for lane in 0..MOST {
        if doubtful >> lane & 1 == 0 {
            continue;
        }
        let [x0, x1, x2] = [x[0][lane], x[1][lane], x[2][lane]];
        let [y0, y1, y2] = [y[0][lane], y[1][lane], y[2][lane]];
        let exact = [
            edge(x2, y1, y2, x1),
            edge(x0, y2, y0, x2),
            edge(x1, y0, y1, x0),
        ];
        let outside = exact.iter().any(|e| *e < 0.0) && exact.iter().any(|e| *e > 0.0);
        let sum = exact[0] + exact[1] + exact[2];
        if outside || sum == 0.0 || !sum.is_finite() {
            continue; // another side, no area, or coordinates beyond all bounds
        }
        for (row, exact) in e.iter_mut().zip(exact) {
            row[lane] = (exact / sum) as Real;
        }
        hit |= 1 << lane;
    }
    hit
}

/// a·b − c·d with the exact sign: products of singles are exact in double precision.
#[cfg(not(feature = "f64"))]
#[inline]
fn edge(a: f32, b: f32, c: f32, d: f32) -> f64 {
    f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d)
}

/// a·b − c·d with the exact sign: where the rounded products agree, what they lack decides.
#[cfg(feature = "f64")]
#[inline]
fn edge(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (ab, cd) = (a * b, c * d);
    if ab == cd {
        libm::fma(a, b, -ab) - libm::fma(c, d, -cd)
    } else {
        ab - cd
    }
}
