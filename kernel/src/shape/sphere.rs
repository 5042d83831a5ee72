//! Rays against exact spheres.
//!
//! The textbook's discriminant b² − ac cancels for a sphere that is small or far away. Here it comes
//! from the perpendicular from the centre to the ray (Haines, Günther, Akenine-Möller 2019, "Precision
//! improvements for ray/sphere intersection", Ray Tracing Gems ch. 7; after Hearn & Baker), and the
//! smaller root from the larger one by their product (Press et al., Numerical Recipes §5.6).

use super::ray::Ray;
use crate::blob::format::Sphere;
use crate::real::{Real, sqrt, vec3};

/// Nearest t with `t_min` < t ≤ `t_max` at which the ray is on the sphere.
#[inline(always)]
#[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
pub fn intersect(sphere: &Sphere, ray: &Ray, t_min: Real, t_max: Real) -> Option<Real> {
    let radius = sphere.radius as Real;
    let d = ray.direction;
    let from_center = ray.origin - vec3(sphere.center);
    // a t² − 2 b t + c = 0; t = b/a is the ray's point closest to the centre.
    let a = d.dot(d);
    let b = -from_center.dot(d);
    let closest = from_center + d * (b / a);
    let discriminant = radius * radius - closest.dot(closest);
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let distance = sqrt(from_center.dot(from_center));
    let c = (distance - radius) * (distance + radius);
    let q = b + sqrt(discriminant * a).copysign(b);
    let (t0, t1) = (c / q, q / a);
    let (near, far) = if t0 <= t1 { (t0, t1) } else { (t1, t0) };
    let inside = |t: Real| t_min < t && t <= t_max;
    if inside(near) {
        Some(near)
    } else if inside(far) {
        Some(far)
    } else {
        None
    }
}
