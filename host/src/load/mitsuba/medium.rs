//! Media, their phase functions and the volumes that they vary by.
//!
//! Our own: `emission` on both kinds of media, phase `forward`, `tracking` on heterogeneous media.

use super::Loader;
use super::document::Document;
use super::plugin::{Plugin, resolve};
use super::texture::show;
use crate::description::{Color, Grid, GridValues, Grids, Lobe, Medium, Phase, Spectrum, Tracking};
use crate::load::error::{LoadError, Problem};
use crate::load::volume as volume_file;
use glam::{DMat4, DVec3};

const KNOWN: &str = "homogeneous or heterogeneous";
const PHASES: &str = "isotropic, hg, rayleigh, blendphase or forward";
const VOLUMES: &str = "constvolume or gridvolume";
/// Parts of a phase function that the kernel takes.
const MOST_LOBES: usize = 4;

/// A value that may vary over a box.
pub enum Source {
    /// The same everywhere.
    Constant(Color),
    /// The same everywhere, in a volume's words: only here does its box mean something.
    Filled(Color, DMat4),
    /// By texels.
    Grid(Grid, DMat4),
}

impl Loader<'_> {
    /// The medium at an element; each is made once.
    pub fn medium(&mut self, index: usize) -> Result<usize, LoadError> {
        if let Some(&done) = self.media.get(&index) {
            return Ok(done);
        }
        let plugin = Plugin::new(self.document, index)?;
        let mut medium = match plugin.kind {
            "homogeneous" => homogeneous(&plugin)?,
            "heterogeneous" => self.heterogeneous(&plugin)?,
            "specmedium" => {
                return Err(plugin.unsupported("medium specmedium", &format!("choose {KNOWN}")));
            }
            _ => return Err(plugin.unknown(KNOWN)),
        };
        if let Some(phase) = plugin.object("phase")? {
            medium.phase = self.phase(phase)?;
        }
        plugin.ignore(&[
            "sample_emitters",
            "has_spectral_extinction",
            "majorant_resolution_factor",
        ])?;
        plugin.finish()?;
        medium.name = self.name(plugin.node);
        medium.place = plugin.node.place.clone();
        self.out.media.push(medium);
        let new = self.out.media.len() - 1;
        self.media.insert(index, new);
        Ok(new)
    }

    /// What is behind and before a shape.
    pub fn sides(&mut self, plugin: &Plugin) -> Result<[Option<usize>; 2], LoadError> {
        let mut sides = [None; 2];
        for (side, name) in sides.iter_mut().zip(["interior", "exterior"]) {
            if let Some(index) = plugin.child(name)? {
                *side = Some(self.medium_at(plugin, index, name)?);
            }
        }
        Ok(sides)
    }

    /// The medium in which a sensor or an emitter stands, whatever it is called there.
    pub fn surroundings(&mut self, plugin: &Plugin) -> Result<Option<usize>, LoadError> {
        match plugin.object("medium")? {
            Some(index) => self.medium(index).map(Some),
            None => Ok(None),
        }
    }

    fn medium_at(&mut self, plugin: &Plugin, index: usize, name: &str) -> Result<usize, LoadError> {
        let tag = &self.document.nodes[index].tag;
        if tag != "medium" {
            return Err(plugin.invalid(name, "a <medium>", format!("<{tag}>")));
        }
        self.medium(index)
    }

    fn heterogeneous(&mut self, plugin: &Plugin) -> Result<Medium, LoadError> {
        let scale = scale(plugin)?;
        let extinction = source(plugin, "sigma_t", [1.0; 3])?;
        let albedo = source(plugin, "albedo", [0.75; 3])?;
        let emission = source(plugin, "emission", [0.0; 3])?;
        let tracking = match plugin.string("tracking")? {
            None | Some("woodcock") => Tracking::Woodcock,
            Some("residual") => Tracking::Residual,
            Some("regular") => Tracking::Regular,
            Some(other) => {
                return Err(plugin.invalid("tracking", "woodcock, residual or regular", other));
            }
        };
        let (sigma_t, extinction, to_grid) = match extinction {
            Source::Grid(grid, to_grid) => ([scale; 3], grid, to_grid),
            Source::Filled(color, to_grid) => (color.map(|c| c * scale), unit(), to_grid),
            Source::Constant(color) => {
                let text = "sigma_t is constant: as in Mitsuba it fills the unit cube; choose homogeneous for a medium without a box";
                self.warn(plugin.node, text);
                (color.map(|c| c * scale), unit(), DMat4::IDENTITY)
            }
        };
        if !upright(&to_grid) {
            let text = "the box of sigma_t is turned: outside of it there is nothing, where Mitsuba fills its axis-aligned box";
            self.warn(plugin.node, text);
        }
        let [albedo, emission] =
            [("albedo", albedo), ("emission", emission)].map(|(name, source)| match source {
                Source::Grid(grid, own) if own.abs_diff_eq(to_grid, 1e-6 * largest(&to_grid)) => {
                    Ok(([1.0; 3], Some(grid)))
                }
                Source::Grid(..) => {
                    Err(plugin.invalid(name, "over the box of sigma_t", "another to_world"))
                }
                Source::Filled(color, _) | Source::Constant(color) => Ok((color, None)),
            });
        let ((albedo, albedos), (emission, emissions)) = (albedo?, emission?);
        at_most_one(plugin, albedo)?;
        if let Some(v) = albedos
            .as_ref()
            .and_then(|g| g.values.flat().0.iter().find(|v| **v > 1.0))
        {
            return Err(plugin.invalid("albedo", "at most 1 everywhere", v));
        }
        if tracking == Tracking::Residual && matches!(extinction.values, GridValues::Rgb(_)) {
            return Err(plugin.invalid(
                "tracking",
                "woodcock or regular where sigma_t has three channels",
                "residual",
            ));
        }
        let medium = Medium {
            sigma_t,
            albedo,
            emission,
            grids: Some(Grids {
                extinction,
                albedo: albedos,
                emission: emissions,
                to_grid: rows(&to_grid),
                tracking,
            }),
            ..Medium::default()
        };
        absorbs(plugin, &medium)?;
        Ok(medium)
    }

    /// The parts of a phase function; their weights add up to 1.
    pub fn phase(&mut self, index: usize) -> Result<Vec<Lobe>, LoadError> {
        if let Some(done) = self.phases.get(&index) {
            return Ok(done.clone());
        }
        if self.open.contains(&index) {
            let node = &self.document.nodes[index];
            let text = "phase function within itself, expected no cycle of references";
            return Err(node.error("<phase>", Problem::Malformed(text.into())));
        }
        let plugin = Plugin::new(self.document, index)?;
        let lobes = match plugin.kind {
            "isotropic" => vec![Phase::Isotropic.into()],
            "rayleigh" => vec![Phase::Rayleigh.into()],
            "forward" => vec![Phase::Forward.into()],
            "hg" => {
                let g = plugin.float("g")?.unwrap_or(0.8);
                if !(g > -1.0 && g < 1.0) {
                    return Err(plugin.invalid("g", "between -1 and 1", g));
                }
                vec![Phase::HenyeyGreenstein { g }.into()]
            }
            "blendphase" => {
                self.open.push(index);
                let lobes = self.blended_phases(&plugin);
                self.open.pop();
                lobes?
            }
            "sggx" | "tabphase" => {
                let what = format!("phase {}", plugin.kind);
                return Err(plugin.unsupported(what, &format!("choose {PHASES}")));
            }
            _ => return Err(plugin.unknown(PHASES)),
        };
        plugin.finish()?;
        self.phases.insert(index, lobes.clone());
        Ok(lobes)
    }

    fn blended_phases(&mut self, plugin: &Plugin) -> Result<Vec<Lobe>, LoadError> {
        if plugin.has("weight")
            && let Some(index) = plugin.child("weight")?
            && ["volume", "texture"].contains(&self.document.nodes[index].tag.as_str())
        {
            return Err(plugin.unsupported("a weight that varies", "give a <float>"));
        }
        let weight = plugin.float("weight")?.unwrap_or(0.5);
        if !(0.0..=1.0).contains(&weight) {
            return Err(plugin.invalid("weight", "from 0 to 1", weight));
        }
        // Mitsuba orders them by name, and 0 and 1 of the weight are the first and the second.
        let mut nested: Vec<(&str, usize)> = Vec::new();
        for &child in &plugin.node.children {
            let target = resolve(self.document, child)?;
            if self.document.nodes[target].tag == "phase" {
                nested.push((self.document.nodes[child].get("name").unwrap_or(""), target));
            }
        }
        if nested.iter().all(|(name, _)| !name.is_empty()) {
            nested.sort_by_key(|(name, _)| *name);
        }
        for (name, _) in nested.iter().filter(|(name, _)| !name.is_empty()) {
            plugin.ignore(&[name])?;
        }
        plugin.objects("phase")?;
        let &[(_, first), (_, second)] = nested.as_slice() else {
            return Err(plugin.invalid("number of nested phase functions", "two", nested.len()));
        };
        let mut lobes = Vec::new();
        for (share, index) in [(1.0 - weight, first), (weight, second)] {
            let parts = self.phase(index)?.into_iter();
            lobes.extend(parts.map(|l| Lobe {
                weight: l.weight * share,
                ..l
            }));
        }
        lobes.retain(|l| l.weight > 0.0);
        if lobes.len() > MOST_LOBES {
            return Err(plugin.invalid(
                "blend",
                format!("of at most {MOST_LOBES} phase functions"),
                lobes.len(),
            ));
        }
        Ok(lobes)
    }
}

