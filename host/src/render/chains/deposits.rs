//! What chains give to pixels, for as long as their start is the same.

use crate::render::grey;
use etendue::Rgb;

/// Columns and rows after which pixels are taken for the same: a chain seldom gets so far.
const SIDE: usize = 32;

/// What chains from one sample gave to each pixel.
pub(super) struct Deposits(Box<[f32; SIDE * SIDE]>);

impl Deposits {
    /// Nothing.
    pub fn new() -> Self {
        Self(Box::new([0.0; SIDE * SIDE]))
    }

    /// Adds what a pixel is given.
    pub fn add(&mut self, [x, y]: [u32; 2], value: Rgb) {
        let at = [x, y].map(|i| i as usize % SIDE);
        self.0[at[1] * SIDE + at[0]] += grey(value);
    }

    /// The sum of their squares; all of them are forgotten.
    pub fn squares(&mut self) -> f64 {
        let squares = self.0.iter().map(|&d| f64::from(d) * f64::from(d)).sum();
        self.0.fill(0.0);
        squares
    }
}
