//! Regular tracking: through the texels' cells one by one. Trilinear extinction along a line is a cubic in each, whose
//! integral two-point Gauss–Legendre quadrature gives exactly.

use super::grid::{Passage, THINNEST};
use super::lattice::{Cell, Cells};
use super::{Carried, Collision, Flight, exponential, fine};
use crate::random::Sampler;
use crate::real::{Real, exp, expm1, log1p};
use crate::spectrum::Spectrum;

/// Newton's or halving steps at most; halving alone would use up single precision in 24.
const STEPS: u32 = 48;
/// Optical depth from which on nothing is left in either precision.
const BLACK: Real = 800.0;

impl<S: Spectrum> Passage<'_, S> {
    /// Free flight by inverting the optical depth: [`super::Way::fly`].
    pub fn fly_regularly(
        &self,
        lead: usize,
        carried: &mut Carried<S>,
        glow: &mut S,
        sampler: &mut impl Sampler,
    ) -> Flight<S> {
        let before = carried.throughput;
        let glows = self.glows();
        let target = exponential(sampler);
        let mut depth = S::BLACK;
        let mut flight = Flight::Through;
        for cell in self.cells() {
            let beyond = self.depth(cell.start, cell.end);
            if glows {
                *glow += before * self.shine(&cell, depth, beyond, sampler);
            }
            let after = depth + beyond;
            if matches!(flight, Flight::Through) && after.channel(lead) > target {
                flight = self.collide(&cell, lead, target, depth, beyond, carried);
                if !glows {
                    return flight;
                }
            }
            depth = after;
            if depth.map(|d| if d < BLACK { 1.0 } else { 0.0 }).is_black() {
                break;
            }
        }
        if matches!(flight, Flight::Through) {
            let f = relative(depth, lead, target);
            carried.draw(f, f);
        }
        flight
    }

    /// τ.
    pub fn exact_transmittance(&self) -> S {
        let mut depth = S::BLACK;
        for cell in self.cells() {
            depth += self.depth(cell.start, cell.end);
        }
        depth.map(|d| exp(-d))
    }

    /// The cells in which extinction is one polynomial.
    #[inline(always)]
    fn cells(&self) -> Cells {
        let grid = self.extinction;
        if grid.nearest == 1 {
            self.line.boxes(grid.size)
        } else {
            self.line.between(grid.size)
        }
    }

    /// ∫σ_t from `a` to `b`, both in one cell.
    #[inline]
    fn depth(&self, a: Real, b: Real) -> S {
        /// Half the distance between the two nodes: √(1/12).
        #[allow(clippy::excessive_precision)] // not excessive in the double-precision package
        const NODE: Real = 0.288_675_134_594_812_9;
        let (middle, width) = (0.5 * (a + b), b - a);
        let sum = self.sigma(middle - NODE * width) + self.sigma(middle + NODE * width);
        sum * (0.5 * width)
    }

    /// The collision in `cell`, where the leading channel's optical depth from the way's start is `target`; up to the cell
    /// it was `depth`, within it is `beyond`.
    fn collide(
        &self,
        cell: &Cell,
        lead: usize,
        target: Real,
        depth: S,
        beyond: S,
        carried: &mut Carried<S>,
    ) -> Flight<S> {
        let rest = target - depth.channel(lead);
        let (mut low, mut high) = (cell.start, cell.end);
        let mut t = low + (high - low) * (rest / beyond.channel(lead)).min(1.0);
        for _ in 0..STEPS {
            let off = self.depth(cell.start, t).channel(lead) - rest;
            if off > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let newton = t - off / self.sigma(t).channel(lead);
            // Also where the slope is 0.
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            let step = (next - t).abs();
            t = next;
            if step <= Real::EPSILON * t {
                break;
            }
        }
        // What rounding has put into a vacuum will be black by its σ_s.
        let sigma: S = self.sigma(t);
        let inverse = 1.0 / sigma.channel(lead).max(THINNEST);
        let f = relative(depth + self.depth(cell.start, t), lead, target) * inverse;
        carried.draw(f, f * sigma);
        Flight::Collided(Collision {
            t,
            scattering: self.scattering(t, sigma),
            emission: self.emission(t, sigma),
        })
    }

    /// ∫E·τ over `cell`, an unbiased estimate from one point; τ from the way's start. Drawn with the density of the slowest
    /// decay, so that no channel's weight is large.
    #[inline]
    fn shine(&self, cell: &Cell, depth: S, beyond: S, sampler: &mut impl Sampler) -> S {
        let least = -beyond.map(|d| -d).max_channel();
        let xi = fine(sampler);
        let (x, inverse) = if least > 1e-3 {
            let whole = -expm1(-least);
            let x = (-log1p(-xi * whole) / least).min(1.0);
            (x, whole / least * exp(least * x))
        } else {
            (xi, 1.0)
        };
        let width = cell.end - cell.start;
        let t = cell.start + width * x;
        let fade = (depth + self.depth(cell.start, t)).map(|d| exp(-d));
        self.emission(t, self.sigma(t)) * fade * (inverse * width)
    }
}

/// e^(−D) relative to the leading channel's, whose D is at most `most`, whatever rounding makes of it.
#[inline(always)]
fn relative<S: Spectrum>(depth: S, lead: usize, most: Real) -> S {
    let leading = depth.channel(lead).min(most);
    depth.map(|d| exp(leading - d))
}
