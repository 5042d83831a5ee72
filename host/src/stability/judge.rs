//! What was found against what is written down.

use super::manifest::{Beside, Case, Expectation, Expected};
use super::measure::Measured;
use super::sampling::PARTS;
use crate::statistics::{Estimate, Interval, student_quantile};

/// What was measured of one estimator on one case.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Why the estimator doesn't answer for the scene.
    pub refused: Option<&'static str>,
    /// The light paths that it can't make.
    pub unreachable: Vec<String>,
    /// What it says of walks that were cut.
    pub loss: Option<String>,
    /// What the render itself has reason to doubt.
    pub warnings: Vec<String>,
    /// In single precision.
    pub single: Measured,
    /// In double precision, the same samples.
    pub double: Measured,
    /// In single precision, the scene without what the program adds to it.
    pub plain: Measured,
    /// Means of the batches' clipped contributions, in single and in double precision.
    pub clipped: [Vec<f64>; 2],
    /// The image in parts: by chains, and by samples of bidirectional.
    pub parts: Option<[[Estimate; PARTS]; 2]>,
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

    /// How many p-values it is judged by: against the truth, one precision against the other, chains' parts against samples'. A bias is judged twice, for being there
    /// and for its size.
    pub fn comparisons(&self) -> usize {
        3 * self.channels + self.parts.map_or(0, |[parts, _]| parts.len())
    }

    /// Energy that arrives over energy that should, and the 95 % interval of that.
    pub fn energy(&self, case: &Case) -> Option<Interval> {
        let truth: f64 = case.truth.value.iter().sum();
        let batches = self.single.batches.get(..self.channels)?;
        let count = batches.first()?.len();
        let sums: Vec<f64> = (0..count)
            .map(|i| batches.iter().map(|b| b[i]).sum::<f64>() / truth)
            .collect();
        let ratio = Estimate::of(&sums);
        let half = student_quantile(count as f64 - 1.0) * ratio.error;
        (count > 1).then_some(Interval {
            value: ratio.mean,
            low: ratio.mean - half,
            high: ratio.mean + half,
        })
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
    /// f32 over f64, minus 1, in the worst channel; of contributions clipped at their mean where few carry it all.
    pub single_over_double: f64,
    /// What differs from what is written down; empty: nothing.
    pub differs: Vec<String>,
}

/// How far off something is.
#[derive(Clone, Copy, Debug)]
struct Off {
    z: f64,
    p: f64,
    /// Relative, if there is anything to be relative to.
    bias: f64,
    /// Its standard error.
    error: f64,
}

impl Off {
    const NONE: Self = Self {
        z: 0.0,
        p: 1.0,
        bias: 0.0,
        error: 0.0,
    };

    fn from(mean: &Estimate, truth: f64, uncertainty: f64) -> Self {
        let z = mean.z(truth, uncertainty * truth.abs());
        let scale = if truth == 0.0 { 1.0 } else { truth };
        Self {
            z,
            p: mean.p(z),
            bias: (mean.mean - truth) / scale,
            error: mean.error / scale.abs(),
        }
    }

    /// One over another minus 1. Both had the same random numbers: what differs are the differences of their batches.
    fn between(one: &[f64], other: &[f64]) -> Self {
        let differences: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
        let reference = Estimate::of(other).mean;
        if differences.len() < 2 || reference == 0.0 {
            return Self::NONE;
        }
        let difference = Estimate::of(&differences);
        let z = difference.z(0.0, 0.0);
        Self {
            z,
            p: difference.p(z),
            bias: difference.mean / reference,
            error: difference.error / reference.abs(),
        }
    }

    /// The less probable of two.
    fn worse(self, other: Self) -> Self {
        if other.p <= self.p { other } else { self }
    }

    /// Whether it is clearly not within a stated range.
    fn is_beyond(&self, by: f64, within: f64, limit: f64) -> bool {
        let (bias, count) = (self.bias, super::measure::BATCHES as usize);
        let estimate = Estimate {
            mean: bias,
            error: self.error,
            count,
        };
        estimate.p(estimate.z(by, within)) < limit
    }
}

fn channels(found: &Found, off: impl Fn(usize) -> Off) -> Off {
    (0..found.channels).map(off).fold(Off::NONE, Off::worse)
}

