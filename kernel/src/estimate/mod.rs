//! Estimators, one file each, and what an embedder calls.
//!
//! Every estimate is a pure function of (scene, settings, element, index): the same bits on every
//! machine, whatever ran before it (`architecture.md`, law 3).

#[cfg(feature = "bidirectional")]
mod bidirectional;
#[cfg(feature = "distributed")]
mod distributed;
mod equiangular;
#[cfg(feature = "light")]
mod light;
#[cfg(feature = "metropolis")]
mod metropolis;
mod patch;
mod path;
#[cfg(feature = "pilot")]
pub(crate) mod pilot;
mod plan;
#[cfg(feature = "quadrature")]
mod quadrature;
#[cfg(feature = "quadrature")]
mod rule;
mod scratch;
mod share;

#[cfg(feature = "metropolis")]
pub use metropolis::{Chain, Mutations};
#[cfg(feature = "pilot")]
pub use pilot::Pilot;
pub use plan::{LEVELS, Rule, Tree};
use scratch::{Light, Workspace};
pub use scratch::{Scratch, ScratchView};

use crate::blob::format::NONE;
#[cfg(any(feature = "glossy", feature = "media"))]
use crate::blob::format::needs;
use crate::blob::{Scene, View};
#[cfg(feature = "glossy")]
use crate::instance::GlossySurfaces;
#[cfg(feature = "media")]
use crate::instance::{Complete, Volumes};
use crate::instance::{Instance, Surfaces};
use crate::path::{Heuristic, Mis, Trace};
use crate::random::{Numbers, Purpose, Sampler, Sequence, Subpath, Work};
use crate::real::{Real, Vec3};
use crate::sensor::Element;
use crate::shape::Tracer;
#[cfg(feature = "spectral")]
use crate::spectrum::Hero;
use crate::spectrum::{Rgb, Spectrum};

/// How light is estimated (`transport.md` §7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// A walk from the sensor; at each vertex a light is sampled as well (Kajiya 1986).
    #[default]
    Path,
    /// A walk from a light; each vertex is joined to the sensor. It can't see mirrors or glass directly.
    #[cfg(feature = "light")]
    Light,
    /// Both walks and all connections between them (Lafortune & Willems 1993, Veach 1997).
    #[cfg(feature = "bidirectional")]
    Bidirectional,
    /// Chains of paths over [`Estimator::Bidirectional`] ([`Chain`]). Their steps aren't samples of pixels: where samples are asked for, these are
    /// those of `Bidirectional`.
    #[cfg(feature = "metropolis")]
    Metropolis,
    /// Ray trees to a stated depth ([`Tree`]); longer paths are left out (Whitted 1980, Cook 1984).
    #[cfg(feature = "distributed")]
    Distributed,
    /// Direct light and single scattering by quadrature ([`Rule`]); all other light is left out.
    #[cfg(feature = "quadrature")]
    Quadrature,
    /// The same, and what it leaves out by [`Estimator::Path`].
    #[cfg(feature = "quadrature")]
    QuadratureAndPath,
}

impl Estimator {
    /// Whether samples of pixels add to other pixels.
    pub const fn splats(self) -> bool {
        match self {
            #[cfg(feature = "light")]
            Self::Light => true,
            #[cfg(feature = "bidirectional")]
            Self::Bidirectional => true,
            #[cfg(feature = "metropolis")]
            Self::Metropolis => true,
            _ => false,
        }
    }

    /// Whether samples are those of `Bidirectional`.
    #[cfg(feature = "bidirectional")]
    const fn joins_walks(self) -> bool {
        match self {
            Self::Bidirectional => true,
            #[cfg(feature = "metropolis")]
            Self::Metropolis => true,
            _ => false,
        }
    }

    /// Whether direct light comes from a rule.
    const fn is_quadrature(self) -> bool {
        match self {
            #[cfg(feature = "quadrature")]
            Self::Quadrature | Self::QuadratureAndPath => true,
            _ => false,
        }
    }

