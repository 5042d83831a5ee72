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

mod phase;

pub use phase::{Phase, Turn};

use crate::blob::Scene;
use crate::blob::format::Medium;
use crate::random::Sampler;
use crate::real::{Real, Vec3, exp};
use crate::shape::Ray;
use crate::spectrum::Spectrum;

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
        let inverse = 1.0 / ratio.mean();
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
pub struct Way<'s, 'a> {
    /// The scene, whose texels grids are made of.
    pub scene: &'s Scene<'a>,
    /// The medium.
    pub medium: &'a Medium,
    /// The way.
    pub ray: Ray,
}

impl Way<'_, '_> {
    /// Free flight: draws where the walk collides, if it does, with channel `lead` leading. What the way emits towards where the
    /// walk came from is added to `glow`, as an unbiased estimate of ∫throughput·E·τ over the way (all of it,
    /// wherever the flight ends). `steps` counts tentative collisions down; [`Flight::Cut`] when none are left.
    pub fn fly<S: Spectrum>(
        &self,
        lead: usize,
        carried: &mut Carried<S>,
        glow: &mut S,
        steps: &mut u32,
        sampler: &mut impl Sampler,
    ) -> Flight<S> {
        let _ = (lead, carried, glow, steps, sampler);
        Flight::Through
    }

    /// τ over the way: exact, or an unbiased estimate by ratio tracking from the same tentative collisions for all channels.
    pub fn transmittance<S: Spectrum>(&self, steps: &mut u32, sampler: &mut impl Sampler) -> S {
        let _ = (steps, sampler);
        S::WHITE
    }

    /// What MIS takes for the density of getting through, if `lead` leads: the same number for the same way in either direction.
    #[inline(always)]
    pub fn expected(&self, lead: usize) -> Real {
        exp(-density(self.medium, lead) * self.ray.t_max)
    }
}

/// E of medium `id` at `position`, if that lies in it.
pub fn emission<S: Spectrum>(scene: &Scene<'_>, id: u32, position: Vec3) -> S {
    let _ = (scene, id, position);
    S::BLACK
}

/// What MIS takes for σ_t of channel `lead`, wherever in the medium.
#[inline(always)]
pub fn density(m: &Medium, lead: usize) -> Real {
    Real::from(m.mean.get(lead).copied().unwrap_or(0.0))
}
