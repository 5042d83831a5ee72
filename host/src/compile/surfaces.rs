//! Materials and textures.

use super::glossy;
use crate::description::{
    Color, ColorSource, Description, Index, Model, Pattern, Spectrum, Texels, Wrap,
};
use crate::spectra::{append, reflected};
use bytemuck::Zeroable;
use etendue::blob::format::{self, Material, NONE, Texture, material, needs, texture};
use etendue::surface::curve::Curve;

/// Materials, textures and their texels, and what they make the scene need.
#[derive(Default)]
pub(super) struct Surfaces {
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub texels: Vec<u32>,
    pub needs: u32,
}

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

impl Surfaces {
    pub fn compile(d: &Description) -> Self {
        let mut out = Self::default();
        for t in &d.textures {
            out.texture(&t.pattern, t.to_uv);
        }
        for (i, m) in d.materials.iter().enumerate() {
            let mut compiled = out.material(&m.model);
            compiled.level = level(d, i, 0);
            out.materials.push(compiled);
        }
        out
    }

    fn texture(&mut self, pattern: &Pattern, to_uv: [[f32; 3]; 2]) {
        let mut t = Texture {
            to_uv,
            texels: self.texels.len() as u32,
            color: [[1.0; 3]; 2],
            ..Texture::zeroed()
        };
        match pattern {
            Pattern::Spectrum(rows) => {
                t.kind = texture::SPECTRUM;
                t.width = rows.len() as u32;
                t.color[0] = reflected(rows);
                append(&mut self.texels, rows);
            }
            Pattern::Checkerboard { colors } => {
                t.kind = texture::CHECKERBOARD;
                t.color = *colors;
            }
            Pattern::Bitmap {
                image,
                nearest,
                wrap,
                alpha,
            } => {
                (t.width, t.height) = (image.width, image.height);
                t.flags = if *nearest { texture::NEAREST } else { 0 }
                    | if *alpha { texture::ALPHA } else { 0 }
                    | match wrap {
                        Wrap::Repeat => 0,
                        Wrap::Clamp => texture::CLAMP,
                        Wrap::Mirror => texture::MIRROR,
                    };
                match &image.texels {
                    Texels::Srgb8(texels) => {
                        t.kind = texture::SRGB8;
                        self.texels
                            .extend(texels.iter().map(|&x| u32::from_le_bytes(x)));
                    }
                    Texels::Linear8(texels) => {
                        t.kind = texture::LINEAR8;
                        self.texels
                            .extend(texels.iter().map(|&x| u32::from_le_bytes(x)));
                    }
                    Texels::Float(texels) => {
                        t.kind = texture::FLOAT;
                        self.texels.extend(
                            texels
                                .as_flattened()
                                .iter()
                                .map(|x| x.clamp(0.0, 1.0).to_bits()),
                        );
                    }
                }
            }
        }
        self.needs |= needs::TEXTURES;
        self.textures.push(t);
    }

    /// A texture of values in [0, 1] by wavelength, and what it stands for without.
    fn spectrum(&mut self, rows: &[[f32; 2]], color: Color) -> u32 {
        self.texture(&Pattern::Spectrum(rows.to_vec()), IDENTITY);
        let id = self.textures.len() - 1;
        self.textures[id].color[0] = color;
        id as u32
    }

    /// A conductor's η and k by wavelength: textures of what they are over their largest value. Without wavelengths they are what the model says.
    fn by_wavelength(&mut self, m: &mut Material, spectra: &Option<[Spectrum; 2]>) {
        let Some(spectra) = spectra else { return };
        let [.., eta, k] = &mut m.texture;
        for (rows, (constant, texture)) in spectra.iter().zip([(&mut m.eta, eta), (&mut m.k, k)]) {
            let most = rows.iter().map(|[_, x]| *x);
            let most = most.chain(*constant).fold(f32::MIN_POSITIVE, f32::max);
            let shares: Vec<_> = rows.iter().map(|[nm, x]| [*nm, x / most]).collect();
            *texture = self.spectrum(&shares, constant.map(|x| x / most));
            *constant = [most; 3];
        }
    }

    /// A texture that is the same everywhere: how a constant opacity is said.
    pub fn constant(&mut self, color: Color) -> u32 {
        self.texture(&Pattern::Checkerboard { colors: [color; 2] }, IDENTITY);
        self.textures.len() as u32 - 1
    }

    /// The texture that `source` names, made if it is a constant.
    pub fn as_texture(&mut self, source: ColorSource) -> u32 {
        match source {
            ColorSource::Constant(color) => self.constant(color),
            ColorSource::Texture(id) => id as u32,
        }
    }

