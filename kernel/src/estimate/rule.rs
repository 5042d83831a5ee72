//! Quadrature rules on the unit interval and the unit square: Gauss and Legendre's, equal steps, and equal steps shifted at random.

use crate::estimate::Rule;
use crate::random::{Purpose, Sampler};
use crate::real::{ONE_MINUS, Real};

/// A rule of so many nodes on [0, 1), whose weights add up to 1.
#[derive(Clone, Copy, Debug)]
pub(super) enum Nodes {
    /// Exact for polynomials of degree 2n − 1.
    Gauss(u8),
    /// The middles of equal steps, moved on by a part of a step (and around): 0 is the midpoint rule, spectrally accurate for periodic
    /// functions; a part drawn at random makes it unbiased for any.
    Steps(u8, Real),
}

impl Nodes {
    /// Gauss's rule; equal steps with a random shift, if `rule` says so.
    #[inline(always)]
    pub fn gauss(rule: &Rule, sampler: &mut impl Sampler) -> Self {
        if rule.shift {
            Self::steps(rule, sampler)
        } else {
            Self::Gauss(order(rule))
        }
    }

    /// Equal steps.
    #[inline(always)]
    pub fn steps(rule: &Rule, sampler: &mut impl Sampler) -> Self {
        Self::Steps(order(rule), shift(rule, sampler))
    }

    /// How many.
    #[inline(always)]
    pub fn count(&self) -> u8 {
        match *self {
            Self::Gauss(n) | Self::Steps(n, _) => n,
        }
    }

    /// Where node `i` is, and its weight.
    #[inline(always)]
    pub fn get(&self, i: u8) -> (Real, Real) {
        match *self {
            Self::Gauss(n) => gauss(n, i),
            Self::Steps(n, part) => {
                let n = Real::from(n);
                let x = ((Real::from(i) + 0.5 + part) / n).clamp(0.0, ONE_MINUS);
                (x, 1.0 / n)
            }
        }
    }
}

/// By how much of a step equal steps are moved: in [−½, ½), 0 without `shift`.
#[inline(always)]
pub(super) fn shift(rule: &Rule, sampler: &mut impl Sampler) -> Real {
    if rule.shift {
        sampler.one(Purpose::Position) - 0.5
    } else {
        0.0
    }
}

#[inline(always)]
fn order(rule: &Rule) -> u8 {
    rule.order.clamp(1, Rule::MAX_ORDER)
}

/// Node `i` of `n` and its weight, moved from [−1, 1] to [0, 1].
#[inline(always)]
fn gauss(n: u8, i: u8) -> (Real, Real) {
    // From the middle outwards; where n is odd the table begins with the middle itself.
    let (half, odd) = (n / 2, n % 2);
    let (place, sign) = if i < half {
        (half - 1 - i + odd, -1.0)
    } else {
        (i.saturating_sub(half), 1.0)
    };
    let table: &[(Real, Real)] = match n {
        1 => &table::GAUSS_1,
        2 => &table::GAUSS_2,
        3 => &table::GAUSS_3,
        4 => &table::GAUSS_4,
        5 => &table::GAUSS_5,
        6 => &table::GAUSS_6,
        7 => &table::GAUSS_7,
        _ => &table::GAUSS_8,
    };
    let (x, weight) = table.get(place as usize).copied().unwrap_or((0.0, 0.0));
    (0.5 + 0.5 * sign * x, 0.5 * weight)
}

/// Abscissas ≥ 0 on [−1, 1], from the middle outwards, and weights (Abramowitz & Stegun 1964, table 25.4).
#[allow(clippy::excessive_precision)] // not excessive in the double-precision package
mod table {
    use crate::real::Real;

    pub const GAUSS_1: [(Real, Real); 1] = [(0.0, 2.0)];
    pub const GAUSS_2: [(Real, Real); 1] = [(0.577_350_269_189_625_7, 1.0)];
    pub const GAUSS_3: [(Real, Real); 2] = [
        (0.0, 0.888_888_888_888_888_9),
        (0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
    ];
    pub const GAUSS_4: [(Real, Real); 2] = [
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    ];
    pub const GAUSS_5: [(Real, Real); 3] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    pub const GAUSS_6: [(Real, Real); 3] = [
        (0.238_619_186_083_196_9, 0.467_913_934_572_691),
        (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
        (0.932_469_514_203_152, 0.171_324_492_379_170_3),
    ];
    pub const GAUSS_7: [(Real, Real); 4] = [
        (0.0, 0.417_959_183_673_469_4),
        (0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
        (0.741_531_185_599_394_4, 0.279_705_391_489_276_7),
        (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
    ];
    pub const GAUSS_8: [(Real, Real); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_2, 0.101_228_536_290_376_3),
    ];
}

#[cfg(test)]
mod tests {
    use super::Nodes;
    use crate::real::{Real, pow};

    fn integral(nodes: Nodes, f: impl Fn(Real) -> Real) -> Real {
        (0..nodes.count())
            .map(|i| nodes.get(i))
            .map(|(x, w)| w * f(x))
            .sum()
    }

    #[test]
    fn gauss_integrates_polynomials_of_degree_2n_minus_1() {
        for n in 1..=8 {
            for degree in 0..2 * n {
                let exact = 1.0 / (Real::from(degree) + 1.0);
                let found = integral(Nodes::Gauss(n), |x| pow(x, Real::from(degree)));
                assert!(
                    (found - exact).abs() < 8.0 * Real::EPSILON,
                    "order {n}, degree {degree}: {found}, expected {exact}"
                );
            }
            let wrong = integral(Nodes::Gauss(n), |x| pow(x, Real::from(2 * n)));
            let off = (wrong * (2.0 * Real::from(n) + 1.0) - 1.0).abs();
            assert!(
                n > 4 || off > 1e-5,
                "order {n}: higher degrees aren't exact"
            );
        }
    }

    #[test]
    fn steps_cover_the_interval() {
        for n in 1..=8 {
            for part in [-0.5, -0.2, 0.0, 0.4999] {
                let nodes = Nodes::Steps(n, part);
                assert!((integral(nodes, |_| 1.0) - 1.0).abs() < 4.0 * Real::EPSILON);
                assert!((0..n).all(|i| (0.0..1.0).contains(&nodes.get(i).0)));
            }
        }
    }
}
