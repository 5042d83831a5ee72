//! Four wavelengths per path (hero wavelength sampling: Wilkie et al. 2014). One is drawn, the others are a quarter of the distribution
//! further each; which of them leads is drawn as for the channels of a medium ([`crate::medium`]), so that what differs between them is
//! combined by one-sample MIS, and what disperses leaves the leading one alone.

use super::observer::{FIRST, LAST, Wave};
use super::{Rgb, Spectrum};
use crate::real::{Real, exp, log};

const N: usize = 4;

/// Radiance, throughput, reflectance at four wavelengths, per nm where it is radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hero(pub [Real; N]);

/// The wavelengths of a path.
#[derive(Clone, Copy, Debug)]
pub struct Waves {
    lambda: [Real; N],
    /// What red, green and blue stand for.
    basis: [[Real; N]; 3],
    white: [Real; N],
    /// From radiance to what a sample adds to linear sRGB: over the density, and over their number.
    rgb: [[Real; N]; 3],
}

/// The distribution that wavelengths are drawn from: logistic, cut to the visible. Its middle and width (nm) are those that make white
/// light least noisy in linear sRGB (of four wavelengths per sample, by numerical search to 5 nm).
const MIDDLE: Real = 505.0;
const WIDTH: Real = 80.0;

/// 1/(1 + e^(−(λ − middle)/width)).
#[inline(always)]
fn logistic(lambda: Real) -> Real {
    1.0 / (1.0 + exp((MIDDLE - lambda) / WIDTH))
}

impl Waves {
    /// The four that belong to ξ.
    fn new(xi: Real) -> Self {
        let (low, high) = (logistic(FIRST), logistic(LAST));
        let drawn: [_; N] = core::array::from_fn(|i| {
            let u = xi + i as Real * (1.0 / N as Real);
            let u = if u < 1.0 { u } else { u - 1.0 };
            let f = low + u * (high - low);
            let lambda = (MIDDLE + WIDTH * log(f / (1.0 - f))).clamp(FIRST, LAST);
            let density = f * (1.0 - f) / (WIDTH * (high - low));
            (lambda, Wave::at(lambda), 1.0 / (N as Real * density))
        });
        Self {
            lambda: drawn.map(|(lambda, ..)| lambda),
            basis: columns(drawn.map(|(_, wave, _)| wave.basis)),
            white: drawn.map(|(_, wave, _)| wave.white),
            rgb: columns(drawn.map(|(_, wave, share)| wave.rgb.map(|x| x * share))),
        }
    }
}

/// Rows by wavelength as columns.
#[inline(always)]
fn columns(rows: [[Real; 3]; N]) -> [[Real; N]; 3] {
    [
        rows.map(|[x, _, _]| x),
        rows.map(|[_, y, _]| y),
        rows.map(|[_, _, z]| z),
    ]
}

impl Spectrum for Hero {
    const BLACK: Self = Self([0.0; N]);
    const WHITE: Self = Self([1.0; N]);
    const CHANNELS: usize = N;
    const FILM: bool = false;
    type Waves = Waves;

    #[inline(never)]
    fn draw(xi: Real) -> (Waves, usize) {
        // Each of the four is distributed as the first is: any may lead.
        (Waves::new(xi), 0)
    }
    #[inline(always)]
    fn channel(self, i: usize) -> Real {
        self.0.get(i).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn only(self, i: usize) -> Self {
        let mut one = Self::BLACK;
        if let (Some(to), Some(x)) = (one.0.get_mut(i), self.0.get(i)) {
            *to = *x;
        }
        one
    }
    #[inline(always)]
    fn lift([r, g, b]: [f32; 3], waves: &Waves) -> Self {
        let [red, green, blue] = waves.basis.map(Self);
        // Blue is what red and green leave, so that grey is flat to rounding.
        red * Real::from(r) + green * Real::from(g) + blue * Real::from(b)
    }
    #[inline(always)]
    fn light(rgb: [f32; 3], waves: &Waves) -> Self {
        Self::lift(rgb, waves) * Self(waves.white)
    }
    #[inline(always)]
    fn to_rgb(self, waves: &Waves) -> Rgb {
        let [r, g, b] = waves.rgb.map(|weights| {
            let [a, b, c, d] = (self * Self(weights)).0;
            (a + b) + (c + d)
        });
        Rgb::new(r, g, b)
    }
    #[inline(always)]
    fn wavelengths(waves: &Waves) -> Self {
        Self(waves.lambda)
    }
    #[inline(always)]
    fn grey(x: Real) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn max_channel(self) -> Real {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }
    #[inline(always)]
    fn mean(self) -> Real {
        let [a, b, c, d] = self.0;
        ((a + b) + (c + d)) * (1.0 / N as Real)
    }
    #[inline(always)]
    fn recorded(self, waves: &Waves) -> Option<Rgb> {
        let rgb = self.to_rgb(waves);
        let fine = self.0.iter().all(|x| (0.0..Real::INFINITY).contains(x));
        (fine && rgb.to_array().iter().all(|x| x.is_finite())).then_some(rgb)
    }
    #[inline(never)]
    fn tabulated(rows: &[[u32; 2]], waves: &Waves) -> Option<Self> {
        Some(Self(waves.lambda.map(|lambda| interpolate(rows, lambda))))
    }
    #[inline(always)]
    fn is_black(self) -> bool {
        self.0 == [0.0; N]
    }
    #[inline(always)]
    fn map(self, f: impl FnMut(Real) -> Real) -> Self {
        Self(self.0.map(f))
    }
    #[inline(always)]
    fn zip(self, o: Self, mut f: impl FnMut(Real, Real) -> Real) -> Self {
        let ([a, b, c, d], [x, y, z, w]) = (self.0, o.0);
        Self([f(a, x), f(b, y), f(c, z), f(d, w)])
    }
}

/// The value at `lambda` of a table of (nm, value), linear between rows and constant beyond them.
pub fn interpolate(rows: &[[u32; 2]], lambda: Real) -> Real {
    let number = |bits: u32| Real::from(f32::from_bits(bits));
    let after = rows.partition_point(|&[nm, _]| number(nm) <= lambda);
    let row = |i: usize| rows.get(i).map(|row| row.map(number));
    match (after.checked_sub(1).and_then(row), row(after)) {
        (Some([a, x]), Some([b, y])) => x + (y - x) * ((lambda - a) / (b - a)),
        (Some([_, x]), None) | (None, Some([_, x])) => x,
        (None, None) => 0.0,
    }
}

super::operators!(Hero);
