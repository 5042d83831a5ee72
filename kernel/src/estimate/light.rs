//! Light tracing: a walk from a light, each vertex joined to the sensor (t = 1). What it can't make, paths
//! that the sensor sees through a mirror or glass, it leaves black.

use super::Settings;
use crate::blob::Scene;
use crate::emitter::{self, Emission};
use crate::path::{Arrival, Joint, Trace, Vertex, Walk};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::Real;
use crate::sensor::{Element, Footprint, Projection};
use crate::shape::{Ray, Tracer};
use crate::spectrum::Spectrum;
use crate::surface::{Local, Mode};

/// One sample.
#[inline(always)]
pub(super) fn estimate<S: Spectrum, T: Tracer, P: Sampler>(
    trace: &mut Trace<'_, '_, T>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    splat: &mut impl FnMut([u32; 2], S),
) -> S {
    let limit = settings.limit();
    let mut own = S::BLACK;
    if limit == 0 {
        return own;
    }
    let Some(emission) = emit::<S, T, P>(trace, sampler) else {
        return own;
    };
    if let Some(seen) = see_light(trace, element, &emission, sampler) {
        spread(
            trace.scene,
            element,
            seen.projection.raster,
            seen.value,
            &mut own,
            splat,
        );
    }
    let mis = super::mis(settings, 0.0, 1);
    let mut walk = Walk::from_light(&emission);
    while walk.edges < limit {
        let Arrival::Vertex(vertex, _) = walk.arrive(trace, sampler, &mis) else {
            break;
        };
        if let Some(seen) = see_vertex(trace, element, &vertex, sampler) {
            spread(
                trace.scene,
                element,
                seen.projection.raster,
                seen.value,
                &mut own,
                splat,
            );
        }
        if walk.leave(&vertex, sampler).is_none() {
            break;
        }
    }
    own
}

/// x₀ and the walk's first direction.
#[inline(always)]
pub(super) fn emit<S: Spectrum, T: Tracer, P: Sampler>(
    trace: &mut Trace<'_, '_, T>,
    sampler: &mut P,
) -> Option<Emission<S>> {
    sampler.at(Subpath::Light, 0);
    let (choice, position) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
    let (direction, more) = (
        sampler.two(Purpose::Emission),
        sampler.two(Purpose::Direction),
    );
    trace.counters.light_walks += 1;
    emitter::emission(trace.scene, choice, position, direction, more)
}

/// What the sensor sees of a light walk's vertex (t = 1), before any weight.
#[cfg_attr(not(feature = "bidirectional"), allow(dead_code))]
pub(super) struct Seen<S> {
    /// Its contribution to the sensor, the pixel filter left out.
    pub value: S,
    /// Where and how it appears.
    pub projection: Projection,
    /// Density of the sensor's walk at the vertex, per area (per solid angle at infinity).
    pub density: Real,
    /// Density of the sensor's walk going on to the vertex before it.
    pub reverse: Real,
}

/// Joins the light itself to the sensor (s = 1).
#[inline(always)]
pub(super) fn see_light<S: Spectrum, T: Tracer, P: Sampler>(
    trace: &mut Trace<'_, '_, T>,
    element: &Element,
    emission: &Emission<S>,
    sampler: &mut P,
) -> Option<Seen<S>> {
    if emission.visible.is_black() {
        return None;
    }
    let lens = sampler.two(Purpose::Lens);
    let (projection, cos, ray) = if emission.distant {
        let towards = -emission.direction;
        let (projection, lens) = element.project_distant(trace.scene, towards, lens)?;
        let ray = Ray {
            origin: lens,
            direction: towards,
            t_min: 0.0,
            t_max: Real::INFINITY,
        };
        (projection, 1.0, ray)
    } else {
        let projection = element.project(trace.scene, emission.position, lens)?;
        let cos = emission.normal?.dot(projection.direction);
        let ray = Ray {
            origin: emission.origin,
            direction: projection.direction,
            t_min: 0.0,
            t_max: projection.distance,
        };
        (projection, cos, ray)
    };
    if cos <= 0.0 {
        return None;
    }
    let free = trace.visibility(ray);
    let density = projection.density * cos;
    (free > 0.0).then(|| Seen {
        value: emission.visible * (density * projection.scale * free),
        projection,
        density,
        reverse: 0.0,
    })
}

/// Joins a vertex of the walk to the sensor (s ≥ 2).
#[inline(always)]
pub(super) fn see_vertex<S: Spectrum, T: Tracer, P: Sampler>(
    trace: &mut Trace<'_, '_, T>,
    element: &Element,
    vertex: &Vertex<S>,
    sampler: &mut P,
) -> Option<Seen<S>> {
    if !vertex.surface.has_smooth() {
        return None;
    }
    let lens = sampler.two(Purpose::Lens);
    let projection = element.project(trace.scene, vertex.point.position, lens)?;
    let Joint {
        value, pdf_reverse, ..
    } = vertex.join(projection.direction, Mode::Importance)?;
    let free = trace.visibility(Ray {
        origin: vertex.point.leave(projection.direction),
        direction: projection.direction,
        t_min: 0.0,
        t_max: projection.distance,
    });
    (free > 0.0).then(|| Seen {
        value: vertex.throughput * value * (projection.density * projection.scale * free),
        projection,
        density: projection.density * projection.direction.dot(vertex.point.normal).abs(),
        reverse: pdf_reverse,
    })
}

/// Hands a contribution of a strategy with t = 1 to the pixels that see it: `own` collects it where
/// the element is no pixel. A light walk counts for the whole image, so each pixel gets 1/n of it.
#[inline(always)]
pub(super) fn spread<S: Spectrum>(
    scene: &Scene<'_>,
    element: &Element,
    raster: [Real; 2],
    value: S,
    own: &mut S,
    splat: &mut impl FnMut([u32; 2], S),
) {
    match element {
        Element::Pixel(_) => {
            let value = value * (1.0 / element.light_paths(scene));
            let sensor = scene.sensor();
            Footprint::around(sensor, raster)
                .for_each(sensor, |pixel, filter| splat(pixel, value * filter));
        }
        _ => *own += value,
    }
}
