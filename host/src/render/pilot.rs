//! Which estimator suits a scene: a short pilot measures what an equal effort would buy.
//!
//! The kernel says how it is measured (`etendue::estimate::Pilot`); here is who competes, and for how long.

use super::crew::{Crew, each_once};
use super::{CAPACITY, RenderError};
use crate::reach::unreachable;
use etendue::estimate::Pilot;
use etendue::{Estimator, Scene, Scratch, Settings};
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

/// What the pilot found of a candidate; no samples, if there was nothing to choose.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Which.
    pub estimator: Estimator,
    /// What its samples are worth.
    pub pilot: Pilot,
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
    let with = |estimator| Settings {
        estimator,
        ..*settings
    };
    // Light that is left out has no error. What bidirectional leaves out, path does.
    let complete =
        |e: Estimator| e == Estimator::Bidirectional || unreachable(scene, &with(e)).is_empty();
    let candidates: Vec<_> = CANDIDATES.into_iter().filter(|&e| complete(e)).collect();
    if let &[estimator] = candidates.as_slice() {
        return Ok(vec![Found {
            estimator,
            pilot: Pilot::default(),
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
    let any = all.iter().any(|f| f.pilot.bright);
    let rank = |f: &Found| match (any && !f.pilot.bright, f.pilot.mse() > 0.0) {
        (true, _) => 0.0,
        (false, true) => f.pilot.efficiency(),
        (false, false) => f64::INFINITY,
    };
    all.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    Ok(all)
}

fn found(scene: &Scene<'_>, settings: &Settings, time: Option<Duration>) -> Found {
    let begun = Instant::now();
    let mut scratch = Box::new(Scratch::<CAPACITY>::new());
    let scratch = &mut scratch.view(scene);
    let mut pilot = Pilot::default();
    let goes_on = |done: u64, rays: u64| {
        let wanted = done < PIXELS && rays < ENOUGH_RAYS || done < FEW_PIXELS && rays < MOST_RAYS;
        // One at least, however short the time.
        done == 0 || wanted && time.is_none_or(|t| begun.elapsed() < t)
    };
    let mut done = 0;
    while goes_on(done, pilot.rays) {
        scene.pilot(settings, done, scratch, &mut pilot);
        done += 1;
    }
    Found {
        estimator: settings.estimator,
        pilot,
    }
}
