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
    /// Samples.
    pub samples: u64,
    /// Samples that contribute anything.
    pub alive: u64,
    /// Hill's estimate (1975) of the index α of the tail P(X > x) ~ x^−α; below 2 variance is infinite. 0 with too few samples alive.
    pub index: f64,
    /// The largest contribution over the mean of all.
    pub largest: f64,
    /// The largest contribution's share of their sum.
    pub share: f64,
    /// The share of those that the index is estimated from: the largest √n of n alive, 16 at least.
    pub top: f64,
}

/// Contributions that Hill's estimate needs at least.
pub const FEWEST_ALIVE: u64 = 32;
/// The most that it takes.
const MOST: usize = 1024;
/// The largest contribution's share of their sum beyond which it dominates.
const DOMINATES: f64 = 0.1;
/// The share of the largest √n beyond which it matters what tail they have.
const MATTERS: f64 = 0.2;
/// Below this tail index variance counts as infinite (2), less what Hill's estimate of a few hundred contributions may err.
const HEAVY: f64 = 1.8;

impl Tail {
    /// Of the contributions of all samples.
    pub fn of(contributions: &[f32]) -> Self {
        let mut all = Heaviest::default();
        contributions.iter().for_each(|&x| all.add(x));
        all.tail()
    }

    /// Whether few samples carry it all.
    pub fn is_heavy(&self) -> bool {
        let tail = self.index < HEAVY && self.top > MATTERS;
        self.alive < FEWEST_ALIVE || tail || self.share > DOMINATES
    }
}

/// The heaviest of contributions that come one after the other, in any order: all that [`Tail`] asks of them.
#[derive(Clone, Debug, Default)]
pub struct Heaviest {
    samples: u64,
    alive: u64,
    sum: f64,
    /// Those above `least`, unsorted: up to twice as many as are wanted, so that sorting out is seldom.
    top: Vec<f32>,
    least: f32,
}

impl Heaviest {
    /// One more.
    #[inline]
    pub fn add(&mut self, contribution: f32) {
        self.samples += 1;
        if contribution > 0.0 {
            self.alive += 1;
            self.sum += f64::from(contribution);
            if contribution > self.least {
                self.keep(contribution);
            }
        }
    }

    fn keep(&mut self, contribution: f32) {
        self.top.push(contribution);
        if self.top.len() > 2 * MOST {
            // One beyond those that are wanted is the threshold.
            self.top.select_nth_unstable_by(MOST, |a, b| b.total_cmp(a));
            self.top.truncate(MOST + 1);
            self.least = self.top[MOST];
        }
    }

    /// Those of others as well.
    pub fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.alive += other.alive;
        self.sum += other.sum;
        other.top.iter().for_each(|&x| self.keep(x));
    }

    /// What they are like.
    pub fn tail(mut self) -> Tail {
        self.top.sort_unstable_by(|a, b| b.total_cmp(a));
        let Some(&largest) = self.top.first() else {
            return Tail {
                samples: self.samples,
                ..Tail::default()
            };
        };
        // The largest √n of them are the tail.
        let k = ((self.alive as f64).sqrt() as usize).clamp(16, MOST);
        let index = if self.alive >= FEWEST_ALIVE {
            let top = self.top.iter().take(k + 1);
            let top: Vec<f64> = top.map(|&x| x.into()).collect();
            tail_index(&top, k).map_or(0.0, |(index, _)| index.min(1e9))
        } else {
            0.0
        };
        let share = f64::from(largest) / self.sum;
        Tail {
            samples: self.samples,
            alive: self.alive,
            index,
            largest: share * self.samples as f64,
            share,
            top: self.top.iter().take(k).map(|&x| f64::from(x)).sum::<f64>() / self.sum,
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
            let x: Vec<f32> = (0..1_000_000)
                .map(|i| ((f64::from(i) + 0.5) / 1e6).powf(-1.0 / alpha) as f32)
                .collect();
            let tail = Tail::of(&x);
            assert!((tail.index / alpha - 1.0).abs() < 0.05, "{}", tail.index);
            assert_eq!((tail.samples, tail.alive), (1_000_000, 1_000_000));
            // ln k/ln n, nearly, where α is 1; else (k/n)^(1 − 1/α).
            let top = [0.56, 1e-2][usize::from(alpha > 2.0)];
            assert!((tail.top / top).ln().abs() < 0.1, "{}", tail.top);
        }
        assert_eq!(Tail::of(&[0.0; 4]).alive, 0);
    }

    /// Who saw which contribution doesn't matter, nor when, and a tail is that of all.
    #[test]
    fn the_heaviest_are_those_of_all() {
        let x: Vec<f32> = uniform(100_000, 9).map(|u| u.powf(-0.5) as f32).collect();
        let mut parts = [0; 3].map(|_| Heaviest::default());
        for (i, &x) in x.iter().enumerate() {
            parts[i * i % 3].add(x);
        }
        let [mut all, b, c] = parts;
        all.merge(&c);
        all.merge(&b);
        let mut sorted: Vec<f64> = x.iter().map(|&x| x.into()).collect();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let (index, _) = tail_index(&sorted, 316).unwrap();
        assert_eq!(all.tail().index, index);
        assert_eq!(Tail::of(&x).index, index);
    }
}
