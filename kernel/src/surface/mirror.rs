//! The perfect mirror: f = k_s·δ(ω_ideal − ω′)/|ω′·n|.

use super::{Local, Mode, Scatter, reflect};
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;

/// Mirror reflection on both sides.
#[derive(Clone, Copy, Debug)]
pub struct Mirror<S> {
    /// k_s.
    pub reflectance: S,
}

impl<S: Spectrum> Local<S> for Mirror<S> {
    #[inline(always)]
    fn sample(&self, w: Vec3, _: Mode, _: Real, _: [Real; 2]) -> Option<Scatter<S>> {
        (!self.reflectance.is_black()).then(|| Scatter::dirac(reflect(w), self.reflectance, 1.0))
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        (index == 0).then(|| self.sample(w, mode, 0.0, [0.0; 2]))?
    }
}
