//! Images: PNG, JPEG, Radiance HDR and OpenEXR. Row 0 is the top. Integers are sRGB-coded unless the
//! scene calls them raw; floats are linear.

use super::error::{LoadError, Problem, read};
use crate::description::{Color, Image, Texels};
use image::{DynamicImage, ImageReader, Limits};
use std::io::Cursor;
use std::path::Path;

/// More pixels than this are refused.
const MOST_PIXELS: u64 = 1 << 28;
/// No format packs a pixel into less than 1/2048 of a byte: a header that promises more lies.
const PIXELS_PER_BYTE: u64 = 2048;

/// Reads an image. `raw`: integers are linear too.
pub fn load(path: &Path, raw: bool) -> Result<Image, LoadError> {
    let bytes = read(path)?;
    let image = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr(&bytes)
    } else {
        other(&bytes, raw)
    };
    let image = image.map_err(|text| LoadError::malformed(path, 0, text))?;
    if let Texels::Float(texels) = &image.texels
        && let Some(i) = texels.iter().position(|t| !t.iter().all(|x| x.is_finite()))
    {
        let (x, y) = (i as u32 % image.width, i as u32 / image.width);
        let problem = Problem::Invalid {
            what: format!("pixel ({x}, {y})"),
            expected: "finite".into(),
            found: format!("{:?}", texels[i]),
        };
        return Err(LoadError::file(path, problem));
    }
    Ok(image)
}

/// Reads an image as linear colours.
pub fn load_linear(path: &Path) -> Result<(u32, u32, Vec<Color>), LoadError> {
    let image = load(path, false)?;
    Ok((image.width, image.height, linear(&image.texels)))
}

/// Texels as linear colours.
pub fn linear(texels: &Texels) -> Vec<Color> {
    match texels {
        Texels::Srgb8(t) => {
            let table: Vec<f32> = (0..=255)
                .map(|i| srgb_to_linear(i as f32 / 255.0))
                .collect();
            t.iter()
                .map(|p| {
                    [
                        table[usize::from(p[0])],
                        table[usize::from(p[1])],
                        table[usize::from(p[2])],
                    ]
                })
                .collect()
        }
        Texels::Linear8(t) => t
            .iter()
            .map(|p| [p[0], p[1], p[2]].map(|x| f32::from(x) / 255.0))
            .collect(),
        Texels::Float(t) => t.clone(),
    }
}

/// The sRGB curve of IEC 61966-2-1, decoded.
pub fn srgb_to_linear(x: f32) -> f32 {
    if x <= 0.04045 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

fn check_size(width: u64, height: u64, bytes: usize) -> Result<(), String> {
    let pixels = width.saturating_mul(height);
    let most = MOST_PIXELS.min((bytes as u64).saturating_mul(PIXELS_PER_BYTE));
    if pixels == 0 || pixels > most {
        return Err(format!(
            "image says {width} x {height} pixels in a file of {bytes} bytes, expected 1 to {most} pixels"
        ));
    }
    Ok(())
}

fn other(bytes: &[u8], raw: bool) -> Result<Image, String> {
    let expected =
        |e: image::ImageError| format!("{e}, expected a PNG, JPEG, Radiance HDR or OpenEXR image");
    let reader = || {
        ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|e| e.to_string())
    };
    let (width, height) = reader()?.into_dimensions().map_err(expected)?;
    check_size(u64::from(width), u64::from(height), bytes.len())?;
    let mut reader = reader()?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_PIXELS * 16);
    reader.limits(limits);
    let decoded = reader.decode().map_err(expected)?;
    let decode16 = |x: u16| {
        let x = f32::from(x) / 65535.0;
        if raw { x } else { srgb_to_linear(x) }
    };
    let float = |d: &DynamicImage| d.to_rgb32f().pixels().map(|p| p.0).collect();
    let texels = match decoded {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Texels::Float(float(&decoded))
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => Texels::Float(
            decoded
                .to_rgb16()
                .pixels()
                .map(|p| p.0.map(decode16))
                .collect(),
        ),
        _ => {
            let texels = decoded.to_rgba8().pixels().map(|p| p.0).collect();
            if raw {
                Texels::Linear8(texels)
            } else {
                Texels::Srgb8(texels)
            }
        }
    };
    Ok(Image {
        width,
        height,
        texels,
    })
}

fn exr(bytes: &[u8]) -> Result<Image, String> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let fail = |e: exr::error::Error| format!("{e}, expected an OpenEXR image");
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(fail)?;
    for header in &meta.headers {
        check_size(
            header.layer_size.0 as u64,
            header.layer_size.1 as u64,
            bytes.len(),
        )?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(fail)?;
    let layer = &image.layer_data;
    let (width, height) = (layer.size.0, layer.size.1);
    let channels = &layer.channel_data.list;
    let find = |name: &str| channels.iter().find(|c| c.name.eq_case_insensitive(name));
    let rgb = match (find("R"), find("G"), find("B"), find("Y")) {
        (Some(r), Some(g), Some(b), _) => [r, g, b],
        (_, _, _, Some(y)) => [y, y, y],
        _ => {
            let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
            return Err(format!(
                "channels {}, expected R, G and B, or Y",
                names.join(", ")
            ));
        }
    };
    let pixels = width * height;
    let mut texels = vec![[0.0f32; 3]; pixels];
    for (k, channel) in rgb.iter().enumerate() {
        if channel.sample_data.len() != pixels {
            return Err(format!(
                "channel {} is subsampled, expected one sample per pixel",
                channel.name
            ));
        }
        for (texel, value) in texels.iter_mut().zip(channel.sample_data.values_as_f32()) {
            texel[k] = value;
        }
    }
    Ok(Image {
        width: width as u32,
        height: height as u32,
        texels: Texels::Float(texels),
    })
}

/// Every texel replaced by its luminance, if they aren't grey already.
pub fn to_grey(image: &mut Image) {
    let grey = |p: &[u8; 4]| p[0] == p[1] && p[1] == p[2];
    let is_grey = match &image.texels {
        Texels::Srgb8(t) | Texels::Linear8(t) => t.iter().all(grey),
        Texels::Float(t) => t.iter().all(|p| p[0] == p[1] && p[1] == p[2]),
    };
    if !is_grey {
        let mut texels = linear(&image.texels);
        for t in &mut texels {
            *t = [0.212_671 * t[0] + 0.715_16 * t[1] + 0.072_169 * t[2]; 3];
        }
        image.texels = Texels::Float(texels);
    }
}
