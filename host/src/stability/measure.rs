//! What is measured: the mean of an image over independent batches, in either precision, and what its contributions are like.

use super::sampling::{Batch, PARTS, double, single};
use super::{Found, Ready, ends};
use crate::reach;
use crate::render::{doubts, wide};
use crate::statistics::{Estimate, Tail};
use etendue::{Estimator, Settings};
use rayon::prelude::*;

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

/// What one precision gave.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Mean radiance of the image by channel.
    pub mean: [Estimate; 3],
    /// Means of the batches by channel.
    pub batches: [Vec<f64>; 3],
    /// The contributions of its samples; of chains, of those that they start from.
    pub tail: Tail,
    /// Values that the kernel rejected: NaN, infinite, negative.
    pub rejected: u64,
    /// Walks cut at the limit of steps.
    pub cut: u64,
    /// Light walks ended because their storage was full.
    pub full: u64,
    /// Values beyond what the film takes.
    pub refused: u64,
}

/// The settings with which an estimator runs.
pub fn settings(estimator: Estimator, max_edges: Option<u32>, seed: u64) -> Settings {
    Settings {
        estimator,
        max_edges,
        seed,
        ..Settings::default()
    }
}

/// Measures one estimator on one case.
pub(super) fn measure(
    ready: &Ready,
    estimator: Estimator,
    budget: &Budget,
) -> Result<Found, String> {
    let bytes = ready.blob.bytes();
    let case = &ready.case;
    let factor = case
        .expected
        .iter()
        .find(|e| e.estimator == estimator)
        .map_or(1.0, |e| e.factor);
    let passes = (case.samples as f64 * factor * budget.scale / BATCHES as f64)
        .round()
        .max(1.0) as u64;
    let scene = single::open(bytes)?;
    let settings = settings(estimator, ready.max_edges, budget.seed);
    let unreachable = reach::unreachable(&scene, &settings);
    if let Some(reason) = estimator.refuses(&scene) {
        return Ok(Found::refused(reason, unreachable));
    }
    let wide_scene = double::open(bytes)?;
    let wide_settings = wide(&settings);
    let pixels = scene.size().iter().map(|&n| u64::from(n)).product::<u64>();
    let per_batch = passes * pixels;
    let range = |b: u64| b * passes..(b + 1) * passes;
    // Any odd multiple: others' seeds are small.
    let seed = |b: u64| budget.seed ^ (b + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let chains = estimator == Estimator::Metropolis;
    let in_single = |scene: &etendue::Scene<'_>| {
        each_batch(&|b| {
            if chains {
                let seed = seed(b);
                single::chains(scene, &Settings { seed, ..settings }, per_batch)
            } else {
                single::samples(scene, &settings, range(b))
            }
        })
    };
    let narrow = in_single(&scene);
    let plain = match &ready.plain {
        None => Vec::new(),
        Some(blob) => in_single(&single::open(blob.bytes())?),
    };
    let wider = each_batch(&|b| {
        if chains {
            let seed = seed(b);
            let settings = etendue_f64::Settings {
                seed,
                ..wide_settings
            };
            double::chains(&wide_scene, &settings, per_batch)
        } else {
            double::samples(&wide_scene, &wide_settings, range(b))
        }
    });
    // A scene without colours has an image whose mean is the bootstrap's whatever chains do. Where they go says whether they go right.
    let parts = chains.then(|| {
        let settings = Settings {
            estimator: Estimator::Bidirectional,
            seed: seed(BATCHES),
            ..settings
        };
        let others = each_batch(&|b| single::samples(&scene, &settings, range(b)));
        [&narrow, &others].map(|batches| in_parts(batches))
    });
    let clipped = clipped([&narrow, &wider]);
    let narrow = Measured::of(narrow);
    let warnings = [
        doubts::tail(&narrow.tail, estimator),
        doubts::rules(&scene, &settings),
    ];
    Ok(Found {
        refused: None,
        unreachable,
        loss: doubts::cut(narrow.cut, estimator),
        warnings: warnings.into_iter().flatten().collect(),
        single: narrow,
        double: Measured::of(wider),
        plain: Measured::of(plain),
        clipped,
        parts,
        ends: ends::violations(&scene, &wide_scene, &settings, &wide_settings),
        channels: case.truth.value.len(),
    })
}

fn each_batch(make: &(dyn Fn(u64) -> Batch + Sync)) -> Vec<Batch> {
    (0..BATCHES).into_par_iter().map(make).collect()
}

fn in_parts(batches: &[Batch]) -> [Estimate; PARTS] {
    std::array::from_fn(|i| {
        let part: Vec<_> = batches.iter().map(|b| b.parts[i]).collect();
        Estimate::of(&part)
    })
}

/// Means of the batches' contributions, of which none counts for more than the mean of those that aren't 0: their variance is finite whatever the
/// tail is, so that the two precisions can be told apart where the means can't.
fn clipped(both: [&[Batch]; 2]) -> [Vec<f64>; 2] {
    let all = both[1].iter().flat_map(|b| &b.contributions);
    let (mut alive, mut sum) = (0u64, 0.0);
    for &x in all.filter(|&&x| x > 0.0) {
        alive += 1;
        sum += f64::from(x);
    }
    let most = sum / alive.max(1) as f64;
    both.map(|batches| {
        let mean = |b: &Batch| {
            let sum: f64 = b
                .contributions
                .iter()
                .map(|&x| f64::from(x).min(most))
                .sum();
            sum / b.contributions.len() as f64
        };
        batches.iter().map(mean).collect()
    })
}

impl Measured {
    fn of(batches: Vec<Batch>) -> Self {
        let mut all: Vec<f32> = Vec::new();
        let mut out = Self::default();
        for b in batches {
            for (means, mean) in out.batches.iter_mut().zip(b.mean) {
                means.push(mean);
            }
            all.extend(b.contributions);
            out.rejected += b.rejected;
            out.cut += b.cut;
            out.full += b.full;
            out.refused += b.refused;
        }
        out.mean = std::array::from_fn(|c| Estimate::of(&out.batches[c]));
        out.tail = Tail::of(&all);
        out
    }
}
