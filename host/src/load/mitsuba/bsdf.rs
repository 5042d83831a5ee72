//! BSDFs to what stands on the two sides of a surface.

use super::Loader;
use super::constants::{GLASSES, INDICES, METALS};
use super::glossy::exponent;
use super::plugin::Plugin;
use super::texture::{Range, show};
use super::value::{number, table};
use crate::description::{Color, ColorSource, Index, Material, Model, Spectrum};
use crate::load::error::{LoadError, Problem};

/// Both sides of a surface, and whether it is there at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// On the side of the normal; `None` is black.
    pub front: Option<usize>,
    /// On the other side; `None` is black.
    pub back: Option<usize>,
    /// Opacity, if it isn't 1 everywhere.
    pub opacity: Option<ColorSource>,
    /// Whether light goes through.
    pub transmits: bool,
}

const KNOWN: &str = "diffuse, twosided, conductor, roughconductor, dielectric, roughdielectric, plastic, roughplastic, phong, phongdielectric, blendbsdf, null, mask, diffusetransmitter or sheet";

/// Known to Mitsuba, unknown to us.
const LATER: [&str; 13] = [
    "thindielectric",
    "principled",
    "principledthin",
    "bumpmap",
    "normalmap",
    "hair",
    "measured",
    "pplastic",
    "polarizer",
    "retarder",
    "circular",
    "ward",
    "coating",
];

