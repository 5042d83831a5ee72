//! A point on a surface: where a ray met it, which way it faces, and how far a new ray must start
//! from it so as not to meet it again.

use super::ray::{Hit, Ray};
use crate::blob::Scene;
use crate::blob::format::{Sphere, needs};
use crate::real::{INV_PI, Real, Vec3, acos, atan2, gamma, safe_sqrt, vec3};

/// A point on a surface of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Where.
    pub position: Vec3,
    /// Geometric normal, unit, outwards.
    pub normal: Vec3,
    /// Shading normal, unit, on the same side.
    pub shading: Vec3,
    /// Texture coordinates.
    pub uv: [Real; 2],
    /// How far along the normal a ray must start to be off the surface: a bound on the error of `position`.
    pub offset: Real,
    /// The shape.
    pub shape: u32,
    /// The primitive.
    pub primitive: u32,
}

impl Point {
    /// The point where `ray` met the scene; `None` only if `hit` names no primitive of the scene.
    #[inline(always)]
    pub fn at(scene: &Scene<'_>, ray: &Ray, hit: &Hit) -> Option<Self> {
        match scene.triangle(hit.primitive) {
            Some(_) => Self::on_triangle(scene, hit.primitive, hit.u, hit.v),
            None => Self::on_sphere(scene, hit.primitive, ray.origin + ray.direction * hit.t),
        }
    }

    /// The point with barycentric weights (1−u−v, u, v) of a triangle.
    #[inline(always)]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    pub fn on_triangle(scene: &Scene<'_>, slot: u32, u: Real, v: Real) -> Option<Self> {
        let triangle = scene.triangle(slot)?;
        let shape = scene.shape(triangle.shape)?;
        let [p0, p1, p2] = scene.corners(slot)?;
        let w = 1.0 - u - v;
        let (a, b, c) = (p0 * w, p1 * u, p2 * v);
        let normal = triangle_normal(p0, p1, p2);
        let position = a + b + c;
        let [i0, i1, i2] = triangle.index;
        let mut shading = normal;
        if let (Some(n0), Some(n1), Some(n2)) = (
            scene.normal(shape, i0),
            scene.normal(shape, i1),
            scene.normal(shape, i2),
        ) {
            let n = n0 * w + n1 * u + n2 * v;
            let length = n.length();
            if length > 1e-6 {
                let n = n * (1.0 / length);
                shading = if n.dot(normal) < 0.0 { -n } else { n };
            }
        }
        let uv = match (
            scene.uv(shape, i0),
            scene.uv(shape, i1),
            scene.uv(shape, i2),
        ) {
            (Some(t0), Some(t1), Some(t2)) => [
                t0[0] as Real * w + t1[0] as Real * u + t2[0] as Real * v,
                t0[1] as Real * w + t1[1] as Real * u + t2[1] as Real * v,
            ],
            _ => [u, v],
        };
        Some(Self {
            position,
            normal,
            shading,
            uv,
            offset: triangle_offset(position, [p0, p1, p2]),
            shape: triangle.shape,
            primitive: slot,
        })
    }

    /// The point of a sphere nearest to `near`.
    #[inline(always)]
    pub fn on_sphere(scene: &Scene<'_>, primitive: u32, near: Vec3) -> Option<Self> {
        let sphere = scene.sphere(primitive)?;
        let center = vec3(sphere.center);
        let radius = Real::from(sphere.radius);
        let outwards = unit_or_z(near - center);
        let local = outwards * radius;
        let normal = if sphere.flipped != 0 {
            -outwards
        } else {
            outwards
        };
        let uv = if cfg!(feature = "textures") && scene.has(needs::TEXTURES) {
            longitude_colatitude(outwards)
        } else {
            [0.0, 0.0]
        };
        Some(Self {
            position: center + local,
            normal,
            shading: normal,
            uv,
            offset: sphere_offset(sphere),
            shape: sphere.shape,
            primitive,
        })
    }

    /// Where a ray towards `direction` starts: off the surface, on the side it goes to
    /// (Wächter & Binder 2019; pbrt-v4 §6.8.6).
    #[inline(always)]
    pub fn leave(&self, direction: Vec3) -> Vec3 {
        let side = if direction.dot(self.normal) < 0.0 {
            -self.offset
        } else {
            self.offset
        };
        self.position + self.normal * side
    }
}

/// How far off a triangle a ray must start that doesn't meet it again.
///
/// Not the error of the position alone, as that can be 0 (a floor at z = 0) where the intersection's isn't: there
/// edge functions have an error of a few roundings of the triangle's extent squared, which shifts the
/// hit in its plane, and so along a slanting ray, by as many roundings of the extent (Woop 2013, §3.3).
#[inline(always)]
pub fn triangle_offset(position: Vec3, [a, b, c]: [Vec3; 3]) -> Real {
    let reach = |corner: Vec3| (corner - position).abs();
    gamma(4) * reach(a).max(reach(b)).max(reach(c)).max_element()
        + gamma(8) * position.abs().max_element()
}

/// How far off a sphere a ray must start that doesn't meet it again.
#[inline(always)]
pub fn sphere_offset(sphere: &Sphere) -> Real {
    gamma(8) * (Real::from(sphere.radius) + vec3(sphere.center).abs().max_element())
}

/// Over the whole parameter square, as meshes of spheres have them.
#[inline(never)]
fn longitude_colatitude(outwards: Vec3) -> [Real; 2] {
    let phi = atan2(outwards.y, outwards.x) * (0.5 * INV_PI);
    [
        if phi < 0.0 { phi + 1.0 } else { phi },
        acos(outwards.z.clamp(-1.0, 1.0)) * INV_PI,
    ]
}

/// The unit geometric normal (v₁−v₀)×(v₂−v₀); any unit vector for a degenerate triangle (which no ray meets).
#[inline(always)]
pub fn triangle_normal(p0: Vec3, p1: Vec3, p2: Vec3) -> Vec3 {
    unit_or_z((p1 - p0).cross(p2 - p0))
}

/// `v` at unit length, or z if it has none. Scaled first: squares of tiny or huge vectors leave the range of `Real`.
#[inline(always)]
pub fn unit_or_z(v: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest < Real::INFINITY {
        let v = v * (1.0 / largest);
        if v.is_finite() {
            return v * (1.0 / safe_sqrt(v.dot(v)));
        }
    }
    Vec3::Z
}
