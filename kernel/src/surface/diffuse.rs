//! Lambert's law, reflecting and transmitting: f = k_r/π on wo's side, k_t/π on the other.

use super::{Local, Mode, Scatter, same_side};
use crate::real::{INV_PI, Real, Vec3};
use crate::spectrum::Spectrum;
use crate::warp;

/// Diffuse reflection and transmission.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse<S> {
    /// k_r.
    pub reflectance: S,
    /// k_t.
    pub transmittance: S,
}

impl<S: Spectrum> Diffuse<S> {
    /// Probabilities of reflection and of transmission; both 0 if the surface is black.
    #[inline(always)]
    fn probabilities(&self) -> (Real, Real) {
        let (r, t) = (
            self.reflectance.max_channel(),
            self.transmittance.max_channel(),
        );
        // Most surfaces transmit nothing: no division for them.
        if t == 0.0 {
            return (if r > 0.0 { 1.0 } else { 0.0 }, 0.0);
        }
        let p = r / (r + t);
        (p, 1.0 - p)
    }
}

impl<S: Spectrum> Local<S> for Diffuse<S> {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        let k = if same_side(wo, wi) {
            self.reflectance
        } else {
            self.transmittance
        };
        k * INV_PI
    }

    #[inline(always)]
    fn pdf(&self, w: Vec3, wi: Vec3, _: Mode) -> Real {
        let (reflect, transmit) = self.probabilities();
        let p = if same_side(w, wi) { reflect } else { transmit };
        p * warp::cosine_hemisphere_pdf(wi.z.abs())
    }

    #[inline(always)]
    fn sample(&self, w: Vec3, _: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let (reflect, transmit) = self.probabilities();
        let transmitted = lobe >= reflect;
        let (k, p) = if transmitted {
            (self.transmittance, transmit)
        } else {
            (self.reflectance, reflect)
        };
        if p <= 0.0 {
            return None;
        }
        let up = warp::cosine_hemisphere(xi);
        let wi = if (w.z < 0.0) == transmitted {
            up
        } else {
            Vec3::new(up.x, up.y, -up.z)
        };
        // No `then`: the compiler would call its closure where many estimators have it, at 1 % of their time.
        if up.z > 0.0 {
            Some(Scatter {
                wi,
                // k/π·cos/(p·cos/π).
                weight: k * (1.0 / p),
                pdf: p * warp::cosine_hemisphere_pdf(up.z),
                pdf_reverse: p * warp::cosine_hemisphere_pdf(w.z.abs()),
                dirac: false,
                transmitted,
                eta_scale: 1.0,
                chances: S::WHITE,
            })
        } else {
            None
        }
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        self.reflectance.max_channel() + self.transmittance.max_channel() > 0.0
    }
}
