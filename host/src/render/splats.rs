//! What samples give to pixels other than their own.

use super::{RenderError, film};
use etendue::film::{Refused, Step, Sum};
use etendue::spectrum::Rgb;
use std::hint::black_box;

/// Contributions that wait until they are added: enough that the caches' misses of one batch overlap, few enough to stay in the
/// nearest cache themselves.
const BATCH: usize = 64;

/// A film that light is splatted on. Its pixels are hit in no order, and seldom in the cache: one contribution after the other, each would wait for
/// memory (a tenth of the time of `bidirectional`, at 256 × 256).
pub(super) struct Splats {
    step: Step,
    columns: usize,
    sums: Vec<Sum>,
    waiting: Vec<(usize, Rgb)>,
    refused: Refused,
}

impl Splats {
    /// Black, or no film at all for an estimator that gives nothing.
    ///
    /// # Errors
    /// If there isn't enough memory.
    pub fn new(step: Step, size: [u32; 2], wanted: bool) -> Result<Self, RenderError> {
        Ok(Self {
            step,
            columns: size[0] as usize,
            sums: if wanted { film(size)? } else { Vec::new() },
            waiting: Vec::with_capacity(BATCH),
            refused: Refused::default(),
        })
    }

    /// Adds `value` to a pixel, now or later.
    #[inline]
    pub fn add(&mut self, [x, y]: [u32; 2], value: Rgb) {
        let at = y as usize * self.columns + x as usize;
        if at < self.sums.len() {
            self.waiting.push((at, value));
        }
        if self.waiting.len() >= BATCH {
            self.settle();
        }
    }

    /// Adds all that waits.
    fn settle(&mut self) {
        // Nothing depends on what is read here, so that the processor reads ahead. A sum may lie in two cache lines.
        let sums = &self.sums;
        let read = |&(at, _): &(usize, Rgb)| sums[at][0] as u64 ^ sums[at][2] as u64;
        black_box(self.waiting.iter().map(read).fold(0, |all, x| all ^ x));
        for (at, value) in self.waiting.drain(..) {
            self.step.add(&mut self.sums[at], value, &mut self.refused);
        }
    }

    /// The film, and what it could not take.
    pub fn finish(mut self) -> (Vec<Sum>, Refused) {
        self.settle();
        (self.sums, self.refused)
    }
}
