//! Image files. A file appears under its name only when it is whole.

use super::Tone;
use super::tone::linear;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

/// A linear image.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

/// File formats, by extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR, 32-bit float, linear.
    Exr,
    /// Radiance RGBE, linear.
    Hdr,
    /// 8-bit, tone-mapped.
    Png,
}

/// Why an image can't be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", .path.display())]
pub struct ImageError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong and what was expected.
    pub reason: String,
}

fn error(path: &Path, reason: impl ToString) -> ImageError {
    ImageError {
        path: path.to_owned(),
        reason: reason.to_string(),
    }
}

impl Format {
    /// What the extension of `path` says.
    ///
    /// # Errors
    /// If it isn't exr, hdr or png.
    pub fn of(path: &Path) -> Result<Self, ImageError> {
        let extension = path.extension().and_then(|e| e.to_str());
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("hdr") => Ok(Self::Hdr),
            Some("png") => Ok(Self::Png),
            _ => Err(error(
                path,
                "expected a name that ends in .exr, .hdr or .png",
            )),
        }
    }
}

/// An image file to be: checked before anything is rendered.
#[derive(Clone, Debug)]
pub struct Output {
    path: PathBuf,
    format: Format,
}

impl Output {
    /// Makes sure that `path` can be written, without touching what is there.
    ///
    /// # Errors
    /// An extension that isn't exr, hdr or png, or a folder that can't be written.
    pub fn open(path: &Path) -> Result<Self, ImageError> {
        let format = Format::of(path)?;
        check_writable(path)?;
        Ok(Self {
            path: path.to_owned(),
            format,
        })
    }
}

/// Writes an image to all `outputs`: each gets its name when all of them are on the disk.
///
/// # Errors
/// What the file system or an encoder says.
pub fn write(outputs: &[Output], image: &Linear, tone: Tone) -> Result<(), ImageError> {
    let encoded = outputs
        .iter()
        .map(|o| encode(o.format, image, tone).map_err(|e| error(&o.path, e)))
        .collect::<Result<Vec<_>, _>>()?;
    let files: Vec<_> = outputs
        .iter()
        .zip(&encoded)
        .map(|(output, bytes)| (output.path.as_path(), bytes.as_slice()))
        .collect();
    write_files(&files)
}

/// Makes sure that a file can be made at `path`, and leaves nothing behind.
///
/// # Errors
/// A folder of that name, or one around it that can't be written.
pub fn check_writable(path: &Path) -> Result<(), ImageError> {
    if path.is_dir() {
        return Err(error(path, "is a folder, expected a file"));
    }
    temporary_beside(path).map(drop)
}

/// Writes files whole: first all of them under other names, which then are changed.
///
/// # Errors
/// What the file system says.
pub fn write_files(files: &[(&Path, &[u8])]) -> Result<(), ImageError> {
    let mut written = Vec::new();
    for &(path, bytes) in files {
        let mut file = temporary_beside(path)?;
        file.as_file_mut()
            .write_all(bytes)
            .and_then(|()| file.as_file().sync_all())
            .map_err(|e| unwritable(path, &e))?;
        written.push((path, file));
    }
    for (path, file) in written {
        file.persist(path).map_err(|e| unwritable(path, &e.error))?;
    }
    Ok(())
}

/// A temporary file in the folder of `path`, which it can be renamed to.
fn temporary_beside(path: &Path) -> Result<tempfile::NamedTempFile, ImageError> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // As any new file: readable by others, if the process's mask lets them.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder
        .prefix(".etendue-")
        .tempfile_in(folder)
        .map_err(|e| unwritable(path, &e))
}

/// The reason, without the temporary name that `tempfile` puts after it: it means nothing to the reader.
fn unwritable(path: &Path, e: &std::io::Error) -> ImageError {
    let text = e.to_string();
    let reason = text.split_once(" at path ").map_or(&*text, |(it, _)| it);
    error(path, format!("can't be written: {reason}"))
}

/// An image as a file of `format`.
///
/// # Errors
/// What the encoder says.
pub fn encode(
    format: Format,
    image: &Linear,
    tone: Tone,
) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let [w, h] = image.size;
    let mut out = Vec::new();
    match format {
        Format::Exr => {
            use exr::prelude::*;
            let channels = SpecificChannels::rgb(|p: Vec2<usize>| {
                let [r, g, b] = image.pixels[p.y() * w as usize + p.x()];
                (r, g, b)
            });
            // Lines in order: the crate's default lets its threads write blocks as they finish, and then one image
            // makes different files.
            let layer = Layer::new(
                (w as usize, h as usize),
                LayerAttributes::default(),
                Encoding::SMALL_LOSSLESS,
                channels,
            );
            Image::from_layer(layer)
                .write()
                .to_buffered(Cursor::new(&mut out))?;
        }
        Format::Hdr => {
            let pixels: Vec<_> = image.pixels.iter().map(|&p| image::Rgb(p)).collect();
            image::codecs::hdr::HdrEncoder::new(&mut out)
                .encode(&pixels, w as usize, h as usize)?;
        }
        Format::Png => {
            let values = image.pixels.as_flattened().iter();
            let bytes: Vec<u8> = values.map(|&x| tone.apply(x)).collect();
            let encoder = image::codecs::png::PngEncoder::new(&mut out);
            let color = image::ExtendedColorType::Rgb8;
            image::ImageEncoder::write_image(encoder, &bytes, w, h, color)?;
        }
    }
    Ok(out)
}

