//! Emitters that aren't shapes.

use super::Loader;
use super::plugin::Plugin;
use super::transform::rows_of_inverse;
use crate::description::{Color, Emitter, EmitterKind};
use crate::load::bitmap::load_linear;
use crate::load::error::{LoadError, Problem};
use glam::{DMat4, DVec3};
use std::path::Path;

const KNOWN: &str = "point, spot, directional, constant, envmap or cubemap (area within a shape)";

impl Loader<'_> {
    /// Adds the emitter at an element of the scene.
    pub fn emitter(&mut self, index: usize) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        let mut spectrum = None;
        let mut light = |name: &str| {
            let (color, rows) = plugin.light(name)?;
            spectrum = rows;
            Ok::<_, LoadError>(color)
        };
        let kind = match plugin.kind {
            "point" => EmitterKind::Point {
                position: place(&plugin)?,
                intensity: light("intensity")?,
            },
            "spot" => self.spot(&plugin, light("intensity")?)?,
            "directional" => EmitterKind::Directional {
                direction: direction(&plugin)?,
                irradiance: light("irradiance")?,
            },
            "constant" => EmitterKind::Constant {
                radiance: light("radiance")?,
            },
            "envmap" => self.envmap(&plugin)?,
            "cubemap" => self.cubemap(&plugin)?,
            "area" => {
                let text = "area emitter outside of a shape, expected it within one";
                return Err(plugin.error(Problem::Malformed(text.into())));
            }
            "sunsky" | "sky" | "sun" | "projector" | "directionalarea" | "volumelight" => {
                let what = format!("emitter {}", plugin.kind);
                return Err(plugin.unsupported(what, &format!("choose {KNOWN}")));
            }
            _ => return Err(plugin.unknown(KNOWN)),
        };
        if matches!(plugin.kind, "constant" | "envmap" | "cubemap")
            && let Some(first) = self.environment.replace(index)
        {
            let line = self.document.nodes[first].place.line;
            return Err(plugin.error(Problem::Duplicate {
                what: "the environment".into(),
                line,
            }));
        }
        let medium = self.surroundings(&plugin)?;
        if medium.is_some() && !matches!(plugin.kind, "point" | "spot") {
            let found = format!("a medium at a {} emitter", plugin.kind);
            return Err(plugin.invalid("medium", "at point and spot emitters only", found));
        }
        plugin.ignore(&["sampling_weight"])?;
        plugin.finish()?;
        let name = self.name(plugin.node);
        self.out.emitters.push(Emitter {
            name,
            place: plugin.node.place.clone(),
            kind,
            medium,
            spectrum,
        });
        Ok(())
    }

    fn spot(&mut self, plugin: &Plugin, intensity: Color) -> Result<EmitterKind, LoadError> {
        let to_world = plugin.transform("to_world")?;
        let cutoff = plugin.positive("cutoff_angle")?.unwrap_or(20.0);
        if cutoff >= 180.0 {
            return Err(plugin.invalid("cutoff_angle", "less than 180 degrees", cutoff));
        }
        let beam_width = plugin.positive("beam_width")?.unwrap_or(cutoff * 0.75);
        if beam_width >= cutoff {
            return Err(plugin.invalid(
                "beam_width",
                format!("less than cutoff_angle, {cutoff}"),
                beam_width,
            ));
        }
        if plugin.has("texture") {
            return Err(plugin.unsupported("a spot's texture", ""));
        }
        Ok(EmitterKind::Spot {
            position: to_world.w_axis.truncate().as_vec3().to_array(),
            direction: to_world
                .transform_vector3(DVec3::Z)
                .normalize()
                .as_vec3()
                .to_array(),
            intensity,
            cutoff: cutoff.to_radians(),
            beam_width: beam_width.to_radians(),
        })
    }

    fn envmap(&mut self, plugin: &Plugin) -> Result<EmitterKind, LoadError> {
        let path = plugin.file("filename")?;
        let (width, height, texels) = self.radiance(&path)?;
        if width < 2 || height < 2 {
            return Err(plugin.invalid(
                "filename",
                "an image of 2 x 2 pixels or more",
                format!("{width} x {height}"),
            ));
        }
        Ok(EmitterKind::LatLong {
            width,
            height,
            texels,
            scale: scale(plugin)?,
            to_local: to_local(plugin)?,
        })
    }

    /// Six files whose pixels are the faces of the blob's cube map, as they stand: on ±x the column
    /// grows with y and the row (from the top) with z, on ±y with z and x, on ±z with x and y.
    fn cubemap(&mut self, plugin: &Plugin) -> Result<EmitterKind, LoadError> {
        let mut width = 0;
        let mut texels = Vec::new();
        for name in ["px", "nx", "py", "ny", "pz", "nz"] {
            let (w, h, face) = self.radiance(&plugin.file(name)?)?;
            if w != h || (width != 0 && w != width) {
                let expected = if width == 0 {
                    "a square".into()
                } else {
                    format!("{width} x {width} as the others")
                };
                return Err(plugin.invalid(name, expected, format!("{w} x {h}")));
            }
            width = w;
            texels.extend(face);
        }
        Ok(EmitterKind::CubeMap {
            width,
            texels,
            scale: scale(plugin)?,
            to_local: to_local(plugin)?,
        })
    }

    fn radiance(&mut self, path: &Path) -> Result<(u32, u32, Vec<Color>), LoadError> {
        let (width, height, mut texels) = load_linear(path)?;
        let mut negative = 0usize;
        for c in texels.iter_mut().flatten() {
            if *c < 0.0 {
                *c = 0.0;
                negative += 1;
            }
        }
        if negative > 0 {
            self.warnings.push(format!(
                "{}: {negative} negative values are taken as 0",
                path.display()
            ));
        }
        Ok((width, height, texels))
    }
}

fn scale(plugin: &Plugin) -> Result<f32, LoadError> {
    match plugin.float("scale")?.unwrap_or(1.0) {
        s if s < 0.0 => Err(plugin.invalid("scale", ">= 0", s)),
        s => Ok(s),
    }
}

fn to_local(plugin: &Plugin) -> Result<[[f32; 3]; 3], LoadError> {
    let to_world = plugin.transform("to_world")?;
    rows_of_inverse(&to_world)
        .ok_or_else(|| plugin.invalid("to_world", "a rotation", "unequal scales or shear"))
}

/// Position from `position` or `to_world`.
fn place(plugin: &Plugin) -> Result<[f32; 3], LoadError> {
    let position = plugin.vector("position")?;
    let to_world = plugin.transform("to_world")?;
    match position {
        Some(_) if plugin.has("to_world") => Err(both(plugin, "position")),
        Some(p) => Ok(p.map(|x| x as f32)),
        None => Ok(to_world.w_axis.truncate().as_vec3().to_array()),
    }
}

/// Direction from `direction` or `to_world`.
fn direction(plugin: &Plugin) -> Result<[f32; 3], LoadError> {
    let direction = plugin.vector("direction")?;
    let to_world: DMat4 = plugin.transform("to_world")?;
    let d = match direction {
        Some(_) if plugin.has("to_world") => return Err(both(plugin, "direction")),
        Some(d) => DVec3::from(d),
        None => to_world.transform_vector3(DVec3::Z),
    };
    let unit = d
        .try_normalize()
        .ok_or_else(|| plugin.invalid("direction", "not zero", d))?;
    Ok(unit.as_vec3().to_array())
}

fn both(plugin: &Plugin, name: &str) -> LoadError {
    plugin.error(Problem::Malformed(format!(
        "{name} and to_world both given, expected one of them"
    )))
}
