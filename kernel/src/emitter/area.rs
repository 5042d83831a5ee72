//! Surfaces that emit: triangles, and spheres sampled by the solid angle they subtend.
//!
//! Emitters are chosen by power, so choice-and-position has the same density per area everywhere on
//! a shape: [`crate::blob::format::Emitter::density`].

use super::{Emission, Incident};
use crate::blob::format::{Emitter, NONE, Sphere};
use crate::blob::{Scene, View};
use crate::real::{Frame, INV_PI, PI, Real, Vec3, safe_sqrt, sqrt, square, vec3};
use crate::shape::{Point, sphere_offset, triangle_normal, triangle_offset};
use crate::spectrum::Spectrum;
use crate::warp;

/// Radiance that leaves `point` towards `direction` (s = 0): on the side of the normal only.
#[inline(always)]
pub fn radiance<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    point: &Point,
    direction: Vec3,
) -> S {
    if point.normal.dot(direction) > 0.0 {
        scene.emitted(e)
    } else {
        S::BLACK
    }
}

/// p_trace(x₀) per area: uniform over the shape.
#[inline(always)]
pub fn trace_density(e: &Emitter) -> Real {
    Real::from(e.density)
}

/// p_connect(x₀ = `point` | y) per solid angle at y, for a walk from y that happened on it at `distance`.
#[inline(always)]
pub fn connect_density(
    scene: &Scene<'_>,
    e: &Emitter,
    point: &Point,
    y: Vec3,
    direction: Vec3,
    distance: Real,
) -> Real {
    if let Some(sphere) = scene.sphere(point.primitive)
        && let Some(cone) = Cone::towards(sphere, y)
    {
        return Real::from(e.density) * area(sphere) / cone.solid_angle();
    }
    let cos = direction.dot(point.normal).abs();
    if cos > 0.0 {
        Real::from(e.density) * square(distance) / cos
    } else {
        0.0
    }
}

/// p_connect(x₀ | y)/p_trace(x₀) for a point x₀ of a sphere.
#[inline(always)]
pub(super) fn connect_over_trace(sphere: &Sphere, x0: Vec3, normal: Vec3, y: Vec3) -> Real {
    let Some(cone) = Cone::towards(sphere, y) else {
        return 1.0;
    };
    let to_light = x0 - y;
    let squared = to_light.length_squared();
    let cos = to_light.dot(normal).abs() / sqrt(squared);
    // Both choose the emitter alike: area·cos/(solid angle·d²).
    area(sphere) * cos / (cone.solid_angle() * squared)
}

/// Light that arrives at `y` from `primitive`.
#[inline(always)]
pub(super) fn incident<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    primitive: u32,
    y: Vec3,
    xi: [Real; 2],
) -> Option<Incident<S>> {
    let density = Real::from(e.density);
    if let Some(sphere) = scene.sphere(primitive)
        && let Some(cone) = Cone::towards(sphere, y)
    {
        let (direction, distance, cos_light) = cone.sample(xi);
        let pdf = density * area(sphere) / cone.solid_angle();
        let jacobian = cos_light / square(distance);
        let outwards =
            (y + direction * distance - vec3(sphere.center)) * (1.0 / Real::from(sphere.radius));
        // No `then` here, nor below: whether the compiler inlines its closure depends on how many estimators there are.
        return if cos_light > 0.0 {
            Some(Incident {
                direction,
                end: Some(y + direction * distance + outwards * sphere_offset(sphere)),
                radiance: scene.emitted(e),
                pdf,
                dirac: false,
                trace_over_connect: density / (pdf * jacobian),
                emission: INV_PI * jacobian,
                medium: NONE,
            })
        } else {
            None
        };
    }
    // A uniform point, as any walk would draw it.
    shine(scene, e, &place(&scene, primitive, xi)?, 1.0, y)
}

/// Light that arrives at `y` from a uniform point of a primitive; p_connect(x₀ | y)/p_trace(x₀) is `over_trace`.
#[inline(always)]
pub(super) fn shine<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    place: &Place,
    over_trace: Real,
    y: Vec3,
) -> Option<Incident<S>> {
    let to_light = place.position - y;
    let squared = to_light.length_squared();
    if squared <= 0.0 {
        return None;
    }
    let distance = sqrt(squared);
    let direction = to_light * (1.0 / distance);
    let cos_light = -direction.dot(place.normal);
    if cos_light > 0.0 {
        Some(Incident {
            direction,
            end: Some(place.position + place.normal * place.offset),
            radiance: scene.emitted(e),
            pdf: Real::from(e.density) * over_trace * squared / cos_light,
            dirac: false,
            trace_over_connect: 1.0 / over_trace,
            emission: INV_PI * cos_light / squared,
            medium: NONE,
        })
    } else {
        None
    }
}

