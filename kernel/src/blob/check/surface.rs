//! Materials and textures.

use super::rules::{Checked, ensure, finite, optional, span, within, zeros};
use crate::blob::format::{Material, Texture, material, needs, table, texture};
use crate::blob::rule::Rule;
use crate::blob::scene::Scene;
#[cfg(feature = "spectral")]
use crate::real::Real;
#[cfg(feature = "spectral")]
use crate::spectrum::{FIRST, LAST};
#[cfg(feature = "spectral")]
use crate::surface::outlined::dispersive::index;

/// Rows of a table of indices at most: materials may share one, and checking takes linear time.
const MOST_ROWS: u32 = 256;
/// Wavelengths at which an index is looked at.
#[cfg(feature = "spectral")]
const STEPS: u32 = 80;

pub(super) fn material(scene: &Scene<'_>, m: &Material) -> Checked {
    ensure(m.kind <= material::DISPERSIVE, Rule::MaterialKind)?;
    let disperses = m.kind == material::DISPERSIVE;
    ensure(
        cfg!(feature = "spectral") || !disperses,
        Rule::SpectraLeftOut,
    )?;
    let glossy = m.kind > material::SHEET && !disperses;
    ensure(cfg!(feature = "glossy") || !glossy, Rule::MaterialLeftOut)?;
    ensure(m.flags & !known_flags(m.kind) == 0, Rule::MaterialFlags)?;
    within(m.color.as_flattened(), 0.0, 1.0, Rule::MaterialColor)?;
    for &t in &m.texture {
        optional(t, scene.textures.len(), Rule::MaterialTexture)?;
    }
    within(&[m.ior], 1e-3, 1e3, Rule::MaterialIor)?;
    within(&m.eta, 0.0, 1e6, Rule::MaterialEta)?;
    within(&m.k, 0.0, 1e6, Rule::MaterialK)?;
    zeros(&[m.reserved], Rule::MaterialReserved)?;
    gloss(scene, m)?;
    // The instance of the estimators that runs is the one that `needs` asks for.
    let told = scene.has(match m.kind {
        material::DISPERSIVE => needs::DISPERSION | needs::SPECTRAL,
        _ => needs::GLOSSY,
    });
    ensure(m.kind <= material::SHEET || told, Rule::MaterialNeeds)
}

fn known_flags(kind: u32) -> u32 {
    use material::{
        BECKMANN, CAVITIES, COMPENSATED, FORMULA, FRESNEL, NONLINEAR, SCHLICK, SEPARABLE,
    };
    match kind {
        material::DIELECTRIC => SCHLICK,
        material::DISPERSIVE => SCHLICK | FORMULA,
        material::PHONG => FRESNEL,
        material::ROUGH_CONDUCTOR => BECKMANN | SEPARABLE | CAVITIES | COMPENSATED,
        material::ROUGH_DIELECTRIC => BECKMANN | SEPARABLE | COMPENSATED,
        material::PLASTIC => NONLINEAR,
        material::ROUGH_PLASTIC => BECKMANN | SEPARABLE | CAVITIES | NONLINEAR,
        _ => 0,
    }
}

/// What glossy materials and blends alone have; zero where a kind has no use for it.
fn gloss(scene: &Scene<'_>, m: &Material) -> Checked {
    let [u, v] = m.gloss;
    match m.kind {
        material::PHONG => {
            within(&[u], 0.0, 1e5, Rule::MaterialExponent)?;
            // A margin for the rounding of whoever wrote it.
            let most = (u + 2.0) * (1.000_001 * 0.5 * core::f32::consts::FRAC_1_PI);
            within(&[v], f32::MIN_POSITIVE, most, Rule::MaterialNormalization)?;
        }
        material::ROUGH_CONDUCTOR | material::ROUGH_DIELECTRIC | material::ROUGH_PLASTIC => {
            within(&m.gloss, 1e-4, 10.0, Rule::MaterialRoughness)?;
        }
        _ => zeros(&m.gloss.map(f32::to_bits), Rule::MaterialReserved)?,
    }
    if m.kind == material::ROUGH_DIELECTRIC {
        ensure((m.ior - 1.0).abs() >= 0.0099, Rule::MaterialRoughIor)?;
    }
    if m.kind == material::PLASTIC || m.kind == material::ROUGH_PLASTIC {
        within(&[m.internal], 0.0, 0.9999, Rule::MaterialInternal)?;
    } else {
        zeros(&[m.internal.to_bits()], Rule::MaterialReserved)?;
    }
    if m.kind != material::BLEND {
        zeros(&[m.level], Rule::MaterialReserved)?;
        return match m.kind {
            material::DISPERSIVE => dispersion(scene, m),
            _ => curves(scene, m),
        };
    }
    ensure(
        (1..=material::MAX_LEVEL).contains(&m.level),
        Rule::MaterialLevel,
    )?;
    for part in m.link {
        let part = scene.materials.get(part as usize);
        // Levels fall towards the parts: no blend is within itself.
        let part = part.ok_or(Rule::MaterialPart)?;
        ensure(part.level < m.level, Rule::MaterialLevel)?;
    }
    Ok(())
}

