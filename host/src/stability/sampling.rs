//! Independent batches of samples, and of chains, by either kernel.
//!
//! A batch of chains is a whole run of Metropolis light transport with random numbers of its own: a bootstrap, chains that start from it, and
//! the bootstrap's mean that their splats are scaled by. The start is drawn in proportion to what the samples are worth, in place of a long way from anywhere: with the mean
//! of the same samples as the scale a batch is unbiased however short it is (Veach 1997, §11.3.1), so that its distance from the truth is chance alone.

/// Parts of an image, in which the light of chains is compared with that of samples: its quarters.
pub(super) const PARTS: usize = 4;

/// What a batch of samples, or of chains, gave.
#[derive(Default)]
pub(super) struct Batch {
    /// The image's mean by channel.
    pub mean: [f64; 3],
    /// What the quarters of the image add to the mean of its channels' sum.
    pub parts: [f64; PARTS],
    /// What each sample contributes to all channels; of chains, each sample of the bootstrap.
    pub contributions: Vec<f32>,
    pub rejected: u64,
    pub cut: u64,
    pub full: u64,
    pub refused: u64,
}

/// Samples of a bootstrap, and steps of all its chains, over the samples that another estimator takes: a step makes one of a sample's strategies.
const STARTS: u64 = 2;
const STEPS: u64 = 4;
/// Chains of a batch, and vertices whose numbers they record (as a render's).
const CHAINS: u64 = 16;
const VERTICES: usize = 16;
/// The stream that starts are drawn from.
const START: u64 = 0x7374_6172_7400_0000;

/// The quarter that a pixel is in.
fn part([x, y]: [u32; 2], [width, height]: [u32; 2]) -> usize {
    usize::from(2 * x >= width) + 2 * usize::from(2 * y >= height)
}

macro_rules! kernel {
    ($name:ident, $kernel:ident) => {
        pub(super) mod $name {
            use super::{Batch, CHAINS, START, STARTS, STEPS, VERTICES, part};
            use $kernel::estimate::Chain;
            use $kernel::film::{Refused, Step, Sum};
            use $kernel::random::{Pcg, Purpose, Sampler as _};
            use $kernel::real::Real;
            use $kernel::{Rgb, Scene, Scratch, Settings};

            /// What `bytes` is a blob of.
            pub fn open(bytes: &[u8]) -> Result<Scene<'_>, String> {
                Scene::open(bytes).map_err(|e| e.to_string())
            }

            /// Where values go.
            struct Film {
                size: [u32; 2],
                step: Step,
                sum: Sum,
                refused: Refused,
                batch: Batch,
            }

            impl Film {
                fn new(scene: &Scene<'_>) -> Self {
                    Self {
                        size: scene.size(),
                        step: Step::new(scene.film_exponent()),
                        sum: [0; 3],
                        refused: Refused::default(),
                        batch: Batch::default(),
                    }
                }

                /// Adds a value to a pixel; the sum of its channels.
                fn add(&mut self, pixel: [u32; 2], value: Rgb) -> f64 {
                    self.step.add(&mut self.sum, value, &mut self.refused);
                    let value = value.to_array().map(f64::from);
                    let all = value.iter().sum();
                    for (sum, v) in self.batch.mean.iter_mut().zip(value) {
                        *sum += v;
                    }
                    self.batch.parts[part(pixel, self.size)] += all;
                    all
                }

                /// The batch, of which `weight` values make a mean.
                fn finish(self, weight: u64, scratch: &Scratch<32>) -> Batch {
                    let share = 1.0 / weight as f64;
                    let counters = scratch.counters;
                    Batch {
                        mean: self.batch.mean.map(|x| x * share),
                        parts: self.batch.parts.map(|x| x * share),
                        rejected: counters.rejected,
                        cut: counters.cut_walks,
                        full: counters.full_walks,
                        refused: self.refused.saturated + self.refused.invalid,
                        ..self.batch
                    }
                }
            }

            /// The passes `passes` over the image.
            pub fn samples(
                scene: &Scene<'_>,
                settings: &Settings,
                passes: std::ops::Range<u64>,
            ) -> Batch {
                let [w, h] = scene.size();
                let mut scratch = Box::new(Scratch::<32>::new());
                let mut film = Film::new(scene);
                let count = (passes.end - passes.start) * u64::from(w) * u64::from(h);
                for index in passes {
                    for pixel in (0..h).flat_map(|y| (0..w).map(move |x| [x, y])) {
                        let mut all = 0.0;
                        let splat = &mut |pixel, v| all += film.add(pixel, v);
                        let own = scene.estimate(settings, pixel, index, &mut scratch, splat);
                        all += film.add(pixel, own);
                        film.batch.contributions.push(all as f32);
                    }
                }
                film.finish(count, &scratch)
            }

            /// Chains for the work of about `samples` samples, by a seed that no other batch has.
            pub fn chains(scene: &Scene<'_>, settings: &Settings, samples: u64) -> Batch {
                let mut scratch = Box::new(Scratch::<32>::new());
                let mut film = Film::new(scene);
                let mut sums = Vec::new();
                let mut total = 0.0;
                for index in 0..STARTS * samples {
                    let mean =
                        scene.bootstrap(settings, index, &mut scratch.view(scene), &mut |_, _| ());
                    total += f64::from(mean);
                    sums.push(total);
                    film.batch.contributions.push(3.0 * mean as f32);
                }
                let scale = total / sums.len() as f64;
                let steps = (STEPS * samples).div_ceil(CHAINS);
                for id in (0..CHAINS).filter(|_| total > 0.0) {
                    let xi = f64::from(Pcg::new(settings.seed, START, id).one(Purpose::Choice));
                    let place = (id as f64 + xi) / CHAINS as f64 * total;
                    let from = sums.partition_point(|&sum| sum <= place);
                    let from = from.min(sums.len() - 1) as u64;
                    let mut chain = Box::new(Chain::<VERTICES>::new());
                    chain.start(scene, settings, id, from, &mut scratch.view(scene));
                    let splat = &mut |pixel, v| {
                        film.add(pixel, v);
                    };
                    let view = &mut scratch.view(scene);
                    chain.advance(scene, settings, scale as Real, steps, view, splat);
                }
                film.finish(CHAINS * steps, &scratch)
            }
        }
    };
}

kernel!(single, etendue);
kernel!(double, etendue_f64);
