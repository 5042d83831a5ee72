//! Metropolis chains on all cores. What they are and where they start depends on the scene, the settings and the image's size, never on threads.
//!
//! 1. A pilot of whole samples, thrown away, says how much of a contribution is left to samples, and how many steps each of them is worth ([`Balance`]).
//! 2. Pilot chains find the size of steps and are thrown away.
//! 3. A pass makes whole samples of each pixel. What samples leave to chains is energy (Cline et al. 2005): it is gathered over a block of
//!    pixels, and each time there is enough of it for a chain, one starts at the sample that has brought the last of it. That draws starts in
//!    proportion to their energy, evenly; and as each chain of a block takes as many steps and hands out as much, whatever it started from, the
//!    image is right in the mean after any number of passes.
//! 4. After 1, 2, 4, 8 … passes it is chosen how often each block is done in those to come: more often where its chains give much to few pixels, as
//!    in what a glass ball shows of a bright gap ([`Block::share_out`]).

mod block;
mod deposits;

use super::crew::{Run, each_once};
use super::rates::Rates;
use super::tiles::film;
use super::{CAPACITY, Course, Job, Progress, RenderError, Rendered, Worker, add_up, grey, lock};
use crate::render::Budget;
use block::Block;
use deposits::Deposits;
use etendue::estimate::Chain;
use etendue::film::{Refused, Step, Sum, merge};
use etendue::random::{Pcg, Purpose, Sampler};
use etendue::real::Real;
use etendue::{Rgb, Scratch, Settings};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Steps of a chain. With 64, 256, 1024, 4096, 16384 of them, glass-caustic.xml has 0.4, 0.7, 0.7, 0.9, 1 of the efficiency, door-ajar.xml 0.7, 0.9, 1, 0.9, 0.7
/// (without walks aside and steps in the image alone).
const LENGTH: u64 = 1024;
/// The most chains from one sample; where it has the energy of more, each hands out more.
const MOST_CHAINS: u64 = 64;
/// Vertices of either walk whose numbers a chain records.
const VERTICES: usize = 16;
/// Samples of the pilot have numbers that no others have.
const PILOT: u64 = 1 << 62;
/// Samples that say how bright the image is; pairs of samples of a pixel that say how good a balance is.
const MEANS: u64 = 1 << 13;
const PAIRS: u64 = 1 << 10;
/// Pairs in a job.
const PART: u64 = 1 << 6;
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
    /// Samples that they started from, or might have.
    pub bootstraps: u64,
    /// The image's mean, over pixels and channels.
    pub mean: f64,
    /// Its relative standard error: the whole image may be brighter or darker by so much.
    pub error: f64,
    /// What of a contribution was left to samples: what it carries up to this, a radiance.
    pub above: f64,
    /// The largest step of a number, as the pilots found it.
    pub size: f64,
    /// The share of small steps that were accepted.
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

/// What is left to samples, and what that means.
#[derive(Clone, Copy, Debug, Default)]
struct Balance {
    /// The variance of a pixel that remains whatever chains do, for each sample: of what samples give, and of what they leave, as far as chains spread it.
    variance: f64,
    /// What chains give: the mean over pixels.
    energy: f64,
}

impl Balance {
    /// Of these multiples of the image's mean. The factor between them is wide, as the pilot's time counts in short renders and its noise would choose between
    /// nearer ones: with 0, 0.125, 0.5, 1, 2, 8 of them door-ajar.xml has 1, 1, 0.9, 0.8, 0.6, 0.5 of the efficiency, glass-caustic.xml with
    /// 0, 0.5, 2, 8, 32 of them 0.3, 0.5, 0.9, 1, 1.
    const ABOVE: [f64; 3] = [0.125, 2.0, 32.0];
    /// Steps for each sample, if all was left to chains: what a step hands out is the image's mean over this. With 6 and 9 of them door-ajar.xml has 0.9 and 1
    /// of the efficiency, glass-caustic.xml as much; with 1, 2, 16, when a step was a third slower, 0.6, 0.9, 0.8.
    const STEPS: f64 = 9.0;
    /// How many steps of a chain are worth one that is independent of all others: 12 to 15 in door-ajar.xml.
    const CORRELATION: f64 = 12.0;
    /// Time of a step over that of a sample.
    const TIME: f64 = 0.25;
    /// Pixels that a chain spreads over, about.
    const REACH: f64 = 256.0;

    /// Variance times time, of a sample and its share of steps that hand out `step`.
    fn cost(&self, step: f64) -> f64 {
        let variance = self.variance + Self::CORRELATION * step * self.energy;
        variance * (1.0 + Self::TIME * self.energy / step)
    }
}

/// Everything that is the same for all steps.
struct Plan<'j, 'a> {
    job: &'j Job<'a>,
    settings: Settings,
    pixels: u64,
    /// What a step hands out.
    energy: f64,
}

