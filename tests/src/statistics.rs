//! Statistics as tests: p-values, and one decision over all of them.
//!
//! A comparison yields the probability of what was seen, or worse, if the code is right. A [`Family`] of
//! comparisons fails if its smallest p-value is below [`FALSE_ALARM`]/count (Bonferroni), so that right code
//! fails a family under at most that share of all seeds. Seeds are fixed: what passes once passes always.

use etendue_host::statistics::ln_gamma;
use std::fmt::Display;

/// How often a family of comparisons would fail right code, over all seeds.
pub const FALSE_ALARM: f64 = 1e-4;

/// Comparisons that stand or fall together.
#[derive(Debug, Default)]
pub struct Family {
    count: u32,
    worst: Option<(f64, String)>,
}

impl Family {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a comparison with p-value `p`.
    pub fn add(&mut self, p: f64, what: impl Display) {
        assert!((0.0..=1.0).contains(&p), "p = {p}: {what}");
        self.count += 1;
        if self.worst.as_ref().is_none_or(|(worst, _)| p < *worst) {
            self.worst = Some((p, what.to_string()));
        }
    }

    /// Panics if the family fails.
    #[track_caller]
    pub fn judge(self) {
        let (p, what) = self.worst.expect("a family without members tests nothing");
        let limit = FALSE_ALARM / f64::from(self.count);
        assert!(p >= limit, "{what}: p = {p:.3e} < {limit:.3e}");
    }
}

/// Pearson's χ² of counts against their expectations: the p-value.
///
/// Bins expected to have less than [`POOL_BELOW`] are pooled, smallest first. Something seen where nothing is
/// expected has p = 0.
pub fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let mut bins: Vec<(f64, f64)> = expected
        .iter()
        .copied()
        .zip(observed.iter().map(|&o| o as f64))
        .collect();
    if bins.iter().any(|&(e, o)| e <= 0.0 && o > 0.0) {
        return 0.0;
    }
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut degrees) = (0.0, -1.0);
    let mut pool = (0.0, 0.0);
    for (i, &(e, o)) in bins.iter().enumerate() {
        pool = (pool.0 + e, pool.1 + o);
        let rest: f64 = bins[i + 1..].iter().map(|b| b.0).sum();
        if pool.0 >= POOL_BELOW && (rest >= POOL_BELOW || i + 1 == bins.len()) {
            let (e, o) = std::mem::take(&mut pool);
            statistic += (o - e) * (o - e) / e;
            degrees += 1.0;
        }
    }
    if degrees > 0.0 {
        gamma_q(0.5 * degrees, 0.5 * statistic)
    } else {
        1.0
    }
}

/// Where χ² stops being χ²-distributed.
pub const POOL_BELOW: f64 = 5.0;

/// Two-sided p-value of a normal deviate.
pub fn normal(z: f64) -> f64 {
    gamma_q(0.5, 0.5 * z * z)
}

/// Mean and variance of numbers as they come (Welford 1962).
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    count: f64,
    mean: f64,
    sum: f64,
}

impl Moments {
    /// One more number.
    pub fn add(&mut self, x: f64) {
        self.count += 1.0;
        let delta = x - self.mean;
        self.mean += delta / self.count;
        self.sum += delta * (x - self.mean);
    }

    /// The mean.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The mean's variance.
    pub fn variance(&self) -> f64 {
        self.sum / (self.count - 1.0) / self.count
    }

    /// The p-value of the mean if the truth is `truth`, known to within `rounding` (relative).
    pub fn against(&self, truth: f64, rounding: f64) -> f64 {
        deviation(self.mean - truth, self.variance(), rounding * truth.abs())
    }

    /// The p-value of two independent means if they estimate the same number.
    pub fn same_as(&self, other: &Self, rounding: f64) -> f64 {
        deviation(
            self.mean - other.mean,
            self.variance() + other.variance(),
            rounding * self.mean.abs(),
        )
    }
}

/// The p-value of a difference, of which `rounding` is nobody's fault.
fn deviation(difference: f64, variance: f64, rounding: f64) -> f64 {
    let beyond = (difference.abs() - rounding).max(0.0);
    if beyond == 0.0 {
        1.0
    } else if variance == 0.0 {
        0.0
    } else {
        normal(beyond / variance.sqrt())
    }
}

/// The regularised incomplete gamma function Q(a, x): by its series below a + 1, by Lentz's continued
/// fraction above (Press et al. 2007, §6.2).
pub fn gamma_q(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-16 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        (1.0 - sum * scale).clamp(0.0, 1.0)
    } else {
        let mut b = x + 1.0 - a;
        let mut c = f64::MAX;
        let mut d = 1.0 / b;
        let mut h = d;
        for i in 1..10_000 {
            let i = f64::from(i);
            let numerator = -i * (i - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            h *= d * c;
            if (d * c - 1.0).abs() < 1e-15 {
                break;
            }
        }
        (scale * h).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables: χ² quantiles (NIST), the normal distribution, and Q(½, ·) = erfc √·.
    #[test]
    fn p_values_are_the_tables() {
        for (degrees, statistic, p) in [
            (1.0, 3.841_458_820_694_124, 0.05),
            (10.0, 18.307_038_053_275_146, 0.05),
            (10.0, 29.588_298_445_074_42, 0.001),
            (100.0, 149.449_252_779_088_7, 0.001),
        ] {
            let q = gamma_q(0.5 * degrees, 0.5 * statistic);
            assert!((q / p - 1.0).abs() < 1e-9, "{degrees}: {q} for {p}");
        }
        assert!((normal(1.959_963_984_540_054) / 0.05 - 1.0).abs() < 1e-10);
        assert!((normal(-6.0) / 1.973_175_290_075_396e-9 - 1.0).abs() < 1e-9);
        assert_eq!(normal(0.0), 1.0);
    }

    #[test]
    fn chi_square_pools_and_refuses() {
        assert_eq!(chi_square(&[10, 10], &[10.0, 10.0]), 1.0);
        // 4 and 2 make one bin of 6; 3.841 with one degree of freedom is p = 0.05.
        let p = chi_square(&[3, 3, 94], &[4.0, 2.0, 94.0]);
        assert_eq!(p, 1.0);
        assert!(chi_square(&[60, 40], &[50.0, 50.0]) < 0.05);
        assert_eq!(chi_square(&[1, 99], &[0.0, 100.0]), 0.0);
        // A small last pool joins the bin before it.
        assert_eq!(chi_square(&[2, 98], &[2.0, 98.0]), 1.0);
    }

    #[test]
    fn means_are_judged_by_their_error() {
        let mut m = Moments::default();
        for i in 0..10_000 {
            m.add(f64::from(i % 2));
        }
        assert!((m.mean() - 0.5).abs() < 1e-12);
        assert!((m.variance() / (0.25 / 9999.0) - 1.0).abs() < 1e-9);
        assert!(m.against(0.51, 0.0) > 0.04 && m.against(0.51, 0.0) < 0.05);
        assert!(m.against(0.53, 0.0) < 1e-8);
        assert_eq!(m.against(0.5, 1e-9), 1.0);
    }

    #[test]
    #[should_panic(expected = "culprit")]
    fn a_family_names_the_culprit() {
        let mut family = Family::new();
        family.add(0.5, "innocent");
        family.add(1e-5, "culprit");
        family.add(0.01, "innocent");
        family.judge();
    }
}
