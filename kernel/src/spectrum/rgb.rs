//! Three broad channels: what scenes need that neither disperse nor give spectra.

use super::Spectrum;
use crate::real::Real;

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
    type Waves = ();
    const BLACK: Self = Self::new(0.0, 0.0, 0.0);
    const WHITE: Self = Self::new(1.0, 1.0, 1.0);
    const CHANNELS: usize = 3;
    const FILM: bool = true;

    #[inline(always)]
    fn draw(xi: Real) -> ((), usize) {
        ((), (xi * 3.0) as usize)
    }
    #[inline(always)]
    fn only(self, i: usize) -> Self {
        match i {
            0 => Self::new(self.r, 0.0, 0.0),
            1 => Self::new(0.0, self.g, 0.0),
            _ => Self::new(0.0, 0.0, self.b),
        }
    }
    #[inline(always)]
    fn channel(self, i: usize) -> Real {
        self.to_array().get(i).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    fn lift(c: [f32; 3], (): &()) -> Self {
        Self::new(c[0] as Real, c[1] as Real, c[2] as Real)
    }
    #[inline(always)]
    fn light(rgb: [f32; 3], waves: &()) -> Self {
        Self::lift(rgb, waves)
    }
    #[inline(always)]
    fn to_rgb(self, (): &()) -> Rgb {
        self
    }
    #[inline(always)]
    fn wavelengths((): &()) -> Self {
        // The dominant wavelengths of sRGB's primaries.
        Self::new(611.4, 549.1, 464.3)
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
    fn recorded(self, (): &()) -> Option<Rgb> {
        let fine = |x: Real| (0.0..Real::INFINITY).contains(&x);
        (fine(self.r) && fine(self.g) && fine(self.b)).then_some(self)
    }
    #[inline(always)]
    fn tabulated(_: &[[u32; 2]], (): &()) -> Option<Self> {
        None
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

super::operators!(Rgb);
