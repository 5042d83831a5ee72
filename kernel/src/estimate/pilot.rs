//! What samples of an estimator are worth in a scene: which one to choose, found out by a few.
//!
//! Of some pixels two samples each are taken. With a sample's own value v and its splats s, the image's total squared error after one pass is, per pixel,
//!
//! ```text
//! MSE = mean (v₁ − v₂)²/2 + mean Σ s²
//! ```
//!
//! The second part is what splats add: those that a pixel receives come from as many light walks as the image has pixels, each of which seldom hits it, and the
//! variance of such a sum is that of a compound Poisson variable. One pass has a walk for each pixel, so that the mean over pixels is that over walks. Efficiency
//! is 1/(MSE × cost), with cost in rays: a count, so that a choice is the same each time.

use super::{ScratchView, Settings, pixel_id};
use crate::blob::Scene;
use crate::random::{Pcg, Purpose, Sampler, Sequence};
use crate::real::Real;
use crate::sensor::Element;
use crate::spectrum::Rgb;

/// Of this number and more are the samples of a pilot: no render gets there.
const FIRST: u64 = 1 << 48;

/// What a pilot found of an estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pilot {
    /// Squared error of all samples together, mean over channels, radiance².
    pub squared_error: f64,
    /// Samples taken.
    pub samples: u64,
    /// Their rays.
    pub rays: u64,
    /// Whether any of them met light.
    pub bright: bool,
}

impl Pilot {
    /// Squared error of a sample, mean over pixels and channels, radiance².
    pub fn mse(&self) -> f64 {
        self.squared_error / self.samples as f64
    }

    /// Rays of a sample.
    pub fn cost(&self) -> f64 {
        self.rays as f64 / self.samples as f64
    }

    /// 1/(MSE × cost); without any error, infinite.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.mse() * self.cost())
    }

    /// Adds pixel number `i` of the pilot, of which `sample(pixel, index)` gives what sample number `index` returns and the sum of [`square`] over its splats.
    pub(crate) fn look(
        &mut self,
        [width, height]: [u32; 2],
        seed: u64,
        i: u64,
        mut sample: impl FnMut([u32; 2], u64) -> (Rgb, f64),
    ) {
        // Spread evenly: the golden ratio's multiples along the image, at random across.
        let x = wide(Pcg::new(seed, FIRST, i).one(Purpose::Filter));
        let y = i as f64 * 0.618_033_988_749_895;
        let at = |x: f64, n: u32| ((x * f64::from(n)) as u32).min(n.saturating_sub(1));
        let pixel = [at(x, width), at(y - (y as u64) as f64, height)];
        let mut one = |k| sample(pixel, FIRST.wrapping_add(i.wrapping_mul(2)).wrapping_add(k));
        let ((a, splats), (b, more)) = (one(0), one(1));
        let [ar, ag, ab] = a.to_array();
        let [br, bg, bb] = b.to_array();
        // What lands in one pixel together counts together, but seldom does.
        self.squared_error += square(Rgb::new(ar - br, ag - bg, ab - bb)) + splats + more;
        self.bright |= splats + more > 0.0 || square(a) + square(b) > 0.0;
        // Numbers may come from anyone.
        self.samples = self.samples.wrapping_add(2);
    }
}

/// `x` in double precision.
#[allow(clippy::unnecessary_cast)] // it is there already in one of the two kernels
fn wide(x: Real) -> f64 {
    x as f64
}

/// |v|², mean over channels.
pub(crate) fn square(v: Rgb) -> f64 {
    let squares = v.to_array().map(|x| wide(x) * wide(x));
    squares.iter().sum::<f64>() / 3.0
}

impl Settings {
    /// The same with independent numbers.
    pub(crate) fn independent(&self) -> Self {
        Self {
            sequence: Sequence::Independent,
            ..*self
        }
    }
}

impl Scene<'_> {
    /// Adds to `pilot` two samples of its pixel number `i`, with independent numbers: how far apart Sobol' points are says nothing of an image's error. Any
    /// split of the numbers gives the same but for rounding.
    #[inline(never)]
    pub fn pilot(
        &self,
        settings: &Settings,
        i: u64,
        scratch: &mut ScratchView<'_>,
        pilot: &mut Pilot,
    ) {
        let settings = &settings.independent();
        let before = scratch.counters().rays();
        pilot.look(self.size(), settings.seed, i, |pixel, index| {
            let mut splats = 0.0;
            let numbers = &mut settings.numbers(pixel_id(pixel), index);
            let element = &Element::Pixel(pixel);
            let splat = &mut |_: [u32; 2], v: Rgb| splats += square(v);
            let own = self.estimate_element(settings, element, numbers, scratch, splat);
            (own, splats)
        });
        pilot.rays += scratch.counters().rays() - before;
    }
}
