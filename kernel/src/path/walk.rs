//! The walk: one loop body for both ends. From a sensor it carries radiance's throughput (f/p in mode
//! radiance), from a light importance's.

use super::trace::{MAX_STEPS, Meeting, Trace, roulette};
use super::vertex::{Step, Vertex};
use super::weight::{Mis, Terms};
use crate::emitter::{self, Emission};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::{Real, Vec3, square};
use crate::sensor::Start;
use crate::shape::{Ray, Tracer};
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// A walk in flight: on its way from one vertex to the next.
#[derive(Clone, Copy, Debug)]
pub struct Walk<S> {
    mode: Mode,
    /// The way it is on.
    pub ray: Ray,
    /// f/p up to and including the direction of `ray`.
    pub throughput: S,
    /// `throughput` relative to the beginning, without refraction's η²: what roulette looks at.
    relative: S,
    /// Density of the direction per solid angle (of the place of parallel rays, per perpendicular area).
    pdf: Real,
    /// No inverse square at the next vertex: it began at infinity, or at a sensor of parallel rays.
    parallel: bool,
    /// |cos| at the vertex it left.
    cos: Real,
    /// Terms of the vertex it left.
    terms: Terms,
    /// Density of the way back at the vertex it left.
    pdf_reverse: Real,
    /// Whether it left by a Dirac lobe.
    dirac: bool,
    /// `a` of the next vertex, unless Dirac.
    next_a: Real,
    /// Edges so far, the one it is on included.
    pub edges: u32,
}

/// Where a walk arrived.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // inlined where it is made: it never moves
pub enum Arrival<S> {
    /// At a surface; the distance.
    Vertex(Vertex<S>, Real),
    /// Nowhere: it left the scene. The terms are those of x_∞, whose density is per solid angle.
    Escaped(Terms),
    /// Cut by [`MAX_STEPS`].
    Cut,
}

impl<S: Spectrum> Walk<S> {
    /// From the sensor. `light_paths` is n of the strategies with t = 1.
    #[inline(always)]
    pub fn from_sensor(start: &Start, light_paths: Real) -> Self {
        Self {
            mode: Mode::Radiance,
            ray: start.ray,
            throughput: S::grey(start.scale),
            relative: S::WHITE,
            pdf: start.density,
            parallel: start.parallel,
            cos: 1.0,
            // Nobody meets a pinhole or a lens: t = 0 doesn't exist.
            terms: Terms {
                forward: 1.0,
                back: 0.0,
                a: 0.0,
                b: 0.0,
            },
            pdf_reverse: 0.0,
            dirac: false,
            next_a: light_paths,
            edges: 1,
        }
    }

    /// From a light.
    #[inline(always)]
    pub fn from_light(emission: &Emission<S>) -> Self {
        Self {
            mode: Mode::Importance,
            ray: Ray {
                origin: emission.origin,
                direction: emission.direction,
                t_min: 0.0,
                t_max: Real::INFINITY,
            },
            throughput: emission.throughput,
            relative: S::WHITE,
            pdf: emission.direction_pdf,
            parallel: emission.distant,
            cos: emission
                .normal
                .map_or(1.0, |n| n.dot(emission.direction).abs()),
            terms: emission_terms(emission),
            pdf_reverse: 0.0,
            dirac: false,
            next_a: 1.0,
            edges: 1,
        }
    }

    /// Goes to the next vertex.
    #[inline(always)]
    pub fn arrive<T: Tracer>(
        &mut self,
        trace: &mut Trace<'_, '_, T>,
        sampler: &mut impl Sampler,
        mis: &Mis,
    ) -> Arrival<S> {
        self.announce(sampler);
        if self.edges > MAX_STEPS {
            trace.counters.cut_walks += 1;
            return Arrival::Cut;
        }
        match trace.meet(self.ray, sampler) {
            Meeting::Surface(point, distance) => {
                let previous = -self.ray.direction;
                let mut vertex =
                    Vertex::new(trace.scene, point, previous, self.throughput, sampler);
                let cos = point.normal.dot(self.ray.direction).abs();
                let inverse_square = 1.0 / square(distance);
                let forward = self.pdf * cos * if self.parallel { 1.0 } else { inverse_square };
                // From x_∞ on, its density is per solid angle: nothing to convert.
                let at_infinity = self.parallel && self.edges == 1;
                let back = if at_infinity {
                    1.0
                } else {
                    self.cos * inverse_square
                };
                vertex.terms = self.extend(mis, forward, back);
                Arrival::Vertex(vertex, distance)
            }
            Meeting::Escaped => Arrival::Escaped(self.extend(mis, self.pdf, self.cos)),
            Meeting::Cut => Arrival::Cut,
        }
    }

    #[inline(always)]
    fn extend(&self, mis: &Mis, forward: Real, back: Real) -> Terms {
        let mut terms = mis.extend(&self.terms, forward, back, self.pdf_reverse, self.dirac);
        if !self.dirac {
            terms.a = self.next_a;
        }
        terms
    }

    /// Leaves `vertex`; `None` if the walk ends there.
    #[inline(always)]
    pub fn leave(&mut self, vertex: &Vertex<S>, sampler: &mut impl Sampler) -> Option<Step<S>> {
        let step = vertex.scatter(self.mode, sampler)?;
        let mut throughput = self.throughput * step.weight;
        let mut relative = self.relative * step.weight * (1.0 / step.eta_scale);
        let q = roulette(relative);
        if q < 1.0 {
            if sampler.one(Purpose::Roulette) >= q {
                return None;
            }
            // Survival is in the throughput, not in the densities of the weights.
            throughput *= 1.0 / q;
            relative *= 1.0 / q;
        }
        self.throughput = throughput;
        self.relative = relative;
        self.ray = Ray {
            origin: vertex.point.leave(step.direction),
            direction: step.direction,
            t_min: 0.0,
            t_max: Real::INFINITY,
        };
        self.pdf = step.pdf;
        self.parallel = false;
        self.cos = step.direction.dot(vertex.point.normal).abs();
        self.terms = vertex.terms;
        self.pdf_reverse = step.pdf_reverse;
        self.dirac = step.dirac;
        self.next_a = 1.0;
        self.edges += 1;
        Some(step)
    }

    /// Whether the direction it goes in was drawn by a Dirac lobe.
    #[inline(always)]
    pub fn dirac(&self) -> bool {
        self.dirac
    }

    /// Density of the direction it goes in.
    #[inline(always)]
    pub fn pdf(&self) -> Real {
        self.pdf
    }

    #[inline(always)]
    fn announce(&self, sampler: &mut impl Sampler) {
        let subpath = match self.mode {
            Mode::Radiance => Subpath::Sensor,
            Mode::Importance => Subpath::Light,
        };
        sampler.at(subpath, self.edges);
    }
}

/// The terms of x₀: `a` says whether a walk may happen on it (s = 0).
#[inline(always)]
pub fn emission_terms<S>(emission: &Emission<S>) -> Terms {
    Terms {
        forward: emission.trace,
        back: 0.0,
        a: if emission.dirac { 0.0 } else { 1.0 },
        b: 0.0,
    }
}

/// Sets `a` of x₁: strategy s = 1 has p_connect(x₀ | x₁) where the others have p_trace(x₀).
#[inline(always)]
pub fn connect_first<S: Spectrum, T: Tracer>(
    trace: &Trace<'_, '_, T>,
    emission: &Emission<S>,
    x1: Vec3,
    terms: &mut Terms,
) {
    terms.a = emitter::connect_over_trace(trace.scene, emission, x1);
}
