//! Phong's lobes: k·c·max(0, ω_ideal·ω)ⁿ about the mirror direction and about the refracted one, beside diffuse reflection and
//! transmission (composite Phong; `transport.md` §8). c = (n+1)/2π makes Phong's density one of directions, (n+2)/2π is the
//! "modified" one (Lafortune & Willems 1994), whose albedo along the normal is k. With an index of 1 it is a thin sheet
//! with glossy parts.
//!
//! ω_ideal is that of the light's direction ω_i. About the mirror direction that is symmetric. The refracted lobe isn't, and
//! nothing is if the lobes have Fresnel's shares, which depend on ω_i: then it isn't reciprocal, only energy is conserved.
//! As n → ∞ the lobes become those of the smooth dielectric, (η_o/η_i)² included.

use super::{drawn, fresh, indices};
use crate::real::{PI, Real, Vec3, exp, expm1, log, log1p, safe_sqrt, square, tangents};
use crate::spectrum::Spectrum;
use crate::surface::{Diffuse, Local, Mode, Scatter, fresnel, reflect, same_side};
use crate::warp::polar;

/// Glossy lobes over a diffuse base.
#[derive(Clone, Copy, Debug)]
pub struct Phong<S> {
    /// The diffuse part, on both sides.
    pub diffuse: Diffuse<S>,
    /// k of the lobe about the mirror direction.
    pub reflectance: S,
    /// k of the lobe about the refracted direction.
    pub transmittance: S,
    /// n.
    pub exponent: Real,
    /// c.
    pub normalization: Real,
    /// Index inside (z < 0) over index outside.
    pub ior: Real,
    /// Whether k of the lobes is scaled by R(ω_i) and 1 − R(ω_i).
    pub fresnel: bool,
}

/// Probabilities of the lobes; the rest is diffuse.
struct Lobes {
    reflect: Real,
    refract: Real,
}

/// Where light from a direction is refracted to.
struct Refracted {
    direction: Vec3,
    /// dσ of refracted directions over dσ of the given ones: η²·cos over η′²·cos′.
    spread: Real,
}

impl<S: Spectrum> Phong<S> {
    /// Shares of reflection and refraction of light from `wi`.
    fn shares(&self, wi: Vec3) -> (Real, Real) {
        if !self.fresnel {
            return (1.0, 1.0);
        }
        let (here, there) = indices(self.ior, wi);
        let boundary = fresnel::dielectric(here, there, wi.z.abs().min(1.0));
        (boundary.reflected, boundary.transmitted)
    }

    /// Light from `w`, refracted; `None` if it is reflected totally.
    fn refracted(&self, w: Vec3) -> Option<Refracted> {
        let (here, there) = indices(self.ior, w);
        let cos_t = fresnel::dielectric(here, there, w.z.abs().min(1.0)).cos_t;
        let back = here / there;
        let direction = Vec3::new(-w.x * back, -w.y * back, -cos_t.copysign(w.z));
        (cos_t > 0.0).then(|| Refracted {
            direction,
            spread: square(back) * w.z.abs() / cos_t,
        })
    }

    fn lobes(&self, w: Vec3) -> Lobes {
        /// A direction that no light would leave by refraction may still lie in a lobe: no probability is 0 for Fresnel's sake.
        const LEAST: Real = 0.1;
        let (r, t) = self.shares(w);
        let (r, t) = (r + LEAST, t + LEAST);
        let r = r * self.reflectance.max_channel();
        let t = t * self.transmittance.max_channel();
        let d = self.diffuse.reflectance.max_channel() + self.diffuse.transmittance.max_channel();
        let sum = r + t + d;
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Lobes {
            reflect: r * scale,
            refract: t * scale,
        }
    }

    /// max(0, a·b)ⁿ of unit vectors by their distance, as 1 − a·b = |a − b|²/2: with n = 10⁵ a cosine's rounding is a lot.
    fn lobe(&self, a: Vec3, b: Vec3) -> Real {
        let difference = a - b;
        let s = 0.5 * difference.dot(difference);
        if s < 1.0 {
            exp(self.exponent * log1p(-s))
        } else {
            0.0
        }
    }

    /// Density of [`Self::draw`], a lobe of 1: (n+1)/2π.
    fn density(&self) -> Real {
        (self.exponent + 1.0) * (0.5 / PI)
    }

    /// A direction about `axis` with density ∝ cosⁿ.
    fn draw(&self, axis: Vec3, xi: [Real; 2]) -> Vec3 {
        // 1 − cos = 1 − u^(1/(n+1)).
        let s = -expm1(log(1.0 - xi[0]) / (self.exponent + 1.0));
        let s = s.clamp(0.0, 1.0);
        let r = safe_sqrt(s * (2.0 - s));
        let phi = 2.0 * PI * xi[1];
        let (x, y) = tangents(axis);
        let [a, b] = polar(r, phi);
        x * a + y * b + axis * (1.0 - s)
    }
}

impl<S: Spectrum> Local<S> for Phong<S> {
    #[inline(never)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        let (r, t) = self.shares(wi);
        let glossy = if same_side(wo, wi) {
            self.reflectance * (r * self.lobe(reflect(wi), wo))
        } else {
            let lobe = |it: Refracted| self.lobe(it.direction, wo);
            self.transmittance * (t * self.refracted(wi).map_or(0.0, lobe))
        };
        glossy * self.normalization + self.diffuse.eval(wo, wi)
    }

    #[inline(never)]
    fn pdf(&self, w: Vec3, wi: Vec3, mode: Mode) -> Real {
        let lobes = self.lobes(w);
        let glossy = if same_side(w, wi) {
            lobes.reflect * self.lobe(reflect(w), wi)
        } else if lobes.refract > 0.0 {
            // From the sensor a direction about wo is drawn, and refracted back to wi.
            let lobe = match mode {
                Mode::Importance => self.refracted(w).map(|it| self.lobe(it.direction, wi)),
                Mode::Radiance => self
                    .refracted(wi)
                    .map(|it| self.lobe(it.direction, w) * it.spread),
            };
            lobes.refract * lobe.unwrap_or(0.0)
        } else {
            0.0
        };
        let rest = (1.0 - lobes.reflect - lobes.refract).max(0.0);
        glossy * self.density() + rest * self.diffuse.pdf(w, wi, mode)
    }

    #[inline(never)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let lobes = self.lobes(w);
        let mut eta_scale = 1.0;
        let (wi, transmitted) = if lobe < lobes.reflect {
            (self.draw(reflect(w), xi), false)
        } else if lobe < lobes.reflect + lobes.refract {
            let wi = match mode {
                Mode::Importance => self.draw(self.refracted(w)?.direction, xi),
                Mode::Radiance => {
                    let about = self.draw(w, xi);
                    if !same_side(about, w) {
                        return None;
                    }
                    let it = self.refracted(about)?;
                    let (here, there) = indices(self.ior, w);
                    eta_scale = square(here / there);
                    it.direction
                }
            };
            (wi, true)
        } else {
            let low = lobes.reflect + lobes.refract;
            let rest = fresh(lobe, low, 1.0 - low);
            let s = self.diffuse.sample(w, mode, rest, xi)?;
            (s.wi, s.transmitted)
        };
        // A lobe's end on the wrong side of the surface.
        (same_side(w, wi) != transmitted)
            .then(|| drawn(self, w, wi, mode, eta_scale))
            .flatten()
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        !(self.reflectance.is_black() && self.transmittance.is_black())
            || Local::<S>::has_smooth(&self.diffuse)
    }
}
