//! Low-discrepancy numbers: Sobol' points in two dimensions, Owen-scrambled, padded.

use super::{Pcg, Purpose, Sampler, Subpath, mix};
use crate::real::{Real, unit};

/// The samples of an element as a sequence: for each (subpath, vertex, purpose) the first two dimensions of Sobol', whose first
/// 2ᵏ points of either kind stratify the square in all ways at once. Each such pair has its own order of points and its own
/// scrambling, so that pairs are independent of each other (padding), and so are elements and seeds: an estimate is unbiased for any
/// number of samples, and best for a power of two.
///
/// No tables: the scramblings are hashes that are trees of bit flips (Burley 2020, "Practical hash-based Owen scrambling"), the second
/// dimension's matrix is Pascal's triangle mod 2.
#[derive(Clone, Debug)]
pub struct Sobol {
    /// Of (seed, element).
    key: u64,
    /// Of the vertex in hand.
    vertex_key: u64,
    /// Which point.
    index: u32,
    /// The walk in hand, and whether it is at its end.
    walk: usize,
    inner: usize,
    /// The farthest vertex of each walk.
    farthest: [u32; 2],
    /// Purposes that have had their pair, a bit each: at each walk's end, and at its farthest vertex.
    taken: [[u32; 2]; 2],
    /// What more is asked for: loops, branches, walks that begin again.
    more: Pcg,
}

impl Sobol {
    /// Sample `index` of the element (pixel, texel) `element` under `seed`.
    pub fn new(seed: u64, element: u64, index: u64) -> Self {
        // The sequence has 2³² points; then another one begins.
        let key = mix(mix(mix(seed ^ 0xa076_1d64_78bd_642f) ^ element) ^ (index >> 32));
        Self {
            key,
            vertex_key: key,
            index: index as u32,
            walk: 0,
            inner: 0,
            farthest: [0; 2],
            taken: [[0; 2]; 2],
            more: Pcg::new(seed, element, index),
        }
    }

    /// The key of the pair for `purpose` at the vertex in hand, unless it has been drawn from.
    #[inline(always)]
    fn pair(&mut self, purpose: Purpose) -> Option<u64> {
        let bit = 1 << purpose as u32;
        let taken = self.taken.get_mut(self.walk)?.get_mut(self.inner)?;
        if *taken & bit != 0 {
            return None;
        }
        *taken |= bit;
        Some(mix(self.vertex_key ^ purpose as u64))
    }
}

impl Sampler for Sobol {
    fn at(&mut self, subpath: Subpath, vertex: u32) {
        (self.walk, self.inner) = (subpath as usize, usize::from(vertex > 0));
        if let (Some(farthest), Some([_, taken])) = (
            self.farthest.get_mut(self.walk),
            self.taken.get_mut(self.walk),
        ) {
            if vertex > *farthest {
                (*farthest, *taken) = (vertex, 0);
            } else if vertex > 0 && vertex < *farthest {
                // It has been here before: branches, a second walk.
                *taken = u32::MAX;
            }
        }
        self.vertex_key = self.key ^ mix(u64::from(vertex) << 1 | subpath as u64);
    }

    fn one(&mut self, purpose: Purpose) -> Real {
        match self.pair(purpose) {
            Some(key) => unit(first(shuffled(self.index, key as u32), (key >> 32) as u32)),
            None => self.more.one(purpose),
        }
    }

    fn two(&mut self, purpose: Purpose) -> [Real; 2] {
        let Some(key) = self.pair(purpose) else {
            return self.more.two(purpose);
        };
        let index = shuffled(self.index, key as u32);
        let scrambling = mix(key);
        [
            unit(first(index, (key >> 32) as u32)),
            unit(second(index, scrambling as u32)),
        ]
    }
}

/// A permutation of the points that takes aligned blocks of 2ᵏ to aligned blocks.
#[inline(always)]
fn shuffled(index: u32, seed: u32) -> u32 {
    flip(index.reverse_bits(), seed).reverse_bits()
}

/// The first dimension, van der Corput's sequence, scrambled.
#[inline(always)]
fn first(index: u32, seed: u32) -> u32 {
    flip(index, seed).reverse_bits()
}

