//! A path vertex, on a surface or in a volume: how light scatters there, and where the walk goes next.
//!
//! f̂ carries the shading-normal correction, so that G can use geometric normals throughout:
//! f̂ = f·|ω_i·n_s|/|ω_i·n_g| with ω_i towards the light, whoever walks (Veach 1997, §5.3).

use super::boundary::{side, sides};
use super::trace::Trace;
use super::weight::Terms;
use crate::blob::Scene;
use crate::blob::format::NONE;
use crate::instance::Instance;
use crate::medium::{Carried, Phase, density};
use crate::random::{Purpose, Sampler};
use crate::real::{Frame, Real, Vec3};
use crate::shape::Point;
use crate::spectrum::Spectrum;
#[cfg(feature = "glossy")]
use crate::surface::chosen;
use crate::surface::{Local, Mode, Scatter, Surface};

/// A vertex of a walk, with what the weights need of the walk so far.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<S> {
    /// Where.
    pub point: Point,
    /// Shading frame.
    pub frame: Frame,
    /// Local model; in a volume none.
    pub surface: Surface<S>,
    /// σ_s, in a volume: what scatters is the phase function of `media`.
    pub scattering: Option<S>,
    /// The media in front of the surface and behind it; in a volume both are the one it is.
    pub media: [u32; 2],
    /// p_k/p̄ of the walk so far, by channel ([`crate::medium`]).
    pub ratio: S,
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
    /// The density by channel over the leading one's ([`Scatter::chances`]).
    pub chances: S,
}

impl<S: Spectrum> Step<S> {
    /// In the world's `direction`; `None` where nothing goes there.
    #[inline(always)]
    fn new(direction: Vec3, s: Scatter<S>, correction: Real) -> Option<Self> {
        let weight = s.weight * correction;
        (!weight.is_black()).then_some(Self {
            direction,
            weight,
            pdf: s.pdf,
            pdf_reverse: s.pdf_reverse,
            dirac: s.dirac,
            eta_scale: s.eta_scale,
            chances: s.chances,
        })
    }

    /// f̂·|cos|/p̄ of the step for a walk with densities `ratio` by channel ([`crate::medium`]), which becomes that after it.
    #[inline(always)]
    pub fn taken<K: Instance<S = S>>(&self, ratio: &mut S) -> S {
        if !K::DISPERSIVE || self.chances == S::WHITE {
            return self.weight;
        }
        let mut carried = Carried {
            throughput: S::WHITE,
            ratio: *ratio,
        };
        carried.draw(self.weight, self.chances);
        *ratio = carried.ratio;
        carried.throughput
    }
}

/// What a vertex says of a direction to which it is joined.
#[derive(Clone, Copy, Debug)]
pub struct Joint<S> {
    /// f̂·|cos| with geometric cosine; σ_s·p in a volume.
    pub value: S,
    /// Density per solid angle of sampling the direction.
    pub pdf: Real,
    /// Density per solid angle of sampling the previous vertex, coming from that direction.
    pub pdf_reverse: Real,
}

impl<S: Spectrum> Vertex<S> {
    /// The vertex on a surface at `point`, reached from direction `previous` through `medium`; its weight terms are zero. A blend
    /// is one of its parts from here on, by `sampler`'s choice.
    #[inline(always)]
    pub fn on_surface<T, K: Instance<S = S>>(
        trace: &Trace<'_, '_, T, K>,
        point: Point,
        previous: Vec3,
        medium: u32,
        throughput: S,
        ratio: S,
        sampler: &mut impl Sampler,
    ) -> Self {
        let (scene, lead) = (trace.scene, trace.lead);
        let front = previous.dot(point.shading) >= 0.0;
        let material = scene
            .shape(point.shape)
            .and_then(|shape| scene.material(if front { shape.front } else { shape.back }));
        #[cfg(feature = "glossy")]
        let material = material.map(|m| {
            let draw = || sampler.one(Purpose::Blend);
            match K::GLOSSY {
                true => chosen(scene.materials(), m, scene.texture_view(), point.uv, draw),
                false => m,
            }
        });
        #[cfg(not(feature = "glossy"))]
        let _ = sampler;
        let surface = match material {
            Some(m) => Surface::resolve::<K>(m, scene.texture_view(), &scene.waves, lead, point.uv),
            None => Surface::BLACK,
        };
        Self {
            point,
            frame: Frame::around(point.shading),
            surface,
            scattering: None,
            media: [medium; 2],
            ratio,
            previous,
            throughput,
            terms: Terms::default(),
        }
    }

    /// The vertex in `medium` at `position`, where it scatters with coefficient `scattering`.
    #[inline(always)]
    pub fn in_volume(
        position: Vec3,
        previous: Vec3,
        medium: u32,
        scattering: S,
        throughput: S,
        ratio: S,
    ) -> Self {
        // No surface: nothing to leave, nothing that emits.
        let point = Point {
            position,
            normal: previous,
            shading: previous,
            uv: [0.0; 2],
            offset: 0.0,
            shape: NONE,
            primitive: NONE,
        };
        Self {
            point,
            frame: Frame {
                x: Vec3::X,
                y: Vec3::Y,
                z: Vec3::Z,
            },
            surface: Surface::BLACK,
            scattering: Some(scattering),
            media: [medium; 2],
            ratio,
            previous,
            throughput,
            terms: Terms::default(),
        }
    }