/// A colour, or a volume of them.
fn source(plugin: &Plugin, name: &str, default: Color) -> Result<Source, LoadError> {
    match plugin.child(name)? {
        Some(index) if plugin.document.nodes[index].tag == "volume" => {
            volume(plugin.document, index)
        }
        Some(_) => Ok(Source::Constant(plugin.color(name)?.unwrap_or(default))),
        None => Ok(Source::Constant(default)),
    }
}

pub fn volume(document: &Document, index: usize) -> Result<Source, LoadError> {
    let plugin = Plugin::new(document, index)?;
    let to_grid = plugin.transform("to_world")?.inverse();
    let source = match plugin.kind {
        "constvolume" => {
            let value = plugin.color("value")?.unwrap_or([1.0; 3]);
            Source::Filled(value, to_grid)
        }
        "gridvolume" => {
            let file = plugin.file("filename")?;
            let mut read = volume_file::load(&file).map_err(|e| plugin.within("filename", e))?;
            read.grid.nearest = match plugin.string("filter_type")? {
                None | Some("trilinear") => false,
                Some("nearest") => true,
                Some(other) => {
                    return Err(plugin.invalid("filter_type", "trilinear or nearest", other));
                }
            };
            match plugin.string("wrap_mode")? {
                None | Some("clamp") => {}
                Some(mode @ ("repeat" | "mirror")) => {
                    let what = format!("wrap_mode {mode}");
                    return Err(plugin.unsupported(what, "choose clamp"));
                }
                Some(other) => return Err(plugin.invalid("wrap_mode", "clamp", other)),
            }
            let own = plugin.boolean("use_grid_bbox")? == Some(true);
            let to_grid = if own {
                from_bounds(&plugin, read.bounds)? * to_grid
            } else {
                to_grid
            };
            // Colours are linear either way, and majorants are found, not told.
            plugin.ignore(&["raw", "accel", "max_value"])?;
            Source::Grid(read.grid, to_grid)
        }
        _ => return Err(plugin.unknown(VOLUMES)),
    };
    plugin.finish()?;
    Ok(source)
}

