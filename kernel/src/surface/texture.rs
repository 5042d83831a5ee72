//! Colours over (u, v).

#[cfg(feature = "textures")]
use super::bitmap::look;
use crate::blob::format::{NONE, Texture};
#[cfg(feature = "spectral")]
use crate::blob::format::{table, texture};
use crate::real::Real;
use crate::spectrum::Spectrum;

/// The textures of a scene and their texels.
#[derive(Clone, Copy, Debug)]
pub struct TextureView<'a> {
    /// Records.
    pub textures: &'a [Texture],
    /// Words.
    pub texels: &'a [u32],
}

impl TextureView<'_> {
    /// The colour of texture `id` at (u, v); white if there is none.
    #[inline(always)]
    pub fn color<S: Spectrum>(&self, id: u32, uv: [Real; 2], waves: &S::Waves) -> S {
        if id == NONE {
            return S::WHITE;
        }
        match self.textures.get(id as usize) {
            #[cfg(feature = "spectral")]
            Some(t) if t.kind == texture::SPECTRUM => {
                let tabulated = S::tabulated(table(self.texels, t.texels, t.width), waves);
                let [color, _] = t.color;
                tabulated.unwrap_or(S::lift(color, waves))
            }
            Some(t) => S::lift(look(self.texels, t, uv), waves),
            None => S::WHITE,
        }
    }

    /// The first channel of texture `id`, as an opacity.
    #[inline(always)]
    pub fn opacity(&self, id: u32, uv: [Real; 2]) -> Real {
        self.textures
            .get(id as usize)
            .map_or(1.0, |t| Real::from(look(self.texels, t, uv)[0]))
    }

    /// The probability of a blend's second part at (u, v).
    #[cfg(feature = "glossy")]
    pub fn weight(&self, m: &crate::blob::format::Material, uv: [Real; 2]) -> Real {
        let [[constant, ..], ..] = m.color;
        let [id, ..] = m.texture;
        if id == NONE {
            return Real::from(constant);
        }
        Real::from(constant) * self.opacity(id, uv)
    }
}

/// Without the feature no blob that opens has a texture.
#[cfg(not(feature = "textures"))]
fn look(_: &[u32], _: &Texture, _: [Real; 2]) -> [f32; 3] {
    [1.0; 3]
}
