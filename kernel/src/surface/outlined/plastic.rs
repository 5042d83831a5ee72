//! Plastic, varnish: a diffuse base under a smooth dielectric coat. Light enters by T = 1 − R, is scattered, and what the coat
//! reflects back inside (ρ_i of diffuse light) is scattered again:
//! f = k_d·T_o·T_i/(π·η²·(1 − k_d·ρ_i)) beside the coat's mirror reflection. With white the whole conserves energy and,
//! over the hemisphere, is Saunderson's (1942) R̄ + (1−R̄)(1−ρ_i)k_d/(1−k_d·ρ_i). Reciprocal.

use super::{drawn, on_side_of, upper};
use crate::blob::format::{Material, material};
use crate::real::{INV_PI, Real, Vec3, square};
use crate::spectrum::Spectrum;
use crate::surface::{Local, Mode, Scatter, fresnel, reflect, same_side};
use crate::warp;

/// A diffuse base under a smooth coat.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<S> {
    /// k_d/(η²(1 − k_d·ρ_i)).
    pub base: S,
    /// Scale of the coat's reflection.
    pub reflectance: S,
    /// Index of the coat over index outside.
    pub ior: Real,
}

/// k_d/(η²(1 − k_d·ρ_i)); unless the material is [`material::NONLINEAR`], ρ_i stands in the place of k_d·ρ_i.
#[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
pub(super) fn base<S: Spectrum>(m: &Material, color: S) -> S {
    let inside = m.internal as Real;
    let scale = 1.0 / square(m.ior as Real);
    let nonlinear = m.flags & material::NONLINEAR != 0;
    color.map(|k| scale * k / (1.0 - if nonlinear { k * inside } else { inside }))
}

impl<S: Spectrum> Plastic<S> {
    fn coat(&self, w: Vec3) -> fresnel::Dielectric {
        fresnel::dielectric(1.0, self.ior, w.z.abs().min(1.0))
    }

    /// The probability of the mirror reflection, and whether there is anything at all. It is the same on the way back.
    fn mirror(&self, coat: &fresnel::Dielectric) -> Option<Real> {
        let specular = self.reflectance.max_channel() * coat.reflected;
        let sum = specular + self.base.max_channel() * coat.transmitted;
        (sum > 0.0).then(|| specular / sum)
    }
}

impl<S: Spectrum> Local<S> for Plastic<S> {
    #[inline(never)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        if !same_side(wo, wi) {
            return S::BLACK;
        }
        self.base * (INV_PI * self.coat(wo).transmitted * self.coat(wi).transmitted)
    }

    #[inline(never)]
    fn pdf(&self, w: Vec3, wi: Vec3, _: Mode) -> Real {
        match self.mirror(&self.coat(w)) {
            Some(p) if same_side(w, wi) => (1.0 - p) * warp::cosine_hemisphere_pdf(wi.z.abs()),
            _ => 0.0,
        }
    }

    #[inline(never)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let coat = self.coat(upper(w));
        let p = self.mirror(&coat)?;
        if lobe < p {
            let weight = self.reflectance * (coat.reflected / p);
            return Some(Scatter::dirac(reflect(w), weight, p));
        }
        drawn(
            self,
            w,
            on_side_of(w, warp::cosine_hemisphere(xi)),
            mode,
            1.0,
        )
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, _: Mode, index: u32) -> Option<Scatter<S>> {
        let weight = self.reflectance * self.coat(upper(w)).reflected;
        (index == 0).then(|| Scatter::dirac(reflect(w), weight, 1.0))
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        !self.base.is_black()
    }
}
