//! Renders on all cores. The image is a pure function of the scene, the settings and the number of passes:
//! films add integers, so neither threads nor tiles matter.

mod accuracy;
mod atlas;
mod bake;
mod budget;
mod chains;
mod crew;
#[cfg(feature = "cuda")]
mod cuda;
#[cfg(feature = "program")]
mod double;
pub(crate) mod doubts;
mod pilot;
mod rates;
mod splats;
mod tiles;
mod until;

pub use accuracy::{Accuracy, CONFIDENCE};
pub use atlas::AtlasError;
pub use bake::{Bake, BakeError, Baked, bake};
pub use budget::Budget;
use budget::Spending;
pub use chains::ChainReport;
pub use crew::{Crew, Run, on_threads};
#[cfg(feature = "program")]
pub use double::render_double;
#[cfg(feature = "program")]
pub(crate) use double::wide;
pub use doubts::{doubts, losses};
pub use pilot::{Found, MOST_TIME, pilot};

use crate::memory::attempt;
use crate::statistics::{Heaviest, Tail};
use crew::each_once;
use etendue::film::{Refused, Step, Sum, merge};
use etendue::{Counters, Estimator, Rgb, Scene, Scratch, Settings};
use rates::Rates;
use splats::Splats;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use tiles::{Tile, cut, film, order};

/// Vertices that a light walk keeps.
pub const CAPACITY: usize = 32;

/// How to render.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Estimator, weights, depth, seed.
    pub settings: Settings,
    /// When to stop.
    pub budget: Budget,
    /// Threads; 0 for one per core.
    pub threads: usize,
    /// What renders. The image doesn't depend on it.
    pub device: Device,
}

/// What renders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Device {
    /// Threads.
    #[default]
    Cpu,
    /// A GPU of NVIDIA's (feature `cuda`).
    Cuda,
}

/// A finished image.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Mean radiance per pixel, row by row from the top.
    pub image: Vec<[f32; 3]>,
    /// Samples per pixel.
    pub passes: u64,
    /// Rendering time.
    pub seconds: f64,
    /// What the kernel counted.
    pub counters: Counters,
    /// What the film refused.
    pub refused: Refused,
    /// Whether it was told to stop, and did so before its budget was spent.
    pub interrupted: bool,
    /// What chains did, if there were any.
    pub chains: Option<ChainReport>,
    /// How accurate it is, if it was to be accurate.
    pub accuracy: Option<Accuracy>,
    /// What its samples' contributions are like; of chains, of those that they start from. `None` where that isn't looked at: on GPUs, and where pixels have
    /// samples of different weight.
    pub tail: Option<Tail>,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples per pixel that are done.
    pub passes: u64,
    /// Samples (pixels times passes) done, within the pass as well.
    pub samples: u64,
    /// Share of the budget that is used, 0 to 1.
    pub done: f64,
}

/// Why an image can't be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The operating system gives no threads, or no memory for them.
    #[error("can't start {threads} threads: {source}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// Why not.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The caller's threads left a job out.
    #[error("the caller's threads returned before every job was done")]
    Jobs,
    /// The GPU, or its driver, isn't there or fails.
    #[error("{0}")]
    Gpu(String),
    /// The scene has light that the estimator can't answer for.
    #[error("{0}")]
    Estimator(&'static str),
    /// The image's sums don't fit into memory.
    #[error("not enough memory for an image of {} × {} pixels", .size[0], .size[1])]
    TooLarge {
        /// Columns and rows.
        size: [u32; 2],
    },
}

/// What a thread works in and adds to.
struct Worker {
    scratch: Box<Scratch<CAPACITY>>,
    splats: Splats,
    heaviest: Heaviest,
    /// What samples' own pixels could not take.
    refused: Refused,
}

/// What all threads share during a render.
struct Job<'a> {
    scene: &'a Scene<'a>,
    settings: Settings,
    step: Step,
    size: [u32; 2],
}

