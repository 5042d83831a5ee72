//! What a path carries: a few numbers per path vertex, one per channel or wavelength.

/// Arithmetic by channel.
macro_rules! operators {
    ($spectrum:ident) => {
        impl core::ops::Add for $spectrum {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                self.zip(o, |a, b| a + b)
            }
        }
        impl core::ops::Mul for $spectrum {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                self.zip(o, |a, b| a * b)
            }
        }
        impl core::ops::Mul<Real> for $spectrum {
            type Output = Self;
            #[inline(always)]
            fn mul(self, k: Real) -> Self {
                self.map(|a| a * k)
            }
        }
        impl core::ops::AddAssign for $spectrum {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }
        impl core::ops::MulAssign for $spectrum {
            #[inline(always)]
            fn mul_assign(&mut self, o: Self) {
                *self = *self * o;
            }
        }
        impl core::ops::MulAssign<Real> for $spectrum {
            #[inline(always)]
            fn mul_assign(&mut self, k: Real) {
                *self = *self * k;
            }
        }
    };
}
use operators;

#[cfg(feature = "spectral")]
mod hero;
#[cfg(feature = "spectral")]
mod observer;
mod rgb;

#[cfg(feature = "spectral")]
pub use hero::{Hero, Waves, interpolate};
#[cfg(feature = "spectral")]
pub use observer::{FIRST, LAST, seen, white};
pub use rgb::Rgb;

use crate::real::Real;

/// The spectral samples a path carries. Estimators are generic over it; [`Rgb`] is what scenes need
/// that neither disperse nor give spectra (`transport.md` §9).
pub trait Spectrum:
    Copy
    + PartialEq
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
    /// Whether they are those of the film, so that what is less here is less there.
    const FILM: bool;
    /// Channel `i`; 0 if there is none.
    fn channel(self, i: usize) -> Real;
    /// What the channels of a path are, where that isn't the same for all paths.
    type Waves: Copy + core::fmt::Debug;
    /// Draws the channels of a path with ξ, and which of them leads ([`crate::medium`]).
    fn draw(xi: Real) -> (Self::Waves, usize);
    /// The smooth spectrum that linear sRGB coefficients of a scene file stand for: a reflectance, an albedo, an extinction. Linear in
    /// them; where they are equal it is the same at all wavelengths.
    fn lift(rgb: [f32; 3], waves: &Self::Waves) -> Self;
    /// The same of light: white is the white of sRGB.
    fn light(rgb: [f32; 3], waves: &Self::Waves) -> Self;
    /// What the film records: linear sRGB. A single wavelength is beyond its gamut, so that channels may be negative.
    fn to_rgb(self, waves: &Self::Waves) -> Rgb;
    /// The spectrum that a table of (nm, value) stands for, linear between its rows; `None` where channels are too broad for that.
    fn tabulated(rows: &[[u32; 2]], waves: &Self::Waves) -> Option<Self>;
    /// The wavelengths of the channels, nm.
    fn wavelengths(waves: &Self::Waves) -> Self;
    /// Channel `i` alone, the others zero.
    #[must_use]
    fn only(self, i: usize) -> Self;
    /// The same value in every channel.
    fn grey(x: Real) -> Self;
    /// The largest channel.
    fn max_channel(self) -> Real;
    /// The mean over channels: the importance of this spectrum where one number must decide.
    fn mean(self) -> Real;
    /// [`Self::to_rgb`]; `None` where a channel of either is NaN or infinite, or one of this is negative.
    fn recorded(self, waves: &Self::Waves) -> Option<Rgb>;
    /// Whether every channel is zero.
    fn is_black(self) -> bool;
    /// Each channel through `f`.
    fn map(self, f: impl FnMut(Real) -> Real) -> Self;
    /// Each pair of channels through `f`.
    fn zip(self, other: Self, f: impl FnMut(Real, Real) -> Real) -> Self;
}