    /// Appends a curve; its first word.
    fn curve(&mut self, curve: Curve) -> u32 {
        let first = self.texels.len() as u32;
        let words = curve.0.as_chunks().0;
        self.texels
            .extend(words.iter().map(|&w| u32::from_le_bytes(w)));
        first
    }

    fn material(&mut self, model: &Model) -> Material {
        let mut m = Material {
            ior: 1.0,
            texture: [NONE; 4],
            ..Material::zeroed()
        };
        let set = |m: &mut Material, role: usize, source: ColorSource| match source {
            ColorSource::Constant(color) => m.color[role] = color,
            ColorSource::Texture(id) => {
                m.color[role] = [1.0; 3];
                m.texture[role] = id as u32;
            }
        };
        match *model {
            Model::Diffuse {
                reflectance,
                transmittance,
            } => {
                m.kind = material::DIFFUSE;
                set(&mut m, 0, reflectance);
                set(&mut m, 1, transmittance);
                if transmittance != ColorSource::Constant([0.0; 3]) {
                    self.needs |= needs::TRANSMISSION;
                }
            }
            Model::Mirror { reflectance } => {
                m.kind = material::MIRROR;
                set(&mut m, 0, reflectance);
                self.needs |= needs::DIRAC;
            }
            Model::Conductor {
                eta,
                k,
                ref spectra,
                reflectance,
            } => {
                m.kind = material::CONDUCTOR;
                (m.eta, m.k) = (eta, k);
                self.by_wavelength(&mut m, spectra);
                set(&mut m, 0, reflectance);
                self.needs |= needs::DIRAC;
            }
            Model::Dielectric {
                ior,
                reflectance,
                transmittance,
                schlick,
            } => {
                m.kind = material::DIELECTRIC;
                m.flags = if schlick { material::SCHLICK } else { 0 };
                m.ior = ior;
                set(&mut m, 0, reflectance);
                set(&mut m, 1, transmittance);
                self.needs |= needs::DIRAC | needs::TRANSMISSION;
            }
            Model::Dispersive {
                ref index,
                outside,
                reflectance,
                transmittance,
                schlick,
            } => {
                m.kind = material::DISPERSIVE;
                m.ior = 1.0 / outside;
                m.flags = if schlick { material::SCHLICK } else { 0 };
                match index {
                    Index::Cauchy(coefficients) => {
                        (m.flags, m.eta) = (m.flags | material::CAUCHY, *coefficients);
                    }
                    Index::Sellmeier { b, c } => {
                        (m.flags, m.eta, m.k) = (m.flags | material::SELLMEIER, *b, *c);
                    }
                    Index::Table(rows) => {
                        m.flags |= material::TABLE;
                        m.link = append(&mut self.texels, rows);
                    }
                }
                set(&mut m, 0, reflectance);
                set(&mut m, 1, transmittance);
                self.needs |= needs::DIRAC | needs::TRANSMISSION;
                self.needs |= needs::DISPERSION;
            }
            Model::Null => {
                m.kind = material::NULL;
                self.needs |= needs::NULL;
            }
            Model::Sheet {
                specular_reflectance,
                specular_transmittance,
                diffuse_reflectance,
                diffuse_transmittance,
            } => {
                m.kind = material::SHEET;
                let roles = [
                    specular_reflectance,
                    specular_transmittance,
                    diffuse_reflectance,
                    diffuse_transmittance,
                ];
                for (role, source) in roles.into_iter().enumerate() {
                    set(&mut m, role, source);
                }
                self.needs |= needs::DIRAC | needs::TRANSMISSION;
            }
            Model::Phong {
                diffuse_reflectance,
                reflectance,
                transmittance,
                diffuse_transmittance,
                exponent,
                modified,
                ior,
                fresnel,
            } => {
                m.kind = material::PHONG;
                m.flags = if fresnel { material::FRESNEL } else { 0 };
                m.ior = ior;
                m.gloss = [exponent, glossy::normalization(exponent, modified)];
                let roles = [
                    diffuse_reflectance,
                    reflectance,
                    transmittance,
                    diffuse_transmittance,
                ];
                for (role, source) in roles.into_iter().enumerate() {
                    set(&mut m, role, source);
                }
                let black = ColorSource::Constant([0.0; 3]);
                if transmittance != black || diffuse_transmittance != black {
                    self.needs |= needs::TRANSMISSION;
                }
            }
            Model::RoughConductor {
                eta,
                k,
                ref spectra,
                reflectance,
                facets,
            } => {
                m.kind = material::ROUGH_CONDUCTOR;
                (m.eta, m.k) = (eta, k);
                self.by_wavelength(&mut m, spectra);
                (m.flags, m.gloss) = (glossy::flags(&facets), facets.alpha);
                set(&mut m, 0, reflectance);
                if facets.compensated {
                    let mean = glossy::mean_reflectance(eta, k);
                    m.color[1] = mean;
                    if let Some([eta, k]) = spectra {
                        m.color[1] = [1.0; 3];
                        m.texture[1] = self.spectrum(&glossy::mean_reflectances(eta, k), mean);
                    }
                    m.link[0] = self.curve(glossy::conductor_loss(&m));
                }
            }
            Model::RoughDielectric {
                ior,
                reflectance,
                transmittance,
                facets,
            } => {
                m.kind = material::ROUGH_DIELECTRIC;
                (m.flags, m.gloss) = (glossy::flags(&facets), facets.alpha);
                m.ior = ior;
                set(&mut m, 0, reflectance);
                set(&mut m, 1, transmittance);
                if facets.compensated {
                    m.link = glossy::dielectric_losses(&m).map(|c| self.curve(c));
                }
                self.needs |= needs::TRANSMISSION;
            }
            Model::Plastic {
                ior,
                diffuse_reflectance,
                reflectance,
                nonlinear,
                facets,
            } => {
                m.kind = material::PLASTIC;
                m.ior = ior;
                set(&mut m, 0, diffuse_reflectance);
                set(&mut m, 1, reflectance);
                match facets {
                    None => {
                        m.internal = glossy::smooth_internal(ior);
                        self.needs |= needs::DIRAC;
                    }
                    Some(facets) => {
                        m.kind = material::ROUGH_PLASTIC;
                        m.flags = glossy::flags(&facets) & !material::COMPENSATED;
                        m.gloss = facets.alpha;
                        let (entering, internal) = glossy::coat(&m, facets.compensated);
                        m.internal = internal;
                        m.link[0] = self.curve(entering);
                    }
                }
                m.flags |= if nonlinear { material::NONLINEAR } else { 0 };
            }
            Model::Blend { parts, weight } => {
                m.kind = material::BLEND;
                m.link = parts.map(|p| p as u32);
                set(&mut m, 0, weight);
            }
        }
        let glossy = [
            material::PHONG,
            material::ROUGH_CONDUCTOR,
            material::ROUGH_DIELECTRIC,
            material::PLASTIC,
            material::ROUGH_PLASTIC,
            material::BLEND,
        ];
        if glossy.contains(&m.kind) {
            self.needs |= needs::GLOSSY;
        }
        m
    }
}

