//! The image in tiles: what threads take one after the other.

use super::RenderError;
use crate::memory::attempt;
use etendue::film::Sum;

/// Columns and rows of a tile.
const SIDE: u32 = 16;

/// A part of the image, and the sums of its pixels, row by row.
pub(super) struct Tile<'a> {
    /// First column and row.
    corner: [u32; 2],
    columns: u32,
    sums: &'a mut [Sum],
}

impl Tile<'_> {
    /// The pixels, each with its sum.
    pub fn pixels(&mut self) -> impl Iterator<Item = ([u32; 2], &mut Sum)> {
        let ([left, top], columns) = (self.corner, self.columns);
        self.sums
            .iter_mut()
            .zip(0u32..)
            .map(move |(sum, i)| ([left + i % columns, top + i / columns], sum))
    }

    /// How many pixels it has.
    pub fn len(&self) -> u64 {
        self.sums.len() as u64
    }
}

/// Cuts an image's sums, which stand tile by tile, into tiles.
pub(super) fn cut(mut sums: &mut [Sum], [width, height]: [u32; 2]) -> Vec<Tile<'_>> {
    let mut tiles = Vec::new();
    for top in (0..height).step_by(SIDE as usize) {
        for left in (0..width).step_by(SIDE as usize) {
            let (columns, rows) = (SIDE.min(width - left), SIDE.min(height - top));
            let (own, rest) = sums.split_at_mut((columns * rows) as usize);
            sums = rest;
            tiles.push(Tile {
                corner: [left, top],
                columns,
                sums: own,
            });
        }
    }
    tiles
}

/// All pixels, in the order in which their sums stand.
pub(super) fn order([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let starts = |n: u32| (0..n).step_by(SIDE as usize);
    let tiles = starts(height).flat_map(move |top| starts(width).map(move |left| [left, top]));
    tiles.flat_map(move |[left, top]| {
        let (right, bottom) = (width.min(left + SIDE), height.min(top + SIDE));
        (top..bottom).flat_map(move |y| (left..right).map(move |x| [x, y]))
    })
}

/// A film of `size`, all zero.
///
/// # Errors
/// If there isn't enough memory.
pub(super) fn film(size: [u32; 2]) -> Result<Vec<Sum>, RenderError> {
    let too_large = RenderError::TooLarge { size };
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    let Ok(pixels) = usize::try_from(pixels) else {
        return Err(too_large);
    };
    let mut film = attempt(pixels).map_err(|_| too_large)?;
    film.resize(pixels, [0; 3]);
    Ok(film)
}

#[cfg(test)]
mod tests {
    use super::{cut, film, order};

    #[test]
    fn tiles_cover_the_image_once() {
        for [width, height] in [[1, 1], [16, 16], [33, 17], [15, 40]] {
            let mut sums = film([width, height]).unwrap();
            let mut seen = vec![0; sums.len()];
            let mut expected = order([width, height]);
            for tile in &mut cut(&mut sums, [width, height]) {
                for ([x, y], _) in tile.pixels() {
                    assert_eq!(expected.next(), Some([x, y]));
                    assert!(x < width);
                    seen[(y * width + x) as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{width} × {height}");
        }
    }

    #[test]
    fn what_no_memory_holds_is_refused() {
        let error = film([u32::MAX, u32::MAX]).unwrap_err();
        assert!(error.to_string().contains("4294967295"), "{error}");
    }
}