impl Loader<'_> {
    /// What a shape without BSDF gets: diffuse, half grey, on its front.
    pub fn default_surface(&mut self) -> Surface {
        // No element has this index.
        let key = usize::MAX;
        if let Some(&done) = self.surfaces.get(&key) {
            return done;
        }
        let half = ColorSource::Constant([0.5; 3]);
        let model = Model::Diffuse {
            reflectance: half,
            transmittance: BLACK,
        };
        let surface = self.one_sided("default".into(), model);
        self.surfaces.insert(key, surface);
        surface
    }

    pub fn push(&mut self, name: String, model: Model) -> usize {
        self.out.materials.push(Material { name, model });
        self.out.materials.len() - 1
    }

    pub fn one_sided(&mut self, name: String, model: Model) -> Surface {
        Surface {
            front: Some(self.push(name, model)),
            back: None,
            opacity: None,
            transmits: false,
        }
    }

    pub fn both_sides(&mut self, name: String, model: Model) -> Surface {
        let material = Some(self.push(name, model));
        Surface {
            front: material,
            back: material,
            opacity: None,
            transmits: true,
        }
    }

    /// The surface of the BSDF at an element.
    pub fn surface(&mut self, index: usize) -> Result<Surface, LoadError> {
        if let Some(&done) = self.surfaces.get(&index) {
            return Ok(done);
        }
        let plugin = Plugin::new(self.document, index)?;
        if self.open.contains(&index) {
            let text = "BSDF within itself, expected one that ends";
            return Err(plugin.error(Problem::Malformed(text.into())));
        }
        self.open.push(index);
        let surface = self.make(&plugin)?;
        self.open.pop();
        plugin.finish()?;
        self.surfaces.insert(index, surface);
        Ok(surface)
    }

    fn make(&mut self, plugin: &Plugin) -> Result<Surface, LoadError> {
        let name = self.name(plugin.node);
        match plugin.kind {
            "diffuse" => {
                let reflectance = self.source(plugin, "reflectance", 0.5, Range::Unit)?;
                Ok(self.one_sided(
                    name,
                    Model::Diffuse {
                        reflectance,
                        transmittance: BLACK,
                    },
                ))
            }
            "conductor" => {
                let model = self.conductor(plugin)?;
                Ok(self.one_sided(name, model))
            }
            "dielectric" => {
                let inside = index(plugin, "int_ior", "bk7")?;
                let outside = index(plugin, "ext_ior", "air")?;
                let reflectance = self.source(plugin, "specular_reflectance", 1.0, Range::Unit)?;
                let transmittance =
                    self.source(plugin, "specular_transmittance", 1.0, Range::Unit)?;
                // Our own: Schlick's approximation.
                let schlick = plugin.boolean("schlick")?.unwrap_or(false);
                let ior = inside / outside;
                if let Some(text) = plugin.string("dispersion")? {
                    let index = dispersion(plugin, text, outside)?;
                    let model = Model::Dispersive {
                        index,
                        outside,
                        reflectance,
                        transmittance,
                        schlick,
                    };
                    return Ok(self.both_sides(name, model));
                }
                Ok(self.both_sides(
                    name,
                    Model::Dielectric {
                        ior,
                        reflectance,
                        transmittance,
                        schlick,
                    },
                ))
            }
            "roughconductor" | "plastic" | "roughplastic" | "phong" => {
                let model = self.glossy(plugin)?;
                Ok(self.one_sided(name, model))
            }
            "roughdielectric" | "phongdielectric" => {
                let model = self.glossy(plugin)?;
                Ok(self.both_sides(name, model))
            }
            "blendbsdf" => self.blend(plugin),
            "null" => Ok(self.both_sides(name, Model::Null)),
            "diffusetransmitter" => {
                let reflectance = self.source(plugin, "reflectance", 0.5, Range::Unit)?;
                let transmittance = self.source(plugin, "transmittance", 0.5, Range::Unit)?;
                at_most_one(
                    plugin,
                    &[reflectance, transmittance],
                    "reflectance + transmittance",
                )?;
                Ok(self.both_sides(
                    name,
                    Model::Diffuse {
                        reflectance,
                        transmittance,
                    },
                ))
            }
            "sheet" => {
                let parts = [
                    self.source(plugin, "specular_reflectance", 0.0, Range::Unit)?,
                    self.source(plugin, "specular_transmittance", 0.0, Range::Unit)?,
                    self.source(plugin, "diffuse_reflectance", 0.0, Range::Unit)?,
                    self.source(plugin, "diffuse_transmittance", 0.0, Range::Unit)?,
                ];
                at_most_one(plugin, &parts, "sum of reflectances and transmittances")?;
                let [
                    specular_reflectance,
                    specular_transmittance,
                    diffuse_reflectance,
                    diffuse_transmittance,
                ] = parts;
                let model = match exponent(plugin)? {
                    None => Model::Sheet {
                        specular_reflectance,
                        specular_transmittance,
                        diffuse_reflectance,
                        diffuse_transmittance,
                    },
                    // Our own: its specular parts are lobes.
                    Some(exponent) => Model::Phong {
                        diffuse_reflectance,
                        reflectance: specular_reflectance,
                        transmittance: specular_transmittance,
                        diffuse_transmittance,
                        exponent,
                        modified: true,
                        ior: 1.0,
                        fresnel: false,
                    },
                };
                Ok(self.both_sides(name, model))
            }
            "twosided" => self.two_sided(plugin),
            "mask" => {
                let opacity = self.source(plugin, "opacity", 0.5, Range::Opacity)?;
                let nested = plugin
                    .object("bsdf")?
                    .ok_or_else(|| plugin.missing("a nested BSDF", "bsdf"))?;
                let nested = self.surface(nested)?;
                if nested.opacity.is_some() {
                    return Err(
                        plugin.unsupported("a mask within a mask", "multiply their opacities")
                    );
                }
                let opacity = Some(opacity).filter(|o| *o != ColorSource::Constant([1.0; 3]));
                Ok(Surface { opacity, ..nested })
            }
            kind if LATER.contains(&kind) => {
                Err(plugin.unsupported(format!("bsdf {kind}"), &format!("choose {KNOWN}")))
            }
            _ => Err(plugin.unknown(KNOWN)),
        }
    }

    fn two_sided(&mut self, plugin: &Plugin) -> Result<Surface, LoadError> {
        let nested = plugin.objects("bsdf")?;
        let (front, back) = match nested.as_slice() {
            [one] => (*one, *one),
            [front, back] => (*front, *back),
            others => {
                let expected = "one or two";
                return Err(plugin.invalid("number of nested BSDFs", expected, others.len()));
            }
        };
        let [front, back] = [self.surface(front)?, self.surface(back)?];
        for side in [front, back] {
            if side.transmits || side.opacity.is_some() || side.back.is_some() {
                return Err(plugin.invalid(
                    "nested BSDF",
                    "one that neither transmits nor is two-sided",
                    "another",
                ));
            }
        }
        Ok(Surface {
            front: front.front,
            back: back.front,
            opacity: None,
            transmits: false,
        })
    }

    fn conductor(&mut self, plugin: &Plugin) -> Result<Model, LoadError> {
        let index = metal(plugin)?;
        let reflectance = self.source(plugin, "specular_reflectance", 1.0, Range::Unit)?;
        Ok(match index {
            None => Model::Mirror { reflectance },
            Some(Metal { eta, k, spectra }) => Model::Conductor {
                eta,
                k,
                spectra,
                reflectance,
            },
        })
    }
}

/// η and k of a conductor relative to outside, and by wavelength if the scene says so.
pub struct Metal {
    pub eta: Color,
    pub k: Color,
    pub spectra: Option<[Spectrum; 2]>,
}

