//! Lights at infinity: a direction, a constant, an image. No inverse square; a light walk from them
//! enters through a disc that covers the scene (`transport.md` §5).

#[cfg(feature = "environment")]
use super::environment;
use super::{Emission, Incident, disc_density};
use crate::blob::View;
#[cfg(feature = "environment")]
use crate::blob::format::emitter as kind;
use crate::blob::format::{Emitter, NONE};
use crate::real::{Frame, INV_PI, Real, Vec3, vec3};
use crate::spectrum::Spectrum;
use crate::warp;

/// A direction towards a background, what comes from there, and its density per solid angle
/// (without the choice among emitters).
pub(super) struct Direction<S> {
    pub direction: Vec3,
    pub radiance: S,
    pub pdf: Real,
}

/// The same from everywhere: density 1/4π.
#[inline(always)]
fn constant<S: Spectrum>(scene: View<'_, '_, S>, e: &Emitter, direction: Vec3) -> Direction<S> {
    Direction {
        direction,
        radiance: scene.emitted(e),
        pdf: 0.25 * INV_PI,
    }
}

/// What comes from `direction`.
#[inline(always)]
fn radiance<S: Spectrum>(scene: View<'_, '_, S>, e: &Emitter, direction: Vec3) -> Direction<S> {
    let _ = scene;
    match e.kind {
        #[cfg(feature = "environment")]
        kind::LATLONG | kind::CUBEMAP => environment::radiance(scene, e, direction),
        _ => constant(scene, e, direction),
    }
}

/// Draws a direction by importance.
#[inline(always)]
fn sample<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    xi: [Real; 2],
    more: [Real; 2],
) -> Option<Direction<S>> {
    let _ = (scene, more);
    match e.kind {
        #[cfg(feature = "environment")]
        kind::LATLONG | kind::CUBEMAP => environment::sample(scene, e, xi, more),
        _ => Some(constant(scene, e, warp::sphere(xi))),
    }
}

/// What a walk sees that leaves the scene towards `direction`: radiance, and the density per solid
/// angle with which the background is sampled there (p_connect = p_trace).
#[inline(always)]
pub fn background<S: Spectrum>(scene: View<'_, '_, S>, direction: Vec3) -> Option<(S, Real)> {
    let e = scene.emitter(scene.world().background)?;
    let seen = radiance(scene, e, direction);
    Some((seen.radiance, seen.pdf * Real::from(e.density)))
}

/// Light that arrives from a background.
#[inline(always)]
pub(super) fn incident<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    xi: [Real; 2],
    more: [Real; 2],
) -> Option<Incident<S>> {
    let Direction {
        direction,
        radiance,
        pdf,
    } = sample(scene, e, xi, more)?;
    Some(Incident {
        direction,
        end: None,
        radiance,
        pdf: pdf * Real::from(e.density),
        dirac: false,
        trace_over_connect: 1.0,
        emission: disc_density(&scene),
        medium: NONE,
    })
}

/// Light that leaves a background: from a direction as above, through a point of the disc.
#[inline(always)]
pub(super) fn emission<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    disc: [Real; 2],
    xi: [Real; 2],
    more: [Real; 2],
) -> Option<Emission<S>> {
    let Direction {
        direction,
        radiance,
        pdf,
    } = sample::<S>(scene, e, xi, more)?;
    let trace = pdf * Real::from(e.density);
    let visible = radiance * (1.0 / trace);
    Some(enter(
        scene, -direction, disc, visible, visible, trace, false,
    ))
}

/// Light that arrives from a far star.
#[inline(always)]
pub(super) fn directional_incident<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
) -> Incident<S> {
    Incident {
        direction: -vec3(e.direction),
        end: None,
        radiance: scene.emitted(e),
        pdf: Real::from(e.density),
        dirac: true,
        trace_over_connect: 1.0,
        emission: disc_density(&scene),
        medium: NONE,
    }
}

/// Light that leaves a far star.
#[inline(always)]
pub(super) fn directional_emission<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    disc: [Real; 2],
) -> Emission<S> {
    let trace = Real::from(e.density);
    let flux = scene.emitted(e) * (1.0 / trace);
    enter(scene, vec3(e.direction), disc, flux, S::BLACK, trace, true)
}

/// A ray that enters the scene along `direction` through the disc of its bounding sphere.
#[inline(always)]
fn enter<S: Spectrum>(
    scene: View<'_, '_, S>,
    direction: Vec3,
    disc: [Real; 2],
    radiance: S,
    visible: S,
    trace: Real,
    dirac: bool,
) -> Emission<S> {
    let world = scene.world();
    let radius = Real::from(world.radius);
    let [x, y] = warp::disc(disc);
    let frame = Frame::around(direction);
    let position = vec3(world.center) + (frame.x * x + frame.y * y - direction) * radius;
    let direction_pdf = disc_density(&scene);
    Emission {
        position,
        origin: position,
        direction,
        normal: None,
        throughput: radiance * (1.0 / direction_pdf),
        visible,
        trace,
        direction_pdf,
        distant: true,
        dirac,
        emitter: NONE,
        primitive: NONE,
        medium: NONE,
        volume: false,
    }
}
