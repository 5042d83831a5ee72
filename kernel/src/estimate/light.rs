//! Light tracing: a walk from a light, each vertex joined to the sensor (t = 1). What it can't make, paths
//! that the sensor sees through a mirror or glass, it leaves black.

use super::Settings;
use crate::blob::Scene;
use crate::emitter::{self, Emission};
use crate::instance::Instance;
use crate::medium;
use crate::path::{Arrival, Joint, Trace, Vertex, Walk, joined, source_facing};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::Real;
use crate::sensor::{Element, Projection, each_pixel};
use crate::shape::{Ray, Tracer};
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// One sample.
#[inline(always)]
pub(super) fn estimate<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    splat: &mut impl FnMut([u32; 2], K::S),
) -> K::S {
    let limit = settings.limit();
    let mut own = K::S::BLACK;
    if limit == 0 {
        return own;
    }
    let Some(emission) = emit(trace, sampler) else {
        return own;
    };
    if let Some(seen) = see_light(trace, element, &emission, sampler) {
        spread(
            &trace.scene,
            element,
            seen.projection.raster,
            seen.value,
            &mut own,
            splat,
        );
    }
    let mis = super::mis(settings, 0.0, 1);
    let mut walk = Walk::from_light(trace, &emission);
    while walk.edges < limit && trace.scene.possible().joins {
        let Arrival::Vertex(vertex, _) = walk.arrive(trace, sampler, &mis) else {
            break;
        };
        if let Some(seen) = see_vertex(trace, element, &vertex, sampler) {
            spread(
                &trace.scene,
                element,
                seen.projection.raster,
                seen.value,
                &mut own,
                splat,
            );
        }
        if walk.leave(trace, &vertex, sampler).is_none() {
            break;
        }
    }
    own
}

/// x₀ and the walk's first direction. Once a walk: not worth a copy in each estimator.
#[inline(never)]
pub(super) fn emit<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    sampler: &mut P,
) -> Option<Emission<K::S>> {
    sampler.at(Subpath::Light, 0);
    let (choice, position) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
    let (direction, more) = (
        sampler.two(Purpose::Emission),
        sampler.two(Purpose::Direction),
    );
    trace.counters.light_walks += 1;
    let mut emission = emitter::emission(trace.scene, choice, position, direction, more)?;
    if K::MEDIA && (emission.volume || emission.normal.is_some()) {
        // Surfaces emit into whatever is in front of them; what glows only where it is.
        let here = trace.medium_at(emission.origin, emission.direction);
        if emission.volume && here != emission.medium {
            return None;
        }
        emission.medium = here;
    }
    Some(emission)
}

/// What the sensor sees of a light walk's vertex (t = 1), before any weight.
#[cfg_attr(not(feature = "bidirectional"), allow(dead_code))]
pub(super) struct Seen<S> {
    /// Its contribution to the sensor, the pixel filter left out.
    pub value: S,
    /// Where and how it appears.
    pub projection: Projection,
    /// Density of the sensor's walk at the vertex, per area (per volume in one, per solid angle at infinity).
    pub density: Real,
    /// Density of the sensor's walk going on to the vertex before it.
    pub reverse: Real,
}

/// Joins the light itself to the sensor (s = 1). Once a walk, as [`emit`].
#[inline(never)]
pub(super) fn see_light<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    element: &Element,
    emission: &Emission<K::S>,
    sampler: &mut P,
) -> Option<Seen<K::S>> {
    if emission.visible.is_black() {
        return None;
    }
    let lens = sampler.two(Purpose::Lens);
    let (projection, cos, ray, medium) = if emission.distant {
        let towards = -emission.direction;
        let (projection, lens) = element.project_distant(&trace.scene, towards, lens)?;
        let ray = Ray {
            origin: lens,
            direction: towards,
            t_min: 0.0,
            t_max: Real::INFINITY,
        };
        (projection, 1.0, ray, super::surroundings(trace, element))
    } else {
        let projection = element.project(&trace.scene, emission.position, lens)?;
        let cos = emission.normal.map_or(1.0, |n| n.dot(projection.direction));
        let ray = Ray {
            origin: emission.origin,
            direction: projection.direction,
            t_min: 0.0,
            t_max: projection.distance,
        };
        (projection, cos, ray, emission.medium)
    };
    if cos <= 0.0 {
        return None;
    }
    let sight = trace.visibility(ray, medium, sampler);
    if sight.value.is_black() {
        return None;
    }
    let facing = if emission.distant {
        1.0
    } else {
        source_facing(trace, emission, projection.direction)
    };
    let white = K::S::WHITE;
    let chances = if K::MEDIA && emission.volume {
        medium::chances(trace.scene, emission.medium, emission.position, trace.lead)?
    } else {
        white
    };
    Some(Seen {
        value: emission.visible
            * joined::<K>(trace.lead, chances, white, sight.value)
            * (projection.density * cos * projection.scale),
        projection,
        density: projection.density * facing * sight.expected,
        reverse: 0.0,
    })
}

/// Joins a vertex of the walk to the sensor (s ≥ 2).
#[inline(always)]
pub(super) fn see_vertex<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    element: &Element,
    vertex: &Vertex<K::S>,
    sampler: &mut P,
) -> Option<Seen<K::S>> {
    if !vertex.has_smooth::<K>(&trace.scene) {
        return None;
    }
    let lens = sampler.two(Purpose::Lens);
    let projection = element.project(&trace.scene, vertex.point.position, lens)?;
    let Joint {
        value, pdf_reverse, ..
    } = vertex.join::<K>(&trace.scene, projection.direction, Mode::Importance)?;
    let ray = Ray {
        origin: vertex.point.leave(projection.direction),
        direction: projection.direction,
        t_min: 0.0,
        t_max: projection.distance,
    };
    let medium = vertex.medium_towards(projection.direction);
    let sight = trace.visibility(ray, medium, sampler);
    (!sight.value.is_black()).then(|| Seen {
        value: vertex.throughput
            * value
            * joined::<K>(trace.lead, vertex.ratio, K::S::WHITE, sight.value)
            * (projection.density * projection.scale),
        projection,
        density: projection.density * vertex.facing(trace, projection.direction) * sight.expected,
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
            each_pixel(scene, raster, |pixel, filter| {
                splat(pixel, value * filter);
            });
        }
        _ => *own += value,
    }
}
