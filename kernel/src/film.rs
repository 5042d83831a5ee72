//! The film: sums that don't depend on the order of what is added.
//!
//! A contribution is rounded once, to a multiple of the film's step 2^(e−64), and from then on everything is
//! integers: threads, tiles, shards and machines may add in any order and get the same bits
//! (`transport.md` §10). The caller owns the integers; e comes from the blob ([`crate::Scene::film_exponent`]).

use crate::real::Real;
use crate::spectrum::Rgb;

/// Sums of red, green and blue, in steps.
pub type Sum = [u128; 3];

/// The step 2^(e−64) of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    exponent: i32,
}

/// What a film could not take as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refused {
    /// Contributions of 2^(e+31) and more, refused.
    pub saturated: u64,
    /// Positive contributions that rounded to 0.
    pub underflowed: u64,
    /// NaN, infinite or negative contributions, refused.
    pub invalid: u64,
}

impl core::ops::AddAssign for Refused {
    fn add_assign(&mut self, o: Self) {
        self.saturated += o.saturated;
        self.underflowed += o.underflowed;
        self.invalid += o.invalid;
    }
}

impl Step {
    /// 2^(exponent − 64).
    pub const fn new(exponent: i32) -> Self {
        Self { exponent }
    }

    /// `x` in steps, rounded to nearest, ties to even; `None` if it is out of range. 2³² contributions of the
    /// largest size that is taken still fit a [`Sum`].
    #[inline]
    pub fn count(self, x: Real, refused: &mut Refused) -> Option<u128> {
        if !(0.0..Real::INFINITY).contains(&x) {
            refused.invalid += 1;
            return None;
        }
        let (mantissa, exponent) = decompose(x);
        // x = mantissa·2^exponent = mantissa·2^shift steps.
        let shift = exponent - (self.exponent - 64);
        if mantissa == 0 {
            return Some(0);
        }
        if shift >= 0 {
            let bits = (u64::BITS - mantissa.leading_zeros()) as i32;
            if bits + shift > 95 {
                refused.saturated += 1;
                return None;
            }
            return Some(u128::from(mantissa) << shift);
        }
        let right = shift.unsigned_abs();
        let steps = if right > 63 {
            0
        } else {
            round_shift(mantissa, right)
        };
        refused.underflowed += u64::from(steps == 0);
        Some(u128::from(steps))
    }

    /// Adds a contribution to a pixel; all of it or, if one channel is refused, nothing.
    #[inline]
    pub fn add(self, sum: &mut Sum, value: Rgb, refused: &mut Refused) {
        let [r, g, b] = value.to_array();
        if let (Some(r), Some(g), Some(b)) = (
            self.count(r, refused),
            self.count(g, refused),
            self.count(b, refused),
        ) {
            merge(sum, &[r, g, b]);
        }
    }

    /// Σ/`n` as a number.
    pub fn mean(self, sum: &Sum, n: u64) -> [f64; 3] {
        let step = libm::scalbn(1.0, self.exponent - 64);
        sum.map(|s| s as f64 * step / n.max(1) as f64)
    }
}

/// Adds one sum to another.
#[inline]
pub fn merge(sum: &mut Sum, other: &Sum) {
    for (s, o) in sum.iter_mut().zip(other) {
        *s = s.saturating_add(*o);
    }
}

/// `mantissa`/2^`right`, 1 ≤ right ≤ 63, to nearest, ties to even.
#[inline]
fn round_shift(mantissa: u64, right: u32) -> u64 {
    let whole = mantissa >> right;
    let rest = mantissa & ((1 << right) - 1);
    let half = 1 << (right - 1);
    whole + u64::from(rest > half || (rest == half && whole & 1 == 1))
}

/// x = mantissa·2^exponent, exactly; x is finite and ≥ 0.
#[inline]
#[allow(clippy::unnecessary_cast)] // Real is f32 or f64
fn decompose(x: Real) -> (u64, i32) {
    const DIGITS: u32 = Real::MANTISSA_DIGITS - 1;
    let bits = x.to_bits() as u64;
    let stored = bits & ((1 << DIGITS) - 1);
    let biased = (bits >> DIGITS) as i32;
    // Subnormals share the exponent of the smallest normal and lack the leading one.
    let mantissa = if biased == 0 {
        stored
    } else {
        stored | 1 << DIGITS
    };
    (mantissa, biased.max(1) + Real::MIN_EXP - 2 - DIGITS as i32)
}

#[cfg(test)]
#[allow(clippy::useless_conversion)] // Real is f32 or f64
mod tests {
    use super::{Refused, Step, Sum, decompose, merge};
    use crate::real::Real;
    use crate::spectrum::Rgb;

    #[test]
    fn numbers_come_apart_exactly() {
        for x in [
            1.0,
            0.1,
            3.5e-20,
            Real::MIN_POSITIVE,
            Real::MIN_POSITIVE / 8.0,
            1e30,
        ] {
            let (m, e) = decompose(x);
            assert_eq!(m as f64 * libm::scalbn(1.0, e), f64::from(x));
        }
        assert_eq!(decompose(0.0).0, 0);
    }

    #[test]
    fn a_contribution_is_rounded_once_to_nearest_even() {
        let step = Step::new(64); // steps of 1
        let mut refused = Refused::default();
        for (x, n) in [(0.5, 0), (1.5, 2), (2.5, 2), (2.75, 3), (7.0, 7), (0.25, 0)] {
            assert_eq!(step.count(x, &mut refused), Some(n), "{x}");
        }
        assert_eq!(
            refused,
            Refused {
                underflowed: 2,
                ..Refused::default()
            }
        );
    }

    #[test]
    fn what_does_not_fit_is_refused_and_counted() {
        let step = Step::new(0);
        let mut refused = Refused::default();
        assert_eq!(step.count(2_147_483_648.0, &mut refused), None);
        assert_eq!(
            step.count(2_147_483_392.0, &mut refused),
            Some(2_147_483_392 << 64)
        );
        for x in [Real::NAN, Real::INFINITY, -1.0] {
            assert_eq!(step.count(x, &mut refused), None);
        }
        let mut sum: Sum = [0; 3];
        step.add(&mut sum, Rgb::new(1.0, Real::NAN, 1.0), &mut refused);
        assert_eq!((sum, refused.saturated, refused.invalid), ([0; 3], 1, 4));
    }

    #[test]
    fn the_order_does_not_matter() {
        let step = Step::new(3);
        let values: [Real; 7] = [1e-9, 3.0, 0.1, 7e5, 1e-3, 0.3, 2e-17];
        let total = |order: &mut dyn Iterator<Item = usize>| {
            let mut sum: Sum = [0; 3];
            for i in order {
                step.add(
                    &mut sum,
                    Rgb::new(values[i], values[6 - i], 0.0),
                    &mut Refused::default(),
                );
            }
            sum
        };
        let forwards = total(&mut (0..7));
        assert_eq!(forwards, total(&mut (0..7).rev()));
        let mut halves = total(&mut (3..7));
        merge(&mut halves, &total(&mut (0..3)));
        assert_eq!(forwards, halves);
        let exact: f64 = values.iter().map(|&v| f64::from(v)).sum();
        assert!((step.mean(&forwards, 1)[0] - exact).abs() < 1e-9);
    }
}
