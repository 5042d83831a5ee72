//! The film: sums that don't depend on the order of what is added.
//!
//! A contribution is rounded once, to a multiple of the film's step 2^(e−64), and from then on everything is
//! integers: threads, tiles, shards and machines may add in any order and get the same bits
//! (`transport.md` §10). The caller owns the integers; e comes from the blob ([`crate::Scene::film_exponent`]).

use crate::real::Real;
use crate::spectrum::Rgb;

/// Sums of red, green and blue, in steps. They have a sign, because a single wavelength is beyond the gamut of any three primaries.
pub type Sum = [i128; 3];

/// Slices of different lengths, which can't be films of one image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LengthMismatch;

impl core::fmt::Display for LengthMismatch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the films have different numbers of pixels")
    }
}

impl core::error::Error for LengthMismatch {}

/// The step 2^(e−64) of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    exponent: i32,
}

/// What a film could not take as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refused {
    /// Contributions whose size is 2^(e+31) or more, refused.
    pub saturated: u64,
    /// Contributions other than 0 that rounded to 0.
    pub underflowed: u64,
    /// NaN or infinite contributions, refused.
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
    /// 2^(exponent − 64). An exponent outside [−64, 64], which no blob that opens has, is taken to the nearer end.
    pub const fn new(exponent: i32) -> Self {
        let exponent = match exponent {
            ..-64 => -64,
            65.. => 64,
            e => e,
        };
        Self { exponent }
    }

    /// `x` in steps, rounded to nearest, ties to even; `None` if it is out of range. 2³² contributions of the
    /// largest size that is taken still fit a [`Sum`].
    #[inline]
    pub fn count(self, x: Real, refused: &mut Refused) -> Option<i128> {
        let size = self.size(x, refused)? as i128;
        Some(if x < 0.0 { -size } else { size })
    }

    /// |`x`| in steps: below 2⁹⁵.
    #[inline(always)]
    fn size(self, x: Real, refused: &mut Refused) -> Option<u128> {
        if !x.is_finite() {
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

    /// A pixel's value from its two sums: samples are divided by how many the pixel has; splats by the number of
    /// light walks, which all pixels share, and scaled by the number of pixels (`transport.md` §7).
    pub fn resolve(
        self,
        samples: &Sum,
        splats: &Sum,
        samples_per_pixel: u64,
        light_walks: u64,
        pixels: u64,
    ) -> [f64; 3] {
        let own = self.mean(samples, samples_per_pixel);
        let others = self.mean(splats, light_walks);
        core::array::from_fn(|c| own[c] + others[c] * pixels as f64)
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

/// Adds one film to another of the same image.
///
/// # Errors
/// If they differ in length; then nothing is added.
pub fn merge_all(sums: &mut [Sum], others: &[Sum]) -> Result<(), LengthMismatch> {
    if sums.len() != others.len() {
        return Err(LengthMismatch);
    }
    for (sum, other) in sums.iter_mut().zip(others) {
        merge(sum, other);
    }
    Ok(())
}

/// `mantissa`/2^`right`, 1 ≤ right ≤ 63, to nearest, ties to even.
#[inline]
fn round_shift(mantissa: u64, right: u32) -> u64 {
    let whole = mantissa >> right;
    let rest = mantissa & ((1 << right) - 1);
    let half = 1 << (right - 1);
    whole + u64::from(rest > half || (rest == half && whole & 1 == 1))
}

/// |x| = mantissa·2^exponent, exactly; x is finite.
#[inline]
#[allow(clippy::unnecessary_cast)] // Real is f32 or f64
fn decompose(x: Real) -> (u64, i32) {
    const DIGITS: u32 = Real::MANTISSA_DIGITS - 1;
    // The sign must not pass for a digit of the exponent.
    let bits = x.abs().to_bits() as u64;
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
    use super::{LengthMismatch, Refused, Step, Sum, decompose, merge, merge_all};
    use crate::real::Real;
    use crate::spectrum::Rgb;
    use rand_core::Rng;

    /// Numbers of all binary orders in [2^`from`, 2^`to`), the same each time.
    fn numbers(from: i32, to: i32) -> impl Iterator<Item = Real> {
        let mut random = rand_pcg::Pcg32::new(17, 4);
        (from..to)
            .flat_map(|e| [e; 64])
            .map(move |e| {
                let fraction = libm::ldexp(f64::from(random.next_u32()), -32);
                libm::ldexp(1.0 + fraction, e) as Real
            })
            .filter(move |&x| f64::from(x) < libm::ldexp(1.0, to))
    }

    #[test]
    fn numbers_come_apart_exactly() {
        let few = [1.0, 0.1, Real::MIN_POSITIVE, Real::MIN_POSITIVE / 8.0, 1e30];
        for x in numbers(-148, 100).chain(few) {
            let (m, e) = decompose(x);
            assert_eq!(m as f64 * libm::scalbn(1.0, e), f64::from(x));
        }
        assert_eq!((decompose(0.0).0, decompose(-0.0).0), (0, 0));
    }

    #[test]
    fn a_contribution_is_rounded_once_to_nearest_even() {
        let step = Step::new(64); // steps of 1
        let mut refused = Refused::default();
        for (x, n) in [(0.5, 0), (1.5, 2), (2.5, 2), (2.75, 3), (7.0, 7), (0.25, 0)] {
            assert_eq!(step.count(x, &mut refused), Some(n), "{x}");
        }
        let underflowed = Refused {
            underflowed: 2,
            ..Refused::default()
        };
        assert_eq!(refused, underflowed);
    }

    /// Scaling by a power of two is exact in double precision here, and so are its `rint` and conversion.
    #[test]
    fn rounding_is_that_of_exact_arithmetic() {
        for exponent in [-64, -17, 0, 3, 64] {
            let step = Step::new(exponent);
            let mut refused = Refused::default();
            let mut underflowed = 0;
            for x in numbers(-148.max(exponent - 130), exponent + 31) {
                let exact = libm::rint(libm::ldexp(f64::from(x), 64 - exponent)) as i128;
                assert_eq!(step.count(x, &mut refused), Some(exact), "{x:e}");
                assert_eq!(step.count(-x, &mut Refused::default()), Some(-exact));
                underflowed += u64::from(exact == 0);
            }
            let counted = (refused.saturated, refused.underflowed, refused.invalid);
            assert_eq!(counted, (0, underflowed, 0));
        }
    }

    #[test]
    fn what_does_not_fit_is_refused_and_counted() {
        let step = Step::new(0);
        let mut refused = Refused::default();
        let limit: Real = 2_147_483_648.0;
        assert_eq!(step.count(limit, &mut refused), None);
        let below = limit * crate::real::ONE_MINUS;
        let steps = libm::ldexp(f64::from(below), 64) as i128;
        assert_eq!(step.count(below, &mut refused), Some(steps));
        assert_eq!(step.count(-below, &mut refused), Some(-steps));
        for x in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
            assert_eq!(step.count(x, &mut refused), None);
        }
        let mut sum: Sum = [0; 3];
        step.add(&mut sum, Rgb::new(1.0, Real::NAN, 1.0), &mut refused);
        assert_eq!((sum, refused.saturated, refused.invalid), ([0; 3], 1, 4));
    }

    /// What it did before: the sign passed for the exponent's highest digit, and the contribution was lost.
    #[test]
    fn minus_zero_is_zero() {
        let mut refused = Refused::default();
        let mut sum: Sum = [0; 3];
        Step::new(0).add(&mut sum, Rgb::new(1.0, -0.0, 2.0), &mut refused);
        assert_eq!((sum, refused), ([1 << 64, 0, 2 << 64], Refused::default()));
    }

    #[test]
    fn extremes_do_no_harm() {
        let mut refused = Refused::default();
        for exponent in [i32::MIN, -65, 65, i32::MAX] {
            let step = Step::new(exponent);
            assert_eq!(step, Step::new(exponent.clamp(-64, 64)));
            for x in [
                0.0,
                Real::MIN_POSITIVE / 8.0,
                Real::MIN_POSITIVE,
                1.0,
                Real::MAX,
            ] {
                step.count(x, &mut refused);
            }
        }
        // The largest contribution fits 2³² times; beyond that the sum stays at its end, in any order.
        let largest = (1i128 << 95) - 1;
        assert!(largest.checked_mul(1 << 32).is_some());
        let mut full: Sum = [i128::MAX - 1, 0, i128::MIN];
        merge(&mut full, &[2, 3, -4]);
        assert_eq!(full, [i128::MAX, 3, i128::MIN]);
        assert!(Step::new(64).mean(&full, 0).iter().all(|x| x.is_finite()));
    }

    #[test]
    fn the_order_does_not_matter() {
        let step = Step::new(3);
        let mut values: [Real; 512] = [0.0; 512];
        for (value, x) in values.iter_mut().zip(numbers(-90, 34).step_by(13)) {
            *value = x;
        }
        let total = |values: &[Real]| {
            let (mut sum, mut refused): (Sum, _) = ([0; 3], Refused::default());
            for &v in values {
                step.add(&mut sum, Rgb::new(v, 1.0, 0.5 * v), &mut refused);
            }
            (sum, refused)
        };
        let expected = total(&values);
        let exact: f64 = values.iter().map(|&v| f64::from(v)).sum();
        assert!((step.mean(&expected.0, 1)[0] / exact - 1.0).abs() < 1e-12);
        let mut random = rand_pcg::Pcg32::new(5, 6);
        for _ in 0..32 {
            for i in (1..values.len()).rev() {
                values.swap(i, random.next_u32() as usize % (i + 1));
            }
            assert_eq!(total(&values), expected);
            let (left, right) = values.split_at(random.next_u32() as usize % values.len());
            let ((mut sum, mut refused), (other, more)) = (total(left), total(right));
            merge_all(core::slice::from_mut(&mut sum), &[other]).unwrap();
            refused += more;
            assert_eq!((sum, refused), expected);
        }
    }

    #[test]
    fn films_resolve_and_merge_whole() {
        let step = Step::new(0);
        let mut refused = Refused::default();
        let (mut samples, mut splats): (Sum, Sum) = ([0; 3], [0; 3]);
        step.add(&mut samples, Rgb::new(8.0, 4.0, 2.0), &mut refused);
        step.add(&mut splats, Rgb::new(1.0, 0.0, 0.5), &mut refused);
        // 4 samples per pixel and as many light walks for each of 10 pixels: both sums are divided by 4.
        let value = step.resolve(&samples, &splats, 4, 40, 10);
        assert_eq!(value, [2.25, 1.0, 0.625]);
        let mut film = [samples, splats];
        assert_eq!(merge_all(&mut film, &[splats]), Err(LengthMismatch));
        assert_eq!(film, [samples, splats]);
    }
}
