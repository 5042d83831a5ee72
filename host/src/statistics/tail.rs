//! Tails of contributions.

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

/// What the contributions of all samples are like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tail {
    /// Samples that contribute anything.
    pub alive: u64,
    /// Hill's estimate (1975) of the index α of the tail P(X > x) ~ x^−α; below 2 variance is infinite. 0 with too few samples alive.
    pub index: f64,
    /// The largest contribution over the mean of all.
    pub largest: f64,
    /// The largest contribution's share of their sum.
    pub share: f64,
}

/// Contributions that Hill's estimate needs at least.
pub const FEWEST_ALIVE: u64 = 32;

impl Tail {
    /// Of the contributions of all samples; sorts them.
    pub fn of(contributions: &mut [f32]) -> Self {
        contributions.sort_unstable_by(|a, b| b.total_cmp(a));
        let alive = contributions.iter().take_while(|x| **x > 0.0).count();
        let Some(&largest) = contributions.first().filter(|_| alive > 0) else {
            return Self::default();
        };
        // The largest √n of them are the tail.
        let k = ((alive as f64).sqrt() as usize).clamp(16, 1024);
        let all: Vec<f64> = contributions[..alive].iter().map(|&x| x.into()).collect();
        let sum: f64 = all.iter().sum();
        let index = if alive as u64 >= FEWEST_ALIVE {
            tail_index(&all, k).map_or(0.0, |(index, _)| index.min(1e9))
        } else {
            0.0
        };
        Self {
            alive: alive as u64,
            index,
            largest: f64::from(largest) / sum * contributions.len() as f64,
            share: f64::from(largest) / sum,
        }
    }
}

/// Uniform in (0, 1].
#[cfg(test)]
pub(super) fn uniform(n: u64, seed: u64) -> impl Iterator<Item = f64> {
    use etendue::random::{Pcg, Purpose, Sampler};
    (0..n).map(move |i| 1.0 - f64::from(Pcg::new(seed, 0, i).one(Purpose::Choice)))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    /// Pareto's distribution has the index that it is made with.
    #[test]
    fn the_tail_of_pareto() {
        for alpha in [1.0, 3.0] {
            let mut x: Vec<f32> = (0..1_000_000)
                .map(|i| ((f64::from(i) + 0.5) / 1e6).powf(-1.0 / alpha) as f32)
                .collect();
            let tail = Tail::of(&mut x);
            assert!((tail.index / alpha - 1.0).abs() < 0.05, "{}", tail.index);
        }
        assert_eq!(Tail::of(&mut [0.0; 4]), Tail::default());
    }
}
