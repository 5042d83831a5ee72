//! The smooth conductor: a mirror whose reflectance is Fresnel's with a complex index η + ik.

use super::{Local, Mode, Scatter, fresnel, reflect};
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;

/// A metal.
#[derive(Clone, Copy, Debug)]
pub struct Conductor<S> {
    /// η, relative to outside.
    pub eta: S,
    /// k.
    pub k: S,
    /// Scale.
    pub reflectance: S,
}

impl<S: Spectrum> Local<S> for Conductor<S> {
    #[inline(always)]
    fn sample(&self, w: Vec3, _: Mode, _: Real, _: [Real; 2]) -> Option<Scatter<S>> {
        let cos = w.z.abs();
        let r = self
            .eta
            .zip(self.k, |eta, k| fresnel::conductor(eta, k, cos));
        Some(Scatter::dirac(reflect(w), self.reflectance * r, 1.0))
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        (index == 0).then(|| self.sample(w, mode, 0.0, [0.0; 2]))?
    }
}