    /// What of a scene this estimator can't answer for, in words; `None` if there is nothing.
    pub fn refuses(self, scene: &Scene<'_>) -> Option<&'static str> {
        match self {
            #[cfg(feature = "quadrature")]
            Self::Quadrature if quadrature::leaves_out_a_light(scene) => Some(
                "quadrature makes no light of environments, constant backgrounds and glowing media: choose quadrature+path",
            ),
            _ => {
                let _ = scene;
                None
            }
        }
    }
}

/// What is the same for all samples of a render.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// How.
    pub estimator: Estimator,
    /// How strategies share a path.
    pub heuristic: Heuristic,
    /// The most edges of a path (1: emitters seen directly, 2: direct light, …); `None`: no limit.
    pub max_edges: Option<u32>,
    /// Where random numbers come from.
    pub sequence: Sequence,
    /// Selects the random numbers.
    pub seed: u64,
    /// Walks that carry less than this share of what they began with go on by Russian roulette. So are connections of
    /// `Estimator::Bidirectional` looked at that carry less than a tenth of this share of what their sample has so far. 0: no roulette.
    pub roulette: Real,
    /// How [`Estimator::Distributed`] branches.
    pub tree: Tree,
    /// How fine [`Estimator::Quadrature`] is.
    pub rule: Rule,
    /// How the chains of [`Estimator::Metropolis`] move.
    #[cfg(feature = "metropolis")]
    pub mutations: Mutations,
    /// Weights always by the explicit ratio walk: slower, the same to rounding. For tests.
    pub explicit_weights: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            estimator: Estimator::default(),
            heuristic: Heuristic::default(),
            max_edges: None,
            sequence: Sequence::default(),
            seed: 0,
            roulette: 0.5,
            tree: Tree::default(),
            rule: Rule::default(),
            #[cfg(feature = "metropolis")]
            mutations: Mutations::default(),
            explicit_weights: false,
        }
    }
}

impl Settings {
    /// The random numbers of sample `index` of the element (pixel, texel) `id`.
    #[inline(always)]
    pub fn numbers(&self, id: u64, index: u64) -> Numbers {
        Numbers::new(self.sequence, self.seed, id, index)
    }

    #[inline(always)]
    fn limit(&self) -> u32 {
        self.max_edges.unwrap_or(u32::MAX)
    }
}

impl Scene<'_> {
    /// One sample of `pixel` (column, row of the image): returns radiance, and reports what the sample
    /// adds to other pixels through `splat`. With n samples per pixel,
    ///
    /// ```text
    /// pixel = (sum of its returned values + sum of splats to it) / n
    /// ```
    ///
    /// `index` counts the samples of a pixel. Values are finite, and ≥ 0 but for scenes with wavelengths ([`needs`](crate::blob::format::needs)`::SPECTRAL`): one
    /// wavelength is beyond sRGB's gamut, so that channels of single samples are negative there.
    #[inline]
    pub fn estimate<const N: usize>(
        &self,
        settings: &Settings,
        pixel: [u32; 2],
        index: u64,
        scratch: &mut Scratch<N>,
        splat: &mut dyn FnMut([u32; 2], Rgb),
    ) -> Rgb {
        let numbers = &mut settings.numbers(pixel_id(pixel), index);
        let element = &Element::Pixel(pixel);
        self.estimate_element(settings, element, numbers, &mut scratch.view(self), splat)
    }

    /// One sample of the radiance that arrives at `origin` from `direction` (unit). `id` and `index`
    /// select the random numbers: the same pair gives the same bits. A light walk can't meet a ray, so
    /// [`Estimator::Light`] is answered by [`Estimator::Path`].
    #[inline]
    pub fn radiance<const N: usize>(
        &self,
        settings: &Settings,
        origin: Vec3,
        direction: Vec3,
        id: u64,
        index: u64,
        scratch: &mut Scratch<N>,
    ) -> Rgb {
        let numbers = &mut settings.numbers(id, index);
        let element = &Element::ray(origin, direction);
        let scratch = &mut scratch.view(self);
        self.estimate_element(settings, element, numbers, scratch, &mut |_, _| ())
    }

    /// One sample of the irradiance at `position` on the side of `normal` (unit): a texel of a light
    /// map, a probe. The position may lie on the scene's geometry.
    #[inline]
    pub fn irradiance<const N: usize>(
        &self,
        settings: &Settings,
        position: Vec3,
        normal: Vec3,
        id: u64,
        index: u64,
        scratch: &mut Scratch<N>,
    ) -> Rgb {
        let numbers = &mut settings.numbers(id, index);
        let element = &Element::irradiance(self, position, normal);
        let scratch = &mut scratch.view(self);
        self.estimate_element(settings, element, numbers, scratch, &mut |_, _| ())
    }

    /// One sample of any element, by [`Settings::numbers`]: what the others call. Nothing in it is generic, so that the estimators are compiled with the
    /// kernel, and not again by each crate that asks.
    #[inline(never)]
    pub fn estimate_element(
        &self,
        settings: &Settings,
        element: &Element,
        numbers: &mut Numbers,
        scratch: &mut ScratchView<'_>,
        splat: &mut dyn FnMut([u32; 2], Rgb),
    ) -> Rgb {
        let tree = &self.tree();
        estimate_with(self, tree, settings, element, numbers, scratch, splat)
    }
}