/// The second dimension, scrambled. Bit i of the matrix' row j is C(j, i) mod 2, which is 1 where i's bits are among j's (Lucas), so that its
/// product is a sum over supersets.
#[inline(always)]
fn second(index: u32, seed: u32) -> u32 {
    let mut bits = index;
    bits ^= (bits >> 1) & 0x5555_5555;
    bits ^= (bits >> 2) & 0x3333_3333;
    bits ^= (bits >> 4) & 0x0f0f_0f0f;
    bits ^= (bits >> 8) & 0x00ff_00ff;
    bits ^= bits >> 16;
    flip(bits, seed).reverse_bits()
}

/// Owen's scrambling of a number whose bits are in reverse: each bit is flipped or not by a hash of those below it. The hash is Laine & Karras's
/// (2011) with the constants that Vegdahl found (2021).
#[inline(always)]
fn flip(mut bits: u32, seed: u32) -> u32 {
    bits ^= bits.wrapping_mul(0x3d20_adea);
    bits = bits.wrapping_add(seed);
    bits = bits.wrapping_mul((seed >> 16) | 1);
    bits ^= bits.wrapping_mul(0x0552_6c56);
    bits ^ bits.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::Sobol;
    use crate::random::{Purpose, Sampler, Subpath};
    use crate::real::Real;

    fn at(seed: u64, index: u64, vertex: u32) -> Sobol {
        let mut numbers = Sobol::new(seed, 17, index);
        numbers.at(Subpath::Sensor, vertex);
        numbers
    }

    /// Of 2^m points one lies in each elementary interval of area 2^-m, whatever its shape: a (0, m, 2)-net, also from other starts.
    #[test]
    fn every_power_of_two_is_stratified_in_all_ways() {
        const M: u32 = 8;
        for (seed, vertex, first) in [(0, 1, 0), (7, 3, 0), (1, 2, 256), (9, 1, 512)] {
            for columns in 0..=M {
                let mut seen = [false; 1 << M];
                for index in first..first + (1 << M) {
                    let [x, y] = at(seed, index, vertex).two(Purpose::Direction);
                    let scale = |n: u32| (1u32 << n) as Real;
                    let (column, row) =
                        ((x * scale(columns)) as u32, (y * scale(M - columns)) as u32);
                    let cell = &mut seen[(row << columns | column) as usize];
                    assert!(!*cell, "2^{columns} columns: {column}, {row} twice");
                    *cell = true;
                }
            }
        }
    }

    /// Pairs for different purposes, vertices, elements and seeds have nothing to do with each other: the correlation of 4096 points is below
    /// 5 standard deviations, in each of 4 pairings.
    #[test]
    #[allow(clippy::useless_conversion)] // in double precision
    fn pairs_are_independent() {
        const N: u64 = 4096;
        let other = |index: u64, which: u32| match which {
            0 => at(3, index, 1).one(Purpose::Position),
            1 => at(3, index, 2).one(Purpose::Direction),
            2 => at(4, index, 1).one(Purpose::Direction),
            _ => {
                let mut numbers = Sobol::new(3, 18, index);
                numbers.at(Subpath::Sensor, 1);
                numbers.one(Purpose::Direction)
            }
        };
        for which in 0..4 {
            let sum: f64 = (0..N)
                .map(|i| {
                    let x = f64::from(at(3, i, 1).one(Purpose::Direction)) - 0.5;
                    x * (f64::from(other(i, which)) - 0.5)
                })
                .sum();
            let deviation = sum / (N as f64 / 144.0).sqrt();
            assert!(deviation.abs() < 5.0, "{which}: {deviation}");
        }
    }

    /// What is asked for again at a vertex, or at a vertex that has been left, is another number.
    #[test]
    fn nothing_is_given_twice() {
        let mut numbers = at(1, 5, 1);
        let first = numbers.two(Purpose::Direction);
        assert_ne!(first, numbers.two(Purpose::Direction));
        numbers.at(Subpath::Light, 1);
        assert_ne!(first, numbers.two(Purpose::Direction));
        numbers.at(Subpath::Sensor, 2);
        let second = numbers.two(Purpose::Direction);
        numbers.at(Subpath::Sensor, 1);
        assert_ne!(first, numbers.two(Purpose::Direction));
        numbers.at(Subpath::Sensor, 2);
        assert_ne!(second, numbers.two(Purpose::Direction));
    }
}