/// The index is that of something at every visible wavelength.
fn dispersion(scene: &Scene<'_>, m: &Material) -> Checked {
    match m.flags & material::FORMULA {
        material::CAUCHY | material::SELLMEIER => {
            zeros(&m.link, Rule::MaterialReserved)?;
        }
        material::TABLE => {
            let [first, rows] = m.link;
            ensure(rows <= MOST_ROWS, Rule::MaterialDispersion)?;
            spectrum(scene, first, rows, 1e3, Rule::MaterialDispersion)?;
        }
        _ => return Err(Rule::MaterialFlags),
    }
    #[cfg(feature = "spectral")]
    for step in 0..=STEPS {
        let nm = FIRST + (LAST - FIRST) * (step as Real / STEPS as Real);
        let n = index(m, scene.texels, nm);
        ensure((0.1..=100.0).contains(&n), Rule::MaterialDispersion)?;
    }
    Ok(())
}

/// Rows of (nm, value) by rising wavelength, values in [0, `most`].
pub(super) fn spectrum(scene: &Scene<'_>, first: u32, rows: u32, most: f32, rule: Rule) -> Checked {
    span(scene.texels, first, 2 * u64::from(rows), rule)?;
    let rows = table(scene.texels, first, rows);
    ensure(!rows.is_empty(), rule)?;
    let mut before = 0.0;
    for &[nm, value] in rows {
        let nm = f32::from_bits(nm);
        ensure(nm > before && nm <= 1e6, rule)?;
        within(&[f32::from_bits(value)], 0.0, most, rule)?;
        before = nm;
    }
    Ok(())
}

/// A curve is four words, any of which are good.
fn curves(scene: &Scene<'_>, m: &Material) -> Checked {
    let compensated = m.flags & material::COMPENSATED != 0;
    let count = match m.kind {
        material::ROUGH_PLASTIC => 1,
        material::ROUGH_CONDUCTOR if compensated => 1,
        material::ROUGH_DIELECTRIC if compensated => 2,
        _ => 0,
    };
    for (i, &first) in m.link.iter().enumerate() {
        if i < count {
            let words = (material::CURVE / 4) as u64;
            span(scene.texels, first, words, Rule::MaterialCurve)?;
        } else {
            zeros(&[first], Rule::MaterialReserved)?;
        }
    }
    Ok(())
}

pub(super) fn texture(scene: &Scene<'_>, t: &Texture, budget: &mut u64) -> Checked {
    ensure(cfg!(feature = "textures"), Rule::TextureLeftOut)?;
    let known = texture::NEAREST | texture::CLAMP | texture::MIRROR | texture::ALPHA;
    ensure(t.kind <= texture::SPECTRUM, Rule::TextureKind)?;
    ensure(t.flags & !known == 0, Rule::TextureFlags)?;
    finite(t.to_uv.as_flattened(), Rule::TextureToUv)?;
    within(t.color.as_flattened(), 0.0, 1.0, Rule::TextureColor)?;
    zeros(&[t.reserved], Rule::TextureReserved)?;
    zeros(&t.reserved2, Rule::TextureReserved)?;
    if t.kind == texture::CHECKERBOARD {
        return Ok(());
    }
    if t.kind == texture::SPECTRUM {
        ensure(cfg!(feature = "spectral"), Rule::SpectraLeftOut)?;
        let words = 2 * u64::from(t.width);
        *budget = budget.checked_sub(words).ok_or(Rule::TextureBudget)?;
        return spectrum(scene, t.texels, t.width, 1.0, Rule::TextureRows);
    }
    let count = size(t.width, t.height).ok_or(Rule::TextureSize)?;
    let float = t.kind == texture::FLOAT;
    let words = if float { 3 * count } else { count };
    let texels = span(scene.texels, t.texels, words, Rule::TextureTexels)?;
    *budget = budget.checked_sub(words).ok_or(Rule::TextureBudget)?;
    let unit = |w: &u32| (0.0..=1.0).contains(&f32::from_bits(*w));
    ensure(!float || texels.iter().all(unit), Rule::TextureFloat)
}

/// Texels of an image of acceptable size: at most 2³⁴.
pub(super) fn size(width: u32, height: u32) -> Option<u64> {
    let fits = (1..=1 << 16).contains(&width) && (1..=1 << 18).contains(&height);
    fits.then(|| u64::from(width) * u64::from(height))
}