fn homogeneous(plugin: &Plugin) -> Result<Medium, LoadError> {
    let scale = scale(plugin)?;
    let (sigma_t, sigma_ts) = value(plugin, "sigma_t", 1.0)?;
    let (albedo, albedos) = value(plugin, "albedo", 0.75)?;
    let (emission, emissions) = value(plugin, "emission", 0.0)?;
    let mut rows = albedos.iter().flatten();
    if let Some([_, found]) = rows.find(|[_, albedo]| *albedo > 1.0) {
        return Err(plugin.invalid("albedo", "at most 1 at every wavelength", found));
    }
    at_most_one(plugin, albedo)?;
    let scaled = |rows: Spectrum| rows.into_iter().map(|[nm, s]| [nm, s * scale]).collect();
    let medium = Medium {
        sigma_t: sigma_t.map(|s| s * scale),
        albedo,
        emission,
        spectra: [sigma_ts.map(scaled), albedos, emissions],
        ..Medium::default()
    };
    absorbs(plugin, &medium)?;
    Ok(medium)
}

/// What is the same everywhere: a colour, or a spectrum and the colour that it stands for.
fn value(
    plugin: &Plugin,
    name: &str,
    default: f32,
) -> Result<(Color, Option<Spectrum>), LoadError> {
    let read = |plugin: &Plugin, key: &str| match name {
        "emission" => plugin.light(key),
        _ => Ok(plugin.number(key)?.unwrap_or(([1.0; 3], None))),
    };
    let Some(index) = plugin.child(name)? else {
        return Ok(([default; 3], None));
    };
    if plugin.document.nodes[index].tag != "volume" {
        return read(plugin, name);
    }
    let volume = Plugin::new(plugin.document, index)?;
    if volume.kind != "constvolume" {
        let what = format!("volume {} as {name} of a homogeneous medium", volume.kind);
        return Err(volume.unsupported(what, "choose heterogeneous"));
    }
    // It is the same everywhere: where its box lies doesn't matter.
    volume.ignore(&["to_world"])?;
    let value = read(&volume, "value")?;
    volume.finish()?;
    Ok(value)
}

