//! Local models whose functions are long: Phong's, those of microfacets, and glass that disperses. They are together behind one door
//! and called, where those of the other models are inlined into every walk.

#[cfg(feature = "spectral")]
pub(crate) mod dispersive;
mod phong;
mod plastic;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;

#[cfg(feature = "spectral")]
pub use dispersive::Dispersive;
pub use phong::Phong;
pub use plastic::Plastic;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;

use super::curve::Curve;
use super::microfacet::Microfacets;
use super::{Diffuse, Local, Mode, Scatter, TextureView, color, same_side, textured};
use crate::blob::format::{Material, material};
use crate::real::{ONE_MINUS, Real, Vec3};
use crate::spectrum::Spectrum;

/// Any of them, its colours looked up.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // each variant is documented at its model
pub enum Outlined<S> {
    Phong(Phong<S>),
    RoughConductor(RoughConductor<S>),
    RoughDielectric(RoughDielectric<S>),
    Plastic(Plastic<S>),
    RoughPlastic(RoughPlastic<S>),
    #[cfg(feature = "spectral")]
    Dispersive(Dispersive<S>),
}

/// Calls the model's own function.
macro_rules! each {
    ($outlined:expr, $model:ident => $call:expr) => {
        match $outlined {
            Outlined::Phong($model) => $call,
            Outlined::RoughConductor($model) => $call,
            Outlined::RoughDielectric($model) => $call,
            Outlined::Plastic($model) => $call,
            Outlined::RoughPlastic($model) => $call,
            #[cfg(feature = "spectral")]
            Outlined::Dispersive($model) => $call,
        }
    };
}

impl<S: Spectrum> Outlined<S> {
    /// The model of a blob's material at (u, v); its kind is one of those above [`material::SHEET`]. A blend is one of its parts by now
    /// ([`super::chosen`]).
    #[inline(never)]
    #[cfg_attr(not(feature = "spectral"), allow(unused_variables))]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    pub fn resolve(
        m: &Material,
        textures: TextureView<'_>,
        waves: &S::Waves,
        lead: usize,
        uv: [Real; 2],
    ) -> Self {
        let color = |role: usize| color(m, role, textures, waves, uv);
        let ior = m.ior as Real;
        let [first, second] = m.link;
        let compensated = m.flags & material::COMPENSATED != 0;
        let loss = |first: u32| match compensated {
            true => Curve::read(textures.texels, first),
            false => Curve::ZERO,
        };
        match m.kind {
            material::ROUGH_CONDUCTOR => Self::RoughConductor(RoughConductor {
                facets: Microfacets::of(m),
                eta: textured(m.eta, m.texture[2], textures, waves, uv),
                k: textured(m.k, m.texture[3], textures, waves, uv),
                reflectance: color(0),
                mean: color(1),
                loss: loss(first),
            }),
            material::ROUGH_DIELECTRIC => Self::RoughDielectric(RoughDielectric {
                facets: Microfacets::of(m),
                ior,
                reflectance: color(0),
                transmittance: color(1),
                loss: [loss(first), loss(second)],
            }),
            material::PLASTIC => Self::Plastic(Plastic {
                base: plastic::base(m, color(0)),
                reflectance: color(1),
                ior,
            }),
            material::ROUGH_PLASTIC => Self::RoughPlastic(RoughPlastic {
                facets: Microfacets::of(m),
                base: plastic::base(m, color(0)),
                reflectance: color(1),
                ior,
                entering: Curve::read(textures.texels, first),
            }),
            #[cfg(feature = "spectral")]
            material::DISPERSIVE => {
                let colors = [color(0), color(1)];
                Self::Dispersive(Dispersive::new(m, textures, waves, lead, colors))
            }
            _ => Self::Phong(Phong {
                diffuse: Diffuse {
                    reflectance: color(0),
                    transmittance: color(3),
                },
                reflectance: color(1),
                transmittance: color(2),
                exponent: m.gloss[0] as Real,
                normalization: m.gloss[1] as Real,
                ior,
                fresnel: m.flags & material::FRESNEL != 0,
            }),
        }
    }
}

impl<S: Spectrum> Local<S> for Outlined<S> {
    #[inline(never)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        each!(self, m => m.eval(wo, wi))
    }

    #[inline(never)]
    fn pdf(&self, w: Vec3, wi: Vec3, mode: Mode) -> Real {
        each!(self, m => Local::<S>::pdf(m, w, wi, mode))
    }

    #[inline(never)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        each!(self, m => m.sample(w, mode, lobe, xi))
    }

    #[inline(never)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        each!(self, m => m.dirac_lobe(w, mode, index))
    }

    #[inline(never)]
    fn has_smooth(&self) -> bool {
        each!(self, m => Local::<S>::has_smooth(m))
    }
}

/// A draw of `wi` by a model whose `eval` and `pdf` say everything about it.
#[inline(always)]
pub(super) fn drawn<S: Spectrum>(
    model: &impl Local<S>,
    w: Vec3,
    wi: Vec3,
    mode: Mode,
    eta_scale: Real,
) -> Option<Scatter<S>> {
    let pdf = model.pdf(w, wi, mode);
    let f = match mode {
        Mode::Radiance => model.eval(w, wi),
        Mode::Importance => model.eval(wi, w),
    };
    let weight = f * (wi.z.abs() / pdf);
    (pdf > 0.0 && weight.max_channel().is_finite()).then(|| Scatter {
        wi,
        weight,
        pdf,
        pdf_reverse: model.pdf(wi, w, mode.reversed()),
        dirac: false,
        transmitted: !same_side(w, wi),
        eta_scale,
        chances: S::WHITE,
    })
}

/// The indices on the side of `w` and on the other, of a boundary with `ior` inside over outside.
#[inline(always)]
fn indices(ior: Real, w: Vec3) -> (Real, Real) {
    if w.z < 0.0 { (ior, 1.0) } else { (1.0, ior) }
}

/// What is left of ξ ∈ [low, low + p) is a fresh number.
#[inline(always)]
pub(super) fn fresh(xi: Real, low: Real, p: Real) -> Real {
    ((xi - low) / p).clamp(0.0, ONE_MINUS)
}

/// The same direction, or its mirror image, on the side of the normal.
#[inline(always)]
pub(super) fn upper(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, w.z.abs())
}

/// A direction of the upper side on the side of `w`.
#[inline(always)]
pub(super) fn on_side_of(w: Vec3, wi: Vec3) -> Vec3 {
    if w.z < 0.0 {
        Vec3::new(wi.x, wi.y, -wi.z)
    } else {
        wi
    }
}
