//! Textures: bitmap and checkerboard.

use super::Loader;
use super::plugin::Plugin;
use super::value::{color, rows};
use crate::description::{Color, ColorSource, Pattern, Texels, Texture, Wrap};
use crate::load::bitmap::to_grey;
use crate::load::error::LoadError;

/// Range of a colour's channels.
#[derive(Clone, Copy, PartialEq)]
pub enum Range {
    /// A reflectance or transmittance: at most 1.
    Unit,
    /// A number ≥ 0, no texture.
    Opacity,
}

impl Loader<'_> {
    /// A colour or a texture, within its range.
    pub fn source(
        &mut self,
        plugin: &Plugin,
        name: &str,
        default: f32,
        range: Range,
    ) -> Result<ColorSource, LoadError> {
        let Some(index) = plugin.child(name)? else {
            return Ok(ColorSource::Constant([default; 3]));
        };
        let node = &self.document.nodes[index];
        if node.tag == "texture" {
            let texture = self.texture(index, range == Range::Opacity)?;
            if let Some(value) = too_bright(&self.out.textures[texture]) {
                return Err(plugin.invalid(name, "from 0 to 1 in all of its texture", value));
            }
            return Ok(ColorSource::Texture(texture));
        }
        if let Some(spectrum) = rows(node, plugin.kind, name)? {
            if let Some([_, value]) = spectrum.iter().find(|[_, value]| *value > 1.0) {
                return Err(plugin.invalid(name, "from 0 to 1", value));
            }
            self.out.textures.push(Texture {
                name: format!("the spectrum at line {}", node.place.line),
                pattern: Pattern::Spectrum(spectrum),
                to_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            });
            return Ok(ColorSource::Texture(self.out.textures.len() - 1));
        }
        let color = color(node, plugin.kind, name)?;
        if color.iter().any(|c| *c > 1.0) {
            return Err(plugin.invalid(name, "from 0 to 1", show(color)));
        }
        Ok(ColorSource::Constant(color))
    }

    /// The texture at an element. `grey`: one channel is asked for, which of a colour is its luminance.
    pub fn texture(&mut self, index: usize, grey: bool) -> Result<usize, LoadError> {
        if let Some(&done) = self.textures.get(&(index, grey)) {
            return Ok(done);
        }
        let plugin = Plugin::new(self.document, index)?;
        let mut to_uv = self.uv_matrix(&plugin)?;
        let pattern = match plugin.kind {
            "bitmap" => self.bitmap(&plugin, grey)?,
            "checkerboard" => {
                // There a square is half a unit wide, here a whole one.
                to_uv = to_uv.map(|row| row.map(|x| 2.0 * x));
                let colors = [
                    plugin.color("color0")?.unwrap_or([0.4; 3]),
                    plugin.color("color1")?.unwrap_or([0.2; 3]),
                ];
                Pattern::Checkerboard { colors }
            }
            _ => return Err(plugin.unknown("bitmap or checkerboard")),
        };
        plugin.finish()?;
        let name = self.name(plugin.node);
        self.out.textures.push(Texture {
            name,
            pattern,
            to_uv,
        });
        let done = self.out.textures.len() - 1;
        self.textures.insert((index, grey), done);
        Ok(done)
    }

    fn uv_matrix(&mut self, plugin: &Plugin) -> Result<[[f32; 3]; 2], LoadError> {
        let m = plugin.transform("to_uv")?.transpose();
        if m.x_axis.z != 0.0 || m.y_axis.z != 0.0 {
            self.warn(
                plugin.node,
                "to_uv: the third column does not act on (u, v) and is left out",
            );
        }
        Ok([m.x_axis, m.y_axis].map(|r| [r.x as f32, r.y as f32, r.w as f32]))
    }

    fn bitmap(&mut self, plugin: &Plugin, grey: bool) -> Result<Pattern, LoadError> {
        let raw = plugin.boolean("raw")?.unwrap_or(false);
        let path = plugin.file("filename")?;
        let nearest = match plugin.string("filter_type")?.unwrap_or("bilinear") {
            "bilinear" => false,
            "nearest" => true,
            other => {
                return Err(plugin.invalid(
                    "filter_type",
                    "bilinear or nearest",
                    format!("\"{other}\""),
                ));
            }
        };
        let wrap = match plugin.string("wrap_mode")?.unwrap_or("repeat") {
            "repeat" => Wrap::Repeat,
            "clamp" => Wrap::Clamp,
            "mirror" => Wrap::Mirror,
            other => {
                return Err(plugin.invalid(
                    "wrap_mode",
                    "repeat, clamp or mirror",
                    format!("\"{other}\""),
                ));
            }
        };
        // Our own: the alpha channel in place of the colour.
        let alpha = plugin.boolean("alpha")?.unwrap_or(false);
        plugin.ignore(&["format", "accel"])?;
        let mut image = (*self.image(path, raw)?).clone();
        if alpha && matches!(image.texels, Texels::Float(_)) {
            return Err(plugin.invalid("alpha", "false for images of more than 8 bits", "true"));
        }
        if grey && !alpha {
            to_grey(&mut image);
        }
        Ok(Pattern::Bitmap {
            image,
            nearest,
            wrap,
            alpha,
        })
    }
}

/// A value outside [0, 1], if there is one.
fn too_bright(texture: &Texture) -> Option<f32> {
    let outside = |c: &&f32| !(0.0..=1.0).contains(*c);
    match &texture.pattern {
        Pattern::Spectrum(rows) => rows.iter().map(|[_, value]| *value).find(|x| outside(&x)),
        Pattern::Checkerboard { colors } => colors.iter().flatten().find(outside).copied(),
        Pattern::Bitmap { image, .. } => match &image.texels {
            Texels::Float(texels) => texels.iter().flatten().find(outside).copied(),
            _ => None,
        },
    }
}

/// A colour in a message.
pub fn show(color: Color) -> String {
    color.map(|c| c.to_string()).join(" ")
}
