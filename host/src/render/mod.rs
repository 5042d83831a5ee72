//! Renders on all cores. The image is a pure function of the scene, the settings and the number of passes:
//! films add integers, so neither threads nor tiles matter.

mod budget;

pub use budget::Budget;

use etendue::film::{Refused, Step, Sum, merge};
use etendue::{Counters, Rgb, Scene, Scratch, Settings};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// Vertices that a light walk keeps.
const CAPACITY: usize = 32;
/// Rows and columns of a tile.
const TILE: u32 = 16;

/// How to render.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Estimator, weights, depth, seed.
    pub settings: Settings,
    /// When to stop.
    pub budget: Budget,
    /// Threads; 0 for one per core.
    pub threads: usize,
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
    /// Whether it was told to stop early.
    pub interrupted: bool,
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

/// Why a render can't begin.
#[derive(Debug, thiserror::Error)]
#[error("can't start {threads} threads: {source}")]
pub struct ThreadError {
    threads: usize,
    source: rayon::ThreadPoolBuildError,
}

/// What a thread works in and adds to.
struct Worker {
    scratch: Box<Scratch<CAPACITY>>,
    splats: Vec<Sum>,
    refused: Refused,
}

/// Renders `scene`. `stop` ends it after the pass it is in; `watch` is told of the progress, now and then.
///
/// # Errors
/// If the threads can't be started.
pub fn render(
    scene: &Scene<'_>,
    options: &Options,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Rendered, ThreadError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|source| ThreadError {
            threads: options.threads,
            source,
        })?;
    Ok(pool.install(|| passes(scene, options, stop, watch)))
}

fn passes(
    scene: &Scene<'_>,
    options: &Options,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Rendered {
    let [width, height] = scene.size();
    let pixels = u64::from(width) * u64::from(height);
    let step = Step::new(scene.film_exponent());
    let mut samples = vec![[0; 3]; pixels as usize];
    let workers = workers(rayon::current_num_threads(), pixels as usize);
    let started = Instant::now();
    let mut budget = options.budget.begin();
    let mut done = 0;
    // Whole passes, several at a time: each tile renders all its samples of a batch in one go.
    while let Some(batch) = budget.next(done, started.elapsed()) {
        let finished = AtomicU64::new(0);
        bands(&mut samples, width)
            .par_bridge()
            .for_each(|(first_row, rows)| {
                let worker = &workers[rayon::current_thread_index().unwrap_or(0)];
                // Nobody else has this thread's worker: the lock is free.
                let mut worker = worker
                    .lock()
                    .unwrap_or_else(std::sync::PoisonError::into_inner);
                for tile in 0..width.div_ceil(TILE) {
                    let columns = tile * TILE..((tile + 1) * TILE).min(width);
                    for (y, row) in rows.chunks_mut(width as usize).enumerate() {
                        for x in columns.clone() {
                            let pixel = [x, first_row + y as u32];
                            for index in done..done + batch {
                                let value = worker.sample(
                                    scene,
                                    &options.settings,
                                    step,
                                    pixel,
                                    index,
                                    width,
                                );
                                step.add(&mut row[x as usize], value, &mut worker.refused);
                            }
                        }
                    }
                    let rows = (rows.len() / width as usize) as u64;
                    let n = u64::from(columns.end - columns.start) * rows * batch;
                    let all = finished.fetch_add(n, Ordering::Relaxed) + n;
                    let part = all as f64 / (pixels * batch) as f64;
                    watch(Progress {
                        passes: done,
                        samples: done * pixels + all,
                        done: budget.share(done, batch, part, started.elapsed()),
                    });
                }
            });
        done += batch;
        if stop.load(Ordering::Relaxed) {
            break;
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    develop(
        samples,
        workers,
        step,
        [width, height],
        done,
        seconds,
        stop.load(Ordering::Relaxed),
    )
}

impl Worker {
    #[inline]
    fn sample(
        &mut self,
        scene: &Scene<'_>,
        settings: &Settings,
        step: Step,
        pixel: [u32; 2],
        index: u64,
        width: u32,
    ) -> Rgb {
        let Self {
            scratch,
            splats,
            refused,
        } = self;
        scene.estimate(settings, pixel, index, scratch, &mut |[x, y], value| {
            if let Some(sum) = splats.get_mut((y * width + x) as usize) {
                step.add(sum, value, refused);
            }
        })
    }
}

fn workers(count: usize, pixels: usize) -> Vec<std::sync::Mutex<Worker>> {
    let worker = || Worker {
        scratch: Box::new(Scratch::new()),
        splats: vec![[0; 3]; pixels],
        refused: Refused::default(),
    };
    (0..count.max(1)).map(|_| worker().into()).collect()
}

/// The image in bands of [`TILE`] rows, each with its first row's number.
fn bands(samples: &mut [Sum], width: u32) -> impl Iterator<Item = (u32, &mut [Sum])> + Send {
    let rows = TILE as usize * width as usize;
    samples
        .chunks_mut(rows)
        .enumerate()
        .map(|(i, band)| (i as u32 * TILE, band))
}

fn develop(
    samples: Vec<Sum>,
    workers: Vec<std::sync::Mutex<Worker>>,
    step: Step,
    size: [u32; 2],
    passes: u64,
    seconds: f64,
    interrupted: bool,
) -> Rendered {
    let mut counters = Counters::default();
    let mut refused = Refused::default();
    let mut splats = vec![[0; 3]; samples.len()];
    for worker in workers {
        let worker = worker
            .into_inner()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        counters += worker.scratch.counters;
        refused += worker.refused;
        for (sum, other) in splats.iter_mut().zip(&worker.splats) {
            merge(sum, other);
        }
    }
    // A splat already counts 1/n of the image's light walks, one of which goes with each sample: both
    // sums are divided by the samples per pixel.
    let image = samples
        .iter()
        .zip(&splats)
        .map(|(own, splat)| {
            let (a, b) = (step.mean(own, passes), step.mean(splat, passes));
            std::array::from_fn(|c| (a[c] + b[c]) as f32)
        })
        .collect();
    Rendered {
        size,
        image,
        passes,
        seconds,
        counters,
        refused,
        interrupted,
    }
}
