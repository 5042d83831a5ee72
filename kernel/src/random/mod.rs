//! Where random numbers come from.
//!
//! An estimator asks for a number by what it is *for*: subpath, vertex, purpose. Independent numbers
//! ([`Pcg`]) ignore that; low-discrepancy and recorded sequences turn it into a dimension, so one can
//! be replayed or mutated without the estimator knowing (`transport.md` §7, Sobol and Metropolis).

#[cfg(feature = "metropolis")]
mod recorded;
#[cfg(feature = "sobol")]
mod sobol;

#[cfg(feature = "metropolis")]
pub use recorded::{CHOICES, Mutation, Recorded, Tapes};
#[cfg(feature = "sobol")]
pub use sobol::Sobol;

use crate::real::{Real, unit};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Which walk a number belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subpath {
    /// The walk from the sensor.
    Sensor,
    /// The walk from an emitter.
    Light,
    /// Those that the sensor's is split into, any number of them: no dimension belongs to one.
    Aside,
}

/// What a number decides at its vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Position in the pixel filter.
    Filter,
    /// Position on the lens.
    Lens,
    /// Which emitter.
    Choice,
    /// A point or direction on the chosen emitter.
    Position,
    /// The direction in which an emitter sends.
    Emission,
    /// Which lobe of the local model.
    Lobe,
    /// The direction within the lobe.
    Direction,
    /// Which channel leads, where densities differ by channel.
    Lead,
    /// How far a walk flies through a medium; tentative collisions.
    Flight,
    /// Whether a fractional mask is there.
    Opacity,
    /// Whether the walk goes on.
    Roulette,
    /// Which part of a blend.
    Blend,
}

/// A source of numbers in [0, 1), never 1.
pub trait Sampler {
    /// Says for which vertex of which walk the numbers to come are.
    fn at(&mut self, subpath: Subpath, vertex: u32);
    /// One number in [0, 1).
    fn one(&mut self, purpose: Purpose) -> Real;
    /// Says that the last walk aside may be what its sample is remembered by.
    #[inline(always)]
    fn keep(&mut self) {}
    /// Two numbers in [0, 1)².
    #[inline(always)]
    fn two(&mut self, purpose: Purpose) -> [Real; 2] {
        let x = self.one(purpose);
        [x, self.one(purpose)]
    }
    /// Does `work` with these numbers; a choice of several kinds hands over the kind that it is, so that work which asks often is
    /// compiled for each and doesn't choose at every number.
    #[inline(always)]
    fn lend<W: Work>(&mut self, work: W) -> W::Result
    where
        Self: Sized,
    {
        work.with(self)
    }
}

/// What [`Sampler::lend`] lends numbers to.
pub trait Work {
    /// What comes of it.
    type Result;
    /// Does it.
    fn with<P: Sampler>(self, numbers: &mut P) -> Self::Result;
}

/// Independent numbers: PCG XSH RR 64/32 (O'Neill 2014), a stream of its own per (pixel, sample).
#[derive(Clone, Debug)]
pub struct Pcg(Pcg32);

impl Pcg {
    /// The stream of sample `index` of the element (pixel, texel, chain) `element` under `seed`:
    /// a pure function of the three, so that it doesn't matter who draws it, or when.
    #[inline]
    pub fn new(seed: u64, element: u64, index: u64) -> Self {
        let mut s = mix(seed ^ 0x9e37_79b9_7f4a_7c15);
        s = mix(s ^ element);
        s = mix(s ^ index);
        Self(Pcg32::new(s, mix(s ^ 0xd1b5_4a32_d192_ed03)))
    }

    /// A stream that starts from `seed` alone.
    pub fn from_seed(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }
}

impl Sampler for Pcg {
    #[inline(always)]
    fn at(&mut self, _: Subpath, _: u32) {}
    #[inline(always)]
    fn one(&mut self, _: Purpose) -> Real {
        unit(self.0.next_u32())
    }
}

/// Two numbers by turns: what no sequence draws in a lifetime, like nothing but 0, or the largest number below 1, to see what becomes of it.
#[cfg(feature = "ends")]
#[derive(Clone, Debug)]
pub struct Ends {
    numbers: [Real; 2],
    second: bool,
}

#[cfg(feature = "ends")]
impl Ends {
    /// `numbers` in [0, 1), the first one first.
    pub const fn new(numbers: [Real; 2]) -> Self {
        Self {
            numbers,
            second: true,
        }
    }
}

#[cfg(feature = "ends")]
impl Sampler for Ends {
    fn at(&mut self, _: Subpath, _: u32) {}
    fn one(&mut self, _: Purpose) -> Real {
        self.second = !self.second;
        self.numbers[usize::from(self.second)]
    }
}

/// Where an estimate's numbers come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sequence {
    /// [`Pcg`]: independent.
    #[default]
    Independent,
    /// [`Sobol`]: the samples of a pixel spread evenly.
    #[cfg(feature = "sobol")]
    Sobol,
}

/// The numbers of one sample, from whichever sequence is asked for.
#[derive(Clone, Debug)]
pub enum Numbers {
    /// Independent.
    Independent(Pcg),
    /// Spread evenly.
    #[cfg(feature = "sobol")]
    Sobol(Sobol),
    /// Two by turns: no [`Sequence`], as no image comes of it.
    #[cfg(feature = "ends")]
    Ends(Ends),
}

impl Numbers {
    /// Those of sample `index` of the element `element` under `seed`.
    #[inline(always)]
    pub fn new(sequence: Sequence, seed: u64, element: u64, index: u64) -> Self {
        match sequence {
            Sequence::Independent => Self::Independent(Pcg::new(seed, element, index)),
            #[cfg(feature = "sobol")]
            Sequence::Sobol => Self::Sobol(Sobol::new(seed, element, index)),
        }
    }
}

impl Sampler for Numbers {
    #[inline(always)]
    fn at(&mut self, subpath: Subpath, vertex: u32) {
        match self {
            Self::Independent(_) => (),
            #[cfg(feature = "sobol")]
            Self::Sobol(s) => s.at(subpath, vertex),
            #[cfg(feature = "ends")]
            Self::Ends(_) => (),
        }
        let _ = (subpath, vertex);
    }
    #[inline(always)]
    fn one(&mut self, purpose: Purpose) -> Real {
        match self {
            Self::Independent(s) => s.one(purpose),
            #[cfg(feature = "sobol")]
            Self::Sobol(s) => s.one(purpose),
            #[cfg(feature = "ends")]
            Self::Ends(s) => s.one(purpose),
        }
    }
    #[inline(always)]
    fn two(&mut self, purpose: Purpose) -> [Real; 2] {
        match self {
            Self::Independent(s) => s.two(purpose),
            #[cfg(feature = "sobol")]
            Self::Sobol(s) => s.two(purpose),
            #[cfg(feature = "ends")]
            Self::Ends(s) => s.two(purpose),
        }
    }
    #[inline(always)]
    fn lend<W: Work>(&mut self, work: W) -> W::Result {
        match self {
            // Where there is one kind only, work is compiled for the choice alone: for less code.
            #[cfg(not(feature = "sobol"))]
            Self::Independent(_) => work.with(self),
            #[cfg(feature = "sobol")]
            Self::Independent(s) => work.with(s),
            #[cfg(feature = "sobol")]
            Self::Sobol(s) => work.with(s),
            #[cfg(feature = "ends")]
            Self::Ends(s) => work.with(s),
        }
    }
}

/// The finaliser of SplitMix64 (Steele et al. 2014): a bijection that avalanches.
#[inline(always)]
fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