fn scale(plugin: &Plugin) -> Result<f32, LoadError> {
    let scale = plugin.float("scale")?.unwrap_or(1.0);
    if scale < 0.0 {
        return Err(plugin.invalid("scale", ">= 0", scale));
    }
    Ok(scale)
}

fn at_most_one(plugin: &Plugin, albedo: Color) -> Result<(), LoadError> {
    if albedo.iter().any(|a| *a > 1.0) {
        return Err(plugin.invalid("albedo", "at most 1 in each channel", show(albedo)));
    }
    Ok(())
}

/// What emits absorbs: else thermodynamics would object, and no walk would meet the emission.
fn absorbs(plugin: &Plugin, m: &Medium) -> Result<(), LoadError> {
    let has_grid = m.grids.as_ref().is_some_and(|g| g.albedo.is_some());
    for c in 0..3 {
        let absorbs = m.sigma_t[c] > 0.0 && (m.albedo[c] < 1.0 || has_grid);
        if m.emission[c] > 0.0 && !absorbs {
            let expected =
                "0 in channels where the medium doesn't absorb (sigma_t > 0, albedo < 1)";
            return Err(plugin.invalid("emission", expected, show(m.emission)));
        }
    }
    Ok(())
}

/// A grid that is 1.
fn unit() -> Grid {
    Grid {
        size: [1; 3],
        values: GridValues::Gray(vec![1.0]),
        nearest: true,
    }
}

/// A file's own box to the unit cube.
fn from_bounds(plugin: &Plugin, [low, high]: [[f32; 3]; 2]) -> Result<DMat4, LoadError> {
    let [low, high] = [low, high].map(|c| DVec3::from(c.map(f64::from)));
    let size = high - low;
    if !(size.min_element() > 0.0 && size.is_finite()) {
        let found = format!("{low} to {high}");
        return Err(plugin.invalid(
            "use_grid_bbox",
            "false where the file's box is empty",
            found,
        ));
    }
    Ok(DMat4::from_scale(1.0 / size) * DMat4::from_translation(-low))
}

fn rows(m: &DMat4) -> [[f32; 4]; 3] {
    let t = m.transpose();
    [t.x_axis, t.y_axis, t.z_axis].map(|row| row.as_vec4().to_array())
}

fn largest(m: &DMat4) -> f64 {
    m.to_cols_array()
        .into_iter()
        .fold(0.0, |a, b| a.max(b.abs()))
}

/// Whether boxes stay along the axes.
fn upright(m: &DMat4) -> bool {
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.truncate().abs());
    columns.iter().all(|c| {
        let sum = c.x + c.y + c.z;
        sum - c.max_element() <= 1e-6 * sum
    })
}
