//! What fills scattering volumes: phase functions, free flight, transmittance. One file per kind of medium.
//!
//! # The leading channel
//! Where extinction differs by channel, one channel, drawn uniformly and once for a whole sample, *leads*: distances are
//! drawn from its density p_l, and the others are combined with it by one-sample MIS (transport.md §5). A walk carries
//!
//! ```text
//! throughput_k = f_k/p̄      ratio_k = p_k/p̄      p̄ = mean over channels of p_k
//! ```
//!
//! where p_k is the density of what has been drawn so far, had channel k led. The weights stay bounded by the number
//! of channels however much the extinctions differ. In Woodcock's tracking tentative collisions are drawn from a majorant of all channels, and
//! the densities are those of the path with its null collisions, which are known pointwise (Miller, Georgiev & Jarosz 2019).

mod grid;
mod homogeneous;
mod lattice;
mod phase;
mod regular;
mod tracking;

pub use phase::Phase;

use crate::blob::View;
use crate::blob::format::{Medium, medium};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, UNIT_STEP, Vec3, exp, log1p};
use crate::shape::Ray;
use crate::spectrum::Spectrum;
use grid::Passage;

/// What a walk carries through media.
#[derive(Clone, Copy, Debug)]
pub struct Carried<S> {
    /// f/p̄.
    pub throughput: S,
    /// p_k/p̄: its mean is 1.
    pub ratio: S,
}

impl<S: Spectrum> Carried<S> {
    /// Something was drawn with density `p` by channel, where `f` is what it contributes; both relative to anything that
    /// is the same for all channels (the leading channel's density, say).
    #[inline(always)]
    pub fn draw(&mut self, f: S, p: S) {
        let ratio = self.ratio * p;
        let mean = ratio.mean();
        // What has underflowed isn't drawn, but for a ξ that has no next one.
        let inverse = if mean >= Real::MIN_POSITIVE {
            1.0 / mean
        } else {
            0.0
        };
        self.throughput = self.throughput * f * inverse;
        self.ratio = ratio * inverse;
    }
}

/// A real collision.
#[derive(Clone, Copy, Debug)]
pub struct Collision<S> {
    /// After which distance.
    pub t: Real,
    /// σ_s there.
    pub scattering: S,
    /// E there.
    pub emission: S,
}

/// How a flight ended.
#[derive(Clone, Copy, Debug)]
pub enum Flight<S> {
    /// In a collision; `carried` has been divided by its density (without σ_s, which belongs to what happens there).
    Collided(Collision<S>),
    /// At the end of the way; `carried` has been divided by the probability of getting there.
    Through,
    /// Too many steps.
    Cut,
}

/// The way through one medium: from the ray's origin over its `t_max`, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct Way<'s, 'a, S: Spectrum> {
    /// The scene, whose texels grids are made of.
    pub scene: View<'s, 'a, S>,
    /// The medium.
    pub medium: &'a Medium,
    /// The way.
    pub ray: Ray,
}

