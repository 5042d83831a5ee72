//! A contact sheet: pictures in rows, each with its caption below.

use super::lettering::{ADVANCE, LINE, dots, wrap};
use super::{Linear, Tone};
use crate::memory::attempt;

/// Pixels around pictures.
const MARGIN: u32 = 14;
/// Pixels from a picture to its caption.
const GAP: u32 = 6;
/// What is behind the pictures: dark, so that the eye judges their shadows.
const PAPER: [f32; 3] = [0.11; 3];
/// Captions.
const INK: [f32; 3] = [0.82; 3];

/// A picture on the sheet.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Radiance.
    pub image: Linear,
    /// How it is shown.
    pub tone: Tone,
    /// What it shows, in the letters that [`super::can_write`] knows.
    pub caption: String,
}

impl Picture {
    /// The caption in lines as wide as the picture.
    fn lines(&self) -> Vec<String> {
        wrap(&self.caption, self.image.size[0] / ADVANCE)
    }

    /// Rows of the picture and its caption.
    fn height(&self) -> u64 {
        let below = match self.lines().len() as u64 {
            0 => 0,
            n => u64::from(GAP) + n * u64::from(LINE),
        };
        u64::from(self.image.size[1]) + below
    }
}

/// The sheet of `rows`, to be written with [`super::AS_IT_IS`]. `None` if it doesn't fit into memory.
pub fn sheet(rows: &[Vec<Picture>]) -> Option<Linear> {
    let margin = u64::from(MARGIN);
    let widths = rows.iter().map(|row| {
        let each = row.iter().map(|p| margin + u64::from(p.image.size[0]));
        margin + each.sum::<u64>()
    });
    let heights = rows
        .iter()
        .map(|row| row.iter().map(Picture::height).max().unwrap_or(0));
    let width = widths.max().unwrap_or(margin);
    let height = margin + heights.clone().map(|h| margin + h).sum::<u64>();
    let size = [u32::try_from(width).ok()?, u32::try_from(height).ok()?];
    let count = usize::try_from(width.checked_mul(height)?).ok()?;
    let mut pixels = attempt(count).ok()?;
    pixels.resize(count, PAPER);
    let mut sheet = Linear { size, pixels };
    let mut top = MARGIN;
    for (row, height) in rows.iter().zip(heights) {
        let mut left = MARGIN;
        for picture in row {
            sheet.paste(picture, [left, top]);
            left += picture.image.size[0] + MARGIN;
        }
        top += height as u32 + MARGIN;
    }
    Some(sheet)
}

impl Linear {
    /// The pixel at a place within the image.
    fn at(&mut self, [x, y]: [u32; 2]) -> &mut [f32; 3] {
        &mut self.pixels[y as usize * self.size[0] as usize + x as usize]
    }

    fn paste(&mut self, picture: &Picture, [left, top]: [u32; 2]) {
        let [width, height] = picture.image.size;
        let mut shown = picture.image.pixels.iter();
        for y in 0..height {
            for (x, pixel) in (0..width).zip(&mut shown) {
                let coded = pixel.map(|v| f32::from(picture.tone.apply(v)) / 255.0);
                *self.at([left + x, top + y]) = coded;
            }
        }
        for (i, line) in (0..).zip(picture.lines()) {
            let base = top + height + GAP + i * LINE;
            // A picture narrower than a letter cuts it off.
            dots(&line, |x, y| {
                if x < width {
                    *self.at([left + x, base + y]) = INK;
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{GAP, INK, LINE, MARGIN, PAPER, Picture, sheet};
    use crate::develop::{AS_IT_IS, Curve, Linear, Tone};

    fn picture(size: [u32; 2], value: f32, caption: &str) -> Picture {
        Picture {
            image: Linear {
                size,
                pixels: vec![[value; 3]; (size[0] * size[1]) as usize],
            },
            tone: Tone {
                exposure: 1.0,
                curve: Curve::None,
            },
            caption: caption.into(),
        }
    }

    #[test]
    fn pictures_and_captions_have_their_places() {
        let rows = [
            vec![picture([12, 3], 0.5, "ab cd"), picture([30, 8], 0.1, "")],
            vec![picture([4, 2], 0.25, "I")],
        ];
        let mut sheet = sheet(&rows).unwrap();
        let first = 3 + GAP + 2 * LINE;
        let second = 2 + GAP + LINE;
        assert_eq!(
            sheet.size,
            [12 + 30 + 3 * MARGIN, first + second + 3 * MARGIN]
        );
        assert_eq!(*sheet.at([0, 0]), PAPER);
        // Exposed by a stop, and coded.
        assert_eq!(*sheet.at([MARGIN, MARGIN]), [1.0; 3]);
        let coded = *sheet.at([MARGIN, MARGIN + first + MARGIN]);
        assert_eq!(AS_IT_IS.apply(coded[0]), rows[1][0].tone.apply(0.25));
        // The b's stem.
        assert_eq!(*sheet.at([MARGIN + 6, MARGIN + 3 + GAP]), INK);
    }

    #[test]
    fn coded_values_are_written_as_they_are() {
        for coded in 0..=255u8 {
            assert_eq!(AS_IT_IS.apply(f32::from(coded) / 255.0), coded);
        }
    }
}
