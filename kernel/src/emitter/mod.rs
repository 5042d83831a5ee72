//! Lights: one file per kind, all of one shape, and the choice among them.
//!
//! A light answers four questions:
//! *incident* — draw light that arrives at a given point (next-event estimation, s = 1);
//! *emission* — draw light that leaves (the first edge of a light walk, s ≥ 2);
//! *radiance* — what does a walk see that happens on it (s = 0);
//! *density* — with what density would the first two have drawn that.
//!
//! p_connect(x₀ | y) and p_trace(x₀) differ where a light is sampled better when y is known
//! (Georgiev 2012, tech. report, §3): [`Incident::trace_over_connect`].

mod area;
mod choice;
mod distant;
#[cfg(feature = "environment")]
mod environment;
mod point;
#[cfg(feature = "media")]
pub mod volume;

pub use area::{connect_density, radiance, trace_density};
#[cfg(feature = "environment")]
pub use choice::pick_cell;
pub use choice::pick_choice;
pub use distant::background;

use crate::blob::format::{Choice, Emitter, emitter as kind};
use crate::blob::{Scene, View};
use crate::real::{INV_PI, Real, Vec3, square, vec3};
use crate::spectrum::Spectrum;

/// Light that arrives at a point y from a point x₀ drawn for it.
#[derive(Clone, Copy, Debug)]
pub struct Incident<S> {
    /// From y towards x₀, unit.
    pub direction: Vec3,
    /// x₀, lifted off its own surface by what rounding may do, so that it can't lie in its own shadow; `None` at infinity.
    pub end: Option<Vec3>,
    /// Radiance that arrives if nothing is in between. Dirac lights: with the Dirac's 1/pdf taken
    /// care of, so that f·cos·radiance/pdf is the estimate in any case (I/d², or irradiance).
    pub radiance: S,
    /// p_connect(x₀ | y) per solid angle at y, choice included; the probability of the choice for Dirac lights.
    pub pdf: Real,
    /// Whether a walk can't happen on this light.
    pub dirac: bool,
    /// p_trace(x₀)/p_connect(x₀ | y), both in the same measure.
    pub trace_over_connect: Real,
    /// A light walk from x₀ has density `emission`·|cos θ_y| per area at y.
    pub emission: Real,
    /// The medium that emits at x₀, and in which x₀ has to lie; [`NONE`](crate::blob::format::NONE) where no medium emits.
    pub medium: u32,
}

/// Light that leaves: x₀ and the first edge of a light walk.
#[derive(Clone, Copy, Debug)]
pub struct Emission<S> {
    /// x₀; for distant lights, where the ray enters.
    pub position: Vec3,
    /// Where the ray starts (x₀ moved off its surface).
    pub origin: Vec3,
    /// Where it goes.
    pub direction: Vec3,
    /// Normal at x₀ of an area light.
    pub normal: Option<Vec3>,
    /// L_e·cos/(p(x₀)·p(ω)).
    pub throughput: S,
    /// L_e towards a sensor that sees x₀, over p_trace(x₀): for the light seen directly (s = t = 1).
    /// Black for Dirac lights, which nobody sees directly.
    pub visible: S,
    /// p_trace(x₀): per area; per solid angle for distant lights; a probability for Dirac ones.
    pub trace: Real,
    /// Density of the direction per solid angle; for distant lights, of the ray's place on the disc per area.
    pub direction_pdf: Real,
    /// Whether x₀ lies at infinity.
    pub distant: bool,
    /// Whether a walk can't happen on this light.
    pub dirac: bool,
    /// The emitter.
    pub emitter: u32,
    /// area: the primitive.
    pub primitive: u32,
    /// The medium that the ray starts in, as far as the emitter knows.
    pub medium: u32,
    /// Whether it is that medium which emits. Then x₀ has to lie in it.
    pub volume: bool,
}

/// The emitter that shape `id` is.
#[inline(always)]
pub fn on<'a>(scene: &Scene<'a>, id: u32) -> Option<&'a Emitter> {
    scene.emitter(scene.shape(id)?.emitter)
}

/// The probability of choosing `entry`.
pub fn probability(scene: &Scene<'_>, entry: &Choice) -> Real {
    let Some(emitter) = scene.emitter(entry.emitter) else {
        return 0.0;
    };
    let density = Real::from(emitter.density);
    if emitter.kind == kind::AREA {
        density * area::of_primitive(scene, entry.primitive)
    } else {
        density
    }
}