/// One sample of `element`, with geometry answered by `tracer` and numbers by `sampler`: the general form of
/// [`Scene::estimate`], for engines that bring their own. Runs the instance of the estimator that has what the scene needs.
#[inline(always)]
pub fn estimate_with<T: Tracer, P: Sampler>(
    scene: &Scene<'_>,
    tracer: &T,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    scratch: &mut ScratchView<'_>,
    splat: &mut (impl FnMut([u32; 2], Rgb) + ?Sized),
) -> Rgb {
    dispatch(
        scene,
        scratch,
        Sample {
            scene,
            tracer,
            settings,
            element,
            sampler,
            splat,
        },
    )
}

/// What is done in one of the instances.
trait Errand {
    /// What comes of it.
    type Result;
    /// Does it.
    fn run<K: Instance>(self, workspace: &mut Workspace<'_, K::S>) -> Self::Result;
}

/// Runs the instance that has what the scene needs.
#[inline(always)]
fn dispatch<E: Errand>(scene: &Scene<'_>, scratch: &mut ScratchView<'_>, errand: E) -> E::Result {
    let _ = scene;
    macro_rules! by {
        ($instance:ty, $light:expr) => {
            errand.run::<$instance>(&mut Workspace {
                light: $light,
                links: scratch.links,
                sensor: scratch.sensor,
                counters: scratch.counters,
            })
        };
    }
    match &mut scratch.light {
        #[cfg(feature = "spectral")]
        Light::Spectral(light) => by!(Complete<Hero>, light),
        #[cfg(feature = "media")]
        Light::Rgb(light) if scene.has(needs::MEDIA | needs::DISPERSION) => {
            if Volumes::<Rgb>::APART && !scene.has(needs::GLOSSY | needs::DISPERSION) {
                by!(Volumes<Rgb>, light)
            } else {
                by!(Complete<Rgb>, light)
            }
        }
        #[cfg(feature = "glossy")]
        Light::Rgb(light) if scene.has(needs::GLOSSY) => by!(GlossySurfaces<Rgb>, light),
        Light::Rgb(light) => by!(Surfaces<Rgb>, light),
    }
}

/// One sample of an element.
struct Sample<'w, 's, 'a, T, P, F: ?Sized> {
    scene: &'s Scene<'a>,
    tracer: &'w T,
    settings: &'w Settings,
    element: &'w Element,
    sampler: &'w mut P,
    splat: &'w mut F,
}

/// Draws what the channels of a path are, and which of them leads; where that matters.
#[inline(always)]
fn channels<K: Instance, P: Sampler>(sampler: &mut P) -> (<K::S as Spectrum>::Waves, usize) {
    let mut xi = 0.0;
    if K::MEDIA {
        sampler.at(Subpath::Sensor, 0);
        xi = sampler.one(Purpose::Lead);
    }
    K::S::draw(xi)
}

