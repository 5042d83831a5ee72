//! Who looks, by what light, and what colours stand for: tables over wavelength, linear between their rows.

#![allow(clippy::excessive_precision)] // not excessive in the double-precision package

use super::{Rgb, Spectrum};
use crate::real::Real;

/// The wavelengths of the first row and the last, nm.
pub const FIRST: Real = 380.0;
/// See [`FIRST`].
pub const LAST: Real = 780.0;
/// From one row to the next, nm.
const STEP: Real = 10.0;
const ROWS: usize = 41;

/// ∫ȳ: a flat spectrum of value 1 has luminance 1.
const FLAT: Real = 106.856_895;
/// ∫ȳ·D65 of this table.
const WHITE: Real = 10_566.308_847;

/// From XYZ to linear sRGB (IEC 61966-2-1: the primaries' chromaticities, white by this table's D65 so that white is 1, 1, 1).
const TO_RGB: [[Real; 3]; 3] = [
    [3.240_358_06, -1.537_092_92, -0.498_516_62],
    [-0.969_061_42, 1.875_614_82, 0.041_547_25],
    [0.055_764_97, -0.204_471_56, 1.059_534_47],
];

/// By wavelength: x̄, ȳ, z̄ of the CIE 1931 standard observer (CIE 15, 2°), the standard illuminant D65, and how much red and how much
/// green a spectrum has for a unit of those coefficients; what is left to 1 is how much blue.
///
/// Red, green and blue are the smoothest three spectra (least sum of squared second differences) within [0, 1] that add up to 1 and
/// that, lit by D65, the observer sees as sRGB's three primaries: 6 linear equations and bounds, a quadratic programme. So every
/// colour within the gamut stands for a spectrum within [0, 1], a linear function of its coefficients (in the manner of Mallett & Yuksel 2019).
#[rustfmt::skip]
const TABLE: [[f32; 6]; ROWS] = [
    [0.001368, 3.9e-05, 0.00645, 49.9755, 0.25998, 0.0],
    [0.004243, 0.00012, 0.02005, 54.6482, 0.21767, 0.0],
    [0.01431, 0.000396, 0.06785, 82.7549, 0.17538, 0.0],
    [0.04351, 0.00121, 0.2074, 91.486, 0.1332, 0.0],
    [0.13438, 0.004, 0.6456, 93.4318, 0.09159, 0.0],
    [0.2839, 0.0116, 1.3856, 86.6823, 0.05214, 0.0],
    [0.34828, 0.023, 1.74706, 104.865, 0.01908, 0.0],
    [0.3362, 0.038, 1.77211, 117.008, 0.0, 0.0],
    [0.2908, 0.06, 1.6692, 117.812, 0.0, 0.00584],
    [0.19536, 0.09098, 1.28764, 114.861, 0.0, 0.09618],
    [0.09564, 0.13902, 0.81295, 115.923, 0.0, 0.27609],
    [0.03201, 0.20802, 0.46518, 108.811, 0.0, 0.50769],
    [0.0049, 0.323, 0.272, 109.354, 0.0, 0.73506],
    [0.0093, 0.503, 0.1582, 107.802, 0.0, 0.90601],
    [0.06327, 0.71, 0.07825, 104.79, 0.0, 0.99073],
    [0.1655, 0.862, 0.04216, 107.689, 0.0, 1.0],
    [0.2904, 0.954, 0.0203, 104.405, 0.0, 1.0],
    [0.43345, 0.99495, 0.00875, 104.046, 0.0, 1.0],
    [0.5945, 0.995, 0.0039, 100.0, 0.0, 0.99822],
    [0.7621, 0.952, 0.0021, 96.3342, 0.02383, 0.93755],
    [0.9163, 0.87, 0.00165, 95.788, 0.19065, 0.75577],
    [1.0263, 0.757, 0.0011, 88.6856, 0.46667, 0.49373],
    [1.0622, 0.631, 0.0008, 90.0062, 0.74766, 0.23742],
    [1.0026, 0.503, 0.00034, 89.5991, 0.93627, 0.06373],
    [0.85445, 0.381, 0.00019, 87.6987, 1.0, 0.0],
    [0.6424, 0.265, 5e-05, 83.2886, 1.0, 0.0],
    [0.4479, 0.175, 2e-05, 83.6992, 1.0, 0.0],
    [0.2835, 0.107, 0.0, 80.0268, 1.0, 0.0],
    [0.1649, 0.061, 0.0, 80.2146, 1.0, 0.0],
    [0.0874, 0.032, 0.0, 82.2778, 1.0, 0.0],
    [0.04677, 0.017, 0.0, 78.2842, 1.0, 0.0],
    [0.0227, 0.00821, 0.0, 69.7213, 1.0, 0.0],
    [0.011359, 0.004102, 0.0, 71.6091, 1.0, 0.0],
    [0.00579, 0.002091, 0.0, 74.349, 1.0, 0.0],
    [0.002899, 0.001047, 0.0, 61.604, 1.0, 0.0],
    [0.00144, 0.00052, 0.0, 69.8856, 1.0, 0.0],
    [0.00069, 0.000249, 0.0, 75.087, 1.0, 0.0],
    [0.000332, 0.00012, 0.0, 63.5927, 1.0, 0.0],
    [0.000166, 6e-05, 0.0, 46.4182, 1.0, 0.0],
    [8.3e-05, 3e-05, 0.0, 66.8054, 1.0, 0.0],
    [4.2e-05, 1.5e-05, 0.0, 63.3828, 1.0, 0.0],
];

/// What the observer sees of a spectrum of radiance, in linear sRGB: a flat one of value 1 has luminance 1.
pub fn seen(radiance: impl Fn(Real) -> Real) -> Rgb {
    let mut sum = Rgb::BLACK;
    for nm in FIRST as u32..LAST as u32 {
        // The middle of each nanometre.
        let lambda = nm as Real + 0.5;
        let [r, g, b] = Wave::at(lambda).rgb;
        sum += Rgb::new(r, g, b) * radiance(lambda);
    }
    sum
}

/// White light, the standard illuminant D65, at `lambda`: of luminance 1.
pub fn white(lambda: Real) -> Real {
    Wave::at(lambda).white
}

/// What there is to know of a wavelength.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    /// What its radiance adds to linear sRGB, per nm.
    pub rgb: [Real; 3],
    /// D65, of luminance 1.
    pub white: Real,
    /// What red, green and blue stand for here: they add up to 1.
    pub basis: [Real; 3],
}

impl Wave {
    /// At `lambda`, nm.
    pub fn at(lambda: Real) -> Self {
        let x = ((lambda - FIRST) / STEP).clamp(0.0, (ROWS - 1) as Real);
        let low = (x as usize).min(ROWS - 2);
        let t = x - low as Real;
        let row = |i: usize| TABLE.get(i).copied().unwrap_or([0.0; 6]);
        let (a, b) = (row(low), row(low + 1));
        let mut value: [Real; 6] = [0.0; 6];
        for ((v, a), b) in value.iter_mut().zip(a).zip(b) {
            *v = Real::from(a) * (1.0 - t) + Real::from(b) * t;
        }
        let [x, y, z, white, red, green] = value;
        let rgb = TO_RGB.map(|[a, b, c]| (a * x + b * y + c * z) * (1.0 / FLAT));
        Self {
            rgb,
            white: white * (FLAT / WHITE),
            // Rounding may leave less than nothing.
            basis: [red, green, (1.0 - red - green).max(0.0)],
        }
    }
}