/// Draws light that arrives at `y`.
#[inline]
pub fn incident<S: Spectrum>(
    scene: View<'_, '_, S>,
    y: Vec3,
    choice: [Real; 2],
    xi: [Real; 2],
    more: [Real; 2],
) -> Option<Incident<S>> {
    incident_from(scene, pick_choice(scene.choices(), choice)?, y, xi, more)
}

/// The same from the emitter, or the emitting primitive, that `entry` names.
#[inline]
pub fn incident_from<S: Spectrum>(
    scene: View<'_, '_, S>,
    entry: &Choice,
    y: Vec3,
    xi: [Real; 2],
    more: [Real; 2],
) -> Option<Incident<S>> {
    let emitter = scene.emitter(entry.emitter)?;
    match emitter.kind {
        kind::AREA => area::incident(scene, emitter, entry.primitive, y, xi),
        kind::POINT | kind::SPOT => point::incident(scene, emitter, y),
        kind::DIRECTIONAL => Some(distant::directional_incident(scene, emitter)),
        #[cfg(feature = "media")]
        kind::VOLUME => volume::incident(scene, emitter, y, [xi[0], xi[1], more[0]]),
        _ => distant::incident(scene, emitter, xi, more),
    }
}

/// A point x₀ of a light that was drawn without knowing for whom: with density p_trace.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    emitter: &'a Emitter,
    primitive: u32,
    /// `None`: the light is a point.
    place: Option<area::Place>,
}

/// Draws a point of a light; `None` if that lies at infinity, or in a medium.
#[inline]
pub fn source<'a>(scene: &Scene<'a>, choice: [Real; 2], xi: [Real; 2]) -> Option<Source<'a>> {
    let entry = pick_choice(scene.choices(), choice)?;
    let emitter = scene.emitter(entry.emitter)?;
    let place = match emitter.kind {
        kind::AREA => Some(area::place(scene, entry.primitive, xi)?),
        kind::POINT | kind::SPOT => None,
        _ => return None,
    };
    Some(Source {
        emitter,
        primitive: entry.primitive,
        place,
    })
}

impl Source<'_> {
    /// Where it is.
    #[inline(always)]
    pub fn position(&self) -> Vec3 {
        self.place
            .map_or(vec3(self.emitter.position), |p| p.position)
    }

    /// Light that arrives at `y` from it.
    #[inline(always)]
    pub fn shine<S: Spectrum>(&self, scene: View<'_, '_, S>, y: Vec3) -> Option<Incident<S>> {
        match &self.place {
            Some(place) => {
                let over_trace = match scene.sphere(self.primitive) {
                    Some(sphere) => {
                        area::connect_over_trace(sphere, place.position, place.normal, y)
                    }
                    None => 1.0,
                };
                area::shine(scene, self.emitter, place, over_trace, y)
            }
            None => point::incident(scene, self.emitter, y),
        }
    }
}

/// Draws light that leaves.
#[inline]
pub fn emission<S: Spectrum>(
    scene: View<'_, '_, S>,
    choice: [Real; 2],
    position: [Real; 2],
    direction: [Real; 2],
    more: [Real; 2],
) -> Option<Emission<S>> {
    let entry = pick_choice(scene.choices(), choice)?;
    let emitter = scene.emitter(entry.emitter)?;
    match emitter.kind {
        kind::AREA => area::emission(scene, emitter, entry.primitive, position, direction),
        kind::POINT | kind::SPOT => point::emission(scene, emitter, direction),
        kind::DIRECTIONAL => Some(distant::directional_emission(scene, emitter, position)),
        #[cfg(feature = "media")]
        kind::VOLUME => {
            let xi = [position[0], position[1], more[0]];
            volume::emission(scene, emitter, xi, direction)
        }
        _ => distant::emission(scene, emitter, position, direction, more),
    }
    .map(|e| Emission {
        emitter: entry.emitter,
        primitive: entry.primitive,
        ..e
    })
}

/// p_connect(x₀ | y)/p_trace(x₀) for x₀ of `emission`, both in the same measure.
#[inline(always)]
pub fn connect_over_trace<S>(scene: &Scene<'_>, emission: &Emission<S>, y: Vec3) -> Real {
    match (scene.sphere(emission.primitive), emission.normal) {
        (Some(sphere), Some(normal)) => {
            area::connect_over_trace(sphere, emission.position, normal, y)
        }
        _ => 1.0,
    }
}

/// 1/(πR²): the density, on a disc that covers the scene, of rays from infinity.
#[inline(always)]
pub fn disc_density(scene: &Scene<'_>) -> Real {
    INV_PI / square(Real::from(scene.world().radius))
}
