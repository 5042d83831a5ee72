//! Image files. A file appears under its name only when it is whole.

use super::Tone;
use std::io::{BufWriter, Write};
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

/// An image file to be: checked before anything is rendered.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    format: Format,
    temporary: tempfile::NamedTempFile,
}

impl Output {
    /// Makes sure that `path` can be written, without touching what is there.
    ///
    /// # Errors
    /// An extension that isn't exr, hdr or png, or a folder that can't be written.
    pub fn open(path: &Path) -> Result<Self, ImageError> {
        let format = match path
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase)
            .as_deref()
        {
            Some("exr") => Format::Exr,
            Some("hdr") => Format::Hdr,
            Some("png") => Format::Png,
            _ => {
                return Err(error(
                    path,
                    "expected a name that ends in .exr, .hdr or .png",
                ));
            }
        };
        if path.is_dir() {
            return Err(error(path, "is a folder, expected a file"));
        }
        let temporary =
            temporary_beside(path).map_err(|e| error(path, format!("can't be written: {e}")))?;
        Ok(Self {
            path: path.to_owned(),
            format,
            temporary,
        })
    }

    /// Writes the image and gives the file its name.
    ///
    /// # Errors
    /// What the file system or the encoder says.
    pub fn write(self, image: &Linear, tone: Tone) -> Result<(), ImageError> {
        let Self {
            path,
            format,
            temporary,
        } = self;
        encode(temporary.as_file(), format, image, tone).map_err(|e| error(&path, e))?;
        persist(temporary, &path).map_err(|e| error(&path, e))
    }
}

/// A temporary file in the folder of `path`, which it can be renamed to.
///
/// # Errors
/// What the file system says.
pub fn temporary_beside(path: &Path) -> std::io::Result<tempfile::NamedTempFile> {
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
    builder.prefix(".etendue-").tempfile_in(folder)
}

/// Gives a temporary file its name.
///
/// # Errors
/// What the file system says.
pub fn persist(temporary: tempfile::NamedTempFile, path: &Path) -> std::io::Result<()> {
    temporary.as_file().sync_all()?;
    temporary.persist(path).map(|_| ()).map_err(|e| e.error)
}

fn encode(
    file: &std::fs::File,
    format: Format,
    image: &Linear,
    tone: Tone,
) -> Result<(), Box<dyn std::error::Error>> {
    let [w, h] = image.size;
    let mut out = BufWriter::new(file);
    match format {
        Format::Exr => {
            use exr::prelude::*;
            let channels = SpecificChannels::rgb(|p: Vec2<usize>| {
                let [r, g, b] = image.pixels[p.y() * w as usize + p.x()];
                (r, g, b)
            });
            Image::from_channels((w as usize, h as usize), channels)
                .write()
                .to_buffered(&mut out)?;
        }
        Format::Hdr => {
            let pixels: Vec<_> = image.pixels.iter().map(|&p| image::Rgb(p)).collect();
            image::codecs::hdr::HdrEncoder::new(&mut out)
                .encode(&pixels, w as usize, h as usize)?;
        }
        Format::Png => {
            let bytes: Vec<u8> = image
                .pixels
                .as_flattened()
                .iter()
                .map(|&x| tone.apply(x))
                .collect();
            let encoder = image::codecs::png::PngEncoder::new(&mut out);
            image::ImageEncoder::write_image(
                encoder,
                &bytes,
                w,
                h,
                image::ExtendedColorType::Rgb8,
            )?;
        }
    }
    out.flush()?;
    Ok(())
}

/// Reads a linear image: EXR or HDR.
///
/// # Errors
/// A missing or damaged file, or a format that isn't linear.
pub fn read(path: &Path) -> Result<Linear, ImageError> {
    match path
        .extension()
        .and_then(|e| e.to_str())
        .map(str::to_ascii_lowercase)
        .as_deref()
    {
        Some("exr") => read_exr(path),
        Some("hdr") => {
            let image = image::open(path).map_err(|e| error(path, e))?.into_rgb32f();
            Ok(Linear {
                size: [image.width(), image.height()],
                pixels: image.pixels().map(|p| p.0).collect(),
            })
        }
        _ => Err(error(path, "expected a linear image, .exr or .hdr")),
    }
}

fn read_exr(path: &Path) -> Result<Linear, ImageError> {
    use exr::prelude::*;
    let image = read_first_rgba_layer_from_file(
        path,
        |size: Vec2<usize>, _: &RgbaChannels| {
            (
                vec![[0.0f32; 3]; size.width() * size.height()],
                size.width(),
            )
        },
        |(pixels, width), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b]
        },
    )
    .map_err(|e| error(path, e))?;
    let size = image.layer_data.size;
    Ok(Linear {
        size: [size.width() as u32, size.height() as u32],
        pixels: image.layer_data.channel_data.pixels.0,
    })
}