impl Plan<'_, '_> {
    /// Sample `index`: the energy that it leaves to chains.
    fn sample(
        &self,
        settings: &Settings,
        index: u64,
        scratch: &mut Scratch<CAPACITY>,
        below: &mut dyn FnMut([u32; 2], Rgb),
    ) -> f32 {
        let scene = self.job.scene;
        scene.bootstrap(settings, index, &mut scratch.view(scene), below)
    }

    /// The number of pilot sample `i` of [`MEANS`], which are all over the image.
    fn pilot(&self, i: u64) -> u64 {
        let stride = (self.pixels / MEANS).max(1);
        PILOT + i * stride + i * 7 % stride
    }

    /// What the pilot's samples leave to chains, one after the other.
    fn energies(&self, run: &Run<'_>) -> Result<Vec<f32>, RenderError> {
        let mut all = vec![0.0; MEANS as usize];
        let parts: Vec<_> = all.chunks_mut(PART as usize).map(Mutex::new).collect();
        each_once(run, parts.len(), &|i| {
            let mut scratch = Box::new(Scratch::new());
            for (energy, at) in lock(&parts[i]).iter_mut().zip(i as u64 * PART..) {
                let index = self.pilot(at);
                *energy = self.sample(&self.settings, index, &mut scratch, &mut |_, _| ());
            }
        })?;
        drop(parts);
        Ok(all)
    }

    /// What leaving `above` to samples means in an image that is `mean` bright, by two samples each of pixels all over it.
    fn balance(&self, run: &Run<'_>, mean: f64, above: f64) -> Result<Balance, RenderError> {
        let mut settings = self.settings;
        settings.mutations.above = above as Real;
        let width = u64::from(self.job.size[0]);
        let parts: Vec<_> = (0..PAIRS / PART).map(|_| Mutex::new([0.0; 2])).collect();
        each_once(run, parts.len(), &|i| {
            let mut scratch = Box::new(Scratch::new());
            let [mut variance, mut below] = [0.0; 2];
            for pair in i as u64 * PART..(i as u64 + 1) * PART {
                let at = (pair * self.pixels / PAIRS + pair) % self.pixels;
                let pixel = [(at % width) as u32, (at / width) as u32];
                let own = [1, 2].map(|k| {
                    let mut own = 0.0;
                    let index = PILOT / self.pixels * self.pixels + k * MEANS * self.pixels + at;
                    let left = self.sample(&settings, index, &mut scratch, &mut |p, v| {
                        let value = f64::from(grey(v)) / 3.0;
                        below += value / 2.0;
                        if p == pixel {
                            own += value;
                        } else {
                            // One of few that come to a pixel from afar.
                            variance += value * value / 2.0;
                        }
                    });
                    variance += f64::from(left).powi(2) / Balance::REACH / 2.0;
                    own
                });
                variance += (own[0] - own[1]).powi(2) / 2.0;
            }
            *lock(&parts[i]) = [variance, below];
        })?;
        let sum = |i: usize| parts.iter().map(|p| lock(p)[i]).sum::<f64>() / PAIRS as f64;
        Ok(Balance {
            variance: sum(0),
            // By what is below, which has a mean that few samples tell; what is beyond may all be in one that they don't have.
            energy: (mean - sum(1)).max(0.0),
        })
    }

    /// The size of steps, by chains that are thrown away. They start from those samples of the pilot that leave them anything.
    fn tune(&mut self, run: &Run<'_>) -> Result<(), RenderError> {
        let energies = self.energies(run)?;
        let mut sum = 0.0;
        let sums: Vec<f64> = energies
            .iter()
            .map(|&e| {
                sum += f64::from(e);
                sum
            })
            .collect();
        let rounds = if sum > 0.0 { ROUNDS } else { 0 };
        for round in 0..rounds {
            let accepted: Vec<_> = (0..PILOTS).map(|_| Mutex::new(0.0)).collect();
            let plan = &*self;
            each_once(run, accepted.len(), &|i| {
                let mut scratch = Box::new(Scratch::<CAPACITY>::new());
                // Starts of all kinds in each round, in proportion to their energy.
                let id = i as u64 * ROUNDS + round;
                let xi = f64::from(Pcg::new(plan.settings.seed, START, id).one(Purpose::Choice));
                let place = (id as f64 + xi) / (PILOTS * ROUNDS) as f64 * sum;
                let from = sums.partition_point(|&s| s <= place).min(sums.len() - 1) as u64;
                let Plan { job, settings, .. } = plan;
                let mut chain = Box::<Chain<VERTICES>>::default();
                let view = &mut scratch.view(job.scene);
                let from = plan.pilot(from);
                chain.start(job.scene, settings, u64::MAX - id, from, view);
                chain.advance(job.scene, settings, 1.0, PILOT_STEPS, view, &mut |_, _| ());
                *lock(&accepted[i]) = f64::from(chain.accepted());
            })?;
            let mean = accepted.iter().map(|a| *lock(a)).sum::<f64>() / PILOTS as f64;
            self.settings.mutations = self.settings.mutations.tuned(mean as Real);
        }
        Ok(())
    }