impl<'a, S: Spectrum> Way<'_, 'a, S> {
    /// Free flight: draws where the walk collides, if it does, with channel `lead` leading. What the way emits towards where the
    /// walk came from is added to `glow`, as an unbiased estimate of ∫throughput·E·τ over the way (all of it,
    /// wherever the flight ends). `steps` counts tentative collisions down; [`Flight::Cut`] when none are left.
    pub fn fly(
        &self,
        lead: usize,
        carried: &mut Carried<S>,
        glow: &mut S,
        steps: &mut u32,
        sampler: &mut impl Sampler,
    ) -> Flight<S> {
        if self.medium.kind == medium::HOMOGENEOUS {
            return homogeneous::fly(
                self.scene,
                self.medium,
                self.length(),
                lead,
                carried,
                glow,
                sampler,
            );
        }
        match self.passage() {
            Some(p) if self.is(medium::REGULAR) => p.fly_regularly(lead, carried, glow, sampler),
            Some(p) => p.fly(lead, carried, glow, steps, sampler),
            None => Flight::Through,
        }
    }

    /// τ over the way: exact, or an unbiased estimate by ratio tracking from the same tentative collisions for all
    /// channels; 0 when no steps are left.
    pub fn transmittance(&self, steps: &mut u32, sampler: &mut impl Sampler) -> S {
        if self.medium.kind == medium::HOMOGENEOUS {
            return homogeneous::transmittance(self.scene, self.medium, self.length());
        }
        match self.passage() {
            Some(p) if self.is(medium::REGULAR) => p.exact_transmittance(),
            Some(p) if self.is(medium::RESIDUAL) => p.residual_transmittance(steps, sampler),
            Some(p) => p.transmittance(steps, sampler),
            None => S::WHITE,
        }
    }

    /// τ over the way, without random numbers: in closed form, or by regular tracking.
    pub fn exact(&self) -> S {
        if self.medium.kind == medium::HOMOGENEOUS {
            return homogeneous::transmittance(self.scene, self.medium, self.length());
        }
        self.passage().map_or(S::WHITE, |p| p.exact_transmittance())
    }

    /// From which distance to which there may be anything on the way.
    pub fn extent(&self) -> Option<(Real, Real)> {
        if self.medium.kind == medium::HOMOGENEOUS {
            return Some((0.0, self.length()));
        }
        let p = self.passage()?;
        Some((p.line.start, p.line.end))
    }

    /// E at `t`.
    pub fn emission(&self, t: Real) -> S {
        if self.medium.kind == medium::HOMOGENEOUS {
            return self.scene.emission(self.medium);
        }
        match self.passage() {
            Some(p) => p.emission(t, p.sigma(t)),
            None => S::BLACK,
        }
    }

    /// ∫E·τ over the way in closed form; `None` where there is none.
    pub fn shine(&self) -> Option<S> {
        if self.medium.kind == medium::HOMOGENEOUS {
            return Some(homogeneous::shine(self.scene, self.medium, self.length()));
        }
        self.medium
            .emission
            .iter()
            .all(|&e| e <= 0.0)
            .then_some(S::BLACK)
    }

    /// The part of the way from distance `a` to `b`.
    #[must_use]
    pub fn between(&self, a: Real, b: Real) -> Self {
        let ray = Ray {
            origin: self.ray.origin + self.ray.direction * a,
            t_max: (b - a).max(0.0),
            ..self.ray
        };
        Self { ray, ..*self }
    }

    /// σ_t and σ_s at `t`.
    pub fn matter(&self, t: Real) -> (S, S) {
        if self.medium.kind == medium::HOMOGENEOUS {
            let sigma = self.scene.sigma_t(self.medium);
            return (sigma, sigma * self.scene.albedo(self.medium));
        }
        match self.passage() {
            Some(p) if p.line.start <= t && t <= p.line.end => {
                let sigma = p.sigma(t);
                (sigma, p.scattering(t, sigma))
            }
            _ => (S::BLACK, S::BLACK),
        }
    }

    /// What MIS takes for the density of getting through, if `lead` leads: the same number for the same way in either
    /// direction, up to rounding.
    #[inline(always)]
    pub fn expected(&self, lead: usize) -> Real {
        let length = if self.medium.kind == medium::HOMOGENEOUS {
            self.length()
        } else {
            self.passage().map_or(0.0, |p| p.length())
        };
        exp(-depth(density(self.scene, self.medium, lead), length))
    }

    /// Without the feature no blob that opens has a medium; here the compiler learns of it.
    #[inline(always)]
    fn length(&self) -> Real {
        if cfg!(feature = "media") {
            self.ray.t_max
        } else {
            0.0
        }
    }

    #[inline(always)]
    fn is(&self, flag: u32) -> bool {
        self.medium.flags & flag != 0
    }

    /// The part of the way that is within the grids' cube.
    #[inline(always)]
    fn passage(&self) -> Option<Passage<'a, S>> {
        if cfg!(feature = "media") {
            Passage::new(self.scene, self.medium, &self.ray)
        } else {
            None
        }
    }
}

/// What MIS takes for σ_t of channel `lead`, wherever in the medium.
#[inline(always)]
pub fn density<S: Spectrum>(scene: View<'_, '_, S>, m: &Medium, lead: usize) -> Real {
    let tabulated = scene.tabulated(m.sigma_t_spectrum);
    tabulated
        .unwrap_or_else(|| scene.lift(m.mean))
        .channel(lead)
}

/// σ_t and E at the point `x` of the medium.
#[inline]
pub fn matter<S: Spectrum>(scene: View<'_, '_, S>, m: &Medium, x: Vec3) -> (S, S) {
    if m.kind == medium::HOMOGENEOUS || !cfg!(feature = "media") {
        return (scene.sigma_t(m), scene.emission(m));
    }
    grid::matter_at(scene, m, x)
}

/// The densities by channel, over the leading one's, that a point `x` of medium `id` counts for which was drawn as a light: those with which a
/// walk collides there, so that all strategies share a path between channels alike ([`crate::path::joined`]). `None` where the
/// leading channel never does.
#[inline(always)]
pub fn chances<S: Spectrum>(scene: View<'_, '_, S>, id: u32, x: Vec3, lead: usize) -> Option<S> {
    let (sigma, _) = matter(scene, scene.medium(id)?, x);
    let leading = sigma.channel(lead);
    (leading > 0.0).then(|| sigma * (1.0 / leading))
}

/// σ·s, where nothing times an infinite way is still nothing.
#[inline(always)]
fn depth(sigma: Real, s: Real) -> Real {
    if sigma == 0.0 { 0.0 } else { sigma * s }
}

/// ξ with more digits where it is small, so that what is rare happens as often as it should: half a step of ξ is
/// 3 % of an optical depth of 1e-6.
#[inline(always)]
fn fine(sampler: &mut impl Sampler) -> Real {
    const SMALL: Real = 1.0 / 1024.0;
    let xi = sampler.one(Purpose::Flight);
    if xi < SMALL {
        xi + UNIT_STEP * sampler.one(Purpose::Flight)
    } else {
        xi
    }
}

/// An optical depth, exponentially distributed; finite.
#[inline(always)]
fn exponential(sampler: &mut impl Sampler) -> Real {
    -log1p(-fine(sampler))
}
