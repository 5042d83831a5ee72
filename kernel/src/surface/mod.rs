//! Local models: how light scatters at a surface. One file per model, all of one shape, [`Local`].
//!
//! Directions are in the local frame (z is the normal) and point away from the surface. wo is where light
//! leaves, wi where it comes from, whoever walks. To add a model: write its file, add it to [`Surface`].

#[cfg(feature = "textures")]
mod bitmap;
#[cfg(feature = "glossy")]
mod blend;
mod conductor;
#[cfg(feature = "glossy")]
pub mod curve;
mod dielectric;
mod diffuse;
pub mod fresnel;
#[cfg(feature = "glossy")]
pub mod microfacet;
mod mirror;
mod null;
#[cfg(feature = "glossy")]
pub(crate) mod outlined;
mod sheet;
mod texture;

#[cfg(feature = "glossy")]
pub use blend::chosen;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use mirror::Mirror;
pub use null::Null;
#[cfg(feature = "spectral")]
pub use outlined::Dispersive;
#[cfg(feature = "glossy")]
pub use outlined::{Outlined, Phong, Plastic, RoughConductor, RoughDielectric, RoughPlastic};
pub use sheet::Sheet;
pub use texture::TextureView;

use crate::blob::format::{Material, NONE, material};
use crate::instance::Instance;
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;

/// Which end a walk comes from: what the direction it already has means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// From the sensor: w is wo, and weights carry f(w ← wi).
    Radiance,
    /// From the light: w is the direction towards the light, and weights carry f(wi ← w).
    Importance,
}

impl Mode {
    /// The other end.
    #[inline(always)]
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Mode::Radiance => Mode::Importance,
            Mode::Importance => Mode::Radiance,
        }
    }
}

/// A direction drawn at a surface.
#[derive(Clone, Copy, Debug)]
pub struct Scatter<S> {
    /// The direction.
    pub wi: Vec3,
    /// f·|cos|/pdf, with f's arguments as [`Mode`] says.
    pub weight: S,
    /// Density per solid angle, the choice of the lobe included; for a Dirac lobe, its probability.
    pub pdf: Real,
    /// The same for the way back: drawing w from wi in the other mode.
    pub pdf_reverse: Real,
    /// Whether the lobe is a Dirac's.
    pub dirac: bool,
    /// Whether the direction is on the other side.
    pub transmitted: bool,
    /// The factor of `weight` that is refraction's (η_o/η_i)², 1 if there is none.
    pub eta_scale: Real,
    /// The density by channel, had it led, over that of the one that leads: other than 1 where channels are treated differently. `weight` is over
    /// the leading one's density in every channel.
    pub chances: S,
}

impl<S: Spectrum> Scatter<S> {
    /// Drawn with probability `pdf`, as if nothing else could have been.
    #[inline(always)]
    fn alone(self) -> Self {
        Self {
            weight: self.weight * self.pdf,
            pdf: 1.0,
            pdf_reverse: 1.0,
            ..self
        }
    }

    /// By a Dirac lobe of probability `p` in both directions.
    #[inline(always)]
    fn dirac(wi: Vec3, weight: S, p: Real) -> Self {
        Self {
            wi,
            weight,
            pdf: p,
            pdf_reverse: p,
            dirac: true,
            transmitted: false,
            eta_scale: 1.0,
            chances: S::WHITE,
        }
    }
}

/// A local model: three functions. What a model of Dirac lobes alone has to say is `sample`.
pub trait Local<S: Spectrum> {
    /// f_s(wo ← wi), without its Dirac parts and without cosine; sr⁻¹.
    #[inline(always)]
    fn eval(&self, _wo: Vec3, _wi: Vec3) -> S {
        S::BLACK
    }

    /// Density per solid angle of drawing `wi` when walking from `w`; Dirac lobes have none.
    #[inline(always)]
    fn pdf(&self, _w: Vec3, _wi: Vec3, _mode: Mode) -> Real {
        0.0
    }

    /// Draws a direction: `lobe` chooses the lobe, `xi` the direction in it. `None` absorbs.
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>>;

    /// The Dirac lobe number `index`, as if there were no other: its whole weight, f·|cos| of the Dirac, with probability 1. `None` behind the
    /// last. A model whose `sample` draws Dirac lobes has to list them all here.
    #[inline(always)]
    fn dirac_lobe(&self, _w: Vec3, _mode: Mode, _index: u32) -> Option<Scatter<S>> {
        None
    }

    /// Whether there is a lobe that isn't Dirac: connections are possible.
    #[inline(always)]
    fn has_smooth(&self) -> bool {
        false
    }
}

/// The ideal direction of a mirror.
#[inline(always)]
fn reflect(w: Vec3) -> Vec3 {
    Vec3::new(-w.x, -w.y, w.z)
}

/// Whether two directions are on one side. The tangent plane counts as front, for all models alike, and
/// signs rather than a product, which underflows.
#[inline(always)]
fn same_side(a: Vec3, b: Vec3) -> bool {
    (a.z < 0.0) == (b.z < 0.0)
}

