//! Local models: how light scatters at a surface. One file per model, all of one shape, [`Local`].
//!
//! Directions are in the local frame (z is the normal) and point away from the surface. wo is where light
//! leaves, wi where it comes from, whoever walks. To add a model: write its file, add it to [`Surface`].

#[cfg(feature = "textures")]
mod bitmap;
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
mod phong;
#[cfg(feature = "glossy")]
mod plastic;
#[cfg(feature = "glossy")]
mod rough_conductor;
#[cfg(feature = "glossy")]
mod rough_dielectric;
#[cfg(feature = "glossy")]
mod rough_plastic;
mod sheet;
mod texture;

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use mirror::Mirror;
pub use null::Null;
#[cfg(feature = "glossy")]
pub use phong::Phong;
#[cfg(feature = "glossy")]
pub use plastic::Plastic;
#[cfg(feature = "glossy")]
pub use rough_conductor::RoughConductor;
#[cfg(feature = "glossy")]
pub use rough_dielectric::RoughDielectric;
#[cfg(feature = "glossy")]
pub use rough_plastic::RoughPlastic;
pub use sheet::Sheet;
pub use texture::TextureView;

use crate::blob::format::{Material, material};
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

/// A draw of `wi` by a model whose `eval` and `pdf` say everything about it.
#[cfg(feature = "glossy")]
#[inline(always)]
fn drawn<S: Spectrum>(
    model: &impl Local<S>,
    w: Vec3,
    wi: Vec3,
    mode: Mode,
    eta_scale: Real,
) -> Option<Scatter<S>> {
    let pdf = model.pdf(w, wi, mode);
    let f = match mode {
        Mode::Radiance => model.eval(w, wi),
        Mode::Importance => model.eval(wi, w),
    };
    let weight = f * (wi.z.abs() / pdf);
    (pdf > 0.0 && weight.max_channel().is_finite()).then(|| Scatter {
        wi,
        weight,
        pdf,
        pdf_reverse: model.pdf(wi, w, mode.reversed()),
        dirac: false,
        transmitted: !same_side(w, wi),
        eta_scale,
    })
}

/// What is left of ξ ∈ [low, low + p) is a fresh number.
#[cfg(feature = "glossy")]
#[inline(always)]
fn fresh(xi: Real, low: Real, p: Real) -> Real {
    ((xi - low) / p).clamp(0.0, crate::real::ONE_MINUS)
}

/// The same direction, or its mirror image, on the side of the normal.
#[cfg(feature = "glossy")]
#[inline(always)]
fn upper(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, w.z.abs())
}

