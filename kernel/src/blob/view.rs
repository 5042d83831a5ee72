//! A scene as one path sees it: at the path's wavelengths.

use super::Scene;
use super::format::{Emitter, Medium, table};
use crate::spectrum::Spectrum;

/// A scene, and what the channels of a path are. With [`crate::Rgb`] it is the scene alone.
#[derive(Debug)]
pub struct View<'s, 'a, S: Spectrum> {
    scene: &'s Scene<'a>,
    /// What the channels are.
    pub waves: S::Waves,
}

// Not derived: that would ask S::Waves' bounds of S.
impl<S: Spectrum> Clone for View<'_, '_, S> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Spectrum> Copy for View<'_, '_, S> {}

impl<'a, S: Spectrum> core::ops::Deref for View<'_, 'a, S> {
    type Target = Scene<'a>;
    #[inline(always)]
    fn deref(&self) -> &Scene<'a> {
        self.scene
    }
}

impl<'s, 'a, S: Spectrum> View<'s, 'a, S> {
    /// `scene`, seen at `waves`.
    #[inline(always)]
    pub fn new(scene: &'s Scene<'a>, waves: S::Waves) -> Self {
        Self { scene, waves }
    }

    /// What coefficients of reflection, absorption or scattering stand for.
    #[inline(always)]
    pub fn lift(&self, rgb: [f32; 3]) -> S {
        S::lift(rgb, &self.waves)
    }

    /// Radiance, intensity or irradiance of an emitter.
    #[inline(always)]
    pub fn emitted(&self, e: &Emitter) -> S {
        self.tabulated(e.spectrum)
            .unwrap_or_else(|| self.light(e.radiance))
    }

    /// σ_t of a homogeneous medium.
    #[inline(always)]
    pub fn sigma_t(&self, m: &Medium) -> S {
        self.tabulated(m.sigma_t_spectrum)
            .unwrap_or_else(|| self.lift(m.sigma_t))
    }

    /// σ_s/σ_t of a homogeneous medium.
    #[inline(always)]
    pub fn albedo(&self, m: &Medium) -> S {
        self.tabulated(m.albedo_spectrum)
            .unwrap_or_else(|| self.lift(m.albedo))
    }

    /// E of a homogeneous medium.
    #[inline(always)]
    pub fn emission(&self, m: &Medium) -> S {
        self.tabulated(m.emission_spectrum)
            .unwrap_or_else(|| self.light(m.emission))
    }

    /// The spectrum in these rows of texels; `None` where there are none, or channels are too broad for that.
    #[inline(always)]
    pub fn tabulated(&self, [first, rows]: [u32; 2]) -> Option<S> {
        if !cfg!(feature = "spectral") || rows == 0 {
            return None;
        }
        S::tabulated(table(self.texels(), first, rows), &self.waves)
    }

    /// What coefficients of light stand for.
    #[inline(always)]
    pub fn light(&self, rgb: [f32; 3]) -> S {
        S::light(rgb, &self.waves)
    }
}