/// Reads an image: EXR and HDR as they are, PNG with its sRGB coding undone (alpha is left out).
///
/// # Errors
/// A missing or damaged file, or one of another format; a value that is no finite number.
pub fn read(path: &Path) -> Result<Linear, ImageError> {
    let format = Format::of(path)?;
    let bytes = std::fs::read(path).map_err(|e| error(path, e))?;
    let image = match format {
        Format::Exr => decode_exr(&bytes).map_err(|e| error(path, e))?,
        Format::Hdr => decode(&bytes, image::ImageFormat::Hdr).map_err(|e| error(path, e))?,
        Format::Png => {
            let mut image = decode(&bytes, image::ImageFormat::Png).map_err(|e| error(path, e))?;
            for x in image.pixels.as_flattened_mut() {
                *x = linear(*x);
            }
            image
        }
    };
    let finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
    match image.pixels.iter().position(|p| !finite(p)) {
        None => Ok(image),
        Some(i) => {
            let (x, y) = (i % image.size[0] as usize, i / image.size[0] as usize);
            let [r, g, b] = image.pixels[i];
            let found = format!("found {r}, {g}, {b} at column {x}, row {y}");
            Err(error(path, format!("expected finite numbers, {found}")))
        }
    }
}

fn decode(bytes: &[u8], format: image::ImageFormat) -> image::ImageResult<Linear> {
    let image = image::load_from_memory_with_format(bytes, format)?.into_rgb32f();
    Ok(Linear {
        size: [image.width(), image.height()],
        pixels: image.pixels().map(|p| p.0).collect(),
    })
}

fn decode_exr(bytes: &[u8]) -> exr::error::Result<Linear> {
    use exr::prelude::*;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size: Vec2<usize>, _: &RgbChannels| (vec![[0.0f32; 3]; size.area()], size.width()),
            |(pixels, width), at, (r, g, b): (f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b]
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))?;
    let size = image.layer_data.size;
    Ok(Linear {
        size: [size.width() as u32, size.height() as u32],
        pixels: image.layer_data.channel_data.pixels.0,
    })
}

#[cfg(test)]
mod tests {
    use super::{Format, Linear, Output, encode, read, write};
    use crate::develop::{Curve, Tone};

    #[test]
    fn images_come_back_as_far_as_their_format_can() {
        let folder = tempfile::tempdir().unwrap();
        let image = Linear {
            size: [3, 2],
            pixels: (0..6u8)
                .map(|i| [0.1, 0.17, 0.03].map(|x| x * f32::from(i)))
                .collect(),
        };
        let tone = Tone {
            exposure: 0.0,
            curve: Curve::None,
        };
        let paths = ["x.exr", "x.hdr", "x.png"].map(|name| folder.path().join(name));
        let outputs = paths.each_ref().map(|path| Output::open(path).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        write(&outputs, &image, tone).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
        for (path, error) in paths.iter().zip([0.0, 1.0 / 128.0, 1.0 / 128.0]) {
            let back = read(path).unwrap();
            assert_eq!(back.size, image.size);
            for (a, b) in back
                .pixels
                .as_flattened()
                .iter()
                .zip(image.pixels.as_flattened())
            {
                assert!((a - b).abs() <= error, "{}: {a} for {b}", path.display());
            }
        }
    }

    #[test]
    fn an_image_always_makes_the_same_file() {
        let image = Linear {
            size: [300, 200],
            pixels: (0..60_000)
                .map(|i| [i as f32 * 0.37, (i % 7) as f32, 1.0])
                .collect(),
        };
        let tone = Tone {
            exposure: 0.0,
            curve: Curve::None,
        };
        for format in [Format::Exr, Format::Hdr, Format::Png] {
            let first = encode(format, &image, tone).unwrap();
            for _ in 0..20 {
                assert!(encode(format, &image, tone).unwrap() == first, "{format:?}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_refused_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        let mut pixels = vec![[1.0; 3]; 6];
        pixels[5][1] = f32::NAN;
        let image = Linear {
            size: [3, 2],
            pixels,
        };
        let tone = Tone {
            exposure: 0.0,
            curve: Curve::None,
        };
        write(&[Output::open(&path).unwrap()], &image, tone).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("column 2, row 1"), "{error}");
    }
}
