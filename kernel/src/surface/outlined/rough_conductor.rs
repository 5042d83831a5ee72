//! The rough conductor: microfacets that are smooth conductors, f = F·D·G₂/(4|cos θ_o||cos θ_i|) (Torrance & Sparrow 1967,
//! Cook & Torrance 1982). Reciprocal.
//!
//! Light that would hit a second facet is lost. Of a white conductor (F = 1, GGX, correlated masking) single scattering leaves, at
//! cos θ = 1 and 0.3: 0.988 and 0.936 for α = 0.1, 0.69 and 0.75 for 0.5, 0.31 and 0.56 for 1 (`tests/truth/bsdf/loss.rs`).
//! A compensated conductor gives it back by a second lobe that has the shape of what is lost, ℓ_o·ℓ_i/(π·mean ℓ), and a colour of
//! at least two reflections, F̄²Ē/(1 − F̄(1 − Ē)) (Kulla & Conty 2017; the square is Hill's, 2018).

use super::{drawn, on_side_of, upper};
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;
use crate::surface::curve::Curve;
use crate::surface::microfacet::Microfacets;
use crate::surface::{Local, Mode, Scatter, fresnel, same_side};
use crate::warp;

/// A metal that isn't polished.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<S> {
    /// Its facets.
    pub facets: Microfacets,
    /// η, relative to outside; 0 reflects everything.
    pub eta: S,
    /// k.
    pub k: S,
    /// Scale.
    pub reflectance: S,
    /// F̄, the mean of Fresnel's reflectance over the hemisphere, if it is compensated.
    pub mean: S,
    /// ℓ, what single scattering loses if F = 1; 0 if it isn't compensated.
    pub loss: Curve,
}

impl<S: Spectrum> RoughConductor<S> {
    /// The second lobe's f.
    fn multiple(&self, cos_o: Real, cos_i: Real) -> S {
        let mean = self.loss.mean();
        let shape = self.loss.at(cos_o) * self.loss.share(cos_i, mean);
        let colour = |f: Real, scale: Real| {
            let f = f * scale;
            let rest = 1.0 - f * mean;
            if rest > 0.0 {
                f * f * (1.0 - mean) / rest
            } else {
                1.0
            }
        };
        self.mean.zip(self.reflectance, colour) * shape
    }
}

impl<S: Spectrum> Local<S> for RoughConductor<S> {
    #[inline(never)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        if !same_side(wo, wi) {
            return S::BLACK;
        }
        let (wo, wi) = (upper(wo), upper(wi));
        let Some((f, cos)) = self.facets.reflection(wo, wi) else {
            return S::BLACK;
        };
        let r = self
            .eta
            .zip(self.k, |eta, k| fresnel::conductor(eta, k, cos));
        let single = self.reflectance * r * f;
        if self.loss == Curve::ZERO {
            return single;
        }
        single + self.multiple(wo.z, wi.z)
    }

    #[inline(never)]
    fn pdf(&self, w: Vec3, wi: Vec3, _: Mode) -> Real {
        if !same_side(w, wi) {
            return 0.0;
        }
        let (w, wi) = (upper(w), upper(wi));
        let second = self.loss.at(w.z);
        (1.0 - second) * self.facets.reflection_pdf(w, wi)
            + second * warp::cosine_hemisphere_pdf(wi.z)
    }

    #[inline(never)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let side = upper(w);
        let second = self.loss.at(side.z);
        let wi = if lobe < second {
            warp::cosine_hemisphere(xi)
        } else {
            self.facets.sample_reflection(side, xi)?
        };
        drawn(self, w, on_side_of(w, wi), mode, 1.0)
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        !self.reflectance.is_black()
    }
}
