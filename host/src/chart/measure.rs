//! Renders each variant on a ladder of budgets, with several seeds, and takes the distance to a reference.

use crate::develop::{Linear, distance};
use crate::reach::unreachable;
use crate::render::{Budget, CAPACITY, Crew, Device, Options, render, render_double};
use crate::scene::Prepared;
use crate::statistics::{Costs, Estimate, Interval, tail_index};
use etendue::random::{Pcg, Purpose, Sampler};
use etendue::{Estimator, Scene, Scratch, Settings};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A way to render.
#[derive(Clone)]
pub struct Subject {
    /// What it is called.
    pub name: String,
    /// The scene, as it is read for this.
    pub prepared: Rc<Prepared>,
    /// How light is estimated.
    pub settings: Settings,
    /// Whether in double precision.
    pub double: bool,
}

impl Subject {
    /// The light paths that it can't make, a sentence each.
    ///
    /// # Errors
    /// If the scene can't be opened.
    pub fn unreachable(&self) -> Result<Vec<String>, String> {
        let scene = Scene::open(self.prepared.blob.bytes()).map_err(|e| e.to_string())?;
        Ok(unreachable(&scene, &self.settings))
    }
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// CPU seconds for each variant.
    pub seconds: f64,
    /// Renders of each budget, each with a seed of its own; at least 2.
    pub seeds: u64,
    /// Threads; 0 for one per core.
    pub threads: usize,
}

/// What errors are taken against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The image.
    pub image: Linear,
    /// What it is, in words.
    pub origin: String,
    /// The mean of its own variance over pixels and channels, and the mean of variance/(value² + 0.01 m²); `None` where that isn't known.
    pub noise: Option<[f64; 2]>,
    /// The light paths that it lacks, as far as that is known: a sentence each.
    pub unreachable: Vec<String>,
}

impl Reference {
    /// Mean squared error and relMSE of an image: as they are seen, and less the reference's own.
    pub fn errors(&self, image: &Linear) -> [[f64; 2]; 2] {
        let d = distance(image, &self.image);
        let (seen, noise) = ([d.mse, d.rel_mse], self.noise.unwrap_or([0.0; 2]));
        [seen, [0, 1].map(|i| (seen[i] - noise[i]).max(0.0))]
    }
}

/// One render.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// CPU seconds.
    pub seconds: f64,
    /// Mean squared error and relMSE, less the reference's own where that is known; never below 0.
    pub errors: [f64; 2],
}

/// An image to look at.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The image.
    pub image: Linear,
    /// Samples per pixel.
    pub passes: u64,
    /// What it took and how far it is off.
    pub trial: Trial,
}

/// A budget.
#[derive(Clone, Debug)]
pub struct Rung {
    /// Samples per pixel.
    pub passes: u64,
    /// One for each seed.
    pub trials: Vec<Trial>,
    /// Whether the reference's own noise is more than a quarter of the error seen.
    pub limited: bool,
}

impl Rung {
    /// Mean over trials of error number `which`, and its standard error.
    pub fn error(&self, which: usize) -> (f64, f64) {
        let errors: Vec<_> = self.trials.iter().map(|t| t.errors[which]).collect();
        let Estimate { mean, error, .. } = Estimate::of(&errors);
        (mean, error)
    }

    /// Mean CPU seconds.
    pub fn seconds(&self) -> f64 {
        let sum: f64 = self.trials.iter().map(|t| t.seconds).sum();
        sum / self.trials.len() as f64
    }
}

/// The largest contributions of single samples, relative to the image's mean.
#[derive(Clone, Debug)]
pub struct Tail {
    /// Samples that were looked at.
    pub samples: usize,
    /// (share of samples above, contribution over the mean), from the most frequent on.
    pub survival: Vec<[f64; 2]>,
    /// Hill's index of the largest thousandth of what isn't 0, and its standard error.
    pub index: Option<(f64, f64)>,
}

