//! How many samples a pixel gets for each pass: one, or more where they buy more.

use super::RenderError;
use super::crew::{Run, each_once};
use super::{CAPACITY, lock};
use etendue::random::Sequence;
use etendue::{Counters, Scene, Scratch, Settings};
use std::sync::Mutex;

/// Columns and rows of a block of pixels, which have a rate in common.
const SIDE: u32 = 4;
/// Samples of a pixel that the rates are found by.
const SAMPLES: u64 = 4;
/// Of this number and more are those samples: no render gets there.
const FIRST: u64 = 1 << 52;
/// Steps of a rate in a sample.
const ONE: u64 = 1 << 8;
/// A block has at most so many times the mean's samples, and no fewer than half: what four samples missed may still be there.
const MOST: f64 = 8.0;

/// Samples of a pixel per pass, by blocks.
pub(super) struct Rates {
    /// In steps of 1/[`ONE`]; empty: one sample everywhere.
    blocks: Vec<u64>,
    columns: usize,
}

impl Rates {
    /// One sample everywhere.
    pub fn uniform() -> Self {
        Self {
            blocks: Vec::new(),
            columns: 0,
        }
    }

    /// Samples of a pixel after `passes`: one at least, after one.
    pub fn count(&self, [x, y]: [u32; 2], passes: u64) -> u64 {
        let block = (y / SIDE) as usize * self.columns + (x / SIDE) as usize;
        match self.blocks.get(block) {
            None => passes,
            Some(rate) => (rate * passes).div_ceil(ONE),
        }
    }

    /// Light walks, one for each sample, over pixels: what splats are to be divided and multiplied by. The kernel has scaled them by
    /// 1/pixels, so that without rates only the passes are left to divide by.
    pub fn walks(&self, passes: u64, [width, height]: [u32; 2]) -> (u64, u64) {
        if self.blocks.is_empty() {
            return (passes, 1);
        }
        let row = |y| (0..width).map(move |x| self.count([x, y], passes));
        let walks = (0..height).flat_map(row).sum();
        (walks, u64::from(width) * u64::from(height))
    }

    /// The rates that make the most of the effort: in proportion to the standard deviation of a sample's own value, and one over the root of what it costs
    /// (Neyman 1934, §5). By samples of their own, which are thrown away: an image whose own samples said how many there should be would be biased.
    ///
    /// # Errors
    /// If the caller's threads leave a job out.
    pub fn found(
        scene: &Scene<'_>,
        settings: &Settings,
        run: &Run<'_>,
    ) -> Result<Self, RenderError> {
        // Points that know of each other would have another variance.
        let settings = &Settings {
            sequence: Sequence::Independent,
            ..*settings
        };
        let size @ [width, height] = scene.size();
        let (columns, rows) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
        let found: Vec<_> = (0..rows).map(|_| Mutex::new(Vec::new())).collect();
        each_once(run, rows as usize, &|row| {
            let mut scratch = Box::new(Scratch::new());
            let blocks = (0..columns).map(|column| {
                let corner = [SIDE * column, SIDE * row as u32];
                worth(scene, settings, corner, size, &mut scratch)
            });
            *lock(&found[row]) = blocks.collect();
        })?;
        let worths: Vec<f64> = found.iter().flat_map(|row| lock(row).clone()).collect();
        let mean = worths.iter().sum::<f64>() / worths.len() as f64;
        if mean <= 0.0 {
            return Ok(Self::uniform());
        }
        let rate = |worth: &f64| ((0.5 + 0.5 * worth / mean).min(MOST) * ONE as f64) as u64;
        Ok(Self {
            blocks: worths.iter().map(rate).collect(),
            columns: columns as usize,
        })
    }
}

/// Standard deviation of a sample over the root of its cost in rays, of a block of pixels.
fn worth(
    scene: &Scene<'_>,
    settings: &Settings,
    [left, top]: [u32; 2],
    [width, height]: [u32; 2],
    scratch: &mut Scratch<CAPACITY>,
) -> f64 {
    let (mut variance, mut pixels) = (0.0, 0.0);
    scratch.counters = Counters::default();
    for y in top..height.min(top + SIDE) {
        for x in left..width.min(left + SIDE) {
            let (mut sum, mut squares) = ([0.0; 3], 0.0);
            for index in FIRST..FIRST + SAMPLES {
                let value = scene.estimate(settings, [x, y], index, scratch, &mut |_, _| ());
                for (sum, v) in sum.iter_mut().zip(value.to_array().map(f64::from)) {
                    *sum += v;
                    squares += v * v;
                }
            }
            let square_of_sum: f64 = sum.iter().map(|s| s * s).sum();
            variance += (squares - square_of_sum / SAMPLES as f64).max(0.0);
            pixels += 1.0;
        }
    }
    let cost = (scratch.counters.rays() as f64 / pixels).max(1.0);
    (variance / pixels / cost).sqrt()
}
