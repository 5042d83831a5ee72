//! Functions of cos θ with values from 0 to 1, in sixteen bytes: what microfacets lose, what a coat lets in. The scene's
//! compiler makes them (a material's roughness and index are the same everywhere), so that the kernel needs no tables.
//!
//! Between nodes at cos θ = (i/15)² they are linear in √cos θ, which follows their steep ends at grazing angles. A byte's
//! rounding is 0.002; interpolation adds up to 0.004 where α ≥ 0.1, 0.01 at grazing angles where α is 0.02.

use crate::blob::format::material::CURVE;
use crate::real::{INV_PI, Real, safe_sqrt};

/// A curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Curve(pub [u8; CURVE]);

impl Curve {
    /// 0 everywhere.
    pub const ZERO: Self = Self([0; CURVE]);

    /// Through the values of `f` at the nodes.
    pub fn through(mut f: impl FnMut(Real) -> Real) -> Self {
        Self(core::array::from_fn(|i| {
            let root = i as Real / LAST;
            let y = f(root * root).clamp(0.0, 1.0);
            (y * 255.0 + 0.5) as u8
        }))
    }

    /// The one that begins at word `first`; 0 if there is none.
    pub fn read(words: &[u32], first: u32) -> Self {
        let words = words.get(first as usize..).unwrap_or_default();
        let byte = |i: usize| words.get(i / 4).map_or(0, |w| (w >> (8 * (i % 4))) as u8);
        Self(core::array::from_fn(byte))
    }

    /// At `cos` ∈ [0, 1].
    pub fn at(&self, cos: Real) -> Real {
        let x = safe_sqrt(cos.min(1.0)) * LAST;
        let low = (x as usize).min(CURVE - 2);
        let node = |i: usize| self.0.get(i).map_or(0.0, |&y| Real::from(y));
        let f = x - low as Real;
        (node(low) * (1.0 - f) + node(low + 1) * f) * (1.0 / 255.0)
    }

    /// The mean over the hemisphere, ∫ c(cos θ) cos θ dσ/π, of the interpolant itself.
    pub fn mean(&self) -> Real {
        let weighted = self.0.iter().zip(&WEIGHTS);
        weighted.map(|(&y, &w)| Real::from(y) * w).sum::<Real>() * (1.0 / 255.0)
    }

    /// Cosine-distributed directions have this density and what a loss gives back has this shape: c(cos)/(π·mean), whose
    /// integral over projected solid angle is 1. 0 if there is no loss.
    pub fn share(&self, cos: Real, mean: Real) -> Real {
        if mean > 0.0 {
            self.at(cos) * INV_PI / mean
        } else {
            0.0
        }
    }
}

const LAST: Real = (CURVE - 1) as Real;

/// ∫₀¹ 2μ·hat(√μ) dμ = ∫₀¹ 4t³·hat(t) dt of each node's hat.
const WEIGHTS: [Real; CURVE] = {
    let mut weights = [0.2; CURVE];
    let n = LAST;
    let mut i = 1;
    while i < CURVE {
        let t = i as Real;
        weights[i] = if i + 1 < CURVE {
            4.0 * t * t * t + 2.0 * t
        } else {
            2.0 * t * t * t - 2.0 * t * t + t - 0.2
        };
        i += 1;
    }
    let mut i = 0;
    while i < CURVE {
        weights[i] /= n * n * n * n;
        i += 1;
    }
    weights
};
