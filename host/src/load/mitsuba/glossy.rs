//! BSDFs of glossy things: microfacets, plastic, Phong, blends.

use super::Loader;
use super::bsdf::{BLACK, Metal, Surface, at_most_one, index, metal};
use super::plugin::Plugin;
use super::texture::Range;
use crate::description::{Distribution, Facets, Masking, Model};
use crate::load::error::LoadError;

impl Loader<'_> {
    /// A rough, glossy or coated model.
    pub fn glossy(&mut self, plugin: &Plugin) -> Result<Model, LoadError> {
        match plugin.kind {
            "roughconductor" => {
                // A conductor of index 0 + i reflects everything.
                let Metal { eta, k, spectra } = metal(plugin)?.unwrap_or(Metal {
                    eta: [0.0; 3],
                    k: [1.0; 3],
                    spectra: None,
                });
                Ok(Model::RoughConductor {
                    eta,
                    k,
                    spectra,
                    reflectance: self.source(plugin, "specular_reflectance", 1.0, Range::Unit)?,
                    facets: facets(plugin)?,
                })
            }
            "roughdielectric" => {
                let ior = ior(plugin, "bk7")?;
                if (ior - 1.0).abs() < 0.01 {
                    return Err(plugin.invalid(
                        "int_ior / ext_ior",
                        "1 % from 1 at least (nearer to it choose dielectric, or null)",
                        ior,
                    ));
                }
                let facets = facets(plugin)?;
                if facets.masking == Masking::Cavities {
                    let found = "cavities";
                    return Err(plugin.invalid("masking", "separable or correlated", found));
                }
                Ok(Model::RoughDielectric {
                    ior,
                    reflectance: self.source(plugin, "specular_reflectance", 1.0, Range::Unit)?,
                    transmittance: self.source(
                        plugin,
                        "specular_transmittance",
                        1.0,
                        Range::Unit,
                    )?,
                    facets,
                })
            }
            "plastic" | "roughplastic" => Ok(Model::Plastic {
                ior: ior(plugin, "polypropylene")?,
                diffuse_reflectance: self.source(
                    plugin,
                    "diffuse_reflectance",
                    0.5,
                    Range::Unit,
                )?,
                reflectance: self.source(plugin, "specular_reflectance", 1.0, Range::Unit)?,
                nonlinear: plugin.boolean("nonlinear")?.unwrap_or(false),
                facets: match plugin.kind {
                    "plastic" => None,
                    _ => Some(facets(plugin)?),
                },
            }),
            "phong" => self.phong(plugin),
            _ => self.phong_dielectric(plugin),
        }
    }

    fn phong(&mut self, plugin: &Plugin) -> Result<Model, LoadError> {
        let diffuse_reflectance = self.source(plugin, "diffuse_reflectance", 0.5, Range::Unit)?;
        let reflectance = self.source(plugin, "specular_reflectance", 0.2, Range::Unit)?;
        at_most_one(
            plugin,
            &[diffuse_reflectance, reflectance],
            "diffuse_reflectance + specular_reflectance",
        )?;
        Ok(Model::Phong {
            diffuse_reflectance,
            reflectance,
            transmittance: BLACK,
            diffuse_transmittance: BLACK,
            exponent: exponent(plugin)?.unwrap_or(30.0),
            modified: modified(plugin)?,
            ior: 1.0,
            fresnel: false,
        })
    }

    /// Our own: a boundary whose reflection and refraction are Phong lobes.
    fn phong_dielectric(&mut self, plugin: &Plugin) -> Result<Model, LoadError> {
        Ok(Model::Phong {
            diffuse_reflectance: BLACK,
            reflectance: self.source(plugin, "specular_reflectance", 1.0, Range::Unit)?,
            transmittance: self.source(plugin, "specular_transmittance", 1.0, Range::Unit)?,
            diffuse_transmittance: BLACK,
            exponent: exponent(plugin)?.unwrap_or(30.0),
            modified: modified(plugin)?,
            ior: ior(plugin, "bk7")?,
            fresnel: true,
        })
    }

    /// Two BSDFs, of which each side blends its own.
    pub fn blend(&mut self, plugin: &Plugin) -> Result<Surface, LoadError> {
        if !plugin.has("weight") {
            return Err(plugin.missing("weight", "float"));
        }
        let weight = self.source(plugin, "weight", 0.5, Range::Opacity)?;
        let nested = plugin.objects("bsdf")?;
        let &[first, second] = nested.as_slice() else {
            return Err(plugin.invalid("number of nested BSDFs", "two", nested.len()));
        };
        let parts = [self.surface(first)?, self.surface(second)?];
        if parts.iter().any(|p| p.opacity.is_some()) {
            return Err(plugin.unsupported("a mask within a blend", "put the blend into the mask"));
        }
        let name = self.name(plugin.node);
        let mut side = |sides: [Option<usize>; 2]| {
            if sides == [None; 2] {
                return None;
            }
            let parts = sides.map(|s| {
                s.unwrap_or_else(|| {
                    let black = Model::Diffuse {
                        reflectance: BLACK,
                        transmittance: BLACK,
                    };
                    self.push(format!("black of {name}"), black)
                })
            });
            Some(self.push(name.clone(), Model::Blend { parts, weight }))
        };
        let front = side(parts.map(|p| p.front));
        let back = side(parts.map(|p| p.back));
        Ok(Surface {
            front,
            back,
            opacity: None,
            transmits: parts.iter().any(|p| p.transmits),
        })
    }
}

