//! Metropolis chains on all cores. What they are and where they start depends on the scene, the settings, the image's size and the number of passes,
//! never on threads.
//!
//! 1. A bootstrap of whole samples estimates the image's mean and gives starts.
//! 2. Pilot chains find the size of steps and are thrown away.
//! 3. Chains run, and beside them goes on the bootstrap. After [`FIRST_AGE`] passes, and whenever there are four times as many, they start over from
//!    what is known by then: how many chains there are of each length and strategy is as good as the bootstrap, and has to become better with the image.

use super::crew::{Run, each_once};
use super::{CAPACITY, Course, Job, Progress, RenderError, Rendered, Worker, add_up, lock};
use crate::memory::attempt;
use crate::render::Budget;
use crate::statistics::Tail;
use etendue::estimate::Chain;
use etendue::film::{Refused, Step, Sum, merge};
use etendue::random::{Pcg, Purpose, Sampler};
use etendue::real::Real;
use etendue::{Rgb, Scratch, Settings};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Pixels for each chain, within the bounds on how many chains there are.
const PIXELS: u64 = 64;
const FEWEST: u64 = 256;
const MOST: u64 = 4096;
/// Vertices of either walk whose numbers a chain records.
const VERTICES: usize = 16;
/// Samples of the bootstrap: for each pixel, and the bounds on how many.
const STARTS_PER_PIXEL: u64 = 2;
const FEWEST_STARTS: u64 = 1 << 13;
const MOST_FIRST_STARTS: u64 = 1 << 16;
/// For so many steps one more sample is made for the bootstrap.
const STEPS_PER_START: u64 = 16;
/// Of those so many are kept to start from.
const MOST_STARTS: u64 = 1 << 22;
/// Samples of it in a job.
const PART: u64 = 1 << 10;
/// Passes until chains start over for the first time.
const FIRST_AGE: u64 = 16;
/// The chains that find the size of steps and are thrown away: how many, how often the size is changed, steps in between.
const PILOTS: u64 = 16;
const ROUNDS: u64 = 12;
const PILOT_STEPS: u64 = 64;
/// The stream that starts are drawn from.
const START: u64 = 0x7374_6172_7400_0000;

/// What chains did.
#[derive(Clone, Copy, Debug)]
pub struct ChainReport {
    /// How many there were.
    pub chains: u64,
    /// Samples that the image's mean was estimated from.
    pub bootstraps: u64,
    /// That mean, over pixels and channels.
    pub mean: f64,
    /// Its relative standard error: the whole image may be brighter or darker by so much.
    pub error: f64,
    /// The largest step of a number, as the pilots found it.
    pub size: f64,
    /// The share of small steps that were accepted since the chains started over.
    pub accepted: f64,
}

/// Estimates of the image's mean, and of their squares, summed exactly.
#[derive(Clone, Default)]
struct Mean {
    count: u64,
    sum: Sum,
    refused: Refused,
    /// Squares: for the error alone.
    squares: f64,
}

impl Mean {
    fn add(&mut self, step: Step, estimate: f32) {
        self.count += 1;
        self.squares += f64::from(estimate) * f64::from(estimate);
        let grey = Rgb::new(estimate, estimate, estimate);
        step.add(&mut self.sum, grey, &mut self.refused);
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.squares += other.squares;
        merge(&mut self.sum, &other.sum);
        self.refused += other.refused;
    }

    fn value(&self, step: Step) -> f64 {
        step.mean(&self.sum, self.count)[0]
    }

    /// Relative standard error.
    fn error(&self, step: Step) -> f64 {
        let (n, mean) = (self.count as f64, self.value(step));
        let variance = (self.squares / n - mean * mean).max(0.0) / n;
        if mean > 0.0 {
            variance.sqrt() / mean
        } else {
            0.0
        }
    }
}

/// A chain, and the estimates of the mean that are made beside it.
#[derive(Default)]
struct Link {
    chain: Chain<VERTICES>,
    mean: Mean,
    /// Those since chains started over, as far as they are kept, and how many there were before.
    estimates: Vec<f32>,
    before: u64,
}

/// Everything that is the same for all steps.
struct Plan<'j, 'a> {
    job: &'j Job<'a>,
    settings: Settings,
    /// The mean that splats are scaled by.
    scale: f64,
    chains: u64,
    /// Steps of a chain in a pass.
    steps: u64,
    /// Samples of the bootstrap that a chain makes in a row, and passes from one row to the next.
    starts: u64,
    period: u64,
}

