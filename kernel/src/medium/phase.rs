//! Stub until the real one lands.
use crate::blob::format::Medium;
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;

/// A direction drawn in a volume.
#[derive(Clone, Copy, Debug)]
pub struct Turn<S> {
    /// The direction.
    pub direction: Vec3,
    /// σ_s·p/pdf.
    pub weight: S,
    /// Its density.
    pub pdf: Real,
    /// Whether it is a Dirac's.
    pub dirac: bool,
}

/// A phase function and σ_s.
#[derive(Clone, Copy, Debug)]
pub struct Phase<'a, S> {
    medium: &'a Medium,
    scattering: S,
}

impl<'a, S: Spectrum> Phase<'a, S> {
    /// Of `medium`.
    pub fn new(medium: &'a Medium, scattering: S) -> Self {
        Self { medium, scattering }
    }
    /// σ_s·p.
    pub fn eval(&self, w: Vec3, wi: Vec3) -> S {
        self.scattering * self.pdf(w, wi)
    }
    /// p.
    pub fn pdf(&self, _: Vec3, _: Vec3) -> Real {
        let _ = self.medium;
        0.25 * crate::real::INV_PI
    }
    /// Draws.
    pub fn sample(&self, _: Vec3, _: Real, xi: [Real; 2]) -> Option<Turn<S>> {
        Some(Turn {
            direction: crate::warp::sphere(xi),
            weight: self.scattering,
            pdf: 0.25 * crate::real::INV_PI,
            dirac: false,
        })
    }
    /// Smooth?
    pub fn has_smooth(&self) -> bool {
        true
    }
}
