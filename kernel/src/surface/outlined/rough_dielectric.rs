//! The rough dielectric: microfacets that are smooth dielectric boundaries (Walter et al. 2007),
//!
//! reflection F·D·G₂/(4|cos θ_o||cos θ_i|), transmission (1−F)·D·G₁G₁·|ω_i·h||ω_o·h|η_o²/(|cos θ_o||cos θ_i|(η_i ω_i·h + η_o ω_o·h)²).
//!
//! Facets are drawn among those that the walk's direction sees, then reflect or refract by Fresnel's shares: as with the smooth
//! boundary, walks from the sensor gather (η_o/η_i)² and walks from the light don't. f/η_o² is symmetric.
//!
//! Light that would hit a second facet is lost, ℓ(cos θ) of what comes on either side. A compensated dielectric gives it
//! back on both sides by a lobe that forgets where light came from: f = η_o²·ℓ_i·ℓ_o/(π·Σ η²·mean ℓ), the sum over sides.
//! It is the one that conserves energy (to 1.5 %, the curves' precision; conductors to 1 %), is symmetric but for η_o² and has the shape of
//! Kulla & Conty 2017.

use super::{drawn, fresh, indices, on_side_of, upper};
use crate::real::{INV_PI, Real, Vec3, sqrt, square};
use crate::spectrum::Spectrum;
use crate::surface::curve::Curve;
use crate::surface::microfacet::Microfacets;
use crate::surface::{Local, Mode, Scatter, fresnel, same_side};
use crate::warp;

/// Ground glass.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<S> {
    /// Its facets; transmission is masked for each direction separately.
    pub facets: Microfacets,
    /// Index inside over index outside; inside is z < 0.
    pub ior: Real,
    /// Scale of reflection.
    pub reflectance: S,
    /// Scale of transmission.
    pub transmittance: S,
    /// ℓ of light from outside and from inside; 0 if it isn't compensated.
    pub loss: [Curve; 2],
}

/// Two directions on two sides and the facet that refracts one into the other.
struct Refraction {
    /// Cosines to the facet's normal, both positive.
    cos_w: Real,
    cos_x: Real,
    /// (η_w·cos_w − η_x·cos_x)².
    denominator: Real,
    normal: Vec3,
}

impl<S: Spectrum> RoughDielectric<S> {
    /// The facet between `w` and `x` on two sides; its normal is on the upper side of a frame where w is.
    fn refraction(&self, w: Vec3, x: Vec3) -> Option<Refraction> {
        let (here, there) = indices(self.ior, w);
        let (w, x) = (upper(w), Vec3::new(x.x, x.y, -x.z.abs()));
        let sum = w * here + x * there;
        let length = sqrt(sum.dot(sum));
        // Of the denser side's index the sum points away from that side.
        let h = sum * ((if there > here { -1.0 } else { 1.0 }) / length);
        let (cos_w, cos_x) = (w.dot(h), -x.dot(h));
        (h.z > 0.0 && cos_w > 0.0 && cos_x > 0.0).then(|| Refraction {
            cos_w,
            cos_x,
            denominator: square(here * cos_w - there * cos_x),
            normal: h,
        })
    }

    /// ℓ of the side of `w`.
    fn loss_of(&self, w: Vec3) -> Real {
        let [outside, inside] = &self.loss;
        (if w.z < 0.0 { inside } else { outside }).at(w.z.abs())
    }

    /// The second lobe's f, per η_o².
    fn multiple(&self, wo: Vec3, wi: Vec3) -> Real {
        let sum = self.randomised();
        if sum > 0.0 {
            self.loss_of(wi) * self.loss_of(wo) * INV_PI / sum
        } else {
            0.0
        }
    }

    /// Σ η²·mean ℓ over both sides.
    fn randomised(&self) -> Real {
        let [outside, inside] = &self.loss;
        outside.mean() + square(self.ior) * inside.mean()
    }

