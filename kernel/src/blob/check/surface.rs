//! Materials and textures.

use super::rules::{Checked, ensure, finite, optional, span, within, zeros};
use crate::blob::format::{Material, Texture, material, texture};
use crate::blob::rule::Rule;
use crate::blob::scene::Scene;

pub(super) fn material(scene: &Scene<'_>, m: &Material) -> Checked {
    ensure(m.kind <= material::SHEET, Rule::MaterialKind)?;
    let known = match m.kind {
        material::DIELECTRIC => material::SCHLICK,
        _ => 0,
    };
    ensure(m.flags & !known == 0, Rule::MaterialFlags)?;
    within(m.color.as_flattened(), 0.0, 1.0, Rule::MaterialColor)?;
    for &t in &m.texture {
        optional(t, scene.textures.len(), Rule::MaterialTexture)?;
    }
    within(&[m.ior], 1e-3, 1e3, Rule::MaterialIor)?;
    within(&m.eta, 0.0, 1e6, Rule::MaterialEta)?;
    within(&m.k, 0.0, 1e6, Rule::MaterialK)?;
    zeros(&[m.reserved], Rule::MaterialReserved)?;
    zeros(&m.reserved2, Rule::MaterialReserved)
}

pub(super) fn texture(scene: &Scene<'_>, t: &Texture, budget: &mut u64) -> Checked {
    ensure(cfg!(feature = "textures"), Rule::TextureLeftOut)?;
    let known = texture::NEAREST | texture::CLAMP | texture::MIRROR | texture::ALPHA;
    ensure(t.kind <= texture::FLOAT, Rule::TextureKind)?;
    ensure(t.flags & !known == 0, Rule::TextureFlags)?;
    finite(t.to_uv.as_flattened(), Rule::TextureToUv)?;
    within(t.color.as_flattened(), 0.0, 1.0, Rule::TextureColor)?;
    zeros(&[t.reserved], Rule::TextureReserved)?;
    zeros(&t.reserved2, Rule::TextureReserved)?;
    if t.kind == texture::CHECKERBOARD {
        return Ok(());
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