/// Where chains may start: the sums of the estimates up to each sample.
struct Starts {
    sums: Vec<f64>,
    /// The first sample of each row of samples whose numbers follow each other, and its number.
    rows: Vec<(usize, u64)>,
}

impl Starts {
    fn new(scouted: &[f32]) -> Self {
        let mut all = Self {
            sums: Vec::new(),
            rows: Vec::new(),
        };
        all.add(scouted, 0);
        all
    }

    /// More samples, whose numbers follow `first`.
    fn add(&mut self, estimates: &[f32], first: u64) {
        self.rows.push((self.sums.len(), first));
        let mut sum = self.total();
        self.sums.extend(estimates.iter().map(|&e| {
            sum += f64::from(e);
            sum
        }));
    }

    fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// The sample that number `i` of `count` starts starts from: in proportion to the estimates, each in its own share of their sum.
    fn draw(&self, seed: u64, i: u64, count: u64) -> u64 {
        let xi = f64::from(Pcg::new(seed, START, i).one(Purpose::Choice));
        let place = (i as f64 + xi) / count as f64 * self.total();
        let at = self.sums.partition_point(|&sum| sum <= place);
        let at = at.min(self.sums.len().saturating_sub(1));
        let row = self.rows.partition_point(|&(first, _)| first <= at);
        let (first, number) = self.rows[row - 1];
        number + (at - first) as u64
    }
}

impl Plan<'_, '_> {
    /// The mean of sample `index` of the bootstrap.
    fn estimate(&self, index: u64, scratch: &mut Scratch<CAPACITY>) -> f32 {
        let scene = self.job.scene;
        scene.bootstrap(&self.settings, index, &mut scratch.view(scene))
    }

    /// The first `count` samples.
    fn bootstrap(&self, run: &Run<'_>, count: u64) -> Result<Vec<f32>, RenderError> {
        let too_large = |_| RenderError::TooLarge {
            size: self.job.size,
        };
        let mut all = attempt(count as usize).map_err(too_large)?;
        all.resize(count as usize, 0.0);
        let parts: Vec<_> = all.chunks_mut(PART as usize).map(Mutex::new).collect();
        each_once(run, parts.len(), &|i| {
            let mut scratch = Box::new(Scratch::new());
            for (estimate, index) in lock(&parts[i]).iter_mut().zip(i as u64 * PART..) {
                *estimate = self.estimate(index, &mut scratch);
            }
        })?;
        drop(parts);
        Ok(all)
    }

    /// The size of steps, by chains that are thrown away.
    fn tune(&mut self, run: &Run<'_>, starts: &Starts) -> Result<(), RenderError> {
        for round in 0..ROUNDS {
            let accepted: Vec<_> = (0..PILOTS).map(|_| Mutex::new(0.0)).collect();
            let plan = &*self;
            each_once(run, accepted.len(), &|i| {
                let mut scratch = Box::new(Scratch::new());
                // Starts of all kinds in each round.
                let id = i as u64 * ROUNDS + round;
                let from = starts.draw(plan.settings.seed, id, PILOTS * ROUNDS);
                let mut pilot = Box::<Link>::default();
                plan.start(&mut pilot, u64::MAX - id, from, &mut scratch);
                let view = &mut scratch.view(plan.job.scene);
                let Plan { job, settings, .. } = plan;
                let chain = &mut pilot.chain;
                chain.advance(job.scene, settings, 1.0, PILOT_STEPS, view, &mut |_, _| ());
                *lock(&accepted[i]) = f64::from(chain.accepted());
            })?;
            let mean = accepted.iter().map(|a| *lock(a)).sum::<f64>() / PILOTS as f64;
            self.settings.mutations = self.settings.mutations.tuned(mean as Real);
        }
        Ok(())
    }

    fn start(&self, link: &mut Link, id: u64, from: u64, scratch: &mut Scratch<CAPACITY>) {
        let view = &mut scratch.view(self.job.scene);
        let Self { job, settings, .. } = self;
        link.chain.start(job.scene, settings, id, from, view);
    }

    /// The number of the first sample in a row of the bootstrap that chain `id` makes.
    fn first_start(&self, id: u64, row: u64) -> u64 {
        MOST_FIRST_STARTS + (row * self.chains + id) * self.starts
    }

