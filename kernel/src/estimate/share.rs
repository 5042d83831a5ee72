//! The weights of the few strategies that share a path in `path` (Veach 1997, §9.2.2–9.2.3).

use crate::instance::Instance;
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

/// The weight of a strategy that shares a path with `rivals`: each with its density relative to this one's. Where there are no media
/// only the first exists.
#[inline(always)]
pub(super) fn share<K: Instance>(
    heuristic: Heuristic,
    own: Strategy,
    rivals: [(Strategy, Real); 2],
) -> Real {
    if K::MEDIA {
        weight(heuristic, own, rivals)
    } else {
        weight(heuristic, own, [rivals[0]])
    }
}

#[inline(always)]
fn weight<const N: usize>(
    heuristic: Heuristic,
    own: Strategy,
    rivals: [(Strategy, Real); N],
) -> Real {
    let w = match heuristic {
        Heuristic::Balance => 1.0 / sum(rivals, |q| q),
        Heuristic::Power => 1.0 / sum(rivals, square),
        Heuristic::Cutoff => {
            let bar = CUTOFF * rivals.iter().fold(1.0, |most: Real, (_, q)| most.max(*q));
            if bar > 1.0 {
                0.0
            } else {
                1.0 / sum(rivals, |q| if q < bar { 0.0 } else { q })
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

/// 1 + Σ f(q).
#[inline(always)]
fn sum<const N: usize>(rivals: [(Strategy, Real); N], f: impl Fn(Real) -> Real) -> Real {
    rivals.into_iter().fold(1.0, |sum, (_, q)| sum + f(q))
}