/// What a variant came to.
#[derive(Clone)]
pub struct Measured {
    /// Which.
    pub subject: Subject,
    /// Why it can't be measured.
    pub refused: Option<String>,
    /// The light paths that it can't make, a sentence each: their light is an error that stays.
    pub unreachable: Vec<String>,
    /// From the smallest budget on.
    pub rungs: Vec<Rung>,
    /// 1/(MSE × CPU s) and 1/(relMSE × CPU s), by all trials of the largest budgets that the reference can tell.
    pub efficiency: [Costs; 2],
    /// The image that has had as much time as those of all others ([`super::equal`]).
    pub shown: Option<Shown>,
    /// Squared error by pixel, mean of the channels and of the seeds of the largest budget.
    pub error_map: Vec<f32>,
    /// Of samples of pixels; `None` for chains and in double precision.
    pub tail: Option<Tail>,
}

impl Measured {
    /// Efficiency by error number `which`.
    pub fn efficiency(&self, which: usize) -> Option<Interval> {
        self.efficiency[which].efficiency()
    }
}

/// Rungs whose trials count for the efficiency.
const TOP: usize = 3;
/// Samples whose contributions are looked at.
const TAIL_SAMPLES: u64 = 1 << 17;
/// Or fewer, if they take more than this share of a variant's budget; but not fewer than these.
const TAIL_SHARE: f64 = 0.1;
const TAIL_LEAST: u64 = 1 << 12;

/// CPU time of this process, in seconds: what other programs take on a busy machine doesn't count.
#[cfg(unix)]
pub fn cpu_seconds() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

