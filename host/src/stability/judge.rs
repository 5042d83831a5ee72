//! What was found against what is written down.

use super::manifest::{Case, Expectation, Expected};
use super::measure::{Measured, Method};
use crate::statistics::{Estimate, FEWEST_ALIVE};

/// What was measured of one estimator on one case.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Why the estimator doesn't answer for the scene.
    pub refused: Option<&'static str>,
    /// The light paths that it can't make.
    pub unreachable: Vec<String>,
    /// In single precision.
    pub single: Measured,
    /// In double precision, the same samples.
    pub double: Measured,
    /// Violations where ξ is at its ends, in single and in double precision.
    pub ends: [u64; 2],
    /// Channels that are compared.
    pub channels: usize,
}

impl Found {
    pub(super) fn refused(reason: &'static str, unreachable: Vec<String>) -> Self {
        Self {
            refused: Some(reason),
            unreachable,
            ..Self::default()
        }
    }

    /// How many p-values it is judged by: against the truth, and one precision against the other.
    pub fn comparisons(&self) -> usize {
        2 * self.channels
    }
}

/// What an estimator did.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The truth.
    Right,
    /// Too dark, by light paths that the program names.
    Misses,
    /// Few samples carry it all.
    Heavy,
    /// It refuses the scene.
    Refused,
    /// Off by so much, relative.
    Biased(f64),
    /// Values were lost: not finite, negative or too large.
    Lost(u64),
}

/// An estimator on a case: expected and found.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: Case,
    /// What is expected.
    pub expected: Expected,
    /// What was measured.
    pub found: Found,
    /// What that amounts to.
    pub outcome: Outcome,
    /// The worst channel's z against the truth.
    pub z: f64,
    /// And its p-value.
    pub p: f64,
    /// f32 over f64, minus 1, in the worst channel.
    pub single_over_double: f64,
    /// What differs from what is written down; empty: nothing.
    pub differs: Vec<String>,
}

/// The largest contribution's share of their sum beyond which it dominates.
const DOMINATES: f64 = 0.1;
/// Below this tail index variance counts as infinite (2), less what Hill's estimate of a few hundred contributions may err.
const HEAVY: f64 = 1.8;
/// Relative difference of f32 and f64 that is rounding.
const ROUNDING: f64 = 1e-4;

/// Judges; `limit` is the smallest p-value that chance may have.
pub fn judge(case: &Case, expected: &Expected, found: Found, limit: f64) -> Row {
    let (mut z, mut p, mut bias): (f64, f64, f64) = (0.0, 1.0, 0.0);
    let (mut apart, mut apart_p): (f64, f64) = (0.0, 1.0);
    for (c, &truth) in case.truth.value.iter().enumerate().take(found.channels) {
        let mean = found.single.mean[c];
        let here = mean.z(truth, case.truth.uncertainty * truth.abs());
        if mean.p(here) <= p {
            (z, p) = (here, mean.p(here));
            bias = if truth == 0.0 {
                mean.mean
            } else {
                mean.mean / truth - 1.0
            };
        }
        let (relative, probability) = precisions(&found, c);
        if relative.abs() >= apart.abs() {
            (apart, apart_p) = (relative, probability);
        }
    }
    let tail = &found.single.tail;
    let lost = found.single.rejected + found.single.refused + found.double.rejected;
    let starved = tail.alive == 0;
    let dark = p < limit && z < 0.0 && !found.unreachable.is_empty();
    let heavy = tail.alive < FEWEST_ALIVE || tail.index < HEAVY || tail.share > DOMINATES;
    let outcome = if found.refused.is_some() {
        Outcome::Refused
    } else if lost > 0 {
        Outcome::Lost(lost)
    } else if starved && expected.what == Expectation::Heavy {
        // Nothing says whether what is black can't be made or only hasn't been: what is written down decides.
        Outcome::Heavy
    } else if dark && (expected.what == Expectation::Misses || starved || !heavy) {
        Outcome::Misses
    } else if heavy {
        Outcome::Heavy
    } else if p >= limit {
        Outcome::Right
    } else {
        Outcome::Biased(bias)
    };
    let mut differs = Vec::new();
    let met = match (&expected.what, &outcome) {
        (Expectation::Right, Outcome::Right)
        | (Expectation::Misses, Outcome::Misses)
        | (Expectation::Heavy, Outcome::Heavy)
        | (Expectation::Refused, Outcome::Refused)
        | (Expectation::Biased(_), Outcome::Right) => true,
        (Expectation::Biased(bound), Outcome::Biased(b)) => b.abs() <= *bound,
        _ => false,
    };
    if !met {
        differs.push(format!("{} in place of {}", outcome, expected.what));
    }
    let ends: u64 = found.ends.iter().sum();
    if ends > 0 {
        differs.push(format!(
            "{ends} values refused or not finite where ξ is at its ends"
        ));
    }
    let allowed = match expected.what {
        Expectation::Biased(bound) => bound,
        _ => ROUNDING,
    };
    if apart_p < limit && apart.abs() > allowed && outcome != Outcome::Heavy {
        differs.push(format!("f32 is off from f64 by {:.2e}", apart));
    }
    Row {
        case: case.clone(),
        expected: expected.clone(),
        found,
        outcome,
        z,
        p,
        single_over_double: apart,
        differs,
    }
}

/// f32 over f64 minus 1 in a channel, and the probability of that if they estimate the same. Both had the same random numbers: what
/// differs are the differences of their batches.
fn precisions(found: &Found, channel: usize) -> (f64, f64) {
    let (a, b) = (
        &found.single.batches[channel],
        &found.double.batches[channel],
    );
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let reference = found.double.mean[channel].mean;
    if differences.len() < 2 || reference == 0.0 {
        return (0.0, 1.0);
    }
    let difference = Estimate::of(&differences);
    let z = difference.z(0.0, 0.0);
    (difference.mean / reference, difference.p(z))
}

impl Row {
    /// Whether all is as written down.
    pub fn is_met(&self) -> bool {
        self.differs.is_empty()
    }

    /// Which estimator.
    pub fn method(&self) -> Method {
        self.expected.method
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Right => f.write_str("right"),
            Self::Misses => f.write_str("misses"),
            Self::Heavy => f.write_str("heavy"),
            Self::Refused => f.write_str("refused"),
            Self::Biased(b) => write!(f, "biased {b:+.4}"),
            Self::Lost(n) => write!(f, "{n} values lost"),
        }
    }
}
