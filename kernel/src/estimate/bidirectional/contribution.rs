//! What each strategy contributes: its value, the junction's densities, its weight.

use super::{Strategies, link};
use crate::blob::format::NONE;
use crate::emitter;
use crate::instance::Instance;
use crate::medium;
use crate::path::{HistoryView, Junction, Link, Mis, Sight, Terms, Trace, Vertex, Walk, joined};
use crate::random::{Purpose, Sampler};
use crate::real::{INV_PI, Real, Vec3, sqrt, square};
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// s = 0 at infinity.
#[inline(always)]
pub(super) fn escaped<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    mis: &Mis,
    walk: &Walk<K::S>,
    terms: &Terms,
    sensor: &HistoryView,
) -> K::S {
    let Some((radiance, density)) = emitter::background::<K::S>(trace.scene, walk.ray.direction)
    else {
        return K::S::BLACK;
    };
    let junction = Junction {
        light_vertices: 0,
        sensor_vertices: walk.edges as usize + 1,
        y_ratio: density / terms.forward,
        y_later: 1.0,
        y_reverse: emitter::disc_density(&trace.scene),
        ..Junction::default()
    };
    let weight = mis.weight(&junction, &Terms::default(), terms, &[], sensor);
    walk.throughput * radiance * weight
}

/// s = 0 on a surface.
#[inline(always)]
pub(super) fn met_light<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    mis: &Mis,
    walk: &Walk<K::S>,
    y: &Vertex<K::S>,
    from: Vec3,
    distance: Real,
    sensor: &HistoryView,
) -> K::S {
    let scene = trace.scene;
    #[cfg(feature = "media")]
    if K::MEDIA && y.scattering.is_some() {
        return met_glow(trace, mis, walk, y, sensor);
    }
    let Some(e) = emitter::on(&scene, y.point.shape) else {
        return K::S::BLACK;
    };
    let radiance = emitter::radiance(scene, e, &y.point, y.previous);
    if radiance.is_black() {
        return K::S::BLACK;
    }
    let cos = y.previous.dot(y.point.normal).abs();
    let traced = emitter::trace_density(e);
    // Seen directly, the other strategy is s = t = 1, whose light point comes from a light walk.
    let connected = if walk.edges == 1 {
        traced
    } else {
        emitter::connect_density(&scene, e, &y.point, from, walk.ray.direction, distance) * cos
            / square(distance)
    };
    let junction = Junction {
        light_vertices: 0,
        sensor_vertices: walk.edges as usize + 1,
        y_ratio: connected / y.terms.forward,
        y_later: traced / connected,
        y_reverse: cos * INV_PI,
        ..Junction::default()
    };
    let weight = mis.weight(&junction, &Terms::default(), &y.terms, &[], sensor);
    walk.throughput * radiance * weight
}

/// s = 0 in a medium that emits.
#[cfg(feature = "media")]
#[inline(always)]
fn met_glow<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    mis: &Mis,
    walk: &Walk<K::S>,
    y: &Vertex<K::S>,
    sensor: &HistoryView,
) -> K::S {
    if walk.emission.is_black() {
        return K::S::BLACK;
    }
    let [medium, _] = y.media;
    let light = trace.scene.medium(medium).map(|m| m.emitter);
    let Some(e) = light.and_then(|id| trace.scene.emitter(id)) else {
        return K::S::BLACK;
    };
    let junction = Junction {
        light_vertices: 0,
        sensor_vertices: walk.edges as usize + 1,
        y_ratio: emitter::volume::trace_density(e) / y.terms.forward,
        y_later: 1.0,
        y_reverse: emitter::volume::DIRECTION_PDF,
        ..Junction::default()
    };
    let weight = mis.weight(&junction, &Terms::default(), &y.terms, &[], sensor);
    walk.throughput * walk.emission * weight
}

/// What a connection of `y` carries, towards a point in `medium`: `carried` says it for what there is in between. What carries little even
/// if that is nothing is looked at with luck ([`Strategies::luck`]).
#[inline(always)]
#[allow(clippy::too_many_arguments)] // a way, and who asks
fn look<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    y: &Vertex<K::S>,
    direction: Vec3,
    end: Option<Vec3>,
    medium: u32,
    wanted: &mut impl Strategies<K::S>,
    sampler: &mut P,
    carried: impl Fn(&Sight<K::S>) -> K::S,
) -> K::S {
    let (mut most, mut scale, little) = (K::S::BLACK, 1.0, wanted.little());
    if !K::MEDIA || little > 0.0 {
        // The less media let through, the more this strategy weighs: at most as if no walk could come this way.
        most = carried(&Sight {
            expected: if K::MEDIA { 0.0 } else { 1.0 },
            medium,
            ..Sight::FREE
        });
        let share = most.max_channel() / little;
        if share < 1.0 {
            scale = wanted.luck(share, sampler);
            if scale <= 0.0 {
                return K::S::BLACK;
            }
        }
    }
    let sight = trace.sees(y, direction, end, sampler);
    if sight.value.is_black() {
        return K::S::BLACK;
    }
    if K::MEDIA {
        carried(&sight) * scale
    } else {
        most * sight.value * scale
    }
}

