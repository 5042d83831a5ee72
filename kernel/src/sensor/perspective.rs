//! The pinhole and the thin lens.

use super::{Projection, Start};
use crate::blob::format::Sensor;
use crate::real::{Real, Vec3, sqrt, vec3};
use crate::shape::Ray;
use crate::warp;

/// A pixel's area on the image plane at distance 1.
#[inline(always)]
fn pixel_area(s: &Sensor) -> Real {
    4.0 * Real::from(s.half_extent[0]) * Real::from(s.half_extent[1])
        / (s.resolution[0] as Real * s.resolution[1] as Real)
}

/// Pixels per solid angle at angle θ from the axis: dA = dω/cos³θ on the plane at distance 1.
#[inline(always)]
fn density(s: &Sensor, cos: Real) -> Real {
    1.0 / (pixel_area(s) * cos * cos * cos)
}

/// The point on the lens, relative to its centre.
#[inline(always)]
fn lens_point(s: &Sensor, xi: [Real; 2]) -> Vec3 {
    if s.aperture == 0.0 {
        return Vec3::ZERO;
    }
    let [x, y] = warp::disc(xi);
    (vec3(s.right) * x + vec3(s.down) * y) * Real::from(s.aperture)
}

/// The ray through `raster` and a point of the lens.
#[inline(always)]
pub(super) fn start(s: &Sensor, raster: [Real; 2], lens: [Real; 2]) -> Start {
    let plane = |axis: usize| {
        (raster[axis] / s.resolution[axis] as Real - 0.5 + Real::from(s.principal[axis]))
            * 2.0
            * Real::from(s.half_extent[axis])
    };
    let forward = vec3(s.forward);
    let pinhole = forward + vec3(s.right) * plane(0) + vec3(s.down) * plane(1);
    let lens = lens_point(s, lens);
    // All rays through the lens meet where the pinhole's ray meets the plane in focus.
    let direction = if s.aperture == 0.0 {
        pinhole
    } else {
        pinhole - lens * (1.0 / Real::from(s.focus))
    };
    let direction = direction * (1.0 / sqrt(direction.dot(direction)));
    let cos = direction.dot(forward);
    Start {
        ray: Ray {
            origin: vec3(s.origin) + lens,
            direction,
            t_min: Real::from(s.clip[0]) / cos,
            t_max: Real::from(s.clip[1]) / cos,
        },
        density: density(s, cos),
        parallel: false,
        scale: 1.0,
    }
}

/// Where the image sees what lies in direction `d` (not unit, from the lens point `lens`).
#[inline(always)]
fn raster(s: &Sensor, d: Vec3, depth: Real, lens: Vec3) -> [Real; 2] {
    // Back along the ray to the plane in focus, and from there to the pinhole's image plane.
    let plane = d * (1.0 / depth) + lens * (1.0 / Real::from(s.focus));
    let coordinate = |axis: usize, along: Vec3| {
        (plane.dot(along) / (2.0 * Real::from(s.half_extent[axis])) + 0.5
            - Real::from(s.principal[axis]))
            * s.resolution[axis] as Real
    };
    [coordinate(0, vec3(s.right)), coordinate(1, vec3(s.down))]
}

/// How `x` appears through a point of the lens.
#[inline(always)]
pub(super) fn project(s: &Sensor, x: Vec3, lens: [Real; 2]) -> Option<Projection> {
    let lens = lens_point(s, lens);
    let d = x - (vec3(s.origin) + lens);
    let depth = d.dot(vec3(s.forward));
    if depth <= Real::from(s.clip[0]) || depth >= Real::from(s.clip[1]) {
        return None;
    }
    let squared = d.dot(d);
    let distance = sqrt(squared);
    let cos = depth / distance;
    Some(Projection {
        direction: d * (-1.0 / distance),
        // From the near plane on: what lies before it doesn't exist for the sensor.
        distance: distance - Real::from(s.clip[0]) / cos,
        density: density(s, cos) / squared,
        scale: 1.0,
        raster: raster(s, d, depth, lens),
    })
}

/// How a direction at infinity appears, and the point of the lens.
#[inline(always)]
pub(super) fn project_distant(
    s: &Sensor,
    towards: Vec3,
    lens: [Real; 2],
) -> Option<(Projection, Vec3)> {
    let lens = lens_point(s, lens);
    let cos = towards.dot(vec3(s.forward));
    // Beyond the far plane the sensor sees nothing, so neither infinity if that is finite… but files
    // give a far plane to mean "far": what leaves the scene is seen (as in Mitsuba).
    (cos > 0.0).then(|| {
        let projection = Projection {
            direction: -towards,
            distance: Real::INFINITY,
            density: density(s, cos),
            scale: 1.0,
            raster: raster(s, towards, cos, lens),
        };
        (
            projection,
            vec3(s.origin) + lens + towards * (Real::from(s.clip[0]) / cos),
        )
    })
}