    /// One pass of block `id`: the same splats whatever passes are done in one go.
    fn pass(&self, id: u64, block: &mut Block, worker: &mut Worker) {
        let Self { job, settings, .. } = self;
        let Worker {
            scratch,
            splats,
            heaviest,
            ..
        } = worker;
        let (mut chain, mut deposits) = (Chain::<VERTICES>::new(), Deposits::new());
        let share = 1.0 / block.rate as f32;
        for [x, y] in Block::pixels(id, job.size) {
            let at = u64::from(y) * u64::from(job.size[0]) + u64::from(x);
            let mut all = 0.0;
            for number in block.samples..block.samples + block.rate {
                let index = number * self.pixels + at;
                let energy = self.sample(settings, index, scratch, &mut |pixel, value| {
                    let value = value * share;
                    all += grey(value);
                    splats.add(pixel, value);
                });
                all += 3.0 * energy * share;
                let wanted = block.gather(f64::from(energy) / (self.energy * LENGTH as f64));
                let chains = wanted.min(MOST_CHAINS);
                let each = self.energy * wanted as f64 / chains.max(1) as f64;
                for _ in 0..chains {
                    let view = &mut scratch.view(job.scene);
                    chain.start(job.scene, settings, id << 32 | block.chains, index, view);
                    let splat = &mut |pixel, value| {
                        deposits.add(pixel, value);
                        splats.add(pixel, value);
                    };
                    let scale = each as Real * share;
                    chain.advance(job.scene, settings, scale, LENGTH, view, splat);
                    block.chains += 1;
                    block.accepted += f64::from(chain.accepted());
                }
                let squares = if chains > 0 { deposits.squares() } else { 0.0 };
                block.note(Balance::TIME * (LENGTH * chains) as f64, squares);
            }
            heaviest.add(all);
            block.mean.add(job.step, all / 3.0);
        }
        block.samples += block.rate;
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
    let begun = Instant::now();
    let mut plan = Plan {
        job,
        settings: job.settings,
        pixels,
        energy: 0.0,
    };
    let energies = plan.energies(run)?;
    let mean = energies.iter().map(|&e| f64::from(e)).sum::<f64>() / MEANS as f64;
    if mean > 0.0 {
        plan.energy = mean / Balance::STEPS;
        let (mut best, mut least) = (0.0, f64::INFINITY);
        for above in Balance::ABOVE.map(|multiple| multiple * mean) {
            let cost = plan.balance(run, mean, above)?.cost(plan.energy);
            if cost < least {
                (best, least) = (above, cost);
            }
        }
        plan.settings.mutations.above = best as Real;
        plan.tune(run)?;
    } else {
        // Where nothing is known of what chains would have to hand out, samples are all there is.
        plan.settings.mutations.above = Real::MAX;
        plan.energy = 1.0;
    }

    let [columns, rows] = Block::count(job.size).map(u64::from);
    let blocks: Vec<_> = (0..columns * rows)
        .map(|_| Mutex::new(Block::new()))
        .collect();
    let mut course = Course::new(budget, begun);
    // All are alike before there is anything to tell them apart.
    Block::share_out(&blocks, 0, plan.settings.seed);
    while course.goes_on() {
        let work = |i: usize, passes: std::ops::Range<u64>, worker: &mut Worker| {
            let (block, id) = (&mut *lock(&blocks[i]), i as u64);
            for _ in passes {
                plan.pass(id, block, worker);
            }
            Block::pixels(id, job.size).count() as u64
        };
        let end = (course.done + 1).next_power_of_two();
        job.spend(&mut course, end, run, stop, watch, blocks.len(), &work)?;
        if course.done == end {
            Block::share_out(&blocks, end, plan.settings.seed);
        }
    }

    let (mut mean, mut bootstraps, mut chains, mut accepted) = (Mean::default(), 0, 0, 0.0);
    for (block, id) in blocks.into_iter().zip(0..) {
        let block = block.into_inner().unwrap_or_else(PoisonError::into_inner);
        mean.merge(&block.mean);
        bootstraps += block.samples * Block::pixels(id, job.size).count() as u64;
        chains += block.chains;
        accepted += block.accepted;
    }
    let (mut rendered, splats) = course.collect(job.size);
    rendered.refused += mean.refused;
    rendered.chains = Some(ChainReport {
        chains,
        bootstraps,
        mean: mean.value(step),
        error: mean.error(step),
        above: f64::from(plan.settings.mutations.above),
        size: f64::from(plan.settings.mutations.size),
        accepted: accepted / chains.max(1) as f64,
    });
    let splats = add_up(run, splats)?;
    // All is splatted, as many samples for each pixel: no pixel has a sum of its own.
    let none = film(job.size)?;
    rendered.image = job.resolve(&none, &splats, &Rates::uniform(), rendered.passes)?;
    Ok(rendered)
}
