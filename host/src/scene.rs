//! A scene from whatever file it is in: a Mitsuba 3 scene, or a compiled blob.

use crate::blob::AlignedBlob;
use crate::compile::compile;
use crate::description::{Advice, Carry, Description, GridValues, Model, Tracking};
use crate::load;
use std::path::Path;

/// Bytes that [`etendue::Scene::open`] accepts, and what the file said beside them.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The blob.
    pub blob: AlignedBlob,
    /// Advice of a scene file.
    pub advice: Advice,
    /// What the reader should know.
    pub warnings: Vec<String>,
}

/// Changes to what a scene file says.
#[derive(Clone, Copy, Debug, Default)]
pub struct Changes {
    /// Columns.
    pub width: Option<u32>,
    /// Rows.
    pub height: Option<u32>,
    /// A factor for both, where neither is said.
    pub scale: Option<f64>,
    /// What paths carry.
    pub carry: Carry,
    /// Whether dielectrics have Schlick's approximation; `None`: what the file says of each.
    pub schlick: Option<bool>,
    /// How the kernel finds its way through all grids; `None`: what the file says of each.
    pub tracking: Option<Tracking>,
}

impl Changes {
    /// What these change but the size.
    ///
    /// # Errors
    /// In words, if a medium can't be tracked as they ask.
    pub fn apply(&self, d: &mut Description) -> Result<(), String> {
        d.carry = self.carry;
        if let Some(wanted) = self.schlick {
            for material in &mut d.materials {
                if let Model::Dielectric { schlick, .. } | Model::Dispersive { schlick, .. } =
                    &mut material.model
                {
                    *schlick = wanted;
                }
            }
        }
        let Some(tracking) = self.tracking else {
            return Ok(());
        };
        for medium in &mut d.media {
            let Some(grids) = &mut medium.grids else {
                continue;
            };
            if tracking == Tracking::Residual
                && matches!(grids.extinction.values, GridValues::Rgb(_))
            {
                return Err(format!(
                    "--tracking: expected woodcock or regular where sigma_t has three channels, as it has in {}, found residual",
                    medium.name
                ));
            }
            grids.tracking = tracking;
        }
        Ok(())
    }
}

/// Whether `path` names a compiled scene.
pub fn is_blob(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("etd"))
}

/// Loads and compiles `path`, or reads it if it is a blob.
///
/// # Errors
/// One line: the file, the place in it, what is wrong and what was expected.
pub fn prepare(
    path: &Path,
    defines: &[(String, String)],
    changes: Changes,
) -> Result<Prepared, String> {
    if is_blob(path) {
        let fixed = changes.width.or(changes.height).is_some()
            || changes.scale.is_some()
            || changes.carry != Carry::AsNeeded
            || changes.schlick.is_some()
            || changes.tracking.is_some()
            || !defines.is_empty();
        if fixed {
            return Err(format!(
                "{}: a compiled scene has its size and its values in it: --width, --height, --color, --fresnel, --tracking and -D need the scene file",
                path.display()
            ));
        }
        let blob = AlignedBlob::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        etendue::Scene::open(blob.bytes()).map_err(|e| format!("{}: {e}", path.display()))?;
        return Ok(Prepared {
            blob,
            advice: Advice::default(),
            warnings: Vec::new(),
        });
    }
    let loaded = load::load(path, defines).map_err(|e| e.to_string())?;
    let mut description = loaded.description;
    changes
        .apply(&mut description)
        .map_err(|e| format!("{}: {e}", path.display()))?;
    resize(&mut description, &changes)?;
    let compiled = compile(&description).map_err(|e| e.in_file(path).to_string())?;
    let mut warnings = loaded.warnings;
    warnings.extend(compiled.warnings);
    Ok(Prepared {
        blob: compiled.blob,
        advice: description.advice,
        warnings,
    })
}

/// Another resolution; one side alone keeps the shape of the picture.
fn resize(d: &mut Description, size: &Changes) -> Result<(), String> {
    let [w, h] = d.sensor.resolution;
    let follow = |n: u32, from: u32, to: u32| {
        (f64::from(n) * f64::from(to) / f64::from(from))
            .round()
            .max(1.0) as u32
    };
    let resolution = match (size.width, size.height) {
        (None, None) => match size.scale {
            Some(k) => [w, h].map(|n| (f64::from(n) * k).round().max(1.0) as u32),
            None => return Ok(()),
        },
        (Some(x), None) => [x, follow(x, w, h)],
        (None, Some(y)) => [follow(y, h, w), y],
        (Some(x), Some(y)) => [x, y],
    };
    if d.sensor.crop.is_some() {
        return Err("--width and --height don't go with a film that has a crop window".into());
    }
    if resolution.iter().any(|&n| n == 0 || n > 1 << 16) {
        return Err(format!(
            "--width and --height: expected 1 to 65536, found {} × {}",
            resolution[0], resolution[1]
        ));
    }
    // Pixels stay square: the field of view in x is kept, that in y follows. A panorama sees everything in any case.
    let aspect = |r: [u32; 2]| r[1] as f32 / r[0] as f32;
    let factor = aspect(resolution) / aspect([w, h]);
    use crate::description::Projection::{Orthographic, Panorama, Perspective};
    match &mut d.sensor.projection {
        Perspective {
            half_tangent: extent,
            ..
        }
        | Orthographic {
            half_extent: extent,
        } => extent[1] *= factor,
        Panorama => (),
    }
    d.sensor.resolution = resolution;
    Ok(())
}
