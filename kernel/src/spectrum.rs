//! What a path carries: a few numbers per path vertex, one per channel or wavelength.

use crate::real::Real;

/// The spectral samples a path carries. Estimators are generic over it; [`Rgb`] is what scenes need
/// that neither disperse nor give spectra (`transport.md` §9).
pub trait Spectrum:
    Copy
    + core::fmt::Debug
    + core::ops::Add<Output = Self>
    + core::ops::Mul<Output = Self>
    + core::ops::Mul<Real, Output = Self>
    + core::ops::AddAssign
    + core::ops::MulAssign
    + core::ops::MulAssign<Real>
{
    /// Zero in every channel.
    const BLACK: Self;
    /// One in every channel.
    const WHITE: Self;
    /// How many channels there are.
    const CHANNELS: usize;
    /// Channel `i`; 0 if there is none.
    fn channel(self, i: usize) -> Real;
    /// The spectrum that linear sRGB coefficients of a scene file stand for.
    fn from_rgb(rgb: [f32; 3]) -> Self;
    /// What the film records: linear sRGB.
    fn to_rgb(self) -> Rgb;
    /// The same value in every channel.
    fn grey(x: Real) -> Self;
    /// The largest channel.
    fn max_channel(self) -> Real;
    /// The mean over channels: the importance of this spectrum where one number must decide.
    fn mean(self) -> Real;
    /// Whether every channel is zero.
    fn is_black(self) -> bool;
    /// Each channel through `f`.
    fn map(self, f: impl FnMut(Real) -> Real) -> Self;
    /// Each pair of channels through `f`.
    fn zip(self, other: Self, f: impl FnMut(Real, Real) -> Real) -> Self;
}

/// Linear sRGB: radiance, throughput, reflectance, by channel.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Rgb {
    /// Red.
    pub r: Real,
    /// Green.
    pub g: Real,
    /// Blue.
    pub b: Real,
}

impl Rgb {
    /// From its channels.
    #[inline(always)]
    pub const fn new(r: Real, g: Real, b: Real) -> Self {
        Self { r, g, b }
    }

    /// The channels in order.
    #[inline(always)]
    pub const fn to_array(self) -> [Real; 3] {
        [self.r, self.g, self.b]
    }
}

impl Spectrum for Rgb {
    const BLACK: Self = Self::new(0.0, 0.0, 0.0);
    const WHITE: Self = Self::new(1.0, 1.0, 1.0);
    const CHANNELS: usize = 3;

    #[inline(always)]
    fn channel(self, i: usize) -> Real {
        self.to_array().get(i).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    fn from_rgb(c: [f32; 3]) -> Self {
        Self::new(c[0] as Real, c[1] as Real, c[2] as Real)
    }
    #[inline(always)]
    fn to_rgb(self) -> Rgb {
        self
    }
    #[inline(always)]
    fn grey(x: Real) -> Self {
        Self::new(x, x, x)
    }
    #[inline(always)]
    fn max_channel(self) -> Real {
        self.r.max(self.g).max(self.b)
    }
    #[inline(always)]
    fn mean(self) -> Real {
        (self.r + self.g + self.b) * (1.0 / 3.0)
    }
    #[inline(always)]
    fn is_black(self) -> bool {
        self.r == 0.0 && self.g == 0.0 && self.b == 0.0
    }
    #[inline(always)]
    fn map(self, mut f: impl FnMut(Real) -> Real) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }
    #[inline(always)]
    fn zip(self, o: Self, mut f: impl FnMut(Real, Real) -> Real) -> Self {
        Self::new(f(self.r, o.r), f(self.g, o.g), f(self.b, o.b))
    }
}

impl core::ops::Add for Rgb {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
}
impl core::ops::Mul for Rgb {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }
}
impl core::ops::Mul<Real> for Rgb {
    type Output = Self;
    #[inline(always)]
    fn mul(self, k: Real) -> Self {
        self.map(|a| a * k)
    }
}
impl core::ops::AddAssign for Rgb {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl core::ops::MulAssign for Rgb {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}
impl core::ops::MulAssign<Real> for Rgb {
    #[inline(always)]
    fn mul_assign(&mut self, k: Real) {
        *self = *self * k;
    }
}
