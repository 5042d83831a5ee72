//! The thin sheet M^s: film, colour filter, cloth, lampshade. A coloured mirror-like part, a coloured straight
//! transmission, and diffuse reflection and transmission; η is the same on both sides.

use super::{Diffuse, Local, Mode, Scatter, reflect};
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;

/// A sheet; per channel the four parts add up to at most 1.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<S> {
    /// Mirror reflection.
    pub specular_reflectance: S,
    /// Straight transmission.
    pub specular_transmittance: S,
    /// Diffuse reflection and transmission.
    pub diffuse: Diffuse<S>,
}

impl<S: Spectrum> Sheet<S> {
    /// Probabilities of mirror reflection and straight transmission; the rest is diffuse.
    #[inline(always)]
    fn probabilities(&self) -> (Real, Real) {
        let r = self.specular_reflectance.max_channel();
        let t = self.specular_transmittance.max_channel();
        let d = self.diffuse.reflectance.max_channel() + self.diffuse.transmittance.max_channel();
        let sum = r + t + d;
        if sum > 0.0 {
            (r / sum, t / sum)
        } else {
            (0.0, 0.0)
        }
    }
}

impl<S: Spectrum> Local<S> for Sheet<S> {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        self.diffuse.eval(wo, wi)
    }

    #[inline(always)]
    fn pdf(&self, w: Vec3, wi: Vec3, mode: Mode) -> Real {
        let (r, t) = self.probabilities();
        (1.0 - r - t) * self.diffuse.pdf(w, wi, mode)
    }

    #[inline(always)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let (r, t) = self.probabilities();
        if lobe < r {
            return Some(Scatter::dirac(
                reflect(w),
                self.specular_reflectance * (1.0 / r),
                r,
            ));
        }
        if lobe < r + t {
            let straight = Scatter::dirac(-w, self.specular_transmittance * (1.0 / t), t);
            return Some(Scatter {
                transmitted: true,
                ..straight
            });
        }
        let p = 1.0 - r - t;
        if p <= 0.0 {
            return None;
        }
        // What is left of ξ is a fresh number.
        let rest = ((lobe - r - t) / p).min(crate::real::ONE_MINUS);
        let s = self.diffuse.sample(w, mode, rest, xi)?;
        Some(Scatter {
            weight: s.weight * (1.0 / p),
            pdf: s.pdf * p,
            pdf_reverse: s.pdf_reverse * p,
            ..s
        })
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, _: Mode, index: u32) -> Option<Scatter<S>> {
        match index {
            0 => Some(Scatter::dirac(reflect(w), self.specular_reflectance, 1.0)),
            1 => Some(Scatter {
                transmitted: true,
                ..Scatter::dirac(-w, self.specular_transmittance, 1.0)
            }),
            _ => None,
        }
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        self.diffuse.has_smooth()
    }
}
