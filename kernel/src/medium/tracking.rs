//! Tracking through tentative collisions: a Poisson process along the way, of a rate that is constant in each box of the
//! majorants, so that empty space costs one step a box. Woodcock's for flights (Woodcock et al. 1965), ratio tracking and
//! residual ratio tracking for transmittance (Novák, Selle & Jarosz 2014).

use super::grid::Passage;
use super::lattice::{Cell, Cells};
use super::{Carried, Collision, Flight, exponential, fine};
use crate::random::Sampler;
use crate::real::{Real, exp};
use crate::spectrum::Spectrum;

/// Far above any weight of random numbers.
const LARGEST: Real = 1e30;

/// The points of the process.
struct Tentative {
    boxes: Cells,
    /// Where we are, the rate from there on, and where that ends.
    t: Real,
    rate: Real,
    end: Real,
    /// Optical depth, in terms of the rate, to the next one.
    depth: Real,
}

impl Tentative {
    fn new<S: Spectrum>(p: &Passage<'_, S>, sampler: &mut impl Sampler) -> Self {
        let start = p.line.start;
        Self {
            boxes: p.line.boxes(p.boxes()),
            t: start,
            rate: 0.0,
            end: start,
            depth: exponential(sampler),
        }
    }

    /// The next one and the rate there, if there is one; `enter` is told of each box on the way there and says its rate, ≥ 0.
    #[inline(always)]
    fn next(
        &mut self,
        mut enter: impl FnMut(&Cell) -> Real,
        sampler: &mut impl Sampler,
    ) -> Option<(Real, Real)> {
        loop {
            let reach = self.rate * (self.end - self.t);
            if self.depth < reach {
                self.t = (self.t + self.depth / self.rate).min(self.end);
                self.depth = exponential(sampler);
                return Some((self.t, self.rate));
            }
            self.depth -= reach;
            let cell = self.boxes.next()?;
            (self.t, self.end) = (cell.start, cell.end);
            self.rate = enter(&cell);
        }
    }
}

/// Counts one down.
#[inline(always)]
fn spend(steps: &mut u32) -> bool {
    match steps.checked_sub(1) {
        Some(left) => {
            *steps = left;
            true
        }
        None => false,
    }
}

impl<S: Spectrum> Passage<'_, S> {
    /// Woodcock's tracking: [`super::Way::fly`]. That a majorant is the same for all channels cancels in all densities but
    /// that of the last one's distance.
    pub fn fly(
        &self,
        lead: usize,
        carried: &mut Carried<S>,
        glow: &mut S,
        steps: &mut u32,
        sampler: &mut impl Sampler,
    ) -> Flight<S> {
        let mut tentative = Tentative::new(self, sampler);
        while let Some((t, majorant)) = tentative.next(|cell| self.majorant(cell), sampler) {
            if !spend(steps) {
                return Flight::Cut;
            }
            let inverse = 1.0 / majorant;
            let sigma: S = self.sigma(t);
            let emission = self.emission(t, sigma);
            *glow += carried.throughput * emission * inverse;
            // More than 1 by rounding only.
            let real = sigma.map(|x| (x * inverse).min(1.0));
            if fine(sampler) < real.channel(lead) {
                carried.draw(S::grey(inverse), real);
                return Flight::Collided(Collision {
                    t,
                    scattering: self.scattering(t, sigma),
                    emission,
                });
            }
            let null = real.map(|p| 1.0 - p);
            carried.draw(null, null);
        }
        Flight::Through
    }

    /// Ratio tracking.
    pub fn transmittance(&self, steps: &mut u32, sampler: &mut impl Sampler) -> S {
        let mut tau = S::WHITE;
        let mut tentative = Tentative::new(self, sampler);
        while let Some((t, majorant)) = tentative.next(|cell| self.majorant(cell), sampler) {
            if !spend(steps) {
                return S::BLACK;
            }
            let inverse = 1.0 / majorant;
            tau *= self.sigma(t).map(|x| 1.0 - (x * inverse).min(1.0));
            if tau.is_black() {
                break;
            }
        }
        tau
    }

    /// Residual ratio tracking, for an extinction of one channel. The control μ is the extinction midway through each box: what
    /// differs from it is at most max(μ, μ̄ − μ), the rate of its process, so that no weight is negative. Where the box is
    /// empty there it is ratio tracking, where it is full everywhere all weights are 1.
    pub fn residual_transmittance(&self, steps: &mut u32, sampler: &mut impl Sampler) -> S {
        let mut tau = S::WHITE;
        // From where on the control's own optical depth isn't in τ yet, and what of it is from boxes before.
        let (mut control, mut from, mut before) = (0.0, self.line.start, 0.0);
        let mut tentative = Tentative::new(self, sampler);
        loop {
            let enter = |cell: &Cell| {
                before += control * (cell.start - from);
                from = cell.start;
                let majorant = self.majorant(cell);
                control = if majorant > 0.0 {
                    let middle: S = self.sigma(0.5 * (cell.start + cell.end));
                    middle.max_channel().min(majorant)
                } else {
                    0.0
                };
                control.max(majorant - control)
            };
            let Some((t, rate)) = tentative.next(enter, sampler) else {
                before += control * (self.line.end - from);
                return tau * exp(-before);
            };
            if !spend(steps) {
                return S::BLACK;
            }
            let controlled = exp(-before - control * (t - from));
            (from, before) = (t, 0.0);
            let residual = |x: Real| controlled * (1.0 - (x - control) / rate).max(0.0);
            tau *= self.sigma(t).map(residual);
            // Numbers that aren't random may let it grow.
            tau = tau.map(|x| x.min(LARGEST));
            if tau.is_black() {
                return S::BLACK;
            }
        }
    }
}
