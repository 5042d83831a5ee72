//! Blocks of the image, and how the work is shared out among them.

use super::Mean;
use crate::render::lock;
use etendue::random::{Pcg, Purpose, Sampler};
use std::sync::Mutex;

/// Columns and rows of a block.
const SIDE: u32 = 8;
/// The most samples of a pixel in a pass.
const MOST: u64 = 16;
/// How many passes of the mean block are taken for known of each.
const PRIOR: f64 = 8.0;
/// The stream that says where energy begins to be gathered.
const BEGIN: u64 = 0x6265_6769_6e00_0000;

/// A block of pixels, whose samples' energy is gathered, and what came of it.
///
/// In each pass it has `rate` samples of each of its pixels, and chains for their energy, all of which count 1/`rate`: a pass gives the same in the mean
/// whatever the rates are. They are chosen between passes, by those before: as all passes count the same, that leaves the image as it is in the mean.
pub(super) struct Block {
    pub rate: u64,
    /// Samples of each pixel.
    pub samples: u64,
    /// Energy, as a share of what makes a chain.
    gathered: f64,
    pub chains: u64,
    pub accepted: f64,
    pub mean: Mean,
    /// What passes with a rate of 1 would have taken, in samples, and what they would have had of variance.
    time: f64,
    variance: f64,
}

impl Block {
    /// How many there are in an image, in rows and columns of them.
    pub fn count(size: [u32; 2]) -> [u32; 2] {
        size.map(|n| n.div_ceil(SIDE))
    }

    /// Nothing yet.
    pub fn new() -> Self {
        Self {
            rate: 1,
            samples: 0,
            gathered: 0.0,
            chains: 0,
            accepted: 0.0,
            mean: Mean::default(),
            time: 0.0,
            variance: 0.0,
        }
    }

    /// The pixels of block `id` of an image of that size.
    pub fn pixels(id: u64, size: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        let columns = u64::from(Self::count(size)[0]);
        let corner = [id % columns, id / columns].map(|i| i as u32 * SIDE);
        let [[left, right], [top, bottom]] =
            [0, 1].map(|i| [corner[i], size[i].min(corner[i] + SIDE)]);
        (top..bottom).flat_map(move |y| (left..right).map(move |x| [x, y]))
    }

    /// Gathers `energy`, as a share of what makes a chain: how many it makes now, with what there was.
    pub fn gather(&mut self, energy: f64) -> u64 {
        self.gathered += energy;
        let chains = self.gathered.floor();
        self.gathered -= chains;
        chains as u64
    }

    /// Notes a sample, the time of the chains that were started from it, in samples, and the sum of the squares of what they gave to pixels.
    pub fn note(&mut self, time: f64, squares: f64) {
        let rate = self.rate as f64;
        self.time += (1.0 + time) / rate;
        // At a rate of 1 one sample stands for `rate` of them, and counts `rate` times as much.
        self.variance += squares * rate;
    }

    /// Chooses all rates after so many passes, a power of 2 each: the variance of the whole is least for its time if each is in proportion to the
    /// root of the block's own variance over its time (Neyman 1934, §5). Energy is gathered anew from anywhere, so that a sample starts as many
    /// chains in the mean as it has energy for, whatever was gathered and led to the rates. On door-ajar.xml this is worth 1.09 of the efficiency
    /// after 16 passes, 1.2 after 48.
    pub fn share_out(blocks: &[Mutex<Self>], passes: u64, seed: u64) {
        let sum = |of: &dyn Fn(&Self) -> f64| blocks.iter().map(|b| of(&lock(b))).sum::<f64>();
        let (all, variance) = (sum(&|b| b.time), sum(&|b| b.variance));
        // Nothing over nothing, before the first pass: no block is worth more than another.
        let known = PRIOR / (passes.max(1) * blocks.len() as u64) as f64;
        let worth = |b: &Self| ((b.variance + known * variance) / (b.time + known * all)).sqrt();
        let mean = sum(&|b| b.time * worth(b)) / all;
        for (block, id) in blocks.iter().zip(0..) {
            let block = &mut *lock(block);
            let worth = worth(block) / mean;
            block.rate = 1;
            while block.rate < MOST && worth * worth > (2 * block.rate * block.rate) as f64 {
                block.rate *= 2;
            }
            let begin = Pcg::new(seed, BEGIN, passes << 32 | id).one(Purpose::Choice);
            block.gathered = f64::from(begin);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Block;
    use std::sync::Mutex;

    fn blocks(n: usize) -> Vec<Mutex<Block>> {
        (0..n).map(|_| Mutex::new(Block::new())).collect()
    }

    fn rates(blocks: &[Mutex<Block>]) -> Vec<u64> {
        blocks.iter().map(|b| b.lock().unwrap().rate).collect()
    }

    #[test]
    fn blocks_cover_the_image_once() {
        for size @ [width, height] in [[1, 1], [8, 8], [33, 17], [15, 40]] {
            let mut seen = vec![0; (width * height) as usize];
            let [columns, rows] = Block::count(size).map(u64::from);
            for [x, y] in (0..columns * rows).flat_map(|id| Block::pixels(id, size)) {
                seen[(y * width + x) as usize] += 1;
            }
            assert!(seen.iter().all(|&n| n == 1), "{width} × {height}");
        }
    }

    /// 16 times the variance for its time is worth 4 times the samples, and rates stay what they are when they are followed.
    #[test]
    fn rates_go_by_the_root_of_variance_over_time() {
        let blocks = blocks(64);
        Block::share_out(&blocks, 0, 1);
        assert_eq!(rates(&blocks), [1; 64]);
        for passes in 1..=1 << 10 {
            for (block, i) in blocks.iter().zip(0..) {
                let block = &mut *block.lock().unwrap();
                for _ in 0..block.rate {
                    let variance = if i == 0 { 16.0 } else { 1.0 };
                    // Of a sample that counts for less.
                    block.note(3.0, variance / (block.rate * block.rate) as f64);
                }
            }
            Block::share_out(&blocks, passes, 1);
        }
        let rates = rates(&blocks);
        assert_eq!((rates[0], &rates[1..]), (4, &[1; 63][..]));
    }

    /// Chains start as often as samples have brought energy for, in the mean, though it is their starts that rates follow from. Of 4000 renders;
    /// false alarms: 1 in 15,000 (4 standard errors).
    #[test]
    fn rates_leave_the_energy_as_it_is() {
        const RENDERS: u64 = 4000;
        const ENERGY: f64 = 0.02;
        let [mut sum, mut squares] = [0.0; 2];
        for seed in 0..RENDERS {
            let blocks = blocks(64);
            Block::share_out(&blocks, 0, seed);
            let mut surplus = 0.0;
            for passes in 1..=16u64 {
                for block in &blocks {
                    let block = &mut *block.lock().unwrap();
                    let share = 1.0 / block.rate as f64;
                    for _ in 0..block.rate {
                        let chains = block.gather(ENERGY) as f64;
                        surplus += (chains - ENERGY) * share;
                        block.note(chains, chains * share * share);
                    }
                }
                if passes.is_power_of_two() {
                    Block::share_out(&blocks, passes, seed);
                }
            }
            sum += surplus;
            squares += surplus * surplus;
        }
        let error = squares.sqrt();
        assert!(sum.abs() < 4.0 * error, "{sum} ± {error}");
    }
}
