//! Sensors without an image: a ray (radiance), a point with a normal (irradiance).

use super::{Projection, Start};
use crate::real::{Frame, INV_PI, PI, Real, Vec3, sqrt};
use crate::shape::Ray;
use crate::warp;

/// The ray itself. Its density is a Dirac's, so no other strategy competes with the walk.
#[inline(always)]
pub(super) fn ray_start(ray: Ray) -> Start {
    Start {
        ray,
        density: 1.0,
        parallel: false,
        scale: 1.0,
    }
}

/// E = ∫ L cos θ dω: directions by cos θ/π, each of value π.
#[inline(always)]
pub(super) fn irradiance_start(position: Vec3, normal: Vec3, xi: [Real; 2]) -> Start {
    let local = warp::cosine_hemisphere(xi);
    Start {
        ray: Ray {
            origin: position,
            direction: Frame::around(normal).world(local),
            t_min: 0.0,
            t_max: Real::INFINITY,
        },
        density: local.z.max(1e-7) * INV_PI,
        parallel: false,
        scale: PI,
    }
}

/// How `x` appears to the point.
#[inline(always)]
pub(super) fn irradiance_project(position: Vec3, normal: Vec3, x: Vec3) -> Option<Projection> {
    let d = x - position;
    let squared = d.dot(d);
    let distance = sqrt(squared);
    let cos = d.dot(normal) / distance;
    (cos > 0.0).then(|| Projection {
        direction: d * (-1.0 / distance),
        distance,
        density: cos * INV_PI / squared,
        scale: PI,
        raster: [0.0, 0.0],
    })
}

/// How a direction at infinity appears to the point.
#[inline(always)]
pub(super) fn irradiance_project_distant(
    position: Vec3,
    normal: Vec3,
    towards: Vec3,
) -> Option<(Projection, Vec3)> {
    let cos = towards.dot(normal);
    (cos > 0.0).then(|| {
        let projection = Projection {
            direction: -towards,
            distance: Real::INFINITY,
            density: cos * INV_PI,
            scale: PI,
            raster: [0.0, 0.0],
        };
        (projection, position)
    })
}
