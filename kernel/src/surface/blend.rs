//! Blends: a mixture of two materials, chosen between by random numbers wherever a walk meets one.

use super::TextureView;
use crate::blob::format::{Material, material};
use crate::real::Real;

/// The part that a blend is at a vertex, chosen by random numbers from `draw`; any other material is itself.
///
/// A vertex of either walk chooses with the same probability, which therefore cancels in every ratio of densities: all
/// estimators stay exact, and each vertex has the code of one part.
#[inline(always)]
pub fn chosen<'a>(
    materials: &'a [Material],
    m: &'a Material,
    textures: TextureView<'_>,
    uv: [Real; 2],
    draw: impl FnMut() -> Real,
) -> &'a Material {
    if m.kind == material::BLEND {
        choose(materials, m, textures, uv, draw)
    } else {
        m
    }
}

/// As [`chosen`]; levels fall, which bounds the steps.
#[inline(never)]
fn choose<'a>(
    materials: &'a [Material],
    mut m: &'a Material,
    textures: TextureView<'_>,
    uv: [Real; 2],
    mut draw: impl FnMut() -> Real,
) -> &'a Material {
    for _ in 0..material::MAX_LEVEL {
        if m.kind != material::BLEND {
            break;
        }
        let second = draw() < textures.weight(m, uv);
        let [first, other] = m.link;
        match materials.get(if second { other } else { first } as usize) {
            Some(part) => m = part,
            None => break,
        }
    }
    m
}