/// A direction of the upper side on the side of `w`.
#[cfg(feature = "glossy")]
#[inline(always)]
fn on_side_of(w: Vec3, wi: Vec3) -> Vec3 {
    if w.z < 0.0 {
        Vec3::new(wi.x, wi.y, -wi.z)
    } else {
        wi
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
    Phong(Phong<S>),
    #[cfg(feature = "glossy")]
    RoughConductor(RoughConductor<S>),
    #[cfg(feature = "glossy")]
    RoughDielectric(RoughDielectric<S>),
    #[cfg(feature = "glossy")]
    Plastic(Plastic<S>),
    #[cfg(feature = "glossy")]
    RoughPlastic(RoughPlastic<S>),
}

/// Calls the model's own function.
macro_rules! each {
    ($surface:expr, $model:ident => $call:expr) => {
        match $surface {
            Surface::Diffuse($model) => $call,
            Surface::Mirror($model) => $call,
            Surface::Conductor($model) => $call,
            Surface::Dielectric($model) => $call,
            Surface::Null($model) => $call,
            Surface::Sheet($model) => $call,
            #[cfg(feature = "glossy")]
            Surface::Phong($model) => $call,
            #[cfg(feature = "glossy")]
            Surface::RoughConductor($model) => $call,
            #[cfg(feature = "glossy")]
            Surface::RoughDielectric($model) => $call,
            #[cfg(feature = "glossy")]
            Surface::Plastic($model) => $call,
            #[cfg(feature = "glossy")]
            Surface::RoughPlastic($model) => $call,
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
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    pub fn resolve(m: &Material, textures: TextureView<'_>, uv: [Real; 2]) -> Self {
        let color = |role: usize| color(m, role, textures, uv);
        match m.kind {
            material::DIFFUSE => Self::Diffuse(Diffuse {
                reflectance: color(0),
                transmittance: color(1),
            }),
            material::MIRROR => Self::Mirror(Mirror {
                reflectance: color(0),
            }),
            material::CONDUCTOR => Self::Conductor(Conductor {
                eta: S::from_rgb(m.eta),
                k: S::from_rgb(m.k),
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
            kind if kind != material::SHEET => Self::glossy(m, textures, uv),
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
    /// [`Self::resolve`] for the kinds above [`material::SHEET`]. A blend is one of its parts by now ([`chosen`]).
    #[cfg(feature = "glossy")]
    #[inline(never)]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    fn glossy(m: &Material, textures: TextureView<'_>, uv: [Real; 2]) -> Self {
        use curve::Curve;
        use microfacet::Microfacets;
        let color = |role: usize| color(m, role, textures, uv);
        let ior = m.ior as Real;
        let [first, second] = m.link;
        let compensated = m.flags & material::COMPENSATED != 0;
        let loss = |first: u32| match compensated {
            true => Curve::read(textures.texels, first),
            false => Curve::ZERO,
        };
        match m.kind {
            material::PHONG => Self::Phong(Phong {
                diffuse: Diffuse {
                    reflectance: color(0),
                    transmittance: color(3),
                },
                reflectance: color(1),
                transmittance: color(2),
                exponent: m.gloss[0] as Real,
                normalization: m.gloss[1] as Real,
                ior,
                fresnel: m.flags & material::FRESNEL != 0,
            }),
            material::ROUGH_CONDUCTOR => Self::RoughConductor(RoughConductor {
                facets: Microfacets::of(m),
                eta: S::from_rgb(m.eta),
                k: S::from_rgb(m.k),
                reflectance: color(0),
                mean: color(1),
                loss: loss(first),
            }),
            material::ROUGH_DIELECTRIC => Self::RoughDielectric(RoughDielectric {
                facets: Microfacets::of(m),
                ior,
                reflectance: color(0),
                transmittance: color(1),
                loss: [loss(first), loss(second)],
            }),
            material::PLASTIC => Self::Plastic(Plastic {
                base: plastic::base(m, color(0)),
                reflectance: color(1),
                ior,
            }),
            material::ROUGH_PLASTIC => Self::RoughPlastic(RoughPlastic {
                facets: Microfacets::of(m),
                base: plastic::base(m, color(0)),
                reflectance: color(1),
                ior,
                entering: Curve::read(textures.texels, first),
            }),
            _ => Self::BLACK,
        }
    }
}

/// A material's colour in a role: the constant times the texture, if there is one.
#[inline(always)]
fn color<S: Spectrum>(m: &Material, role: usize, textures: TextureView<'_>, uv: [Real; 2]) -> S {
    let constant = S::from_rgb(m.color.get(role).copied().unwrap_or([0.0; 3]));
    match m.texture.get(role) {
        Some(&id) if id != crate::blob::format::NONE => constant * textures.color::<S>(id, uv),
        _ => constant,
    }
}

/// The part that a blend is at a vertex, chosen by random numbers from `draw`; any other material is itself.
///
/// A vertex of either walk chooses with the same probability, which therefore cancels in every ratio of densities: all
/// estimators stay exact, and each vertex has the code of one part.
#[cfg(feature = "glossy")]
#[inline(always)]
pub fn chosen<'a>(
    materials: &'a [Material],
    m: &'a Material,
    textures: TextureView<'_>,
    uv: [Real; 2],
    draw: impl FnMut() -> Real,
) -> &'a Material {
    if m.kind == material::BLEND {
        choose(materials, m, textures, uv, draw)
    } else {
        m
    }
}

/// As [`chosen`]; levels fall, which bounds the steps.
#[cfg(feature = "glossy")]
#[inline(never)]
fn choose<'a>(
    materials: &'a [Material],
    mut m: &'a Material,
    textures: TextureView<'_>,
    uv: [Real; 2],
    mut draw: impl FnMut() -> Real,
) -> &'a Material {
    for _ in 0..material::MAX_LEVEL {
        if m.kind != material::BLEND {
            break;
        }
        let second = draw() < textures.weight(m, uv);
        let [first, other] = m.link;
        match materials.get(if second { other } else { first } as usize) {
            Some(part) => m = part,
            None => break,
        }
    }
    m
}

impl<S: Spectrum> Local<S> for Surface<S> {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        each!(self, m => m.eval(wo, wi))
    }

    #[inline(always)]
    fn pdf(&self, w: Vec3, wi: Vec3, mode: Mode) -> Real {
        each!(self, m => Local::<S>::pdf(m, w, wi, mode))
    }

    #[inline(always)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        each!(self, m => m.sample(w, mode, lobe, xi))
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        each!(self, m => m.dirac_lobe(w, mode, index))
    }

    #[inline(always)]
    fn has_smooth(&self) -> bool {
        each!(self, m => Local::<S>::has_smooth(m))
    }
}