/// Any local model, its colours looked up.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // each variant is documented at its model
pub enum Surface<S> {
    Diffuse(Diffuse<S>),
    Mirror(Mirror<S>),
    Conductor(Conductor<S>),
    Dielectric(Dielectric<S>),
    Null(Null),
    Sheet(Sheet<S>),
    #[cfg(feature = "glossy")]
    Outlined(Outlined<S>),
}

/// Calls the model's own function; `$none` for one behind the door where there are none.
macro_rules! each {
    ($surface:expr, $model:ident => $call:expr, else $none:expr) => {
        match $surface {
            Surface::Diffuse($model) => $call,
            Surface::Mirror($model) => $call,
            Surface::Conductor($model) => $call,
            Surface::Dielectric($model) => $call,
            Surface::Null($model) => $call,
            Surface::Sheet($model) => $call,
            #[cfg(feature = "glossy")]
            Surface::Outlined(model) if K::GLOSSY => {
                // Its functions are calls; a copy keeps what they see apart from the vertex, which stays in registers.
                let $model = &{ *model };
                $call
            }
            #[cfg(feature = "glossy")]
            Surface::Outlined(_) => $none,
        }
    };
}

impl<S: Spectrum> Surface<S> {
    /// A surface that swallows all light.
    pub const BLACK: Self = Self::Diffuse(Diffuse {
        reflectance: S::BLACK,
        transmittance: S::BLACK,
    });

    /// The model of a blob's material at (u, v).
    #[inline(always)]
    #[cfg_attr(not(feature = "glossy"), allow(unused_variables))]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    pub fn resolve<K: Instance<S = S>>(
        m: &Material,
        textures: TextureView<'_>,
        waves: &S::Waves,
        lead: usize,
        uv: [Real; 2],
    ) -> Self {
        let color = |role: usize| color(m, role, textures, waves, uv);
        match m.kind {
            material::DIFFUSE => Self::Diffuse(Diffuse {
                reflectance: color(0),
                transmittance: color(1),
            }),
            material::MIRROR => Self::Mirror(Mirror {
                reflectance: color(0),
            }),
            material::CONDUCTOR => Self::Conductor(Conductor {
                eta: textured(m.eta, m.texture[2], textures, waves, uv),
                k: textured(m.k, m.texture[3], textures, waves, uv),
                reflectance: color(0),
            }),
            material::DIELECTRIC => Self::Dielectric(Dielectric {
                ior: m.ior as Real,
                schlick: m.flags & material::SCHLICK != 0,
                reflectance: color(0),
                transmittance: color(1),
            }),
            material::NULL => Self::Null(Null),
            #[cfg(feature = "glossy")]
            kind if K::GLOSSY && kind != material::SHEET => {
                Self::Outlined(Outlined::resolve(m, textures, waves, lead, uv))
            }
            _ => Self::Sheet(Sheet {
                specular_reflectance: color(0),
                specular_transmittance: color(1),
                diffuse: Diffuse {
                    reflectance: color(2),
                    transmittance: color(3),
                },
            }),
        }
    }
}

/// A material's colour in a role: the constant times the texture, if there is one.
#[inline(always)]
fn color<S: Spectrum>(
    m: &Material,
    role: usize,
    textures: TextureView<'_>,
    waves: &S::Waves,
    uv: [Real; 2],
) -> S {
    match (m.color.get(role), m.texture.get(role)) {
        (Some(&constant), Some(&id)) => textured(constant, id, textures, waves, uv),
        _ => S::BLACK,
    }
}

/// A constant times texture `id`, if there is one.
#[inline(always)]
fn textured<S: Spectrum>(
    constant: [f32; 3],
    id: u32,
    textures: TextureView<'_>,
    waves: &S::Waves,
    uv: [Real; 2],
) -> S {
    let constant = S::lift(constant, waves);
    if id == NONE {
        constant
    } else {
        constant * textures.color::<S>(id, uv, waves)
    }
}

/// A surface as an instance of the estimators knows it.
#[derive(Clone, Copy, Debug)]
pub struct Known<'s, K: Instance>(&'s Surface<K::S>);

impl<S: Spectrum> Surface<S> {
    /// As `K` knows it.
    #[inline(always)]
    pub fn of<K: Instance<S = S>>(&self) -> Known<'_, K> {
        Known(self)
    }
}

impl<K: Instance> Local<K::S> for Known<'_, K> {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> K::S {
        each!(self.0, m => m.eval(wo, wi), else K::S::BLACK)
    }

    #[inline(always)]
    fn pdf(&self, w: Vec3, wi: Vec3, mode: Mode) -> Real {
        each!(self.0, m => Local::<K::S>::pdf(m, w, wi, mode), else 0.0)
    }

    #[inline(always)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<K::S>> {
        each!(self.0, m => m.sample(w, mode, lobe, xi), else None)
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<K::S>> {
        each!(self.0, m => m.dirac_lobe(w, mode, index), else None)
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        each!(self.0, m => Local::<K::S>::has_smooth(m), else false)
    }
}
