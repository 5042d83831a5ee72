//! What is measured: the mean of an image over independent batches, in either precision, and what its contributions are like.

use super::{Found, Ready, ends, scenes};
use crate::reach;
use crate::statistics::{Estimate, Tail};
use rayon::prelude::*;

/// An estimator, by the name that `--estimator` has for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the kernel's
pub enum Method {
    Path,
    Light,
    Bidirectional,
    Distributed,
    Quadrature,
    QuadratureAndPath,
}

impl Method {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Path, "path"),
        (Self::Light, "light"),
        (Self::Bidirectional, "bidirectional"),
        (Self::Distributed, "distributed"),
        (Self::Quadrature, "quadrature"),
        (Self::QuadratureAndPath, "quadrature+path"),
    ];

    /// By its name.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, n)| *n == name).map(|(m, _)| *m)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(m, _)| *m == self)
            .map_or("", |(_, n)| n)
    }
}

impl Method {
    /// The kernel's settings with which it runs.
    pub fn settings(self, max_edges: Option<u32>, seed: u64) -> etendue::Settings {
        single::settings(self, max_edges, seed)
    }
}

/// How much is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Factor for all numbers of samples.
    pub scale: f64,
    /// Selects the random numbers.
    pub seed: u64,
}

/// Independent batches that an image's mean is taken over.
pub const BATCHES: u64 = 32;

/// Which kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// f32.
    Single,
    /// f64.
    Double,
}

/// What one precision gave.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Mean radiance of the image by channel.
    pub mean: [Estimate; 3],
    /// Means of the batches by channel.
    pub batches: [Vec<f64>; 3],
    /// The contributions of its samples.
    pub tail: Tail,
    /// Values that the kernel rejected: NaN, infinite, negative.
    pub rejected: u64,
    /// Walks cut at the limit of steps.
    pub cut: u64,
    /// Light walks ended because their storage was full.
    pub full: u64,
    /// Values beyond what the film takes.
    pub refused: u64,
    /// Samples, pixels times passes.
    pub samples: u64,
}

/// A batch of passes over the image.
#[derive(Default)]
pub(super) struct Batch {
    sum: [f64; 3],
    contributions: Vec<f32>,
    rejected: u64,
    cut: u64,
    full: u64,
    refused: u64,
}

macro_rules! kernel {
    ($name:ident, $kernel:ident) => {
        pub(super) mod $name {
            use super::{Batch, Method};
            use $kernel::estimate::Estimator;
            use $kernel::film::{Refused, Step, Sum};
            use $kernel::{Rgb, Scene, Scratch, Settings};

            /// The kernel's name of a method.
            pub fn estimator(method: Method) -> Estimator {
                match method {
                    Method::Path => Estimator::Path,
                    Method::Light => Estimator::Light,
                    Method::Bidirectional => Estimator::Bidirectional,
                    Method::Distributed => Estimator::Distributed,
                    Method::Quadrature => Estimator::Quadrature,
                    Method::QuadratureAndPath => Estimator::QuadratureAndPath,
                }
            }

            /// The settings of a run.
            pub fn settings(method: Method, max_edges: Option<u32>, seed: u64) -> Settings {
                Settings {
                    estimator: estimator(method),
                    max_edges,
                    seed,
                    ..Settings::default()
                }
            }

            /// The passes `passes` over the image.
            pub fn batch(
                scene: &Scene<'_>,
                settings: &Settings,
                passes: std::ops::Range<u64>,
            ) -> Batch {
                let [w, h] = scene.size();
                let mut scratch = Box::new(Scratch::<32>::new());
                let step = Step::new(scene.film_exponent());
                let (mut out, mut refused) = (Batch::default(), Refused::default());
                for index in passes {
                    for y in 0..h {
                        for x in 0..w {
                            let mut all = [0.0f64; 3];
                            let mut sum: Sum = [0; 3];
                            let mut add = |_: [u32; 2], v: Rgb| {
                                step.add(&mut sum, v, &mut refused);
                                for (a, v) in all.iter_mut().zip(v.to_array()) {
                                    *a += f64::from(v);
                                }
                            };
                            let own =
                                scene.estimate(settings, [x, y], index, &mut scratch, &mut add);
                            add([x, y], own);
                            out.sum.iter_mut().zip(all).for_each(|(s, a)| *s += a);
                            out.contributions.push(all.iter().sum::<f64>() as f32);
                        }
                    }
                }
                out.rejected = scratch.counters.rejected;
                out.cut = scratch.counters.cut_walks;
                out.full = scratch.counters.full_walks;
                out.refused = refused.saturated + refused.invalid;
                out
            }

            /// What `bytes` is a blob of.
            pub fn open(bytes: &[u8]) -> Result<Scene<'_>, String> {
                Scene::open(bytes).map_err(|e| e.to_string())
            }
        }
    };
}

kernel!(single, etendue);
kernel!(double, etendue_f64);

/// Measures one estimator on one case.
pub(super) fn measure(ready: &Ready, method: Method, budget: &Budget) -> Result<Found, String> {
    let bytes = ready.blob.bytes();
    let case = &ready.case;
    let factor = case
        .expected
        .iter()
        .find(|e| e.method == method)
        .map_or(1.0, |e| e.factor);
    let passes = (case.samples as f64 * factor * budget.scale / BATCHES as f64)
        .round()
        .max(1.0) as u64;
    let depth = scenes::advised_depth(case);
    let scene = single::open(bytes)?;
    let settings = single::settings(method, depth, budget.seed);
    let unreachable = reach::unreachable(&scene, &settings);
    if let Some(reason) = settings.estimator.refuses(&scene) {
        return Ok(Found::refused(reason, unreachable));
    }
    let wide = double::open(bytes)?;
    let wide_settings = double::settings(method, depth, budget.seed);
    let range = |b: u64| b * passes..(b + 1) * passes;
    let pixels = scene.size().iter().map(|&n| u64::from(n)).product::<u64>();
    let per_batch = passes * pixels;
    let narrow: Vec<_> = (0..BATCHES)
        .into_par_iter()
        .map(|b| single::batch(&scene, &settings, range(b)))
        .collect();
    let wider: Vec<_> = (0..BATCHES)
        .into_par_iter()
        .map(|b| double::batch(&wide, &wide_settings, range(b)))
        .collect();
    Ok(Found {
        refused: None,
        unreachable,
        single: Measured::of(narrow, per_batch),
        double: Measured::of(wider, per_batch),
        ends: ends::violations(&scene, &wide, &settings, &wide_settings),
        channels: case.truth.value.len(),
    })
}

impl Measured {
    fn of(batches: Vec<Batch>, per_batch: u64) -> Self {
        let mut all: Vec<f32> = Vec::new();
        let mut out = Self {
            samples: per_batch * batches.len() as u64,
            ..Self::default()
        };
        for b in batches {
            for (means, sum) in out.batches.iter_mut().zip(b.sum) {
                means.push(sum / per_batch as f64);
            }
            all.extend(b.contributions);
            out.rejected += b.rejected;
            out.cut += b.cut;
            out.full += b.full;
            out.refused += b.refused;
        }
        out.mean = std::array::from_fn(|c| Estimate::of(&out.batches[c]));
        out.tail = Tail::of(&mut all);
        out
    }
}
