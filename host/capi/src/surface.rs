//! Local models and textures.

use crate::arguments::{Sized32, input, place, slice};
use crate::boundary::{Trouble, copied, fill};
use crate::builder::{ETD_NONE, EtdBuilder, edit};
use crate::described::Described;
use etendue::capi::status::{ETD_E_ARGUMENT, ETD_E_SIZE, EtdStatus};
use etendue_host::description::{
    Carry, Color, ColorSource, Distribution, Facets, Image, Index, Masking, Material, Model,
    Pattern, Texels, Texture, Wrap, is_spectrum,
};
use std::ffi::c_void;

/// Diffuse: `color[0]` reflected, `color[1]` transmitted.
pub const ETD_DIFFUSE: u32 = 0;
/// A perfect mirror: `color[0]`.
pub const ETD_MIRROR: u32 = 1;
/// A smooth conductor: `eta` + i·`k` relative to outside, scaled by `color[0]`.
pub const ETD_CONDUCTOR: u32 = 2;
/// A smooth dielectric: `ior`; `color[0]` scales reflection, `color[1]` transmission.
pub const ETD_DIELECTRIC: u32 = 3;
/// Light passes.
pub const ETD_BOUNDARY: u32 = 4;
/// A thin sheet: `color[0]` mirror-like, `color[1]` straight through, `color[2]` diffusely reflected, `color[3]` diffusely transmitted.
pub const ETD_SHEET: u32 = 5;
/// Phong lobes of `exponent`: `color[0]` diffusely reflected, `color[1]` about the mirror direction, `color[2]` about the refracted
/// direction (`ior`; 1 is a thin sheet), `color[3]` diffusely transmitted.
pub const ETD_PHONG: u32 = 6;
/// A rough conductor: as `ETD_CONDUCTOR`, with microfacets of roughness `alpha`.
pub const ETD_ROUGH_CONDUCTOR: u32 = 7;
/// A rough dielectric: as `ETD_DIELECTRIC`, with microfacets of roughness `alpha`; `ior` at least 1 % from 1.
pub const ETD_ROUGH_DIELECTRIC: u32 = 8;
/// Diffuse `color[0]` under a smooth coat of index `ior`; `color[1]` scales the coat's reflection.
pub const ETD_PLASTIC: u32 = 9;
/// The same under a coat with microfacets of roughness `alpha`.
pub const ETD_ROUGH_PLASTIC: u32 = 10;
/// At each point one of the two materials `parts`: the second with probability `color[0]`, its first channel.
pub const ETD_BLEND: u32 = 11;
/// A smooth dielectric whose index depends on wavelength λ (µm): over `ior`, which is the index outside, n² = 1 + Σ `eta[i]`·λ²/(λ² − `k[i]`)
/// (Sellmeier); with `ETD_CAUCHY` n = `eta[0]` + `eta[1]`/λ² + `eta[2]`/λ⁴. Colours as `ETD_DIELECTRIC`.
pub const ETD_DISPERSIVE: u32 = 12;
/// Flag of `ETD_DIELECTRIC` and `ETD_DISPERSIVE`: Schlick's approximation in place of Fresnel's equations.
pub const ETD_SCHLICK: u32 = 1;
/// Flag of `ETD_PHONG`: the lobes have Fresnel's shares of the light, by `ior`.
pub const ETD_FRESNEL: u32 = 2;
/// Flag of the rough kinds: Beckmann's distribution of facets rather than GGX.
pub const ETD_BECKMANN: u32 = 4;
/// Flag of the rough kinds: masking of each direction for itself rather than correlated by height.
pub const ETD_SEPARABLE: u32 = 8;
/// Flag of `ETD_ROUGH_CONDUCTOR` and `ETD_ROUGH_PLASTIC`: masking by V-shaped cavities.
pub const ETD_CAVITIES: u32 = 16;
/// Flag of the rough kinds: the light that scattering by single facets loses is given back.
pub const ETD_COMPENSATED: u32 = 32;
/// Flag of `ETD_DISPERSIVE`: Cauchy's formula.
pub const ETD_CAUCHY: u32 = 128;
/// Flag of the plastics: light that the coat sends back takes the base's colour each time.
pub const ETD_NONLINEAR: u32 = 64;

