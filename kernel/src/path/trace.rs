//! Asking the scene: what does a ray meet, is a segment free. Masks and null boundaries are dealt
//! with here, so that walks and connections never see them: they count no edge, and a fractional mask
//! is passed with probability 1 − α on a walk and multiplies V by 1 − α on a connection. So is what fills the space
//! between surfaces (`passage.rs`).

use super::passage::Passage;
use super::vertex::Vertex;
use crate::blob::View;
use crate::blob::format::{NONE, Shape, material};
use crate::instance::Instance;
use crate::medium::Collision;
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3, sqrt};
use crate::shape::{Point, Ray, Tracer};
use crate::spectrum::Spectrum;
use core::marker::PhantomData;

/// The most edges of a walk, and the most surfaces (masks, null boundaries) that all rays of one sample pass together.
/// The only cut there is; reaching it is counted ([`Counters::cut_walks`]).
///
/// With it the work of a sample is bounded: two walks of so many edges, at most N + 2 segments asked to be free at each vertex
/// (N: the scratch's capacity), so many surfaces passed: (N + 5)·2¹⁶ queries of the tree, each of which visits every node and
/// primitive at most once. A ray tree has at most so many rays, each with at most 255 lights sampled at its end; a quadrature so many evaluations.
pub const MAX_STEPS: u32 = 1 << 16;

/// The farthest part of a segment that is not asked about, relative to its length: the rounding of
/// the hit's distance there. 2⁻¹⁶ in single precision.
pub(super) const SHORTEN: Real = 1.0 - 128.0 * Real::EPSILON;

/// What happened while estimating: kept by the caller's scratch, added up by whoever wants to know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays for which the closest hit was asked.
    pub closest_rays: u64,
    /// Segments that were asked to be free.
    pub shadow_rays: u64,
    /// Walks from a light.
    pub light_walks: u64,
    /// Walks, and segments, cut by [`MAX_STEPS`].
    pub cut_walks: u64,
    /// Light walks that ended because their storage was full: longer strategies don't exist, in any weight.
    pub full_walks: u64,
    /// Contributions refused because they were NaN, infinite or negative.
    pub rejected: u64,
}

impl Counters {
    /// Nothing happened.
    pub const ZERO: Self = Self {
        closest_rays: 0,
        shadow_rays: 0,
        light_walks: 0,
        cut_walks: 0,
        full_walks: 0,
        rejected: 0,
    };

    /// All rays.
    pub const fn rays(&self) -> u64 {
        self.closest_rays + self.shadow_rays
    }
}

impl core::ops::AddAssign for Counters {
    fn add_assign(&mut self, o: Self) {
        self.closest_rays += o.closest_rays;
        self.shadow_rays += o.shadow_rays;
        self.light_walks += o.light_walks;
        self.cut_walks += o.cut_walks;
        self.full_walks += o.full_walks;
        self.rejected += o.rejected;
    }
}

/// What a ray met.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // inlined where it is made: it never moves
pub enum Meeting<S> {
    /// A surface, after this distance.
    Surface(Point, Real),
    /// Something in the medium it was in, after this distance.
    Collision(Collision<S>, Real),
    /// Nothing: it left the scene.
    Escaped,
    /// It ran into [`MAX_STEPS`].
    Cut,
}

/// What is between two points.
#[derive(Clone, Copy, Debug)]
pub struct Sight<S> {
    /// V·τ: 0 past a surface; the product of 1 − α and of the media's transmittance on the way.
    pub value: S,
    /// The probability that a walk gets through, as the weights assume it.
    pub expected: Real,
    /// The medium at the other end.
    pub medium: u32,
}

impl<S: Spectrum> Sight<S> {
    /// Nothing is.
    pub const FREE: Self = Self {
        value: S::WHITE,
        expected: 1.0,
        medium: NONE,
    };

    /// Through empty space, of which this part is free.
    #[inline(always)]
    pub(super) fn free(part: Real) -> Self {
        Self {
            value: S::grey(part),
            ..Self::FREE
        }
    }
}

/// A scene, the tracer that answers for it, and the counters.
pub struct Trace<'t, 'a, T, K: Instance> {
    /// The scene, at the path's wavelengths.
    pub scene: View<'t, 'a, K::S>,
    /// Who answers for its geometry.
    pub tracer: &'t T,
    /// What happened.
    pub counters: Counters,
    /// The channel whose densities distances are drawn from ([`crate::medium`]).
    pub lead: usize,
    /// 1 over the share of its beginning below which a walk has to win its way.
    keep: Real,
    /// Transmittance without random numbers, even where they are cheaper.
    pub exact: bool,
    /// Surfaces that may still be passed, and tentative collisions.
    pub(super) remaining: u32,
    instance: PhantomData<K>,
}

impl<'t, 'a, T: Tracer, K: Instance> Trace<'t, 'a, T, K> {
    /// With counters at zero. Walks that carry less than the share `roulette` of what they began with go on by Russian roulette.
    #[inline(always)]
    pub fn new(scene: View<'t, 'a, K::S>, tracer: &'t T, lead: usize, roulette: Real) -> Self {
        Self {
            scene,
            tracer,
            counters: Counters::default(),
            lead,
            keep: 1.0 / roulette,
            exact: false,
            remaining: MAX_STEPS,
            instance: PhantomData,
        }
    }

    /// Takes note of a surface that is passed; false if that was one too many.
    #[inline(always)]
    pub(super) fn pass(&mut self) -> bool {
        if self.remaining == 0 {
            self.counters.cut_walks += 1;
            return false;
        }
        self.remaining -= 1;
        true
    }