/// Where a process's own time isn't known: time.
#[cfg(not(unix))]
pub fn cpu_seconds() -> f64 {
    use std::sync::LazyLock;
    use std::time::Instant;
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// One image and the CPU seconds that it took.
pub fn image(
    subject: &Subject,
    settings: Settings,
    passes: u64,
    threads: usize,
    stop: &AtomicBool,
) -> Result<(Linear, f64), String> {
    let blob = subject.prepared.blob.bytes();
    let scene = Scene::open(blob).map_err(|e| e.to_string())?;
    let started = cpu_seconds();
    let pixels = if subject.double {
        render_double(blob, &settings, passes, Crew::Own(threads), stop)
            .map_err(|e| e.to_string())?
    } else {
        let options = Options {
            settings,
            budget: Budget::Passes(passes),
            threads,
            device: Device::Cpu,
        };
        let rendered = render(&scene, &options, stop, &|_| ()).map_err(|e| e.to_string())?;
        rendered.image
    };
    let size = scene.size();
    Ok((Linear { size, pixels }, cpu_seconds() - started))
}

/// Measures a variant. `None` if `stop` was set.
///
/// # Errors
/// What a render says, except that an estimator can't answer for a scene: that is what came of it.
pub fn measure(
    subject: Subject,
    reference: &Reference,
    plan: &Plan,
    stop: &AtomicBool,
    watch: &mut dyn FnMut(u64, f64),
) -> Result<Option<Measured>, String> {
    let mut m = Measured {
        refused: None,
        unreachable: subject.unreachable()?,
        rungs: Vec::new(),
        efficiency: Default::default(),
        shown: None,
        error_map: Vec::new(),
        tail: None,
        subject,
    };
    let mut spent = 0.0;
    let mut passes = 1;
    loop {
        let mut rung = Rung {
            passes,
            trials: Vec::new(),
            limited: false,
        };
        let mut map = Vec::new();
        let mut seen = 0.0;
        for seed in 0..plan.seeds {
            let settings = Settings {
                // Far from the reference's, and from each other in every rung.
                seed: (m.subject.settings.seed ^ 1 << 63).wrapping_add(passes * plan.seeds + seed),
                ..m.subject.settings
            };
            let (image, seconds) = match image(&m.subject, settings, passes, plan.threads, stop) {
                Ok(done) => done,
                Err(reason) if m.rungs.is_empty() && seed == 0 => {
                    m.refused = Some(reason);
                    return Ok(Some(m));
                }
                Err(e) => return Err(e),
            };
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let [as_seen, errors] = reference.errors(&image);
            seen += as_seen[0] / plan.seeds as f64;
            rung.trials.push(Trial { seconds, errors });
            spent += seconds;
            map.resize(image.pixels.len(), 0.0);
            for ((sum, p), q) in map
                .iter_mut()
                .zip(&image.pixels)
                .zip(&reference.image.pixels)
            {
                let squares: f32 = (0..3).map(|c| (p[c] - q[c]) * (p[c] - q[c])).sum();
                *sum += squares / (3.0 * plan.seeds as f32);
            }
        }
        rung.limited = reference.noise.is_some_and(|n| seen < 4.0 * n[0]);
        let took = rung.seconds() * plan.seeds as f64;
        m.error_map = map;
        m.rungs.push(rung);
        watch(passes, spent / plan.seconds);
        // The next one takes about twice as long, and one image like its is made to be looked at.
        let next = 2.0 * took * (1.0 + 1.0 / plan.seeds as f64);
        if spent + next > plan.seconds || passes >= 1 << 40 {
            break;
        }
        passes *= 2;
    }
    let told: Vec<&Rung> = m.rungs.iter().filter(|r| !r.limited).collect();
    let told = if told.is_empty() {
        m.rungs.iter().collect()
    } else {
        told
    };
    for rung in told.iter().rev().take(TOP) {
        for trial in &rung.trials {
            for (costs, error) in m.efficiency.iter_mut().zip(trial.errors) {
                costs.add(error * trial.seconds);
            }
        }
    }
    m.tail = tail(&m.subject, TAIL_SHARE * plan.seconds, stop)?;
    Ok(Some(m))
}

/// The contributions of single samples, all that one adds to any pixel together.
fn tail(subject: &Subject, seconds: f64, stop: &AtomicBool) -> Result<Option<Tail>, String> {
    if subject.double || subject.settings.estimator == Estimator::Metropolis {
        return Ok(None);
    }
    let scene = Scene::open(subject.prepared.blob.bytes()).map_err(|e| e.to_string())?;
    let [width, height] = scene.size();
    let mut scratch = Box::new(Scratch::<CAPACITY>::new());
    let grey = |v: etendue::Rgb| f64::from(v.to_array().iter().sum::<f32>()) / 3.0;
    let begun = cpu_seconds();
    let goes_on = |index: u64| {
        let spent =
            index >= TAIL_LEAST && index.is_multiple_of(256) && cpu_seconds() - begun > seconds;
        !spent && !stop.load(Ordering::Relaxed)
    };
    let mut all: Vec<f64> = (0..TAIL_SAMPLES)
        .take_while(|&index| goes_on(index))
        .map(|index| {
            let [x, y] = Pcg::new(subject.settings.seed, 1 << 63, index).two(Purpose::Filter);
            let at = |x: f32, n: u32| ((x * n as f32) as u32).min(n - 1);
            let pixel = [at(x, width), at(y, height)];
            let mut sum = 0.0;
            let splat = &mut |_: [u32; 2], value| sum += grey(value);
            let settings = &subject.settings;
            let own = scene.estimate(settings, pixel, index, &mut scratch, splat);
            sum + grey(own)
        })
        .collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let positive = all.iter().filter(|&&x| x > 0.0).count();
    let index = tail_index(&all, (positive / 1000).max(20));
    all.sort_by(|a, b| b.total_cmp(a));
    // Evenly spaced in the logarithm.
    let mut survival: Vec<[f64; 2]> = Vec::new();
    let mut rank = 1.0f64;
    while (rank as usize) < positive && mean > 0.0 {
        let i = rank as usize;
        survival.push([i as f64 / all.len() as f64, all[i - 1] / mean]);
        rank = (rank * 1.2).max(rank + 1.0);
    }
    survival.reverse();
    Ok(Some(Tail {
        samples: all.len(),
        survival,
        index,
    }))
}