/// Levels of blends within a material; one above what the kernel takes if they don't end, which it refuses.
fn level(d: &Description, material: usize, depth: u32) -> u32 {
    match d.materials.get(material).map(|m| &m.model) {
        Some(Model::Blend { parts, .. }) if depth <= material::MAX_LEVEL => {
            let below = parts.map(|p| level(d, p, depth + 1));
            1 + below[0].max(below[1])
        }
        _ => 0,
    }
}

/// The camera's record.
pub(super) fn sensor(s: &crate::description::Sensor, medium: Option<usize>) -> format::Sensor {
    use crate::description::{Filter, Projection};
    let (kind, half_extent, aperture, focus) = match s.projection {
        Projection::Perspective {
            half_tangent,
            aperture,
            focus,
        } => (format::sensor::PERSPECTIVE, half_tangent, aperture, focus),
        Projection::Orthographic { half_extent } => {
            (format::sensor::ORTHOGRAPHIC, half_extent, 0.0, 1.0)
        }
        Projection::Panorama => (format::sensor::PANORAMA, [1.0; 2], 0.0, 1.0),
    };
    let (filter, filter_radius, filter_sigma) = match s.filter {
        Filter::Box { radius } => (format::sensor::BOX, radius, 0.0),
        Filter::Tent { radius } => (format::sensor::TENT, radius, 0.0),
        Filter::Gaussian { sigma, radius } => (format::sensor::GAUSSIAN, radius, sigma),
    };
    let [x, y, w, h] = s.crop.unwrap_or([0, 0, s.resolution[0], s.resolution[1]]);
    format::Sensor {
        kind,
        filter,
        filter_radius,
        filter_sigma,
        resolution: s.resolution,
        crop_offset: [x, y],
        crop_size: [w, h],
        half_extent,
        aperture,
        focus,
        clip: s.clip,
        origin: s.origin,
        right: s.right,
        down: s.down,
        forward: s.forward,
        medium: super::optional(medium),
        principal: s.principal,
        reserved: [0; 1],
    }
}
