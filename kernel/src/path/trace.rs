//! Asking the scene: what does a ray meet, is a segment free. Masks and null boundaries are dealt
//! with here, so that walks and connections never see them: they count no edge, and a fractional mask
//! is passed with probability 1 − α on a walk and multiplies V by 1 − α on a connection.

use crate::blob::Scene;
use crate::blob::format::{NONE, Shape, material};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3, sqrt};
use crate::shape::{Point, Ray, Tracer};
use crate::spectrum::Spectrum;

/// The most edges of a walk, and the most surfaces (masks, null boundaries) that all rays of one sample pass together.
/// The only cut there is; reaching it is counted ([`Counters::cut_walks`]).
///
/// With it the work of a sample is bounded: two walks of so many edges, at most N + 2 segments asked to be free at each vertex
/// (N: the scratch's capacity), so many surfaces passed: (N + 5)·2¹⁶ queries of the tree, each of which visits every node and
/// primitive at most once.
pub const MAX_STEPS: u32 = 1 << 16;

/// The farthest part of a segment that is not asked about, relative to its length: the rounding of
/// the hit's distance there. 2⁻¹⁶ in single precision.
const SHORTEN: Real = 1.0 - 128.0 * Real::EPSILON;

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
pub enum Meeting {
    /// A surface, after this distance.
    Surface(Point, Real),
    /// Nothing: it left the scene.
    Escaped,
    /// It ran into [`MAX_STEPS`].
    Cut,
}

/// A scene, the tracer that answers for it, and the counters.
pub struct Trace<'t, 'a, T> {
    /// The scene.
    pub scene: &'t Scene<'a>,
    /// Who answers for its geometry.
    pub tracer: &'t T,
    /// What happened.
    pub counters: Counters,
    /// Surfaces passed.
    passed: u32,
}

impl<'t, 'a, T: Tracer> Trace<'t, 'a, T> {
    /// With counters at zero.
    #[inline(always)]
    pub fn new(scene: &'t Scene<'a>, tracer: &'t T) -> Self {
        Self {
            scene,
            tracer,
            counters: Counters::default(),
            passed: 0,
        }
    }

    /// Takes note of a surface that is passed; false if that was one too many.
    #[inline(always)]
    fn pass(&mut self) -> bool {
        self.passed += 1;
        if self.passed > MAX_STEPS {
            self.counters.cut_walks += 1;
            return false;
        }
        true
    }

    /// The first surface that stops `ray`.
    #[inline(always)]
    pub fn meet(&mut self, ray: Ray, sampler: &mut impl Sampler) -> Meeting {
        self.counters.closest_rays += 1;
        let Some(hit) = self.tracer.closest(&ray) else {
            return Meeting::Escaped;
        };
        let Some(point) = Point::at(self.scene, &ray, &hit) else {
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
    ) -> Meeting {
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
            ray = Ray {
                origin: point.leave(ray.direction),
                t_min: 0.0,
                t_max: ray.t_max - t,
                ..ray
            };
            self.counters.closest_rays += 1;
            let next = self.tracer.closest(&ray);
            let Some((hit, p)) = next.and_then(|h| Some((h, Point::at(self.scene, &ray, &h)?)))
            else {
                return Meeting::Escaped;
            };
            (point, t) = (p, hit.t);
        }
    }

    /// V over a segment that starts off its surface at `ray.origin`: 1, 0, or the product of 1 − α on the way.
    /// `ray.t_max` is the distance of the other end.
    #[inline(always)]
    pub fn visibility(&mut self, mut ray: Ray) -> Real {
        self.counters.shadow_rays += 1;
        ray.t_max *= SHORTEN;
        if !self.scene.has_passable() {
            return if self.tracer.occluded(&ray) { 0.0 } else { 1.0 };
        }
        self.visibility_past(ray)
    }

    /// V between a surface point and `end`, a point off its own surface, or infinity in `direction`.
    #[inline(always)]
    pub fn sees(&mut self, from: &Point, direction: Vec3, end: Option<Vec3>) -> Real {
        let origin = from.leave(direction);
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
                return 1.0;
            }
            (ray.direction, ray.t_max) = (segment * (1.0 / length), length);
        }
        self.visibility(ray)
    }

    #[inline(never)]
    fn visibility_past(&mut self, mut ray: Ray) -> Real {
        let mut free = 1.0;
        loop {
            let Some(hit) = self.tracer.closest(&ray) else {
                return free;
            };
            let Some(point) = Point::at(self.scene, &ray, &hit) else {
                return free;
            };
            free *= 1.0 - self.opacity(&point, ray.direction);
            if free <= 0.0 || !self.pass() {
                return 0.0;
            }
            ray = Ray {
                origin: point.leave(ray.direction),
                t_min: 0.0,
                t_max: ray.t_max - hit.t,
                ..ray
            };
        }
    }

    /// α of the surface at `point`: 0 for null boundaries.
    #[inline(always)]
    fn opacity(&self, point: &Point, direction: Vec3) -> Real {
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

/// Russian roulette: the probability with which a walk goes on, given what it carries relative to what
/// it began with (without the η² of refraction, `transport.md` §1). Walks that still carry much always go
/// on: ending them would save little and cost variance.
#[inline(always)]
pub fn roulette<S: Spectrum>(relative: S) -> Real {
    /// Below this share of the beginning a walk has to win its way.
    const THRESHOLD: Real = 0.5;
    let q = relative.max_channel() * (1.0 / THRESHOLD);
    if q < 1.0 { q } else { 1.0 }
}
