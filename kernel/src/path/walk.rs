//! The walk: one loop body for both ends. From a sensor it carries radiance's throughput (f/p in mode
//! radiance), from a light importance's.

use super::passage::{Leg, Passage};
use super::trace::{MAX_STEPS, Meeting, Trace};
use super::vertex::{Step, Vertex};
use super::weight::{Mis, Terms};
use crate::blob::format::NONE;
use crate::emitter::{self, Emission};
use crate::instance::Instance;
use crate::medium::{self, Carried, density};
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
    /// Whose numbers it takes.
    subpath: Subpath,
    /// The way it is on.
    pub ray: Ray,
    /// f/p up to and including the direction of `ray`.
    pub throughput: S,
    /// p_k/p̄ by channel ([`crate::medium`]).
    pub ratio: S,
    /// The medium it is in.
    medium: u32,
    /// What the media on the last way send back along it, times what the walk carried.
    pub glow: S,
    /// E where it collided last.
    pub emission: S,
    /// Where the way through a medium began on which it collided last.
    pub leg: Option<Leg<S>>,
    /// One of the ways through media that it has gone since it left a vertex, drawn uniformly, and how many there were.
    pub drawn: Option<(Leg<S>, u32)>,
    /// `throughput` relative to the beginning, without refraction's η²: what roulette looks at.
    relative: S,
    /// Density of the direction per solid angle (of the place of parallel rays, per perpendicular area).
    pdf: Real,
    /// No inverse square at the next vertex: it began at infinity, or at a sensor of parallel rays.
    parallel: bool,
    /// What turns a density per solid angle, times 1/d², into one of the vertex it left ([`Vertex::facing`]).
    facing: Real,
    /// The probability of the way it went last, as the weights assume it.
    pub expected: Real,
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
    /// At a surface, or in a volume; the distance.
    Vertex(Vertex<S>, Real),
    /// Nowhere: it left the scene. The terms are those of x_∞, whose density is per solid angle.
    Escaped(Terms),
    /// Cut by [`MAX_STEPS`].
    Cut,
}