/// Index inside over index outside.
fn ior(plugin: &Plugin, inside: &str) -> Result<f32, LoadError> {
    let ior = index(plugin, "int_ior", inside)? / index(plugin, "ext_ior", "air")?;
    if (1e-3..=1e3).contains(&ior) {
        Ok(ior)
    } else {
        Err(plugin.invalid("int_ior / ext_ior", "from 0.001 to 1000", ior))
    }
}

fn facets(plugin: &Plugin) -> Result<Facets, LoadError> {
    let alpha = |name: &str| {
        let found = plugin.float(name)?;
        match found {
            Some(a) if !(1e-4..=10.0).contains(&a) => {
                Err(plugin.invalid(name, "from 0.0001 to 10", a))
            }
            _ => Ok(found),
        }
    };
    let (both, u, v) = (alpha("alpha")?, alpha("alpha_u")?, alpha("alpha_v")?);
    let alpha = match (both, u, v) {
        (None, Some(u), Some(v)) if u == v => [u, v],
        (None, Some(_), Some(_)) => {
            return Err(plugin.unsupported(
                "a roughness that differs along u and v",
                "give the same alpha_u and alpha_v",
            ));
        }
        (None, Some(_), None) => return Err(plugin.missing("alpha_v", "float")),
        (None, None, Some(_)) => return Err(plugin.missing("alpha_u", "float")),
        (Some(both), None, None) => [both; 2],
        (None, None, None) => [0.1; 2],
        (Some(both), ..) => {
            let expected = "left out where alpha_u and alpha_v are given";
            return Err(plugin.invalid("alpha", expected, both));
        }
    };
    let distribution = match plugin.string("distribution")? {
        None | Some("beckmann") => Distribution::Beckmann,
        Some("ggx") => Distribution::Ggx,
        Some(other) => {
            let found = format!("\"{other}\"");
            return Err(plugin.invalid("distribution", "beckmann or ggx", found));
        }
    };
    // Our own; Mitsuba's is separable.
    let masking = match plugin.string("masking")? {
        None | Some("separable") => Masking::Separable,
        Some("correlated") => Masking::Correlated,
        Some("cavities") => Masking::Cavities,
        Some(other) => {
            let expected = "separable, correlated or cavities";
            return Err(plugin.invalid("masking", expected, format!("\"{other}\"")));
        }
    };
    plugin.ignore(&["sample_visible"])?;
    Ok(Facets {
        alpha,
        distribution,
        masking,
        compensated: plugin.boolean("compensated")?.unwrap_or(false),
    })
}

/// Phong's exponent.
pub fn exponent(plugin: &Plugin) -> Result<Option<f32>, LoadError> {
    let found = plugin.float("exponent")?;
    match found {
        Some(n) if !(0.0..=1e5).contains(&n) => {
            Err(plugin.invalid("exponent", "from 0 to 100000", n))
        }
        _ => Ok(found),
    }
}

/// Our own: which normalisation.
fn modified(plugin: &Plugin) -> Result<bool, LoadError> {
    Ok(plugin.boolean("modified")?.unwrap_or(true))
}
