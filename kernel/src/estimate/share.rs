//! The weights of the few strategies that share a path in `path` (Veach 1997, §9.2.2–9.2.3).

use crate::path::{CUTOFF, Heuristic};
use crate::real::{Real, square};

/// The strategies, in the order in which ties are broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Strategy {
    /// The walk flies, and meets the light.
    Met,
    /// The walk flies, and a point of the light is drawn for where it is.
    Drawn,
    /// A point of the light is drawn, and a distance for it.
    #[cfg_attr(not(feature = "media"), allow(dead_code))]
    Equiangular,
}

/// The weight of a strategy that shares a path with `rivals`: each with its density relative to this one's.
#[inline(always)]
pub(super) fn share(heuristic: Heuristic, own: Strategy, rivals: [(Strategy, Real); 2]) -> Real {
    let [(_, a), (_, b)] = rivals;
    let w = match heuristic {
        Heuristic::Balance => 1.0 / (1.0 + a + b),
        Heuristic::Power => 1.0 / (1.0 + square(a) + square(b)),
        Heuristic::Cutoff => {
            let bar = CUTOFF * a.max(b).max(1.0);
            let kept = |q: Real| if q < bar { 0.0 } else { q };
            if bar > 1.0 {
                0.0
            } else {
                1.0 / (1.0 + kept(a) + kept(b))
            }
        }
        Heuristic::Maximum => {
            let loses = |(rival, q): (Strategy, Real)| q > 1.0 || (q == 1.0 && rival < own);
            if rivals.into_iter().any(loses) {
                0.0
            } else {
                1.0
            }
        }
    };
    if w.is_finite() { w } else { 0.0 }
}
