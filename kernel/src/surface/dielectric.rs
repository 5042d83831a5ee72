//! The smooth dielectric boundary: f = [R·δ_R + (1−R)(η_o/η_i)²·δ_T]/|ω′·n|.
//!
//! η_o is the index on the side of wo, where light leaves. A walk from the sensor has w = wo and
//! gathers (η_o/η_i)²; one from the light has w = wi, and the adjoint has no such factor (Veach 1997, §5.2).

use super::{Local, Mode, Scatter, fresnel, reflect};
use crate::real::{Real, Vec3, square};
use crate::spectrum::Spectrum;

/// Glass, water, diamond.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<S> {
    /// Index inside over index outside; inside is z < 0.
    pub ior: Real,
    /// Schlick's approximation instead of Fresnel's equations.
    pub schlick: bool,
    /// Scale of reflection.
    pub reflectance: S,
    /// Scale of transmission.
    pub transmittance: S,
}

impl<S: Spectrum> Dielectric<S> {
    /// The indices on the side of `w` and on the other one, and what Fresnel says.
    #[inline(always)]
    pub(in crate::surface) fn boundary(&self, w: Vec3) -> (Real, Real, fresnel::Dielectric) {
        let (here, there) = if w.z > 0.0 {
            (1.0, self.ior)
        } else {
            (self.ior, 1.0)
        };
        let cos = w.z.abs();
        let boundary = if self.schlick {
            fresnel::schlick(here, there, cos)
        } else {
            fresnel::dielectric(here, there, cos)
        };
        (here, there, boundary)
    }

    /// Refraction.
    #[inline(always)]
    fn refraction(&self, w: Vec3, mode: Mode) -> Scatter<S> {
        let (here, there, boundary) = self.boundary(w);
        let back = here / there;
        let wi = Vec3::new(-w.x * back, -w.y * back, -boundary.cos_t.copysign(w.z));
        let eta_scale = match mode {
            Mode::Radiance => square(back),
            Mode::Importance => 1.0,
        };
        Scatter {
            transmitted: true,
            eta_scale,
            ..Scatter::dirac(wi, self.transmittance * eta_scale, boundary.transmitted)
        }
    }
}

impl<S: Spectrum> Local<S> for Dielectric<S> {
    #[inline(always)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, _: [Real; 2]) -> Option<Scatter<S>> {
        let (_, _, boundary) = self.boundary(w);
        // Lobes by Fresnel's shares: the same from either side, so the way back has the same probability.
        if lobe < boundary.reflected {
            let p = boundary.reflected;
            return (p > 0.0).then(|| Scatter::dirac(reflect(w), self.reflectance, p));
        }
        (boundary.transmitted > 0.0).then(|| self.refraction(w, mode))
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        let (_, _, boundary) = self.boundary(w);
        match index {
            0 => {
                let p = boundary.reflected;
                Some(Scatter::dirac(reflect(w), self.reflectance, p).alone())
            }
            1 => Some(self.refraction(w, mode).alone()),
            _ => None,
        }
    }
}
