//! Spectra, and the colours that they are where paths carry no wavelengths.

use crate::description::Color;
use etendue::spectrum::{Rgb, interpolate, seen, white};

/// Appends rows to a blob's texels: their first word and their number.
pub(crate) fn append(texels: &mut Vec<u32>, rows: &[[f32; 2]]) -> [u32; 2] {
    let first = texels.len() as u32;
    texels.extend(rows.as_flattened().iter().map(|x| x.to_bits()));
    [first, rows.len() as u32]
}

/// The value at a wavelength in nm.
pub(crate) fn at(rows: &[[f32; 2]], nm: f32) -> f32 {
    interpolate(bytemuck::cast_slice(rows), nm)
}

/// The nearest colour with no negative channel.
fn color(rgb: Rgb) -> Color {
    rgb.to_array().map(|x| x.max(0.0))
}

/// The colour of light of a spectrum; a flat one of value 1 has luminance 1.
pub(crate) fn emitted(rows: &[[f32; 2]]) -> Color {
    color(seen(|nm| at(rows, nm)))
}

/// The colour of a spectrum times that of white light.
fn by_white_light(rows: &[[f32; 2]]) -> Color {
    color(seen(|nm| at(rows, nm) * white(nm)))
}

/// What a spectrum that is no light is to red, green and blue, by white light: a flat one is its value in each, and none is beyond its rows.
pub(crate) fn weighed(rows: &[[f32; 2]]) -> Color {
    let values = || rows.iter().map(|[_, x]| *x);
    let (least, most) = (
        values().fold(f32::INFINITY, f32::min),
        values().fold(0.0, f32::max),
    );
    by_white_light(rows).map(|x| x.max(least).min(most))
}

/// The colour of what reflects a spectrum of white light.
pub(crate) fn reflected(rows: &[[f32; 2]]) -> Color {
    by_white_light(rows).map(|x| x.min(1.0))
}