/// A local model. `etd_material_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdMaterial {
    /// sizeof(EtdMaterial).
    pub struct_size: u32,
    /// `ETD_DIFFUSE` to `ETD_DISPERSIVE`.
    pub kind: u32,
    /// `ETD_SCHLICK` to `ETD_CAUCHY`, added up.
    pub flags: u32,
    /// Index of refraction inside (behind the front) over that outside, 0.001 to 1000.
    pub ior: f32,
    /// Shares of the light, 0 to 1; what a kind scatters may not exceed 1 in sum. Not looked at where there is a texture.
    pub color: [[f32; 3]; 4],
    /// Textures in their place, or `ETD_NONE`.
    pub texture: [u32; 4],
    /// Real part of the index of refraction, per channel, > 0. `ETD_DISPERSIVE`: coefficients.
    pub eta: [f32; 3],
    /// Imaginary part, per channel, ≥ 0. `ETD_DISPERSIVE`: Sellmeier's second three, µm².
    pub k: [f32; 3],
    /// Roughness of microfacets, 0.0001 to 10.
    pub alpha: f32,
    /// Phong's exponent, 0 to 100000. The lobes are normalised such that along the normal a colour is an albedo.
    pub exponent: f32,
    /// A blend's two materials.
    pub parts: [u32; 2],
}

/// Squares of the colours `color[0]` (where ⌊u⌋ + ⌊v⌋ is even) and `color[1]`.
pub const ETD_CHECKERBOARD: u32 = 0;
/// Texels of 4 bytes, RGBA, coded as sRGB (alpha linear).
pub const ETD_SRGB8: u32 = 1;
/// Texels of 4 bytes, RGBA, linear.
pub const ETD_LINEAR8: u32 = 2;
/// Texels of 3 floats, linear RGB, 0 to 1.
pub const ETD_FLOAT: u32 = 3;
/// The same everywhere, by wavelength: `width` rows of two floats, nm and value (0 to 1), by rising wavelength; linear between. `height` is 1.
pub const ETD_SPECTRUM: u32 = 4;
/// Flag: the nearest texel rather than a bilinear mixture.
pub const ETD_NEAREST: u32 = 1;
/// Flag: outside [0, 1]² the border goes on, rather than the image starting over.
pub const ETD_CLAMP: u32 = 2;
/// Flag: outside [0, 1]² the image goes back and forth.
pub const ETD_MIRRORED: u32 = 4;
/// Flag: the value is the alpha channel.
pub const ETD_ALPHA: u32 = 8;

/// A colour over texture coordinates. `etd_texture_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdTexture {
    /// sizeof(EtdTexture).
    pub struct_size: u32,
    /// `ETD_CHECKERBOARD` to `ETD_SPECTRUM`.
    pub kind: u32,
    /// `ETD_NEAREST` and so on, added up.
    pub flags: u32,
    /// Columns of an image, 1 to 65536.
    pub width: u32,
    /// Rows of an image, 1 to 65536; the first is the top, at v = 0.
    pub height: u32,
    /// Zero.
    pub reserved: u32,
    /// Colours of a checkerboard, 0 to 1.
    pub color: [[f32; 3]; 2],
    /// Texture coordinates are this matrix of two rows times (u, v, 1).
    pub to_uv: [[f32; 3]; 2],
    /// An image's texels, row by row; floats aligned as such.
    pub texels: *const c_void,
    /// How many bytes they are: `width` · `height` · 4, · 12 for `ETD_FLOAT`, · 8 for `ETD_SPECTRUM`.
    pub bytes: usize,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdMaterial {}
// SAFETY: repr(C), the size first, numbers and a pointer only.
unsafe impl Sized32 for EtdTexture {}

/// Paths carry wavelengths where a material disperses or a texture is a spectrum; otherwise red, green and blue. As at first.
pub const ETD_COLOR_AUTO: u32 = 0;
/// Paths carry red, green and blue; an index that disperses has three values.
pub const ETD_COLOR_RGB: u32 = 1;
/// Paths carry four wavelengths.
pub const ETD_COLOR_SPECTRAL: u32 = 2;

pub(crate) fn finite(values: &[f32]) -> bool {
    values.iter().all(|x| x.is_finite())
}

/// An id that may be `ETD_NONE`.
pub(crate) fn optional_id(what: &str, id: u32, count: usize) -> Result<Option<usize>, Trouble> {
    match id as usize {
        _ if id == ETD_NONE => Ok(None),
        id if id < count => Ok(Some(id)),
        id => Err(bad(format!("{what} {id}: there are {count}"))),
    }
}

fn bad(reason: impl Into<String>) -> Trouble {
    Trouble::new(ETD_E_ARGUMENT, reason)
}

