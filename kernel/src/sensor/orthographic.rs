//! Parallel rays. A point of the scene is seen by one ray only, so t = 1 is deterministic.

use super::{Projection, Start};
use crate::blob::format::Sensor;
use crate::real::{Real, Vec3, vec3};
use crate::shape::Ray;

/// Pixels per area of the image plane.
#[inline(always)]
fn density(s: &Sensor) -> Real {
    s.resolution[0] as Real * s.resolution[1] as Real
        / (4.0 * Real::from(s.half_extent[0]) * Real::from(s.half_extent[1]))
}

/// The ray through `raster`.
#[inline(always)]
pub(super) fn start(s: &Sensor, raster: [Real; 2]) -> Start {
    let plane = |axis: usize| {
        (raster[axis] / s.resolution[axis] as Real - 0.5 + Real::from(s.principal[axis]))
            * 2.0
            * Real::from(s.half_extent[axis])
    };
    Start {
        ray: Ray {
            origin: vec3(s.origin) + vec3(s.right) * plane(0) + vec3(s.down) * plane(1),
            direction: vec3(s.forward),
            t_min: Real::from(s.clip[0]),
            t_max: Real::from(s.clip[1]),
        },
        density: density(s),
        parallel: true,
        scale: 1.0,
    }
}

/// How `x` appears.
#[inline(always)]
pub(super) fn project(s: &Sensor, x: Vec3) -> Option<Projection> {
    let d = x - vec3(s.origin);
    let depth = d.dot(vec3(s.forward));
    if depth <= Real::from(s.clip[0]) || depth >= Real::from(s.clip[1]) {
        return None;
    }
    let coordinate = |axis: usize, along: Vec3| {
        (d.dot(along) / (2.0 * Real::from(s.half_extent[axis])) + 0.5
            - Real::from(s.principal[axis]))
            * s.resolution[axis] as Real
    };
    Some(Projection {
        direction: -vec3(s.forward),
        distance: depth - Real::from(s.clip[0]),
        density: density(s),
        scale: 1.0,
        raster: [coordinate(0, vec3(s.right)), coordinate(1, vec3(s.down))],
    })
}
