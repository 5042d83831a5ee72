//! Sensors, films, pixel filters, samplers.

use super::Loader;
use super::plugin::Plugin;
use super::transform::{orthogonal, similarity};
use super::value::number;
use crate::description::{Filter, Projection, Sensor};
use crate::load::error::{LoadError, Problem};
use glam::{DMat3, DMat4};

/// The widest filter that a scene may ask for.
const WIDEST_FILTER: f32 = 8.0;

impl Loader<'_> {
    /// The sensor at an element; its sampler's count goes to the advice.
    pub fn load_sensor(&mut self, index: usize) -> Result<Sensor, LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        if !["perspective", "thinlens", "orthographic", "panorama"].contains(&plugin.kind) {
            return Err(plugin.unknown("perspective, thinlens, orthographic or panorama"));
        }
        let mut sensor = Sensor {
            medium: self.surroundings(&plugin)?,
            ..Sensor::default()
        };
        match plugin.object("film")? {
            Some(film) => self.film(film, &mut sensor)?,
            None => sensor.filter = gaussian(0.5),
        }
        if let Some(sampler) = plugin.object("sampler")? {
            self.sampler(sampler)?;
        }
        sensor.clip = clip(&plugin)?;
        let to_world = plugin.transform("to_world")?;
        let scale = frame(&plugin, &to_world, &mut sensor)?;
        let aspect = sensor.resolution[0] as f32 / sensor.resolution[1] as f32;
        sensor.projection = if plugin.kind == "panorama" {
            Projection::Panorama
        } else if plugin.kind == "orthographic" {
            Projection::Orthographic {
                half_extent: [scale[0], scale[1] / aspect],
            }
        } else {
            let tangent = half_tangent(&plugin, aspect)?;
            for (slot, name) in sensor
                .principal
                .iter_mut()
                .zip(["principal_point_offset_x", "principal_point_offset_y"])
            {
                *slot = plugin.float(name)?.unwrap_or(0.0);
            }
            let (aperture, focus) = if plugin.kind == "thinlens" {
                let aperture = plugin.float("aperture_radius")?;
                let aperture =
                    aperture.ok_or_else(|| plugin.missing("aperture_radius", "float"))?;
                if aperture < 0.0 {
                    return Err(plugin.invalid("aperture_radius", ">= 0", aperture));
                }
                (
                    aperture,
                    plugin.positive("focus_distance")?.unwrap_or(sensor.clip[1]),
                )
            } else {
                plugin.positive("focus_distance")?;
                (0.0, 1.0)
            };
            Projection::Perspective {
                half_tangent: [tangent, tangent / aspect],
                aperture,
                focus,
            }
        };
        if plugin.has("srf") {
            return Err(plugin.unsupported("srf", ""));
        }
        plugin.ignore(&["shutter_open", "shutter_close"])?;
        plugin.finish()?;
        Ok(sensor)
    }

    fn film(&mut self, index: usize, sensor: &mut Sensor) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        if plugin.kind != "hdrfilm" {
            return Err(plugin.unknown("hdrfilm"));
        }
        let size = |name, default| Ok(plugin.integer_in(name, 1, 1 << 20)?.unwrap_or(default));
        sensor.resolution = [size("width", 768)?, size("height", 576)?];
        let [width, height] = sensor.resolution;
        let crop = [
            "crop_offset_x",
            "crop_offset_y",
            "crop_width",
            "crop_height",
        ];
        if crop.iter().any(|n| plugin.has(n)) {
            let first = |name, size: u32| {
                Ok(plugin
                    .integer_in(name, 0, i64::from(size) - 1)?
                    .unwrap_or(0))
            };
            let (x, y) = (first(crop[0], width)?, first(crop[1], height)?);
            let count =
                |name, left: u32| Ok(plugin.integer_in(name, 1, i64::from(left))?.unwrap_or(left));
            sensor.crop = Some([
                x,
                y,
                count(crop[2], width - x)?,
                count(crop[3], height - y)?,
            ]);
        }
        sensor.filter = match plugin.object("rfilter")? {
            Some(filter) => self.filter(filter)?,
            None => gaussian(0.5),
        };
        plugin.ignore(&[
            "pixel_format",
            "component_format",
            "file_format",
            "sample_border",
            "compensate",
            "banner",
        ])?;
        plugin.ignore(&["high_quality_edges"])?;
        plugin.finish()
    }

    fn filter(&mut self, index: usize) -> Result<Filter, LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        let radius = |default| match plugin.positive("radius")?.unwrap_or(default) {
            r if r > WIDEST_FILTER => {
                Err(plugin.invalid("radius", format!("at most {WIDEST_FILTER}"), r))
            }
            r => Ok(r),
        };
        let filter = match plugin.kind {
            "box" => Filter::Box {
                radius: radius(0.5)?,
            },
            "tent" => Filter::Tent {
                radius: radius(1.0)?,
            },
            "gaussian" => match plugin.positive("stddev")?.unwrap_or(0.5) {
                s if 4.0 * s > WIDEST_FILTER => {
                    return Err(plugin.invalid(
                        "stddev",
                        format!("at most {}", WIDEST_FILTER / 4.0),
                        s,
                    ));
                }
                s => gaussian(s),
            },
            "mitchell" | "lanczos" | "catmullrom" => {
                return Err(plugin.unsupported(
                    format!("rfilter {}", plugin.kind),
                    "choose box, tent or gaussian",
                ));
            }
            _ => return Err(plugin.unknown("box, tent or gaussian")),
        };
        plugin.finish()?;
        Ok(filter)
    }

    fn sampler(&mut self, index: usize) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        if ![
            "independent",
            "stratified",
            "multijitter",
            "orthogonal",
            "ldsampler",
        ]
        .contains(&plugin.kind)
        {
            return Err(
                plugin.unknown("independent, stratified, multijitter, orthogonal or ldsampler")
            );
        }
        self.out.advice.samples = plugin.integer_in("sample_count", 1, i64::from(u32::MAX))?;
        plugin.ignore(&["seed", "jitter", "strength"])?;
        plugin.finish()
    }
}