/// White and diffuse, without textures; an index of refraction of 1.5; eta 1, k 0; a roughness of 0.1, an exponent of 30, no parts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_material_default(material: *mut EtdMaterial) -> EtdStatus {
    fill(material, || EtdMaterial {
        struct_size: size_of::<EtdMaterial>() as u32,
        kind: ETD_DIFFUSE,
        flags: 0,
        ior: 1.5,
        color: [[1.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]],
        texture: [ETD_NONE; 4],
        eta: [1.0; 3],
        k: [0.0; 3],
        alpha: 0.1,
        exponent: 30.0,
        parts: [ETD_NONE; 2],
    })
}

/// A checkerboard of black and white squares, one to a unit of texture coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_texture_default(texture: *mut EtdTexture) -> EtdStatus {
    fill(texture, || EtdTexture {
        struct_size: size_of::<EtdTexture>() as u32,
        kind: ETD_CHECKERBOARD,
        flags: 0,
        width: 0,
        height: 0,
        reserved: 0,
        color: [[0.0; 3], [1.0; 3]],
        to_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        texels: std::ptr::null(),
        bytes: 0,
    })
}

/// Adds a material and writes its id, counted from 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_material(
    builder: *mut EtdBuilder,
    material: *const EtdMaterial,
    id: *mut u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let (m, id) = (input(material)?, place(id)?);
        let model = model(&m, scene)?;
        let new = scene.materials.len();
        let name = format!("material {new}");
        scene.materials.push(Material { name, model });
        *id = new as u32;
        Ok(())
    })
}

/// Puts another material in the place of `id`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_material(
    builder: *mut EtdBuilder,
    id: u32,
    material: *const EtdMaterial,
) -> EtdStatus {
    edit(builder, |scene| {
        let model = model(&input(material)?, scene)?;
        let count = scene.materials.len();
        match scene.materials.get_mut(id as usize) {
            Some(place) => place.model = model,
            None => return Err(bad(format!("material {id}: there are {count}"))),
        }
        Ok(())
    })
}

/// Says what paths carry: `ETD_COLOR_AUTO` to `ETD_COLOR_SPECTRAL`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_color(builder: *mut EtdBuilder, color: u32) -> EtdStatus {
    edit(builder, |scene| {
        scene.carry = match color {
            ETD_COLOR_AUTO => Carry::AsNeeded,
            ETD_COLOR_RGB => Carry::Rgb,
            ETD_COLOR_SPECTRAL => Carry::Wavelengths,
            _ => return Err(bad("color: unknown")),
        };
        Ok(())
    })
}

/// Adds a texture and writes its id, counted from 0. Its texels are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_texture(
    builder: *mut EtdBuilder,
    texture: *const EtdTexture,
    id: *mut u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let (t, id) = (input(texture)?, place(id)?);
        let pattern = pattern(&t)?;
        if !finite(t.to_uv.as_flattened()) {
            return Err(bad("texture: to_uv must be finite"));
        }
        let new = scene.textures.len();
        scene.textures.push(Texture {
            name: format!("texture {new}"),
            pattern,
            to_uv: t.to_uv,
        });
        *id = new as u32;
        Ok(())
    })
}

fn pattern(t: &EtdTexture) -> Result<Pattern, Trouble> {
    let known = ETD_NEAREST | ETD_CLAMP | ETD_MIRRORED | ETD_ALPHA;
    let both = ETD_CLAMP | ETD_MIRRORED;
    if t.kind > ETD_SPECTRUM || t.flags & !known != 0 || t.flags & both == both || t.reserved != 0 {
        return Err(bad("texture: unknown kind or flags, or reserved isn't 0"));
    }
    if t.kind == ETD_CHECKERBOARD {
        shares("texture", &t.color)?;
        return Ok(Pattern::Checkerboard { colors: t.color });
    }
    if ![t.width, t.height]
        .iter()
        .all(|n| (1..=1 << 16).contains(n))
    {
        return Err(bad("texture: width and height must be 1 to 65536"));
    }
    let count = t.width as usize * t.height as usize;
    let size = match t.kind {
        ETD_FLOAT => 12,
        ETD_SPECTRUM => 8,
        _ => 4,
    };
    if count.checked_mul(size) != Some(t.bytes) {
        let reason = format!("texture: {} bytes, expected {count} times {size}", t.bytes);
        return Err(Trouble::new(ETD_E_SIZE, reason));
    }
    if t.kind == ETD_SPECTRUM {
        let rows = slice(t.texels.cast::<[f32; 2]>(), count)?;
        if t.height != 1 || t.flags != 0 || !is_spectrum(rows, 1.0) {
            return Err(bad(
                "texture: a spectrum has height 1, no flags, and rows by rising wavelength, values 0 to 1",
            ));
        }
        return Ok(Pattern::Spectrum(copied(rows)?));
    }
    let small = || slice(t.texels.cast::<[u8; 4]>(), count);
    let texels = match t.kind {
        ETD_SRGB8 => Texels::Srgb8(copied(small()?)?),
        ETD_LINEAR8 => Texels::Linear8(copied(small()?)?),
        _ => {
            let texels = slice(t.texels.cast::<Color>(), count)?;
            shares("texture", texels)?;
            Texels::Float(copied(texels)?)
        }
    };
    Ok(Pattern::Bitmap {
        image: Image {
            width: t.width,
            height: t.height,
            texels,
        },
        nearest: t.flags & ETD_NEAREST != 0,
        wrap: match t.flags & both {
            ETD_CLAMP => Wrap::Clamp,
            ETD_MIRRORED => Wrap::Mirror,
            _ => Wrap::Repeat,
        },
        alpha: t.flags & ETD_ALPHA != 0,
    })
}

