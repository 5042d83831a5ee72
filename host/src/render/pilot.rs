//! Which estimator suits a scene: a short pilot measures what an equal effort would buy.
//!
//! Of each candidate the pilot takes two samples of each of some pixels. With a sample's own value v and its splats s, the image's total squared error after
//! one pass is, per pixel,
//!
//! ```text
//! MSE = mean (v₁ − v₂)²/2 + mean Σ s²
//! ```
//!
//! The second part is what splats add: those that a pixel receives come from as many light walks as the image has pixels, each of which seldom hits it, and the
//! variance of such a sum is that of a compound Poisson variable. One pass has a walk for each pixel, so that the mean over pixels is that over walks. Efficiency is 1/(MSE × cost). Pilot samples have numbers of their own and don't enter the image.

use super::crew::{Crew, each_once};
use super::{CAPACITY, RenderError};
use crate::reach::unreachable;
use etendue::random::{Pcg, Purpose, Sampler, Sequence};
use etendue::{Estimator, Rgb, Scene, Scratch, Settings};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Who competes, unless one makes light that the other can't: those that make all light of most scenes, and whose samples are independent. Chains' aren't, and a short pilot can't tell how much they
/// depend on each other.
const CANDIDATES: [Estimator; 2] = [Estimator::Path, Estimator::Bidirectional];
/// Pixels that are looked at, unless their rays come to more than so many before.
const PIXELS: u64 = 1 << 15;
const ENOUGH_RAYS: u64 = 1 << 20;
/// Where a sample is long, fewer pixels than this are too few, and there are more rays, up to a bound: that of the pilot's share of a render of 30 s, for one
/// candidate of two and at 2.8 million rays a second, which one core makes. Connections that roulette leaves out have no rays and aren't counted: where they are all
/// that walks of thousands of edges do, `bidirectional` takes longer, and looks cheaper than it is.
const FEW_PIXELS: u64 = 1 << 10;
const MOST_RAYS: u64 = 1 << 21;
/// The most of a render's time that a pilot takes, where the render has a time.
pub const MOST_TIME: f64 = 0.05;
/// Of this number and more are the samples of the pilot: no render gets there.
const FIRST: u64 = 1 << 48;

/// What the pilot found of a candidate.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Which.
    pub estimator: Estimator,
    /// Squared error of a sample, mean over pixels and channels.
    pub mse: f64,
    /// Rays of a sample: counts, not times, so that the choice and with it the image is the same each time.
    pub cost: f64,
    /// Whether it met any light.
    pub bright: bool,
    /// Samples that were taken; 0 if there was nothing to choose.
    pub samples: u64,
    /// Their rays.
    pub rays: u64,
}

impl Found {
    /// 1/(MSE × cost); without any error, infinite.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.mse * self.cost)
    }
}

/// What the pilot found of all candidates, the best first; ties in their own order. With a render's `time`, it ends at [`MOST_TIME`] of that, even if that is early;
/// then what is found depends on the machine.
///
/// # Errors
/// If there are no threads.
pub fn pilot(
    scene: &Scene<'_>,
    settings: &Settings,
    crew: Crew<'_>,
    time: Option<Duration>,
) -> Result<Vec<Found>, RenderError> {
    // The variance of a sample is that of independent ones: Sobol' points know of each other.
    let with = |estimator| Settings {
        estimator,
        sequence: Sequence::Independent,
        ..*settings
    };
    // Light that is left out has no error. What bidirectional leaves out, path does.
    let complete =
        |e: Estimator| e == Estimator::Bidirectional || unreachable(scene, &with(e)).is_empty();
    let candidates: Vec<_> = CANDIDATES.into_iter().filter(|&e| complete(e)).collect();
    if let &[estimator] = candidates.as_slice() {
        return Ok(vec![Found {
            estimator,
            mse: 0.0,
            cost: 0.0,
            bright: false,
            samples: 0,
            rays: 0,
        }]);
    }
    // Each has its part of the time, as there may be one thread for all; a fifth is left for threads to begin and last samples to end.
    let part = 0.8 * MOST_TIME / candidates.len() as f64;
    let time = time.map(|t| t.mul_f64(part));
    let pilots: Vec<_> = candidates.iter().map(|_| OnceLock::new()).collect();
    crew.employ(|run| {
        each_once(run, pilots.len(), &|i| {
            let _ = pilots[i].set(found(scene, &with(candidates[i]), time));
        })
    })?;
    let mut all: Vec<Found> = pilots
        .into_iter()
        .filter_map(OnceLock::into_inner)
        .collect();
    // Who met no light where the other did has no error because it missed all. Stable, and NaN (no error at no cost) counts as the best there is.
    let any = all.iter().any(|f| f.bright);
    let rank = |f: &Found| match (any && !f.bright, f.mse > 0.0) {
        (true, _) => 0.0,
        (false, true) => f.efficiency(),
        (false, false) => f64::INFINITY,
    };
    all.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    Ok(all)
}

fn found(scene: &Scene<'_>, settings: &Settings, time: Option<Duration>) -> Found {
    let begun = Instant::now();
    let [width, height] = scene.size();
    let mut scratch = Box::new(Scratch::<CAPACITY>::new());
    let square = |v: Rgb| {
        v.to_array()
            .map(|x| f64::from(x) * f64::from(x))
            .iter()
            .sum::<f64>()
            / 3.0
    };
    let (mut sum, mut done, mut bright) = (0.0, 0, false);
    let goes_on = |done: u64, rays: u64| {
        let wanted = done < PIXELS && rays < ENOUGH_RAYS || done < FEW_PIXELS && rays < MOST_RAYS;
        // One at least, however short the time.
        done == 0 || wanted && time.is_none_or(|t| begun.elapsed() < t)
    };
    while goes_on(done, scratch.counters.rays()) {
        let i = done;
        // Spread evenly: the golden ratio's multiples along the image, at random across.
        let x = f64::from(Pcg::new(settings.seed, FIRST, i).one(Purpose::Filter));
        let y = (i as f64 * 0.618_033_988_749_895).fract();
        let at = |x: f64, n: u32| ((x * f64::from(n)) as u32).min(n - 1);
        let pixel = [at(x, width), at(y, height)];
        let mut splats = 0.0;
        let mut one = |index| {
            // What lands in one pixel together counts together, but seldom does.
            let splat = &mut |_: [u32; 2], v: Rgb| splats += 0.5 * square(v);
            scene.estimate(settings, pixel, FIRST + index, &mut scratch, splat)
        };
        let (a, b) = (one(2 * i), one(2 * i + 1));
        let (a, b) = (a.to_array(), b.to_array());
        let squares = (0..3).map(|c| f64::from(a[c] - b[c]).powi(2));
        let own = squares.sum::<f64>() / 3.0;
        sum += 0.5 * own + splats;
        bright |= splats > 0.0 || [a, b].as_flattened().iter().any(|&x| x != 0.0);
        done += 1;
    }
    Found {
        estimator: settings.estimator,
        mse: sum / done as f64,
        cost: scratch.counters.rays() as f64 / (2 * done) as f64,
        bright,
        samples: 2 * done,
        rays: scratch.counters.rays(),
    }
}