    /// The first surface that stops `ray`, or the collision before it.
    #[inline(always)]
    pub fn meet(
        &mut self,
        ray: Ray,
        passage: &mut Passage<K::S>,
        sampler: &mut impl Sampler,
    ) -> Meeting<K::S> {
        if K::MEDIA {
            return self.meet_in_media(ray, passage, sampler);
        }
        self.counters.closest_rays += 1;
        let Some(hit) = self.tracer.closest(&ray) else {
            return Meeting::Escaped;
        };
        let Some(point) = Point::at(&self.scene, &ray, &hit) else {
            return Meeting::Escaped;
        };
        if !self.scene.has_passable() {
            return Meeting::Surface(point, hit.t);
        }
        self.meet_past(ray, point, hit.t, sampler)
    }

    /// [`Self::meet`] where there may be something to pass.
    #[inline(never)]
    fn meet_past(
        &mut self,
        mut ray: Ray,
        mut point: Point,
        mut t: Real,
        sampler: &mut impl Sampler,
    ) -> Meeting<K::S> {
        let mut distance = 0.0;
        loop {
            let opacity = self.opacity(&point, ray.direction);
            if opacity >= 1.0 || (opacity > 0.0 && sampler.one(Purpose::Opacity) < opacity) {
                return Meeting::Surface(point, distance + t);
            }
            if !self.pass() {
                return Meeting::Cut;
            }
            distance += t;
            ray = past(&ray, &point, t);
            self.counters.closest_rays += 1;
            let next = self.tracer.closest(&ray);
            let Some((hit, p)) = next.and_then(|h| Some((h, Point::at(&self.scene, &ray, &h)?)))
            else {
                return Meeting::Escaped;
            };
            (point, t) = (p, hit.t);
        }
    }

    /// V·τ over a segment that starts off its surface at `ray.origin`, in `medium`.
    /// `ray.t_max` is the distance of the other end.
    #[inline(always)]
    pub fn visibility(
        &mut self,
        mut ray: Ray,
        medium: u32,
        sampler: &mut impl Sampler,
    ) -> Sight<K::S> {
        self.counters.shadow_rays += 1;
        if K::MEDIA {
            return self.visibility_in_media(ray, medium, sampler);
        }
        ray.t_max *= SHORTEN;
        if !self.scene.has_passable() {
            return Sight::free(if self.tracer.occluded(&ray) { 0.0 } else { 1.0 });
        }
        Sight::free(self.visibility_past(ray))
    }

    /// V·τ between a vertex and `end`, a point off its own surface, or infinity in `direction`.
    #[inline(always)]
    pub fn sees(
        &mut self,
        from: &Vertex<K::S>,
        direction: Vec3,
        end: Option<Vec3>,
        sampler: &mut impl Sampler,
    ) -> Sight<K::S> {
        let origin = from.point.leave(direction);
        let medium = from.medium_towards(direction);
        let mut ray = Ray {
            origin,
            direction,
            t_min: 0.0,
            t_max: Real::INFINITY,
        };
        if let Some(end) = end {
            // Both ends have been lifted: the segment isn't quite along `direction` any more.
            let segment = end - origin;
            let length = sqrt(segment.dot(segment));
            if length <= 0.0 {
                return Sight {
                    medium,
                    ..Sight::free(1.0)
                };
            }
            (ray.direction, ray.t_max) = (segment * (1.0 / length), length);
        }
        self.visibility(ray, medium, sampler)
    }

    #[inline(never)]
    fn visibility_past(&mut self, mut ray: Ray) -> Real {
        let mut free = 1.0;
        loop {
            let Some(hit) = self.tracer.closest(&ray) else {
                return free;
            };
            let Some(point) = Point::at(&self.scene, &ray, &hit) else {
                return free;
            };
            free *= 1.0 - self.opacity(&point, ray.direction);
            if free <= 0.0 || !self.pass() {
                return 0.0;
            }
            ray = past(&ray, &point, hit.t);
        }
    }

    /// α of the surface at `point`: 0 for null boundaries.
    #[inline(always)]
    pub(super) fn opacity(&self, point: &Point, direction: Vec3) -> Real {
        let Some(shape) = self.scene.shape(point.shape) else {
            return 1.0;
        };
        if self.is_null(shape, point.normal.dot(direction) < 0.0) {
            return 0.0;
        }
        if shape.opacity == NONE {
            return 1.0;
        }
        self.scene.texture_view().opacity(shape.opacity, point.uv)
    }

    /// Whether the side that the ray arrives at is a null boundary.
    #[inline(always)]
    fn is_null(&self, shape: &Shape, front: bool) -> bool {
        let id = if front { shape.front } else { shape.back };
        self.scene
            .material(id)
            .is_some_and(|m| m.kind == material::NULL)
    }
}

impl<T, K: Instance> Trace<'_, '_, T, K> {
    /// Russian roulette: the probability with which a walk goes on, given what it carries relative to what
    /// it began with (without the η² of refraction, `transport.md` §1). Walks that still carry much always go
    /// on: ending them would save little and cost variance.
    #[inline(always)]
    pub fn roulette(&self, relative: K::S) -> Real {
        let q = relative.max_channel() * self.keep;
        if q < 1.0 { q } else { 1.0 }
    }
}

/// What is left of `ray` behind the surface that it met at `point` after `t`.
#[inline(always)]
pub(super) fn past(ray: &Ray, point: &Point, t: Real) -> Ray {
    Ray {
        origin: point.leave(ray.direction),
        t_min: 0.0,
        t_max: ray.t_max - t,
        ..*ray
    }
}
