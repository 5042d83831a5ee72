//! Rough plastic: a diffuse base under a coat of microfacets. As [`super::Plastic`], with the microfacets' reflection
//! F·D·G₂/(4|cos θ_o||cos θ_i|) in place of the mirror's and T, what the coat lets in from a direction, a curve. Reciprocal.

use super::{drawn, on_side_of, upper};
use crate::real::{INV_PI, Real, Vec3};
use crate::spectrum::Spectrum;
use crate::surface::curve::Curve;
use crate::surface::microfacet::Microfacets;
use crate::surface::{Local, Mode, Scatter, fresnel, same_side};
use crate::warp;

/// A diffuse base under a rough coat.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlastic<S> {
    /// The coat's facets.
    pub facets: Microfacets,
    /// k_d/(η²(1 − k_d·ρ_i)).
    pub base: S,
    /// Scale of the coat's reflection.
    pub reflectance: S,
    /// Index of the coat over index outside.
    pub ior: Real,
    /// T.
    pub entering: Curve,
}

impl<S: Spectrum> RoughPlastic<S> {
    /// The probability of the coat's lobe. It is never 0 where the coat reflects, which a curve can't say.
    fn glossy(&self, w: Vec3) -> Real {
        const LEAST: Real = 0.02;
        let t = self.entering.at(w.z);
        let specular = self.reflectance.max_channel() * (1.0 - t).max(LEAST);
        let sum = specular + self.base.max_channel() * t;
        if sum > 0.0 { specular / sum } else { 0.0 }
    }
}

impl<S: Spectrum> Local<S> for RoughPlastic<S> {
    #[inline(never)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        if !same_side(wo, wi) {
            return S::BLACK;
        }
        let (wo, wi) = (upper(wo), upper(wi));
        let coat = self.facets.reflection(wo, wi).map_or(0.0, |(f, cos)| {
            f * fresnel::dielectric(1.0, self.ior, cos.min(1.0)).reflected
        });
        let through = INV_PI * self.entering.at(wo.z) * self.entering.at(wi.z);
        self.reflectance * coat + self.base * through
    }

    #[inline(never)]
    fn pdf(&self, w: Vec3, wi: Vec3, _: Mode) -> Real {
        if !same_side(w, wi) || !Local::<S>::has_smooth(self) {
            return 0.0;
        }
        let (w, wi) = (upper(w), upper(wi));
        let p = self.glossy(w);
        p * self.facets.reflection_pdf(w, wi) + (1.0 - p) * warp::cosine_hemisphere_pdf(wi.z)
    }

    #[inline(never)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let side = upper(w);
        let wi = if lobe < self.glossy(side) {
            self.facets.sample_reflection(side, xi)?
        } else {
            warp::cosine_hemisphere(xi)
        };
        drawn(self, w, on_side_of(w, wi), mode, 1.0)
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        !(self.base.is_black() && self.reflectance.is_black())
    }
}