/// Mitsuba cuts it at 4 σ.
fn gaussian(sigma: f32) -> Filter {
    Filter::Gaussian {
        sigma,
        radius: 4.0 * sigma,
    }
}

fn clip(plugin: &Plugin) -> Result<[f32; 2], LoadError> {
    let near = plugin.positive("near_clip")?.unwrap_or(1e-2);
    let far = plugin.positive("far_clip")?.unwrap_or(1e4);
    if near >= far {
        return Err(plugin.invalid("near_clip", format!("less than far_clip, {far}"), near));
    }
    Ok([near, far])
}

/// Fills in origin and axes; returns how long the transform makes them. A mirrored frame stays mirrored.
fn frame(plugin: &Plugin, to_world: &DMat4, sensor: &mut Sensor) -> Result<[f32; 2], LoadError> {
    let m = DMat3::from_mat4(*to_world);
    let lengths = [m.x_axis.length(), m.y_axis.length()];
    if !orthogonal(&m) {
        return Err(plugin.invalid(
            "to_world",
            "free of shear",
            "axes that aren't perpendicular",
        ));
    }
    let rigid = similarity(&m).is_some_and(|s| (s - 1.0).abs() < 1e-3);
    if plugin.kind != "orthographic" && !rigid {
        let found = format!(
            "scale {:.4} {:.4} {:.4}",
            lengths[0],
            lengths[1],
            m.z_axis.length()
        );
        return Err(plugin.invalid("to_world", "free of scale", found));
    }
    sensor.origin = to_world.w_axis.truncate().as_vec3().to_array();
    // Local +x points to the image's left, +y up, +z into the scene.
    sensor.right = (-m.x_axis.normalize()).as_vec3().to_array();
    sensor.down = (-m.y_axis.normalize()).as_vec3().to_array();
    sensor.forward = m.z_axis.normalize().as_vec3().to_array();
    Ok(lengths.map(|l| l as f32))
}

/// Tangent of half the horizontal field of view.
fn half_tangent(plugin: &Plugin, aspect: f32) -> Result<f32, LoadError> {
    let fov = plugin.float("fov")?;
    let focal_length = plugin.string("focal_length")?;
    let axis = plugin.string("fov_axis")?.unwrap_or("x");
    let diagonal = |tangent: f32| tangent / (1.0 + 1.0 / (aspect * aspect)).sqrt();
    if !["x", "y", "diagonal", "smaller", "larger"].contains(&axis) {
        let expected = "x, y, diagonal, smaller or larger";
        return Err(plugin.invalid("fov_axis", expected, format!("\"{axis}\"")));
    }
    match (fov, focal_length) {
        (Some(_), Some(_)) => {
            let text = "fov and focal_length both given, expected one of them";
            Err(plugin.error(Problem::Malformed(text.into())))
        }
        (Some(fov), None) => {
            if !(fov > 0.0 && fov < 180.0) {
                return Err(plugin.invalid("fov", "between 0 and 180 degrees", fov));
            }
            let tangent = (f64::from(fov).to_radians() / 2.0).tan() as f32;
            let vertical = axis == "y"
                || (axis == "smaller" && aspect > 1.0)
                || (axis == "larger" && aspect <= 1.0);
            Ok(match axis {
                "diagonal" => diagonal(tangent),
                _ if vertical => tangent * aspect,
                _ => tangent,
            })
        }
        (None, length) => {
            // Of a 36 × 24 mm film, along its diagonal.
            let text = length.unwrap_or("50mm");
            let length = number(text.strip_suffix("mm").unwrap_or(text)).filter(|l| *l > 0.0);
            let length = length.ok_or_else(|| {
                plugin.invalid("focal_length", "like 50mm", format!("\"{text}\""))
            })?;
            Ok(diagonal(
                (36.0f32 * 36.0 + 24.0 * 24.0).sqrt() / (2.0 * length),
            ))
        }
    }
}
