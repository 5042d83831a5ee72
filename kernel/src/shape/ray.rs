//! A ray, and where it meets a primitive.

use crate::real::{Real, Vec3};

/// The part of a line that is asked about: origin + t·direction, `t_min` < t < `t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; unit length.
    pub direction: Vec3,
    /// Nearest t, exclusive; ≥ 0.
    pub t_min: Real,
    /// Farthest t, exclusive; may be infinite.
    pub t_max: Real,
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: Real,
    /// The primitive: a triangle slot (packet · 4 + lane), or `sphere_base` + sphere index.
    pub primitive: u32,
    /// Barycentric weight of the triangle's vertex 1 (0 on spheres).
    pub u: Real,
    /// Barycentric weight of the triangle's vertex 2 (0 on spheres).
    pub v: Real,
}

/// Answers the two questions that light transport asks of geometry. The kernel's own answer is the
/// BVH in the blob; an engine can bring its own structure by implementing this over the primitives
/// that [`crate::Scene::triangles`] and [`crate::Scene::spheres`] list.
///
/// Both methods see exactly the open interval (`t_min`, `t_max`); triangles are two-sided.
pub trait Tracer {
    /// The closest hit; of several at equal distance, the one with the lowest primitive id.
    fn closest(&self, ray: &Ray) -> Option<Hit>;
    /// Whether there is any hit.
    fn occluded(&self, ray: &Ray) -> bool;
}