    /// The probability that the second lobe stays on the side of `w`.
    fn staying(&self, w: Vec3) -> Real {
        let [outside, _] = &self.loss;
        let out = outside.mean() / self.randomised();
        if w.z < 0.0 { 1.0 - out } else { out }
    }

    fn is_compensated(&self) -> bool {
        self.loss != [Curve::ZERO; 2]
    }
}

impl<S: Spectrum> Local<S> for RoughDielectric<S> {
    #[inline(never)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        let (here, there) = indices(self.ior, wo);
        let same = same_side(wo, wi);
        let color = if same {
            self.reflectance
        } else {
            self.transmittance
        };
        let (up_o, up_i) = (upper(wo), upper(wi));
        let mut f = if same {
            self.facets.reflection(up_o, up_i).map_or(0.0, |(f, cos)| {
                f * fresnel::dielectric(here, there, cos).reflected
            })
        } else {
            self.refraction(wo, wi).map_or(0.0, |r| {
                let share = fresnel::dielectric(here, there, r.cos_w).transmitted;
                let masked = self.facets.separable_over_cosines(up_o, up_i);
                let jacobian = r.cos_w * r.cos_x * square(here) / r.denominator;
                share * self.facets.density(r.normal) * masked * jacobian
            })
        };
        if self.is_compensated() {
            f += square(here) * self.multiple(wo, wi);
        }
        if f.is_finite() { color * f } else { S::BLACK }
    }

    #[inline(never)]
    fn pdf(&self, w: Vec3, wi: Vec3, _: Mode) -> Real {
        let (here, there) = indices(self.ior, w);
        let same = same_side(w, wi);
        let single = if same {
            let (w, wi) = (upper(w), upper(wi));
            self.facets.reflection(w, wi).map_or(0.0, |(_, cos)| {
                fresnel::dielectric(here, there, cos).reflected * self.facets.reflection_pdf(w, wi)
            })
        } else {
            self.refraction(w, wi).map_or(0.0, |r| {
                let share = fresnel::dielectric(here, there, r.cos_w).transmitted;
                let facet = self.facets.pdf(upper(w), r.normal);
                share * facet * square(there) * r.cos_x / r.denominator
            })
        };
        let pdf = if self.is_compensated() {
            let second = self.loss_of(w);
            let side = self.staying(w);
            let side = if same { side } else { 1.0 - side };
            (1.0 - second) * single + second * side * warp::cosine_hemisphere_pdf(wi.z.abs())
        } else {
            single
        };
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    #[inline(never)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let (here, there) = indices(self.ior, w);
        let side = upper(w);
        let second = if self.is_compensated() {
            self.loss_of(w)
        } else {
            0.0
        };
        let (wi, transmitted) = if lobe < second {
            let transmitted = fresh(lobe, 0.0, second) >= self.staying(w);
            (warp::cosine_hemisphere(xi), transmitted)
        } else {
            let lobe = fresh(lobe, second, 1.0 - second);
            let h = self.facets.sample(side, xi);
            let cos = side.dot(h);
            let boundary = fresnel::dielectric(here, there, cos);
            if lobe < boundary.reflected {
                (h * (2.0 * cos) - side, false)
            } else {
                let back = here / there;
                let down = h * (back * cos - boundary.cos_t) - side * back;
                (Vec3::new(down.x, down.y, -down.z), true)
            }
        };
        if wi.z <= 0.0 {
            return None;
        }
        let wi = wi * (1.0 / sqrt(wi.dot(wi)));
        let wi = on_side_of(if transmitted { -w } else { w }, wi);
        let eta_scale = match mode {
            Mode::Radiance if transmitted => square(here / there),
            _ => 1.0,
        };
        // In the tangent plane, which counts as front, the other side may be the same.
        (same_side(w, wi) != transmitted)
            .then(|| drawn(self, w, wi, mode, eta_scale))
            .flatten()
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        !(self.reflectance.is_black() && self.transmittance.is_black())
    }
}
