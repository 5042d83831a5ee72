//! What reports say about chance: means, intervals, tails.

mod distribution;
mod efficiency;
mod tail;

pub use distribution::{fisher_quantile, ln_gamma, student, student_quantile};
pub use efficiency::{Costs, Interval};
pub use tail::{FEWEST_ALIVE, Heaviest, Tail, tail_index};

/// Mean and standard error of the mean of independent batches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
    /// Batches.
    pub count: usize,
}

impl Estimate {
    /// Of batches; the error of fewer than two is infinite.
    pub fn of(batches: &[f64]) -> Self {
        let n = batches.len() as f64;
        let mean = batches.iter().sum::<f64>() / n;
        let squares: f64 = batches.iter().map(|x| (x - mean) * (x - mean)).sum();
        let error = if batches.len() < 2 {
            f64::INFINITY
        } else {
            (squares / (n - 1.0) / n).sqrt()
        };
        Self {
            mean,
            error,
            count: batches.len(),
        }
    }

    /// How many standard errors it is from `truth`, of which `uncertainty` (absolute) is nobody's fault.
    pub fn z(&self, truth: f64, uncertainty: f64) -> f64 {
        let off = self.mean - truth;
        let beyond = (off.abs() - uncertainty).max(0.0).copysign(off);
        if beyond == 0.0 {
            0.0
        } else {
            beyond / self.error
        }
    }

    /// The probability of being so many standard errors off, in either direction, if the batches are normal.
    pub fn p(&self, z: f64) -> f64 {
        student(z, self.count.saturating_sub(1) as u32)
    }
}
