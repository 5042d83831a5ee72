//! A path vertex on a surface: how light scatters there, and where the walk goes next.
//!
//! f̂ carries the shading-normal correction, so that G can use geometric normals throughout:
//! f̂ = f·|ω_i·n_s|/|ω_i·n_g| with ω_i towards the light, whoever walks (Veach 1997, §5.3).

use super::weight::Terms;
use crate::blob::Scene;
use crate::random::{Purpose, Sampler};
use crate::real::{Frame, Real, Vec3};
use crate::shape::Point;
use crate::spectrum::Spectrum;
#[cfg(feature = "glossy")]
use crate::surface::chosen;
use crate::surface::{Local, Mode, Surface};

/// A vertex of a walk, with what the weights need of the walk so far.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<S> {
    /// Where.
    pub point: Point,
    /// Shading frame.
    pub frame: Frame,
    /// Local model.
    pub surface: Surface<S>,
    /// Towards the previous vertex of the walk, unit.
    pub previous: Vec3,
    /// What the walk carries here: f/p of everything before this vertex.
    pub throughput: S,
    /// What the weights need of the walk so far.
    pub terms: Terms,
}

/// Where a walk goes next.
#[derive(Clone, Copy, Debug)]
pub struct Step<S> {
    /// The direction, unit.
    pub direction: Vec3,
    /// f̂·|cos|/pdf.
    pub weight: S,
    /// Density of the direction per solid angle (probability of the lobe, if Dirac).
    pub pdf: Real,
    /// The same for the way back.
    pub pdf_reverse: Real,
    /// Whether a Dirac lobe was drawn.
    pub dirac: bool,
    /// The part of `weight` that is refraction's η².
    pub eta_scale: Real,
}

/// What a vertex says of a direction to which it is joined.
#[derive(Clone, Copy, Debug)]
pub struct Joint<S> {
    /// f̂·|cos| with geometric cosine.
    pub value: S,
    /// Density per solid angle of sampling the direction.
    pub pdf: Real,
    /// Density per solid angle of sampling the previous vertex, coming from that direction.
    pub pdf_reverse: Real,
}

impl<S: Spectrum> Vertex<S> {
    /// The vertex at `point`, reached from direction `previous`; its weight terms are zero. A blend is one of its parts from
    /// here on, by `sampler`'s choice.
    #[inline(always)]
    pub fn new(
        scene: &Scene<'_>,
        point: Point,
        previous: Vec3,
        throughput: S,
        sampler: &mut impl Sampler,
    ) -> Self {
        let front = previous.dot(point.shading) >= 0.0;
        let material = scene
            .shape(point.shape)
            .and_then(|shape| scene.material(if front { shape.front } else { shape.back }));
        #[cfg(feature = "glossy")]
        let material = material.map(|m| {
            let draw = || sampler.one(Purpose::Blend);
            chosen(scene.materials(), m, scene.texture_view(), point.uv, draw)
        });
        #[cfg(not(feature = "glossy"))]
        let _ = sampler;
        let surface = match material {
            Some(m) => Surface::resolve(m, scene.texture_view(), point.uv),
            None => Surface::BLACK,
        };
        Self {
            point,
            frame: Frame::around(point.shading),
            surface,
            previous,
            throughput,
            terms: Terms::default(),
        }
    }

    /// Draws where the walk goes; `None` if it ends here.
    #[inline(always)]
    pub fn scatter(&self, mode: Mode, sampler: &mut impl Sampler) -> Option<Step<S>> {
        let w = self.frame.local(self.previous);
        let lobe = sampler.one(Purpose::Lobe);
        let s = self
            .surface
            .sample(w, mode, lobe, sampler.two(Purpose::Direction))?;
        let direction = self.frame.world(s.wi);
        let correction = self.correction(w, s.wi, direction, mode)?;
        let weight = s.weight * correction;
        (!weight.is_black()).then_some(Step {
            direction,
            weight,
            pdf: s.pdf,
            pdf_reverse: s.pdf_reverse,
            dirac: s.dirac,
            eta_scale: s.eta_scale,
        })
    }

    /// What joining the vertex to something in `direction` gives.
    #[inline(always)]
    pub fn join(&self, direction: Vec3, mode: Mode) -> Option<Joint<S>> {
        let w = self.frame.local(self.previous);
        let to = self.frame.local(direction);
        let correction = self.correction(w, to, direction, mode)?;
        let (wo, wi) = match mode {
            Mode::Radiance => (w, to),
            Mode::Importance => (to, w),
        };
        let f = self.surface.eval(wo, wi);
        if f.is_black() {
            return None;
        }
        Some(Joint {
            value: f * (to.z.abs() * correction),
            pdf: self.surface.pdf(w, to, mode),
            pdf_reverse: self.surface.pdf(to, w, mode.reversed()),
        })
    }

    /// f̂|ω·n_g| over f|ω·n_s| for the direction ω that the walk goes to: 1 on walks from the sensor, Veach's
    /// |ω_i·n_s||ω_o·n_g|/(|ω_i·n_g||ω_o·n_s|) on walks from the light.
    ///
    /// The shading normal alone says what is reflection and what transmission (as in Mitsuba 3 and pbrt-v4): asking
    /// the geometric one as well would draw black seams where interpolated normals turn away from the viewer.
    #[inline(always)]
    fn correction(&self, w: Vec3, to: Vec3, direction: Vec3, mode: Mode) -> Option<Real> {
        match mode {
            Mode::Radiance => Some(1.0),
            Mode::Importance if self.point.shading == self.point.normal => Some(1.0),
            Mode::Importance => {
                let from_g = self.previous.dot(self.point.normal);
                let to_g = direction.dot(self.point.normal);
                let factor = (w.z * to_g / (from_g * to.z)).abs();
                factor.is_finite().then_some(factor)
            }
        }
    }
}