fn shares(what: &str, colors: &[Color]) -> Result<(), Trouble> {
    if colors
        .as_flattened()
        .iter()
        .all(|x| (0.0..=1.0).contains(x))
    {
        Ok(())
    } else {
        Err(bad(format!("{what}: colours must be 0 to 1")))
    }
}

fn known_flags(kind: u32) -> u32 {
    let rough = ETD_BECKMANN | ETD_SEPARABLE | ETD_COMPENSATED;
    match kind {
        ETD_DIELECTRIC => ETD_SCHLICK,
        ETD_DISPERSIVE => ETD_SCHLICK | ETD_CAUCHY,
        ETD_PHONG => ETD_FRESNEL,
        ETD_ROUGH_CONDUCTOR => rough | ETD_CAVITIES,
        ETD_ROUGH_DIELECTRIC => rough,
        ETD_PLASTIC => ETD_NONLINEAR,
        ETD_ROUGH_PLASTIC => rough | ETD_CAVITIES | ETD_NONLINEAR,
        _ => 0,
    }
}

fn facets(m: &EtdMaterial) -> Facets {
    let has = |flag: u32| m.flags & flag != 0;
    Facets {
        alpha: [m.alpha; 2],
        distribution: if has(ETD_BECKMANN) {
            Distribution::Beckmann
        } else {
            Distribution::Ggx
        },
        masking: if has(ETD_CAVITIES) {
            Masking::Cavities
        } else if has(ETD_SEPARABLE) {
            Masking::Separable
        } else {
            Masking::Correlated
        },
        compensated: has(ETD_COMPENSATED),
    }
}

/// A blend's part, which must be there already.
fn part(id: u32, scene: &Described) -> Result<usize, Trouble> {
    match optional_id("material", id, scene.materials.len())? {
        Some(part) => Ok(part),
        None => Err(bad("material: a blend needs two parts")),
    }
}

fn dispersive(
    m: &EtdMaterial,
    reflectance: ColorSource,
    transmittance: ColorSource,
) -> Result<Model, Trouble> {
    let index = if m.flags & ETD_CAUCHY != 0 {
        Index::Cauchy(m.eta)
    } else {
        Index::Sellmeier { b: m.eta, c: m.k }
    };
    let coefficients = m.eta.iter().chain(&m.k).all(|x| (0.0..=1e6).contains(x));
    if !(coefficients && (0.01..=100.0).contains(&m.ior) && index.is_visible(m.ior)) {
        return Err(bad(
            "material: eta and k must be 0 to 1e6, and the index 0.1 to 100 from 380 to 780 nm",
        ));
    }
    Ok(Model::Dispersive {
        index,
        outside: m.ior,
        reflectance,
        transmittance,
        schlick: m.flags & ETD_SCHLICK != 0,
    })
}