/// s = 1: a light point drawn for y.
#[inline(always)]
#[allow(clippy::too_many_arguments)] // an end, with its history
pub(super) fn next_event<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    mis: &Mis,
    y: &Vertex<K::S>,
    t: usize,
    wanted: &mut impl Strategies<K::S>,
    sampler: &mut P,
    sensor: &HistoryView,
) -> K::S {
    let (scene, lead) = (trace.scene, trace.lead);
    let (choice, xi) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
    let more = sampler.two(Purpose::Emission);
    let Some(light) = emitter::incident::<K::S>(scene, y.point.position, choice, xi, more) else {
        return K::S::BLACK;
    };
    let Some(joint) = y.join::<K>(&scene, light.direction, Mode::Radiance) else {
        return K::S::BLACK;
    };
    let facing = y.facing(trace, light.direction);
    let (mut density, mut chances) = (1.0, K::S::WHITE);
    if K::MEDIA && light.medium != NONE {
        // A walk would have to collide there.
        let at = |x0| medium::chances(scene, light.medium, x0, lead);
        let Some(at) = light.end.and_then(at) else {
            return K::S::BLACK;
        };
        chances = at;
        let medium = scene.medium(light.medium);
        density = medium.map_or(0.0, |m| medium::density(scene, m, lead));
    }
    let x0 = Terms {
        forward: 1.0,
        a: if light.dirac { 0.0 } else { 1.0 },
        ..Terms::default()
    };
    let carried = |sight: &Sight<K::S>| {
        // The point has to lie in what emits.
        if K::MEDIA && light.medium != NONE && sight.medium != light.medium {
            return K::S::BLACK;
        }
        let junction = Junction {
            light_vertices: 1,
            sensor_vertices: t,
            x_ratio: joint.pdf * sight.expected * density / light.pdf,
            x_reverse: 0.0,
            y_ratio: light.trace_over_connect * light.emission * facing * sight.expected
                / y.terms.forward,
            y_later: 1.0,
            y_reverse: joint.pdf_reverse,
        };
        let weight = mis.weight(&junction, &x0, &y.terms, &[link(&x0)], sensor);
        y.throughput
            * joint.value
            * light.radiance
            * joined::<K>(lead, y.ratio, chances, sight.value)
            * (weight / light.pdf)
    };
    let medium = light.medium;
    look(
        trace,
        y,
        light.direction,
        light.end,
        medium,
        wanted,
        sampler,
        carried,
    )
}

/// s ≥ 2, t ≥ 2: joins x and y.
#[inline(always)]
#[allow(clippy::too_many_arguments)] // both ends, with their histories
pub(super) fn connect<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    mis: &Mis,
    x: &Vertex<K::S>,
    y: &Vertex<K::S>,
    [s, t]: [usize; 2],
    wanted: &mut impl Strategies<K::S>,
    sampler: &mut P,
    light: &[Link],
    sensor: &HistoryView,
) -> K::S {
    let lead = trace.lead;
    let to_x = x.point.position - y.point.position;
    let squared = to_x.dot(to_x);
    if squared <= 0.0 {
        return K::S::BLACK;
    }
    let direction = to_x * (1.0 / sqrt(squared));
    let Some(at_y) = y.join::<K>(&trace.scene, direction, Mode::Radiance) else {
        return K::S::BLACK;
    };
    let Some(at_x) = x.join::<K>(&trace.scene, -direction, Mode::Importance) else {
        return K::S::BLACK;
    };
    let inverse_square = 1.0 / squared;
    let (facing_x, facing_y) = (x.facing(trace, direction), y.facing(trace, direction));
    let carried = |sight: &Sight<K::S>| {
        let reached = inverse_square * sight.expected;
        let junction = Junction {
            light_vertices: s,
            sensor_vertices: t,
            x_ratio: at_y.pdf * facing_x * reached / x.terms.forward,
            x_reverse: at_x.pdf_reverse,
            y_ratio: at_x.pdf * facing_y * reached / y.terms.forward,
            y_later: 1.0,
            y_reverse: at_y.pdf_reverse,
        };
        let weight = mis.weight(&junction, &x.terms, &y.terms, light, sensor);
        x.throughput
            * at_x.value
            * y.throughput
            * at_y.value
            * joined::<K>(lead, x.ratio, y.ratio, sight.value)
            * (inverse_square * weight)
    };
    let end = Some(x.point.leave(-direction));
    look(trace, y, direction, end, NONE, wanted, sampler, carried)
}
