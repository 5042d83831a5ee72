//! Statistics of a few batches and of many contributions.

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
    /// Of batches, two at least.
    pub fn of(batches: &[f64]) -> Self {
        let n = batches.len() as f64;
        let mean = batches.iter().sum::<f64>() / n;
        let squares: f64 = batches.iter().map(|x| (x - mean) * (x - mean)).sum();
        Self {
            mean,
            error: (squares / (n - 1.0) / n).sqrt(),
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

/// Two-sided p-value of Student's t with `degrees` degrees of freedom: the finite series (Abramowitz & Stegun 1964, 26.7.3–4).
pub fn student(t: f64, degrees: u32) -> f64 {
    if t.is_nan() || degrees == 0 {
        return 1.0;
    }
    if t.is_infinite() {
        return 0.0;
    }
    let n = f64::from(degrees);
    let cos2 = n / (n + t * t);
    let (sin, cos) = (t.abs() / (n + t * t).sqrt(), cos2.sqrt());
    // The complement of A(t|ν) is what counts, and it is small: the incomplete beta function I(cos²; ν/2, 1/2) by its continued fraction.
    if sin > 0.5 {
        return beta(cos2, 0.5 * n, 0.5);
    }
    let mut term = if degrees.is_multiple_of(2) { 1.0 } else { cos };
    let mut sum = if degrees == 1 { 0.0 } else { term };
    let mut k = if degrees.is_multiple_of(2) { 2 } else { 3 };
    while k + 1 < degrees {
        term *= cos2 * f64::from(k - 1) / f64::from(k);
        sum += term;
        k += 2;
    }
    let a = if degrees.is_multiple_of(2) {
        sin * sum
    } else {
        2.0 / std::f64::consts::PI * ((t.abs() / n.sqrt()).atan() + sin * sum)
    };
    1.0 - a
}

/// The regularised incomplete beta function I(x; a, b) for x < (a + 1)/(a + b + 2), by Lentz's continued fraction (Press et al. 2007, §6.4).
fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p()).exp();
    let guard = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..500 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        for step in [even, odd] {
            d = 1.0 / guard(1.0 + step * d);
            c = guard(1.0 + step / c);
            h *= d * c;
        }
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h / a
}

/// ln Γ(x) for x > 0 by Stirling's series, after the recurrence has lifted x above 10.
fn ln_gamma(mut x: f64) -> f64 {
    let mut product = 1.0;
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y / 1680.0))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - f64::ln(product)
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
        let sum: f64 = contributions[..alive].iter().map(|&x| f64::from(x)).sum();
        // The largest √n of them are the tail.
        let k = ((alive as f64).sqrt() as usize).clamp(16, 1024);
        let index = match contributions[..alive].get(k) {
            Some(&edge) if alive as u64 >= FEWEST_ALIVE => {
                let logs = contributions[..k].iter().map(|&x| f64::from(x / edge).ln());
                k as f64 / logs.sum::<f64>().max(1e-9)
            }
            _ => 0.0,
        };
        Self {
            alive: alive as u64,
            index,
            largest: f64::from(largest) / sum * contributions.len() as f64,
            share: f64::from(largest) / sum,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of Student's distribution (NIST).
    #[test]
    fn p_values_are_the_tables() {
        for (t, degrees, p) in [
            (12.706_204_736, 1, 0.05),
            (2.228_138_852, 10, 0.05),
            (3.169_272_673, 10, 0.01),
            (2.039_513_446, 31, 0.05),
            (0.682_486_3, 31, 0.5),
            (3.633_456, 31, 0.001),
        ] {
            assert!(
                (student(t, degrees) / p - 1.0).abs() < 1e-5,
                "{t} {degrees}: {}",
                student(t, degrees)
            );
        }
        assert_eq!(student(f64::INFINITY, 3), 0.0);
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