fn model(m: &EtdMaterial, scene: &Described) -> Result<Model, Trouble> {
    let mut roles = [ColorSource::Constant([0.0; 3]); 4];
    for ((role, &color), &texture) in roles.iter_mut().zip(&m.color).zip(&m.texture) {
        *role = match optional_id("texture", texture, scene.textures.len())? {
            Some(texture) => ColorSource::Texture(texture),
            None => {
                shares("material", &[color])?;
                ColorSource::Constant(color)
            }
        };
    }
    let [a, b, c, d] = roles;
    if m.flags & !known_flags(m.kind) != 0 {
        return Err(bad("material: unknown flags"));
    }
    let scatters = match m.kind {
        ETD_DIFFUSE => 2,
        ETD_SHEET => 4,
        // Fresnel's shares add up to 1 whatever they scale.
        ETD_PHONG if m.flags & ETD_FRESNEL == 0 => 4,
        _ => 1,
    };
    // What textures add to it can't be told before they are looked up; the kernel is safe whatever it is.
    let sum = |channel: usize| -> f32 {
        let of = |role: &ColorSource| match role {
            ColorSource::Constant(color) => color[channel],
            ColorSource::Texture(_) => 0.0,
        };
        roles.iter().take(scatters).map(of).sum()
    };
    if (0..3).any(|channel| sum(channel) > 1.0 + 1e-5) {
        return Err(bad("material: scatters more light than it gets"));
    }
    let index = m.eta.iter().all(|x| *x > 0.0 && *x <= 1e6);
    let absorbs = m.k.iter().all(|x| (0.0..=1e6).contains(x));
    let refracts = (1e-3..=1e3).contains(&m.ior);
    let facets = facets(m);
    match m.kind {
        ETD_DIFFUSE => Ok(Model::Diffuse {
            reflectance: a,
            transmittance: b,
        }),
        ETD_MIRROR => Ok(Model::Mirror { reflectance: a }),
        ETD_CONDUCTOR | ETD_ROUGH_CONDUCTOR if !(index && absorbs) => {
            Err(bad("material: eta must be > 0, k >= 0"))
        }
        ETD_CONDUCTOR => Ok(Model::Conductor {
            spectra: None,
            eta: m.eta,
            k: m.k,
            reflectance: a,
        }),
        ETD_DISPERSIVE => dispersive(m, a, b),
        ETD_DIELECTRIC | ETD_ROUGH_DIELECTRIC | ETD_PLASTIC | ETD_ROUGH_PLASTIC | ETD_PHONG
            if !refracts =>
        {
            Err(bad("material: ior must be 0.001 to 1000"))
        }
        ETD_ROUGH_DIELECTRIC if (m.ior - 1.0).abs() < 0.01 => {
            Err(bad("material: a rough dielectric's ior must be 1 % from 1"))
        }
        ETD_ROUGH_CONDUCTOR | ETD_ROUGH_DIELECTRIC | ETD_ROUGH_PLASTIC
            if !(1e-4..=10.0).contains(&m.alpha) =>
        {
            Err(bad("material: alpha must be 0.0001 to 10"))
        }
        ETD_PHONG if !(0.0..=1e5).contains(&m.exponent) => {
            Err(bad("material: exponent must be 0 to 100000"))
        }
        ETD_DIELECTRIC => Ok(Model::Dielectric {
            ior: m.ior,
            reflectance: a,
            transmittance: b,
            schlick: m.flags == ETD_SCHLICK,
        }),
        ETD_BOUNDARY => Ok(Model::Null),
        ETD_SHEET => Ok(Model::Sheet {
            specular_reflectance: a,
            specular_transmittance: b,
            diffuse_reflectance: c,
            diffuse_transmittance: d,
        }),
        ETD_PHONG => Ok(Model::Phong {
            diffuse_reflectance: a,
            reflectance: b,
            transmittance: c,
            diffuse_transmittance: d,
            exponent: m.exponent,
            modified: true,
            ior: m.ior,
            fresnel: m.flags & ETD_FRESNEL != 0,
        }),
        ETD_ROUGH_CONDUCTOR => Ok(Model::RoughConductor {
            spectra: None,
            eta: m.eta,
            k: m.k,
            reflectance: a,
            facets,
        }),
        ETD_ROUGH_DIELECTRIC => Ok(Model::RoughDielectric {
            ior: m.ior,
            reflectance: a,
            transmittance: b,
            facets,
        }),
        ETD_PLASTIC | ETD_ROUGH_PLASTIC => Ok(Model::Plastic {
            ior: m.ior,
            diffuse_reflectance: a,
            reflectance: b,
            nonlinear: m.flags & ETD_NONLINEAR != 0,
            facets: (m.kind == ETD_ROUGH_PLASTIC).then_some(facets),
        }),
        ETD_BLEND => Ok(Model::Blend {
            parts: [part(m.parts[0], scene)?, part(m.parts[1], scene)?],
            weight: a,
        }),
        _ => Err(bad("material: unknown kind")),
    }
}