    /// Takes note of the media that the surface parts.
    #[inline(always)]
    pub fn look_around(&mut self, scene: &Scene<'_>) {
        let [here, _] = self.media;
        self.media = sides(scene, &self.point, here);
    }

    /// The medium that lies towards `direction`.
    #[inline(always)]
    pub fn medium_towards(&self, direction: Vec3) -> u32 {
        side(&self.media, &self.point, direction)
    }

    /// The phase function, in a volume.
    #[inline(always)]
    fn phase<'a>(&self, scene: &Scene<'a>) -> Option<Phase<'a, S>> {
        let [medium, _] = self.media;
        Some(Phase {
            lobes: &scene.medium(medium)?.phase,
            scattering: self.scattering?,
        })
    }

    /// Whether there is a lobe that isn't Dirac: connections are possible.
    #[inline(always)]
    pub fn has_smooth<K: Instance<S = S>>(&self, scene: &Scene<'_>) -> bool {
        if K::MEDIA && self.scattering.is_some() {
            return self.phase(scene).is_some_and(|p| p.has_smooth());
        }
        self.surface.of::<K>().has_smooth()
    }

    /// What turns a density per solid angle, times 1/d², into one of this vertex for a walk that comes along `direction` (or its
    /// opposite): |cos| per area on a surface, σ_t (as the weights assume it) per volume.
    #[inline(always)]
    pub fn facing<T, K: Instance<S = S>>(
        &self,
        trace: &Trace<'_, '_, T, K>,
        direction: Vec3,
    ) -> Real {
        if K::MEDIA && self.scattering.is_some() {
            let [medium, _] = self.media;
            let medium = trace.scene.medium(medium);
            return medium.map_or(0.0, |m| density(trace.scene, m, trace.lead));
        }
        direction.dot(self.point.normal).abs()
    }

    /// Draws where the walk goes; `None` if it ends here. In a browser's module and a microcontroller's flash once rather than in every
    /// walk: there it is the size that counts, and in a browser that is the faster one too.
    #[cfg_attr(any(target_family = "wasm", target_arch = "arm"), inline(never))]
    #[cfg_attr(not(any(target_family = "wasm", target_arch = "arm")), inline(always))]
    pub fn scatter<K: Instance<S = S>>(
        &self,
        scene: &Scene<'_>,
        mode: Mode,
        sampler: &mut impl Sampler,
    ) -> Option<Step<S>> {
        let lobe = sampler.one(Purpose::Lobe);
        let xi = sampler.two(Purpose::Direction);
        if K::MEDIA && self.scattering.is_some() {
            let s = self.phase(scene)?.sample(self.previous, lobe, xi);
            return Step::new(s.wi, s, 1.0);
        }
        let w = self.frame.local(self.previous);
        let s = self.surface.of::<K>().sample(w, mode, lobe, xi)?;
        let direction = self.frame.world(s.wi);
        Step::new(direction, s, self.correction(w, s.wi, direction, mode)?)
    }

    /// The Dirac lobe number `index` of a surface, as if there were no other; a black one has no weight. `None` behind the last.
    #[cfg_attr(not(feature = "quadrature"), allow(dead_code))]
    #[inline(always)]
    pub fn dirac_lobe<K: Instance<S = S>>(&self, scene: &Scene<'_>, index: u32) -> Option<Step<S>> {
        let _ = scene;
        let w = self.frame.local(self.previous);
        let s = self
            .surface
            .of::<K>()
            .dirac_lobe(w, Mode::Radiance, index)?;
        Some(Step {
            direction: self.frame.world(s.wi),
            weight: s.weight,
            pdf: s.pdf,
            pdf_reverse: s.pdf_reverse,
            dirac: true,
            eta_scale: s.eta_scale,
            chances: s.chances,
        })
    }

    /// What joining the vertex to something in `direction` gives.
    #[inline(always)]
    pub fn join<K: Instance<S = S>>(
        &self,
        scene: &Scene<'_>,
        direction: Vec3,
        mode: Mode,
    ) -> Option<Joint<S>> {
        if K::MEDIA && self.scattering.is_some() {
            let phase = self.phase(scene)?;
            // Symmetric: the way back has the same density.
            let pdf = phase.pdf(self.previous, direction);
            let value = phase.scattering * pdf;
            return (!value.is_black()).then_some(Joint {
                value,
                pdf,
                pdf_reverse: pdf,
            });
        }
        let w = self.frame.local(self.previous);
        let to = self.frame.local(direction);
        let correction = self.correction(w, to, direction, mode)?;
        let (wo, wi) = match mode {
            Mode::Radiance => (w, to),
            Mode::Importance => (to, w),
        };
        let f = self.surface.of::<K>().eval(wo, wi);
        if f.is_black() {
            return None;
        }
        Some(Joint {
            value: f * (to.z.abs() * correction),
            pdf: self.surface.of::<K>().pdf(w, to, mode),
            pdf_reverse: self.surface.of::<K>().pdf(to, w, mode.reversed()),
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