/// What a contribution counts for.
fn grey(value: Rgb) -> f32 {
    let [r, g, b] = value.to_array();
    r + g + b
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The sum of films of the same size.
fn add_up(run: &Run<'_>, films: Vec<Vec<Sum>>) -> Result<Vec<Sum>, RenderError> {
    const PART: usize = 1 << 14;
    let mut films = films.into_iter();
    let mut all = films.next().unwrap_or_default();
    let others: Vec<_> = films.collect();
    let parts: Vec<_> = all.chunks_mut(PART).map(Mutex::new).collect();
    each_once(run, parts.len(), &|i| {
        let mut part = lock(&parts[i]);
        for other in &others {
            for (sum, o) in part.iter_mut().zip(&other[i * PART..]) {
                merge(sum, o);
            }
        }
    })?;
    drop(parts);
    Ok(all)
}

/// Renders `scene`. `stop` ends it after the batch of passes it is in, half a second or one pass long; `watch`
/// is told of the progress by all threads, tile by tile.
///
/// # Errors
/// If the threads can't be started, the image doesn't fit into memory, or the GPU that is asked for isn't there.
pub fn render(
    scene: &Scene<'_>,
    options: &Options,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Rendered, RenderError> {
    accept(scene, &options.settings)?;
    if options.device == Device::Cuda {
        if let Budget::Error { .. } = options.budget {
            return Err(RenderError::Gpu(
                "an image that is to be so accurate is rendered by the CPU only".into(),
            ));
        }
        #[cfg(feature = "cuda")]
        return cuda::render(scene, options, stop, watch);
        #[cfg(not(feature = "cuda"))]
        return Err(RenderError::Gpu(
            "this program was built without GPUs: build it with --features cuda".into(),
        ));
    }
    let Options {
        settings, budget, ..
    } = *options;
    let crew = Crew::Own(options.threads);
    render_with(scene, settings, budget, crew, stop, watch)
}

/// Makes sure that the estimator can answer for the scene.
fn accept(scene: &Scene<'_>, settings: &Settings) -> Result<(), RenderError> {
    match settings.estimator.refuses(scene) {
        Some(reason) => Err(RenderError::Estimator(reason)),
        None => Ok(()),
    }
}

/// The same on anybody's threads.
///
/// # Errors
/// As [`render`]; and if the caller's threads leave a job out.
pub fn render_with(
    scene: &Scene<'_>,
    settings: Settings,
    budget: Budget,
    crew: Crew<'_>,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Rendered, RenderError> {
    accept(scene, &settings)?;
    let job = Job {
        scene,
        settings,
        step: Step::new(scene.film_exponent()),
        size: scene.size(),
    };
    crew.employ(|run| job.run(budget, run, stop, watch))
}

/// A budget on its way.
struct Course {
    spending: Spending,
    started: Instant,
    /// Passes.
    done: u64,
    interrupted: bool,
    counters: Counters,
    refused: Refused,
    heaviest: Heaviest,
    /// As many workers as threads were ever busy at once: the caller's may be any number.
    idle: Mutex<Vec<Worker>>,
}

impl Course {
    /// Of which time has gone since `started`.
    fn new(budget: Budget, started: Instant) -> Self {
        Self {
            spending: budget.begin(),
            started,
            done: 0,
            interrupted: false,
            counters: Counters::default(),
            refused: Refused::default(),
            heaviest: Heaviest::default(),
            idle: Mutex::new(Vec::new()),
        }
    }

    /// The next batch of passes, which doesn't go beyond `end`.
    fn next(&self, end: u64) -> Option<u64> {
        let batch = self.spending.next(self.done, self.started.elapsed())?;
        Some(batch.min(end - self.done)).filter(|&n| n > 0)
    }

    /// Whether there is anything left.
    fn goes_on(&self) -> bool {
        !self.interrupted && self.next(u64::MAX).is_some()
    }

    /// The workers' splats; what they counted is kept.
    fn harvest(&mut self) -> Vec<Vec<Sum>> {
        let idle = self.idle.get_mut().unwrap_or_else(PoisonError::into_inner);
        let mut splats = Vec::new();
        for worker in idle.drain(..) {
            self.counters += worker.scratch.counters;
            let (film, refused) = worker.splats.finish();
            self.refused += worker.refused;
            self.refused += refused;
            self.heaviest.merge(&worker.heaviest);
            splats.push(film);
        }
        splats
    }

    /// All of the render but its image, and the workers' splats.
    fn collect(mut self, size: [u32; 2]) -> (Rendered, Vec<Vec<Sum>>) {
        let splats = self.harvest();
        let rendered = Rendered {
            size,
            image: Vec::new(),
            passes: self.done,
            seconds: self.started.elapsed().as_secs_f64(),
            counters: self.counters,
            refused: self.refused,
            interrupted: self.interrupted,
            chains: None,
            accuracy: None,
            tail: Some(self.heaviest.tail()),
        };
        (rendered, splats)
    }
}

impl Job<'_> {
    /// Whole passes up to number `end`, several at a time, each in `jobs` jobs: `work` does its job for all passes of a batch in one go, and says how many
    /// samples one of them takes.
    #[allow(clippy::too_many_arguments)] // what a job and its callers have
    fn spend(
        &self,
        course: &mut Course,
        end: u64,
        run: &Run<'_>,
        stop: &AtomicBool,
        watch: &(dyn Fn(Progress) + Sync),
        jobs: usize,
        work: &(dyn Fn(usize, std::ops::Range<u64>, &mut Worker) -> u64 + Sync),
    ) -> Result<(), RenderError> {
        let pixels = self.size.map(u64::from).iter().product::<u64>();
        let trouble = Mutex::new(None);
        while let Some(batch) = course.next(end) {
            if stop.load(Ordering::Relaxed) && course.done > 0 {
                course.interrupted = true;
                break;
            }
            let done = course.done;
            let finished = AtomicU64::new(done * pixels);
            each_once(run, jobs, &|i| {
                let free = lock(&course.idle).pop();
                let mut worker = match free.map_or_else(|| Worker::new(self), Ok) {
                    Ok(worker) => worker,
                    Err(e) => {
                        *lock(&trouble) = Some(e);
                        return;
                    }
                };
                let added = work(i, done..done + batch, &mut worker) * batch;
                lock(&course.idle).push(worker);
                let samples = finished.fetch_add(added, Ordering::Relaxed) + added;
                let passes = samples as f64 / pixels as f64;
                watch(Progress {
                    passes: passes as u64,
                    samples,
                    done: course.spending.share(passes, course.started.elapsed()),
                });
            })?;
            if let Some(e) = lock(&trouble).take() {
                return Err(e);
            }
            course.done += batch;
        }
        Ok(())
    }

    fn run(
        &self,
        budget: Budget,
        run: &Run<'_>,
        stop: &AtomicBool,
        watch: &(dyn Fn(Progress) + Sync),
    ) -> Result<Rendered, RenderError> {
        if let Budget::Error { relative, .. } = budget {
            return until::render(self, relative, budget, run, stop, watch);
        }
        if self.settings.estimator == Estimator::Metropolis {
            return chains::render(self, budget, run, stop, watch);
        }
        let rates = &Rates::uniform();
        let mut samples = film(self.size)?;
        let tiles: Vec<_> = cut(&mut samples, self.size)
            .into_iter()
            .map(Mutex::new)
            .collect();
        let mut course = Course::new(budget, Instant::now());
        let work = |i: usize, passes: std::ops::Range<u64>, worker: &mut Worker| {
            // Each tile is one job: the lock is free.
            let mut tile = lock(&tiles[i]);
            worker.render(self, rates, &mut tile, passes);
            tile.len()
        };
        self.spend(&mut course, u64::MAX, run, stop, watch, tiles.len(), &work)?;
        drop(tiles);
        let (mut rendered, splats) = course.collect(self.size);
        let splats = add_up(run, splats)?;
        rendered.image = self.resolve(&samples, &splats, rates, rendered.passes)?;
        Ok(rendered)
    }

    /// The image, row by row.
    fn resolve(
        &self,
        samples: &[Sum],
        splats: &[Sum],
        rates: &Rates,
        passes: u64,
    ) -> Result<Vec<[f32; 3]>, RenderError> {
        let [width, height] = self.size.map(|n| n as usize);
        let mut image =
            attempt(width * height).map_err(|_| RenderError::TooLarge { size: self.size })?;
        image.resize(width * height, [0.0; 3]);
        let (walks, scale) = rates.walks(passes, self.size);
        for (own, pixel @ [x, y]) in samples.iter().zip(order(self.size)) {
            let at = y as usize * width + x as usize;
            let splat = splats.get(at).unwrap_or(&[0; 3]);
            let count = rates.count(pixel, passes);
            let value = self.step.resolve(own, splat, count, walks, scale);
            image[at] = value.map(|x| x as f32);
        }
        Ok(image)
    }
}

impl Worker {
    fn new(job: &Job<'_>) -> Result<Self, RenderError> {
        let wanted = job.settings.estimator.splats();
        Ok(Self {
            scratch: Box::new(Scratch::new()),
            splats: Splats::new(job.step, job.size, wanted)?,
            heaviest: Heaviest::default(),
            refused: Refused::default(),
        })
    }

    /// Adds the samples of some passes to each pixel of a tile.
    fn render(
        &mut self,
        job: &Job<'_>,
        rates: &Rates,
        tile: &mut Tile<'_>,
        passes: std::ops::Range<u64>,
    ) {
        let Self {
            scratch,
            splats,
            heaviest,
            refused,
        } = self;
        let step = job.step;
        for (pixel, sum) in tile.pixels() {
            let samples = rates.count(pixel, passes.start)..rates.count(pixel, passes.end);
            for index in samples {
                let mut all = 0.0;
                let splat = &mut |pixel, value: Rgb| {
                    all += grey(value);
                    splats.add(pixel, value);
                };
                let value = job
                    .scene
                    .estimate(&job.settings, pixel, index, scratch, splat);
                step.add(sum, value, refused);
                heaviest.add(all + grey(value));
            }
        }
    }
}
