//! Efficiencies and their intervals.

use super::{Estimate, student_quantile};

/// A positive quantity and its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Its estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Error × time of independent trials. Efficiency is one over their mean, whose logarithm has the relative error of the mean (delta method): a mean, not a
/// geometric one, because rare large errors are what an estimator with a heavy tail has.
#[derive(Clone, Debug, Default)]
pub struct Costs(Vec<f64>);

impl Costs {
    /// One more trial.
    pub fn add(&mut self, error_times_time: f64) {
        self.0.push(error_times_time);
    }

    /// ln of the efficiency, its standard error, degrees of freedom.
    fn log(&self) -> Option<(f64, f64, f64)> {
        let Estimate { mean, error, .. } = Estimate::of(&self.0);
        (mean > 0.0).then(|| (-mean.ln(), error / mean, self.0.len() as f64 - 1.0))
    }

    /// The efficiency and its interval. `None` without any error.
    pub fn efficiency(&self) -> Option<Interval> {
        let (log, error, degrees) = self.log()?;
        Some(around(log, error, degrees))
    }

    /// The quotient of two efficiencies and its interval (Welch 1947).
    pub fn over(&self, other: &Self) -> Option<Interval> {
        let ((m, e, k), (n, f, l)) = (self.log()?, other.log()?);
        let (e2, f2) = (e * e, f * f);
        let welch = (e2 + f2).powi(2) / (e2 * e2 / k + f2 * f2 / l);
        let welch = if welch.is_nan() { 0.0 } else { welch };
        Some(around(m - n, (e2 + f2).sqrt(), welch))
    }
}

fn around(log: f64, error: f64, degrees: f64) -> Interval {
    let half = if error == 0.0 {
        0.0
    } else {
        student_quantile(degrees) * error
    };
    Interval {
        value: log.exp(),
        low: (log - half).exp(),
        high: (log + half).exp(),
    }
}

#[cfg(test)]
mod tests {
    use super::Costs;
    use crate::statistics::tail::uniform;

    /// Of 2000 intervals of 12 log-normal errors that vary by a third, 95 % hold the truth: within 5 standard deviations of that share.
    #[test]
    fn intervals_cover_at_their_rate() {
        let mut covered = 0;
        const TRIALS: u64 = 2000;
        const SPREAD: f64 = 0.3;
        for trial in 0..TRIALS {
            let mut costs = Costs::default();
            for pair in uniform(24, trial).collect::<Vec<_>>().chunks(2) {
                let normal = (-2.0 * pair[0].ln()).sqrt() * (std::f64::consts::TAU * pair[1]).cos();
                costs.add((SPREAD * normal).exp());
            }
            let i = costs.efficiency().unwrap();
            let truth = (-0.5 * SPREAD * SPREAD).exp();
            covered += u64::from(i.low <= truth && truth <= i.high);
        }
        let share = covered as f64 / TRIALS as f64;
        assert!(
            (share - 0.95).abs() < 5.0 * (0.95f64 * 0.05 / TRIALS as f64).sqrt(),
            "{share}"
        );
    }
}