/// The index of a conductor; `None` reflects everything.
pub fn metal(plugin: &Plugin) -> Result<Option<Metal>, LoadError> {
    let material = plugin.string("material")?;
    let eta = plugin.number("eta")?;
    let k = plugin.number("k")?;
    let outside = match plugin.has("ext_eta") {
        true => index(plugin, "ext_eta", "vacuum")?,
        false => 1.0,
    };
    let (eta, k) = match (material, eta, k) {
        (None | Some("none"), None, None) => return Ok(None),
        (Some(name), None, None) => {
            let found = METALS.iter().find(|m| m.0 == name);
            let found = found.ok_or_else(|| {
                let names: Vec<&str> = METALS.iter().map(|m| m.0).collect();
                plugin.invalid(
                    "material",
                    format!("none, {}", names.join(", ")),
                    format!("\"{name}\""),
                )
            })?;
            ((found.1, None), (found.2, None))
        }
        (Some(name), _, _) if name != "none" => {
            return Err(plugin.invalid(
                "material",
                "left out where eta and k are given",
                format!("\"{name}\""),
            ));
        }
        (_, Some(eta), Some(k)) => (eta, k),
        (_, Some(_), None) => return Err(plugin.missing("k", "rgb")),
        (_, None, _) => return Err(plugin.missing("eta", "rgb")),
    };
    let ((eta, etas), (k, ks)) = (eta, k);
    let least = etas.iter().flatten().map(|[_, e]| *e);
    if eta.into_iter().chain(least).any(|e| e <= 0.0) {
        return Err(plugin.invalid("eta", "> 0", show(eta)));
    }
    // One that is given as a colour beside the other's table is one number, or it would be unclear what it is in between.
    let table = |name: &str, color: Color, rows: Option<Spectrum>| match rows {
        Some(rows) => Ok(rows),
        None if color == [color[0]; 3] => Ok(vec![[550.0, color[0]]]),
        None => Err(plugin.invalid(
            name,
            "one number or a spectrum where the other is one",
            show(color),
        )),
    };
    let spectra = match etas.is_some() || ks.is_some() {
        true => Some([table("eta", eta, etas)?, table("k", k, ks)?]),
        false => None,
    };
    let over = |rows: Spectrum| rows.into_iter().map(|[nm, x]| [nm, x / outside]).collect();
    Ok(Some(Metal {
        eta: eta.map(|e| e / outside),
        k: k.map(|x| x / outside),
        spectra: spectra.map(|both| both.map(over)),
    }))
}

pub const BLACK: ColorSource = ColorSource::Constant([0.0; 3]);

/// An index of refraction: a number or a name.
pub fn index(plugin: &Plugin, name: &str, default: &str) -> Result<f32, LoadError> {
    let found = plugin.child(name)?.map(|i| &plugin.document.nodes[i]);
    let text = match found {
        Some(node) if node.tag == "string" => plugin.string(name)?.unwrap_or(default),
        Some(_) => {
            let value = plugin.positive(name)?;
            return Ok(value.unwrap_or(1.0));
        }
        None => default,
    };
    let known = INDICES
        .iter()
        .find(|(n, _)| n.eq_ignore_ascii_case(text))
        .map(|(_, v)| *v);
    known
        .or_else(|| number(text).filter(|v| *v > 0.0))
        .ok_or_else(|| {
            let names: Vec<&str> = INDICES.iter().map(|(n, _)| *n).collect();
            plugin.invalid(
                name,
                format!("a number > 0 or one of {}", names.join(", ")),
                format!("\"{text}\""),
            )
        })
}

/// Constants must not make energy together; what textures add is theirs to answer for.
pub fn at_most_one(plugin: &Plugin, parts: &[ColorSource], what: &str) -> Result<(), LoadError> {
    let mut sum = [0.0f32; 3];
    for part in parts {
        if let ColorSource::Constant(c) = part {
            for (s, c) in sum.iter_mut().zip(c) {
                *s += c;
            }
        }
    }
    if sum.iter().any(|s| *s > 1.0 + 1e-5) {
        return Err(plugin.invalid(what, "at most 1 in each channel", show(sum)));
    }
    Ok(())
}

/// Our own: how the index inside depends on wavelength, in place of `int_ior`. `cauchy A B [C]` and `sellmeier B1 B2 B3 C1 C2 C3` (λ in µm),
/// `table NM:N …`, or a glass by name.
fn dispersion(plugin: &Plugin, text: &str, outside: f32) -> Result<Index, LoadError> {
    let wrong = || {
        let expected = "cauchy A B [C], sellmeier B1 B2 B3 C1 C2 C3, table NM:N …, bk7, sf11 or fused silica, an index from 0.1 to 100 at 380 to 780 nm";
        plugin.invalid("dispersion", expected, format!("\"{text}\""))
    };
    if plugin.has("int_ior") {
        let text = "has int_ior and dispersion, expected one of the two";
        return Err(plugin.error(Problem::Malformed(text.into())));
    }
    if let Some((_, b, c)) = GLASSES.iter().find(|(name, ..)| *name == text.trim()) {
        return Ok(Index::Sellmeier { b: *b, c: *c });
    }
    let (formula, rest) = text
        .trim()
        .split_once(char::is_whitespace)
        .ok_or_else(wrong)?;
    let numbers = || {
        let words = rest.split([',', ' ', '\t', '\n']).filter(|w| !w.is_empty());
        words.map(str::parse).collect::<Result<Vec<f32>, _>>()
    };
    let index = match (formula, numbers().unwrap_or_default().as_slice()) {
        ("cauchy", &[a, b]) => Index::Cauchy([a, b, 0.0]),
        ("cauchy", &[a, b, c]) => Index::Cauchy([a, b, c]),
        ("sellmeier", &[b1, b2, b3, c1, c2, c3]) => Index::Sellmeier {
            b: [b1, b2, b3],
            c: [c1, c2, c3],
        },
        ("table", _) => Index::Table(table(rest).filter(|t| t.len() <= 256).ok_or_else(wrong)?),
        _ => return Err(wrong()),
    };
    if index.is_visible(outside) {
        Ok(index)
    } else {
        Err(wrong())
    }
}
