//! What charts say about chance: intervals of means, and tails.

/// Mean and standard error of independent numbers; the error of fewer than two is infinite.
pub fn mean_and_error(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    if x.len() < 2 {
        return (mean, f64::INFINITY);
    }
    let squares: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// The 97.5 % quantile of Student's t with `degrees` of freedom, to 0.2 %: tabulated up to 10, beyond by the expansion about the normal quantile z
/// (Abramowitz & Stegun 1964, 26.7.5).
pub fn t_quantile(degrees: f64) -> f64 {
    const TABLE: [f64; 10] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    ];
    const Z: f64 = 1.959_964;
    let whole = degrees.floor();
    if whole < 1.0 {
        return f64::INFINITY;
    }
    if let Some(t) = TABLE.get(whole as usize - 1) {
        return *t;
    }
    let z3 = Z * Z * Z;
    let z5 = z3 * Z * Z;
    Z + (z3 + Z) / (4.0 * degrees) + (5.0 * z5 + 16.0 * z3 + 3.0 * Z) / (96.0 * degrees * degrees)
}

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
        let (mean, error) = mean_and_error(&self.0);
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
        t_quantile(degrees) * error
    };
    Interval {
        value: log.exp(),
        low: (log - half).exp(),
        high: (log + half).exp(),
    }
}

/// Hill's (1975) estimate of the tail index α, P(x > t) ~ t^−α, from the `k` largest of `x`, and its standard error. The variance is
/// infinite where α ≤ 2, the mean where α ≤ 1. `None` with fewer than `k` + 1 positive numbers.
pub fn tail_index(x: &[f64], k: usize) -> Option<(f64, f64)> {
    let mut positive: Vec<f64> = x.iter().copied().filter(|&x| x > 0.0).collect();
    if k == 0 || positive.len() <= k {
        return None;
    }
    positive.sort_by(|a, b| b.total_cmp(a));
    let threshold = positive[k].ln();
    let mean = positive[..k]
        .iter()
        .map(|x| x.ln() - threshold)
        .sum::<f64>()
        / k as f64;
    let index = 1.0 / mean;
    Some((index, index / (k as f64).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::{Costs, t_quantile, tail_index};
    use etendue::random::{Pcg, Purpose, Sampler};

    fn uniform(n: u64, seed: u64) -> impl Iterator<Item = f64> {
        (0..n).map(move |i| 1.0 - f64::from(Pcg::new(seed, 0, i).one(Purpose::Choice)))
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, t) in [
            (1.0, 12.706),
            (5.0, 2.571),
            (11.0, 2.201),
            (30.0, 2.042),
            (1e9, 1.96),
        ] {
            assert!((t_quantile(degrees) / t - 1.0).abs() < 2e-3, "{degrees}");
        }
        assert!(t_quantile(0.0).is_infinite());
    }

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

    #[test]
    fn tails_of_known_index_are_found() {
        for alpha in [0.8, 1.5, 3.0] {
            let x: Vec<f64> = uniform(100_000, 5).map(|u| u.powf(-1.0 / alpha)).collect();
            let (index, error) = tail_index(&x, 1000).unwrap();
            assert!(
                (index - alpha).abs() < 4.0 * error,
                "{alpha}: {index} ± {error}"
            );
        }
        assert!(tail_index(&[1.0, 2.0], 2).is_none());
    }
}