impl<S: Spectrum> Walk<S> {
    /// From the sensor, which stands in `medium`. `light_paths` is n of the strategies with t = 1.
    #[inline(always)]
    pub fn from_sensor(start: &Start, medium: u32, light_paths: Real) -> Self {
        Self {
            mode: Mode::Radiance,
            subpath: Subpath::Sensor,
            ray: start.ray,
            throughput: S::grey(start.scale),
            ratio: S::WHITE,
            medium,
            glow: S::BLACK,
            emission: S::BLACK,
            leg: None,
            drawn: None,
            relative: S::WHITE,
            pdf: start.density,
            parallel: start.parallel,
            facing: 1.0,
            expected: 1.0,
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
    pub fn from_light<T, K: Instance<S = S>>(
        trace: &Trace<'_, '_, T, K>,
        emission: &Emission<S>,
    ) -> Self {
        let mut carried = Carried {
            throughput: emission.throughput,
            ratio: S::WHITE,
        };
        if K::MEDIA && emission.volume {
            let x0 = emission.position;
            match medium::chances(trace.scene, emission.medium, x0, trace.lead) {
                Some(chances) => carried.draw(S::WHITE, chances),
                None => carried.throughput = S::BLACK,
            }
        }
        Self {
            mode: Mode::Importance,
            subpath: Subpath::Light,
            ray: Ray {
                origin: emission.origin,
                direction: emission.direction,
                t_min: 0.0,
                t_max: Real::INFINITY,
            },
            throughput: carried.throughput,
            ratio: carried.ratio,
            medium: if K::MEDIA { emission.medium } else { NONE },
            glow: S::BLACK,
            emission: S::BLACK,
            leg: None,
            drawn: None,
            relative: S::WHITE,
            pdf: emission.direction_pdf,
            parallel: emission.distant,
            facing: source_facing(trace, emission, emission.direction).abs(),
            expected: 1.0,
            terms: emission_terms(emission),
            pdf_reverse: 0.0,
            dirac: false,
            next_a: 1.0,
            edges: 1,
        }
    }

    /// Goes to the next vertex. Inlined where [`Vertex::scatter`] is.
    #[cfg_attr(any(target_family = "wasm", target_arch = "arm"), inline(never))]
    #[cfg_attr(not(any(target_family = "wasm", target_arch = "arm")), inline(always))]
    pub fn arrive<T: Tracer, K: Instance<S = S>>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        sampler: &mut impl Sampler,
        mis: &Mis,
    ) -> Arrival<S> {
        self.announce(sampler);
        if self.edges > MAX_STEPS {
            trace.counters.cut_walks += 1;
            return Arrival::Cut;
        }
        let mut passage = Passage {
            medium: self.medium,
            carried: Carried {
                throughput: S::WHITE,
                ratio: self.ratio,
            },
            glow: S::BLACK,
            expected: 1.0,
            leg: None,
            drawn: None,
        };
        let meeting = trace.meet(self.ray, &mut passage, sampler);
        if K::MEDIA {
            self.medium = passage.medium;
            self.ratio = passage.carried.ratio;
            self.glow = self.throughput * passage.glow;
            self.throughput *= passage.carried.throughput;
            self.relative *= passage.carried.throughput;
            self.expected = passage.expected;
            (self.leg, self.drawn) = (passage.leg, passage.drawn);
        }
        match meeting {
            Meeting::Surface(point, distance) => {
                let mut vertex = Vertex::on_surface(
                    trace,
                    point,
                    -self.ray.direction,
                    self.medium,
                    self.throughput,
                    self.ratio,
                    sampler,
                );
                if K::MEDIA {
                    vertex.look_around(&trace.scene);
                }
                self.emission = S::BLACK;
                vertex.terms = self.terms_at(trace, mis, &vertex, distance);
                Arrival::Vertex(vertex, distance)
            }
            Meeting::Collision(collision, distance) => {
                let mut vertex = Vertex::in_volume(
                    self.ray.origin + self.ray.direction * distance,
                    -self.ray.direction,
                    self.medium,
                    collision.scattering,
                    self.throughput,
                    self.ratio,
                );
                self.emission = collision.emission;
                vertex.terms = self.terms_at(trace, mis, &vertex, distance);
                Arrival::Vertex(vertex, distance)
            }
            Meeting::Escaped => {
                let (forward, back) = (self.pdf * self.expected, self.facing * self.expected);
                let mut terms = self.extend(mis, forward, back);
                // A light walk can't show a background to parallel rays: t = 1 doesn't exist.
                if self.parallel {
                    terms.a = 0.0;
                }
                Arrival::Escaped(terms)
            }
            Meeting::Cut => Arrival::Cut,
        }
    }

    /// The terms of `vertex`, reached after `distance`.
    #[inline(always)]
    fn terms_at<T, K: Instance<S = S>>(
        &self,
        trace: &Trace<'_, '_, T, K>,
        mis: &Mis,
        vertex: &Vertex<S>,
        distance: Real,
    ) -> Terms {
        let inverse_square = 1.0 / square(distance);
        let facing = vertex.facing(trace, self.ray.direction);
        let mut forward = self.pdf * facing * if self.parallel { 1.0 } else { inverse_square };
        // From x_∞ on, its density is per solid angle: nothing to convert.
        let at_infinity = self.parallel && self.edges == 1;
        let mut back = if at_infinity {
            1.0
        } else {
            self.facing * inverse_square
        };
        if K::MEDIA {
            forward *= self.expected;
            back *= self.expected;
        }
        self.extend(mis, forward, back)
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
    pub fn leave<T, K: Instance<S = S>>(
        &mut self,
        trace: &Trace<'_, '_, T, K>,
        vertex: &Vertex<S>,
        sampler: &mut impl Sampler,
    ) -> Option<Step<S>> {
        let step = vertex.scatter::<K>(&trace.scene, self.mode, sampler)?;
        let weight = step.taken::<K>(&mut self.ratio);
        let mut throughput = self.throughput * weight;
        let mut relative = self.relative * weight * (1.0 / step.eta_scale);
        let q = trace.roulette(relative);
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
        self.set_off(trace, vertex, &step);
        Some(step)
    }

    /// One of several walks that leave `vertex`, where this walk's edge number `edges` ended, each with its `share` of what
    /// came there. No roulette.
    #[inline(always)]
    pub fn branch<T, K: Instance<S = S>>(
        &self,
        trace: &Trace<'_, '_, T, K>,
        vertex: &Vertex<S>,
        step: &Step<S>,
        share: Real,
        edges: u32,
    ) -> Self {
        let mut ratio = vertex.ratio;
        let weight = step.taken::<K>(&mut ratio);
        let mut walk = Self {
            throughput: vertex.throughput * weight * share,
            ratio,
            edges,
            ..*self
        };
        walk.set_off(trace, vertex, step);
        walk
    }

    /// On its way from `vertex` along `step`.
    #[inline(always)]
    fn set_off<T, K: Instance<S = S>>(
        &mut self,
        trace: &Trace<'_, '_, T, K>,
        vertex: &Vertex<S>,
        step: &Step<S>,
    ) {
        self.ray = Ray {
            origin: vertex.point.leave(step.direction),
            direction: step.direction,
            t_min: 0.0,
            t_max: Real::INFINITY,
        };
        self.pdf = step.pdf;
        self.parallel = false;
        self.facing = vertex.facing(trace, step.direction);
        if K::MEDIA {
            self.medium = vertex.medium_towards(step.direction);
        }
        self.terms = vertex.terms;
        self.pdf_reverse = step.pdf_reverse;
        self.dirac = step.dirac;
        self.next_a = 1.0;
        self.edges += 1;
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

    /// The same as one of several that it is split into.
    #[inline(always)]
    pub fn aside(&self) -> Self {
        Self {
            subpath: Subpath::Aside,
            ..*self
        }
    }

    /// The next numbers are for where its last edge ends.
    #[inline(always)]
    pub fn announce(&self, sampler: &mut impl Sampler) {
        sampler.at(self.subpath, self.edges);
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

/// What turns a density per solid angle, times 1/d², into one of x₀: the cosine, negative behind it, on a surface; σ_t, as the
/// weights assume it, in a medium that emits.
#[inline(always)]
pub fn source_facing<T, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    emission: &Emission<K::S>,
    direction: Vec3,
) -> Real {
    if K::MEDIA && emission.volume {
        let medium = trace.scene.medium(emission.medium);
        return medium.map_or(0.0, |m| density(trace.scene, m, trace.lead));
    }
    emission.normal.map_or(1.0, |n| n.dot(direction))
}

/// Sets `a` of x₁: strategy s = 1 has p_connect(x₀ | x₁) where the others have p_trace(x₀).
#[inline(always)]
pub fn connect_first<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    emission: &Emission<K::S>,
    x1: Vec3,
    terms: &mut Terms,
) {
    terms.a = emitter::connect_over_trace(&trace.scene, emission, x1);
}

/// What to multiply to f/p̄ of two walks with ratios `x` and `y`, joined over a way of transmittance `tau`, on which the leading
/// channel competes as if it had been walked:
///
/// ```text
/// f·τ_k/(p_l(x)·p_l(y)) · p̂_l/mean p̂ = (f/p̄(x))·(f/p̄(y)) · τ_k·τ_l/mean(ratio_x·ratio_y·τ)      p̂_k = p_k(x)·p_k(y)·τ_k
/// ```
///
/// p̂ is the same whichever edge of the path is the one that is joined, so one-sample MIS over channels and MIS over strategies (given the leading
/// channel) don't interfere.
#[inline(always)]
pub fn joined<K: Instance>(lead: usize, x: K::S, y: K::S, tau: K::S) -> K::S {
    if !K::MEDIA {
        return tau;
    }
    let mean = (x * y * tau).mean();
    let led = tau.channel(lead);
    // Nothing has got here, or nothing gets through.
    if led > 0.0 && mean > 0.0 {
        tau * (led / mean)
    } else {
        K::S::BLACK
    }
}