/// Light that leaves: a uniform point, a direction by the cosine.
#[inline(always)]
pub(super) fn emission<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    primitive: u32,
    xi: [Real; 2],
    direction: [Real; 2],
) -> Option<Emission<S>> {
    let point = match scene.sphere(primitive) {
        Some(s) => Point::on_sphere(
            &scene,
            primitive,
            vec3(s.center) + warp::sphere(xi) * Real::from(s.radius),
        )?,
        None => {
            let [u, v] = warp::triangle(xi);
            Point::on_triangle(&scene, primitive, u, v)?
        }
    };
    let local = warp::cosine_hemisphere(direction);
    let cos = local.z;
    let direction = Frame::around(point.normal).world(local);
    let trace = trace_density(e);
    // L·cos/(p(x₀)·cos/π): the cosine cancels.
    let visible = scene.emitted(e) * (1.0 / trace);
    (cos > 0.0).then(|| Emission {
        position: point.position,
        origin: point.leave(direction),
        direction,
        normal: Some(point.normal),
        throughput: visible * PI,
        visible,
        trace,
        direction_pdf: cos * INV_PI,
        distant: false,
        dirac: false,
        emitter: NONE,
        primitive: NONE,
        medium: NONE,
        volume: false,
    })
}

/// A point of a primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub position: Vec3,
    /// The normal there.
    pub normal: Vec3,
    /// How far off it rays are off the surface.
    pub offset: Real,
}

/// A uniform point of `primitive`.
#[inline(always)]
pub(super) fn place(scene: &Scene<'_>, primitive: u32, xi: [Real; 2]) -> Option<Place> {
    if let Some(s) = scene.sphere(primitive) {
        let outwards = warp::sphere(xi);
        return Some(Place {
            position: vec3(s.center) + outwards * Real::from(s.radius),
            normal: if s.flipped != 0 { -outwards } else { outwards },
            offset: sphere_offset(s),
        });
    }
    let [p0, p1, p2] = scene.corners(primitive)?;
    let [u, v] = warp::triangle(xi);
    let position = p0 * (1.0 - u - v) + p1 * u + p2 * v;
    Some(Place {
        position,
        normal: triangle_normal(p0, p1, p2),
        offset: triangle_offset(position, [p0, p1, p2]),
    })
}

/// Of a triangle or a sphere.
pub(super) fn of_primitive(scene: &Scene<'_>, primitive: u32) -> Real {
    if let Some(s) = scene.sphere(primitive) {
        return area(s);
    }
    let Some([p0, p1, p2]) = scene.corners(primitive) else {
        return 0.0;
    };
    0.5 * (p1 - p0).cross(p2 - p0).length()
}

#[inline(always)]
fn area(s: &Sphere) -> Real {
    4.0 * PI * square(Real::from(s.radius))
}

/// The cone under which a point outside sees a sphere that emits outwards.
struct Cone {
    axis: Vec3,
    distance: Real,
    radius: Real,
    /// 1 − cos of the half-angle, from sin² without cancellation.
    one_minus_cos: Real,
}

impl Cone {
    /// `None` where the sphere is seen from inside, or emits inwards: then its area is sampled.
    #[inline(always)]
    fn towards(s: &Sphere, y: Vec3) -> Option<Self> {
        let radius = Real::from(s.radius);
        let to_center = vec3(s.center) - y;
        let distance = to_center.length();
        if s.flipped != 0 || distance <= radius {
            return None;
        }
        let sin_squared = square(radius / distance);
        // 1 − sin² as a product: it doesn't cancel when y nearly touches the sphere.
        let cos_squared = (1.0 - radius / distance) * (1.0 + radius / distance);
        Some(Self {
            axis: to_center * (1.0 / distance),
            distance,
            radius,
            one_minus_cos: sin_squared / (1.0 + safe_sqrt(cos_squared)),
        })
    }

    #[inline(always)]
    fn solid_angle(&self) -> Real {
        2.0 * PI * self.one_minus_cos
    }

    /// A direction in the cone, the distance at which it meets the sphere, and the cosine there.
    #[inline(always)]
    fn sample(&self, xi: [Real; 2]) -> (Vec3, Real, Real) {
        let local = warp::cone(self.one_minus_cos, xi);
        let direction = Frame::around(self.axis).world(local);
        // Perpendicular distance of the ray from the centre, over the radius: sine at the sphere.
        let sin_squared = local.x * local.x + local.y * local.y;
        let ratio = self.distance / self.radius;
        let cos_light = safe_sqrt(1.0 - sin_squared * square(ratio));
        // The near root, as a quotient: (d² − r²)/(d·cos + r·cos_light).
        let power = (self.distance - self.radius) * (self.distance + self.radius);
        let distance = power / (self.distance * local.z + self.radius * cos_light);
        (direction, distance, cos_light)
    }
}
