//! The observer against chromaticities that the CIE publishes (CIE 15:2004, tables T.3 and 8.1).

use super::kernel::real::Real;
use super::kernel::spectrum::{Rgb, seen, white};

/// x, y and Y by the published matrix of sRGB (IEC 61966-2-1), which is rounded to four digits.
fn chromaticity(rgb: Rgb) -> [f64; 3] {
    let [r, g, b] = rgb.to_array().map(|c| c as f64);
    let x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
    [x / (x + y + z), y / (x + y + z), y]
}

/// Tungsten at 2856 K: CIE 15, eq. 4.1.
fn tungsten(lambda: Real) -> Real {
    let planck = |lambda: f64| lambda.powi(-5) / ((1.435e7 / (2848.0 * lambda)).exp() - 1.0);
    (planck(lambda as f64) / planck(560.0)) as Real
}

/// The table's steps of 10 nm and the visible range leave a few parts in ten thousand.
#[test]
fn illuminants_have_their_chromaticities() {
    for (name, found, x, y) in [
        ("E", chromaticity(seen(|_| 1.0)), 1.0 / 3.0, 1.0 / 3.0),
        ("A", chromaticity(seen(tungsten)), 0.447_57, 0.407_45),
        ("D65", chromaticity(seen(white)), 0.312_72, 0.329_03),
    ] {
        let [fx, fy, _] = found;
        assert!(
            (fx - x).abs() < 5e-4 && (fy - y).abs() < 5e-4,
            "{name}: {found:?}"
        );
    }
    let [_, _, luminance] = chromaticity(seen(|_| 1.0));
    assert!((luminance - 1.0).abs() < 5e-4, "{luminance}");
}

#[test]
fn white_is_white() {
    for c in seen(white).to_array() {
        assert!((c - 1.0).abs() < 2e-5, "{c}");
    }
}

/// Wavelengths far apart are seen in their colours: single ones lie outside of sRGB's triangle.
#[test]
fn lines_are_beyond_the_gamut() {
    let line = |at: Real| seen(move |l| if (l - at).abs() < 1.0 { 1.0 } else { 0.0 });
    let (blue, green, red) = (line(450.0), line(520.0), line(650.0));
    assert!(blue.b > 10.0 * blue.r.abs() && blue.g < 0.0);
    assert!(green.r < 0.0 && green.g > 0.0 && green.b < green.g);
    assert!(red.r > 0.0 && red.g < 0.0 && red.b.abs() < 0.1 * red.r);
}
