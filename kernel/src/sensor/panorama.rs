//! All directions around a point, lat-long: columns are equal steps about the frame's up (−`down`), rows equal steps from it.
//!
//! The convention is that of our environments ([`crate::blob::format::emitter::LATLONG`]) with up as y, `forward` as z and `right` as −x:
//! `forward` lies in the middle (u = ½), `right` at u = ¾, the back at both ends. Pixels are areas: pixel (i, j) of W × H looks at longitudes
//! 2π·(i/W − ½) to 2π·((i+1)/W − ½) and polar angles π·j/H to π·(j+1)/H.
//!
//! Beyond its edges the image goes on: columns start over, and rows go on over a pole, half a turn further. So a filter that is wider
//! than a pixel reaches across the seam.

use super::{Projection, Start};
use crate::blob::format::Sensor;
use crate::real::{INV_PI, PI, Real, Vec3, atan2, sin_cos, sqrt, square, vec3};
use crate::shape::Ray;
use crate::warp::polar;

/// The sine of a polar angle that a density may be divided by.
const LEAST_SINE: Real = 1e-6;

/// Pixels per solid angle: dω = sin θ dθ dφ with dφ = 2π/W, dθ = π/H per pixel.
#[inline(always)]
fn density(s: &Sensor, sine: Real) -> Real {
    s.resolution[0] as Real * s.resolution[1] as Real * (0.5 * INV_PI * INV_PI)
        / sine.abs().max(LEAST_SINE)
}

/// The ray through `raster`, which may lie beyond the image's edges.
#[inline(always)]
pub(super) fn start(s: &Sensor, raster: [Real; 2]) -> Start {
    let phi = (raster[0] / s.resolution[0] as Real - 0.5) * (2.0 * PI);
    let theta = raster[1] / s.resolution[1] as Real * PI;
    // Over a pole the sine is negative: half a turn further.
    let ((sine, up), [ahead, right]) = (sin_cos(theta), polar(1.0, phi));
    let level = vec3(s.forward) * ahead + vec3(s.right) * right;
    let direction = level * sine - vec3(s.down) * up;
    Start {
        ray: Ray {
            origin: vec3(s.origin),
            direction: direction * (1.0 / sqrt(direction.dot(direction))),
            t_min: Real::from(s.clip[0]),
            t_max: Real::from(s.clip[1]),
        },
        density: density(s, sine),
        parallel: false,
        scale: 1.0,
    }
}

/// Where the image sees what lies in direction `d` (unit), and the sine of its polar angle.
#[inline(always)]
fn raster(s: &Sensor, d: Vec3) -> ([Real; 2], Real) {
    let (x, y) = (d.dot(vec3(s.right)), d.dot(vec3(s.forward)));
    let sine = sqrt(square(x) + square(y));
    let u = atan2(x, y) * (0.5 * INV_PI) + 0.5;
    let v = atan2(sine, -d.dot(vec3(s.down))) * INV_PI;
    (
        [u * s.resolution[0] as Real, v * s.resolution[1] as Real],
        sine,
    )
}

/// How `x` appears.
#[inline(always)]
pub(super) fn project(s: &Sensor, x: Vec3) -> Option<Projection> {
    let d = x - vec3(s.origin);
    let squared = d.dot(d);
    let distance = sqrt(squared);
    if distance <= Real::from(s.clip[0]) || distance >= Real::from(s.clip[1]) {
        return None;
    }
    let d = d * (1.0 / distance);
    let (raster, sine) = raster(s, d);
    Some(Projection {
        direction: -d,
        distance: distance - Real::from(s.clip[0]),
        density: density(s, sine) / squared,
        scale: 1.0,
        raster,
    })
}

/// How a direction at infinity appears, and where the ray to it begins.
#[inline(always)]
pub(super) fn project_distant(s: &Sensor, towards: Vec3) -> (Projection, Vec3) {
    let (raster, sine) = raster(s, towards);
    let projection = Projection {
        direction: -towards,
        distance: Real::INFINITY,
        density: density(s, sine),
        scale: 1.0,
        raster,
    };
    (projection, vec3(s.origin) + towards * Real::from(s.clip[0]))
}

/// Calls `f` with the points of the raster, in and around the image, that look where `raster` (in the image) does: all that may lie within
/// `radius` of it, at most 18 · 11 · 2 with the widest filter around the smallest image.
#[inline(always)]
pub(super) fn repeats(s: &Sensor, raster: [Real; 2], radius: Real, mut f: impl FnMut([Real; 2])) {
    let [width, height] = s.resolution.map(|n| n.max(1) as Real);
    let columns = (radius / width) as i32 + 2;
    let rows = (0.5 * radius / height) as i32 + 1;
    for row in -rows..=rows {
        let turn = 2.0 * height * row as Real;
        for (x, y) in [
            (raster[0], raster[1] + turn),
            (raster[0] + 0.5 * width, turn - raster[1]),
        ] {
            if y < -radius || y > height + radius {
                continue;
            }
            for column in -columns..=columns {
                f([x + width * column as Real, y]);
            }
        }
    }
}