impl<T, P, F> Errand for Sample<'_, '_, '_, T, P, F>
where
    T: Tracer,
    P: Sampler,
    F: FnMut([u32; 2], Rgb) + ?Sized,
{
    type Result = Rgb;

    // Not inlined: the stack of one instance isn't that of all.
    #[inline(never)]
    fn run<K: Instance>(self, scratch: &mut Workspace<'_, K::S>) -> Rgb {
        let Self {
            scene,
            tracer,
            settings,
            element,
            sampler,
            splat,
        } = self;
        let (waves, lead) = channels::<K, P>(sampler);
        let mut trace =
            Trace::<T, K>::new(View::new(scene, waves), tracer, lead, settings.roulette);
        let mut rejected = 0;
        let mut value: K::S = {
            #[cfg_attr(not(feature = "light"), allow(unused_variables))]
            let splat = &mut |pixel, value: K::S| match accept(value, &waves) {
                Some(v) => splat(pixel, v),
                None => rejected += 1,
            };
            match (settings.estimator, element) {
                #[cfg(feature = "light")]
                (Estimator::Light, Element::Pixel(_) | Element::Irradiance { .. }) => {
                    light::estimate(&mut trace, settings, element, sampler, splat)
                }
                #[cfg(feature = "bidirectional")]
                (estimator, _) if estimator.joins_walks() => {
                    bidirectional::estimate(&mut trace, settings, element, sampler, scratch, splat)
                }
                #[cfg(feature = "distributed")]
                (Estimator::Distributed, _) => {
                    distributed::estimate(&mut trace, settings, element, sampler, scratch)
                }
                #[cfg(feature = "quadrature")]
                (Estimator::Quadrature, _) => {
                    quadrature::estimate(&mut trace, settings, element, sampler, scratch)
                }
                #[cfg(feature = "quadrature")]
                (Estimator::QuadratureAndPath, _) => {
                    quadrature::and_path(&mut trace, settings, element, sampler, scratch)
                }
                // No light walk meets a ray.
                _ => sampler.lend(ByPath {
                    trace: &mut trace,
                    settings,
                    element,
                }),
            }
        };
        if let Element::Irradiance { position, normal } = *element
            && settings.limit() > 0
            && !settings.estimator.is_quadrature()
        {
            let medium = surroundings(&mut trace, element);
            value += patch::direct(&mut trace, position, normal, medium, sampler);
        }
        let value = accept(value, &waves);
        trace.counters.rejected += rejected + u64::from(value.is_none());
        *scratch.counters += trace.counters;
        value.unwrap_or(Rgb::BLACK)
    }
}

/// [`path`] for each kind of numbers: its samples are so short that choosing at every number would cost 2 %.
struct ByPath<'w, 't, 'a, T, K: Instance> {
    trace: &'w mut Trace<'t, 'a, T, K>,
    settings: &'w Settings,
    element: &'w Element,
}

impl<T: Tracer, K: Instance> Work for ByPath<'_, '_, '_, T, K> {
    type Result = K::S;
    #[inline(always)]
    fn with<P: Sampler>(self, numbers: &mut P) -> K::S {
        path::estimate(
            self.trace,
            self.settings,
            self.element,
            numbers,
            &mut path::Everything,
        )
    }
}

/// The medium that a sensor walk begins in: the camera's is known; around other elements the scene is asked.
#[inline(always)]
fn surroundings<T: Tracer, K: Instance>(trace: &mut Trace<'_, '_, T, K>, element: &Element) -> u32 {
    match element {
        _ if !K::MEDIA => NONE,
        Element::Pixel(_) => trace.scene.sensor().medium,
        Element::Ray(ray) => trace.medium_at(ray.origin, ray.direction),
        Element::Irradiance { position, normal } => trace.medium_at(*position, *normal),
    }
}

/// The number of a pixel's stream of random numbers.
#[inline(always)]
pub(crate) fn pixel_id([x, y]: [u32; 2]) -> u64 {
    u64::from(y) << 32 | u64::from(x)
}

/// No NaN, infinity or negative radiance leaves an estimator.
#[inline(always)]
fn accept<S: Spectrum>(value: S, waves: &S::Waves) -> Option<Rgb> {
    value.recorded(waves)
}

/// The weights' settings for one element.
#[inline(always)]
fn mis(settings: &Settings, light_paths: Real, capacity: usize) -> Mis {
    Mis {
        heuristic: settings.heuristic,
        light_paths,
        capacity,
        explicit: settings.explicit_weights,
    }
}