/// Judges; `limit` is the smallest p-value that chance may have. `warnings`: of compiling the scene.
pub fn judge(
    case: &Case,
    expected: &Expected,
    found: Found,
    warnings: &[String],
    limit: f64,
) -> Row {
    let truth = &case.truth;
    let from_truth = |m: &Measured| {
        channels(&found, |c| {
            Off::from(&m.mean[c], truth.value[c], truth.uncertainty)
        })
    };
    let from = |other: &Measured| {
        channels(&found, |c| {
            Off::between(&found.single.batches[c], &other.batches[c])
        })
    };
    let off = from_truth(&found.single);
    let mut apart = from(&found.double);
    let beside = expected.beside.map(|b| match b {
        Beside::Double => ("f64", &found.double),
        Beside::Plain => ("the plain scene", &found.plain),
    });
    let seen = beside.map_or(off, |(_, other)| from(other));
    let tail = &found.single.tail;
    let lost = found.single.rejected + found.single.refused + found.double.rejected;
    let starved = tail.alive == 0;
    let dark = off.p < limit && off.z < 0.0 && !found.unreachable.is_empty();
    let heavy = tail.is_heavy();
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
    } else if seen.p >= limit {
        Outcome::Right
    } else {
        Outcome::Biased(seen.bias)
    };
    let mut differs = Vec::new();
    let met = match (&expected.what, &outcome) {
        (Expectation::Right, Outcome::Right)
        | (Expectation::Misses, Outcome::Misses)
        | (Expectation::Heavy, Outcome::Heavy)
        | (Expectation::Refused, Outcome::Refused) => true,
        (Expectation::Biased { by, within }, Outcome::Biased(_)) => {
            !seen.is_beyond(*by, *within, limit)
        }
        (Expectation::Biased { by, within }, Outcome::Right) => by.abs() <= *within,
        _ => false,
    };
    if !met {
        differs.push(format!("{} in place of {}", outcome, expected.what));
    }
    if let Some((name, other)) = beside {
        let other = from_truth(other);
        if other.p < limit {
            differs.push(format!("{name} is off by {:+.2e}", other.bias));
        }
    }
    let ends: u64 = found.ends.iter().sum();
    if ends > 0 {
        differs.push(format!(
            "{ends} values refused or not finite where ξ is at its ends"
        ));
    }
    if outcome == Outcome::Heavy {
        apart = Off::between(&found.clipped[0], &found.clipped[1]);
    }
    if expected.beside != Some(Beside::Double)
        && apart.p < limit
        && apart.bias.abs() > expected.rounding
    {
        differs.push(format!("f32 is off from f64 by {:.2e}", apart.bias));
    }
    if outcome != Outcome::Heavy {
        differs.extend(astray(&found, limit));
    }
    differs.extend(unwarned(expected, &found, warnings));
    Row {
        case: case.clone(),
        expected: expected.clone(),
        found,
        outcome,
        z: seen.z,
        p: seen.p,
        single_over_double: apart.bias,
        differs,
    }
}

/// A part of the image in which chains have other light than samples have.
fn astray(found: &Found, limit: f64) -> Option<String> {
    let [chains, samples] = found.parts.as_ref()?;
    chains
        .iter()
        .zip(samples)
        .zip(1..)
        .find_map(|((a, b), number)| {
            let error = (a.error * a.error + b.error * b.error).sqrt();
            let difference = Estimate {
                mean: a.mean - b.mean,
                error,
                count: a.count,
            };
            let p = difference.p(difference.z(0.0, 0.0));
            (p < limit).then(|| {
                format!(
                    "quarter {number} of the image has {:.4} by chains, {:.4} by bidirectional",
                    a.mean, b.mean
                )
            })
        })
}

/// A warning that is missing, or one in vain.
fn unwarned(expected: &Expected, found: &Found, compiled: &[String]) -> Option<String> {
    let mut all = compiled.iter().chain(&found.warnings).chain(&found.loss);
    match &expected.warns {
        Some(cure) if !all.any(|w| w.contains(cure)) => Some(format!("no warning says {cure:?}")),
        None if expected.what == Expectation::Right => found
            .warnings
            .first()
            .map(|w| format!("a warning in vain: {w}")),
        _ => None,
    }
}

impl Row {
    /// Whether all is as written down.
    pub fn is_met(&self) -> bool {
        self.differs.is_empty()
    }

    /// What the command line calls its estimator.
    pub fn name(&self) -> String {
        super::name(self.expected.estimator)
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