    /// One pass of chain `id`: the same splats whatever passes are done in one go.
    fn pass(&self, id: u64, pass: u64, link: &mut Link, worker: &mut Worker) {
        let Self { job, settings, .. } = self;
        let Worker {
            scratch, splats, ..
        } = worker;
        let splat = &mut |pixel, value| splats.add(pixel, value);
        let (view, scale) = (&mut scratch.view(job.scene), self.scale as Real);
        let chain = &mut link.chain;
        chain.advance(job.scene, settings, scale, self.steps, view, splat);
        if !pass.is_multiple_of(self.period) {
            return;
        }
        let first = self.first_start(id, pass / self.period);
        for index in first..first + self.starts {
            let estimate = self.estimate(index, scratch);
            link.mean.add(job.step, estimate);
            if link.mean.count <= MOST_STARTS / self.chains {
                link.estimates.push(estimate);
            }
        }
    }

    /// All that chains can start from after some passes.
    fn known(&self, starts: &mut Starts, links: &[Mutex<Link>]) {
        for (link, id) in links.iter().zip(0..) {
            let link = &mut *lock(link);
            let rows = link.estimates.chunks(self.starts as usize);
            for (estimates, row) in rows.zip(link.before / self.starts..) {
                starts.add(estimates, self.first_start(id, row));
            }
            link.estimates = Vec::new();
            link.before = link.mean.count;
        }
    }
}

/// Renders by chains.
pub(super) fn render(
    job: &Job<'_>,
    budget: Budget,
    run: &Run<'_>,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Rendered, RenderError> {
    let step = job.step;
    let pixels = job.size.map(u64::from).iter().product::<u64>();
    let chains = (pixels / PIXELS).clamp(FEWEST, MOST);
    let steps = pixels.div_ceil(chains);
    let begun = Instant::now();
    let mut plan = Plan {
        job,
        settings: job.settings,
        scale: 0.0,
        chains,
        steps,
        starts: steps.div_ceil(STEPS_PER_START),
        period: (STEPS_PER_START / steps).max(1),
    };
    let first = (STARTS_PER_PIXEL * pixels).clamp(FEWEST_STARTS, MOST_FIRST_STARTS);
    let mut mean = Mean::default();
    let estimates = plan.bootstrap(run, first)?;
    estimates.iter().for_each(|&e| mean.add(step, e));
    let tail = Tail::of(&estimates);
    let mut starts = Starts::new(&estimates);
    let dark = starts.total() <= 0.0;
    plan.scale = mean.value(step);
    if !dark {
        plan.tune(run, &starts)?;
    }

    let links: Vec<_> = (0..chains).map(|_| Mutex::new(Link::default())).collect();
    let mut course = Course::new(budget, begun);
    let (mut age, mut end) = (0, FIRST_AGE);
    while course.goes_on() {
        let work = |i: usize, passes: std::ops::Range<u64>, worker: &mut Worker| {
            let (link, id) = (&mut *lock(&links[i]), i as u64);
            if passes.start == age && !dark {
                let from = starts.draw(plan.settings.seed ^ age, id, chains);
                // Chains that start over are others.
                plan.start(link, id ^ age << 32, from, &mut worker.scratch);
            }
            for pass in passes {
                plan.pass(id, pass, link, worker);
            }
            steps
        };
        job.spend(&mut course, end, run, stop, watch, links.len(), &work)?;
        plan.known(&mut starts, &links);
        (age, end) = (end, end * 4);
    }

    let (mut accepted, count) = (0.0, links.len() as f64);
    for link in links {
        let link = link.into_inner().unwrap_or_else(PoisonError::into_inner);
        accepted += f64::from(link.chain.accepted()) / count;
        mean.merge(&link.mean);
    }
    let (value, done) = (mean.value(step), course.done);
    let (mut rendered, splats) = course.collect(job.size);
    rendered.refused += mean.refused;
    rendered.tail = Some(tail);
    rendered.chains = Some(ChainReport {
        chains,
        bootstraps: mean.count,
        mean: value,
        error: mean.error(step),
        size: f64::from(plan.settings.mutations.size),
        accepted,
    });
    let splats = add_up(run, splats)?;
    // What splats were scaled by, against what is known of it now.
    let brighter = if dark { 0.0 } else { value / plan.scale };
    let too_large = |_| RenderError::TooLarge { size: job.size };
    rendered.image = attempt(pixels as usize).map_err(too_large)?;
    rendered.image.resize(pixels as usize, [0.0; 3]);
    for (pixel, sum) in rendered.image.iter_mut().zip(&splats) {
        let value = step.resolve(&[0; 3], sum, 1, done * chains * steps, pixels);
        *pixel = value.map(|x| (x * brighter) as f32);
    }
    Ok(rendered)
}
