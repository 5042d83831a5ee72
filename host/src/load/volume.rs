//! Mitsuba's `.vol`, version 3: numbers over a box, little-endian.
//!
//! ```text
//! "VOL" 3 · encoding 1 (f32) · texels in x, y, z · channels · box: low x y z, high x y z · data, channels fastest, then x, y, z
//! ```

use super::error::{LoadError, read};
use crate::description::{Grid, GridValues};
use std::path::Path;

/// Bytes before the data.
const HEADER: usize = 48;
/// Texels by axis that the kernel takes.
const MOST_TEXELS: u32 = 4096;

/// A file's grid, and the box that the file wants it to fill.
#[derive(Clone, Debug)]
pub struct Volume {
    /// Trilinear.
    pub grid: Grid,
    /// Low and high corner.
    pub bounds: [[f32; 3]; 2],
}

/// Reads a file.
pub fn load(path: &Path) -> Result<Volume, LoadError> {
    parse(&read(path)?, path)
}

/// Reads a file's bytes; `path` is for messages.
pub fn parse(bytes: &[u8], path: &Path) -> Result<Volume, LoadError> {
    one(bytes).map_err(|text| LoadError::malformed(path, 0, text))
}

fn one(bytes: &[u8]) -> Result<Volume, String> {
    let (head, data) = bytes.split_at_checked(HEADER).ok_or_else(|| {
        format!(
            "file of {} bytes ends too early, expected a header of {HEADER} bytes",
            bytes.len()
        )
    })?;
    if head[..3] != *b"VOL" {
        return Err("doesn't start with \"VOL\", expected a volume of Mitsuba's".into());
    }
    if head[3] != 3 {
        return Err(format!("version {}, expected 3", head[3]));
    }
    let word = |i: usize| u32::from_le_bytes(std::array::from_fn(|b| head[4 * i + b]));
    if word(1) != 1 {
        return Err(format!(
            "encoding {}, expected 1 (32-bit floating point)",
            word(1)
        ));
    }
    let size = [word(2), word(3), word(4)];
    if size.iter().any(|n| !(1..=MOST_TEXELS).contains(n)) {
        let [x, y, z] = size;
        return Err(format!(
            "{x} x {y} x {z} texels, expected 1 to {MOST_TEXELS} by axis"
        ));
    }
    let channels = word(5);
    if channels != 1 && channels != 3 {
        return Err(format!("{channels} channels, expected 1 or 3"));
    }
    // At most 2³⁶ · 3 · 4.
    let [x, y, z] = size.map(u64::from);
    let expected = x * y * z * u64::from(channels) * 4;
    if data.len() as u64 != expected {
        return Err(format!(
            "{} bytes of data, expected {expected}: {x} x {y} x {z} texels of {channels} x 4 bytes",
            data.len()
        ));
    }
    let corner = |i: usize| std::array::from_fn(|a| f32::from_bits(word(i + a)));
    let bounds = [corner(6), corner(9)];
    let numbers: Vec<f32> = data
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b))
        .collect();
    if let Some(at) = numbers.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
        let texel = at as u64 / u64::from(channels);
        return Err(format!(
            "texel ({}, {}, {}) is {}, expected a finite number >= 0",
            texel % x,
            texel / x % y,
            texel / x / y,
            numbers[at]
        ));
    }
    let values = match channels {
        1 => GridValues::Gray(numbers),
        _ => GridValues::Rgb(numbers.as_chunks::<3>().0.to_vec()),
    };
    Ok(Volume {
        grid: Grid {
            size,
            values,
            nearest: false,
        },
        bounds,
    })
}
