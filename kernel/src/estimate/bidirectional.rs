//! Bidirectional path tracing (Lafortune & Willems 1993; Veach 1997, ch. 10): a walk from a light, a
//! walk from the sensor, and every way (s, t) of joining a prefix of one to a prefix of the other.
//!
//! ```text
//! s = 0   the sensor walk meets a light          s = 1   a light point drawn anew (next-event estimation)
//! t = 1   a light vertex seen by the sensor: a splat            else    connect x_{s−1} y_{t−1}
//! ```
//!
//! The light walk is stored; the sensor walk connects as it goes and keeps only what weights need.

use super::Settings;
use super::light::{Seen, emit, see_light, see_vertex, spread};
use super::scratch::Workspace;
use crate::blob::format::NONE;
use crate::blob::{Possible, View};
use crate::emitter;
use crate::instance::Instance;
use crate::medium;
use crate::path::{
    Arrival, HistoryView, Junction, Link, Mis, Terms, Trace, Vertex, Walk, connect_first,
    emission_terms, joined,
};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::{INV_PI, Real, sqrt, square};
use crate::sensor::Element;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// Which ways of joining the walks are wanted, and where what they contribute goes.
pub(super) trait Strategies<S> {
    /// Whether this one is.
    fn has(&self, s: usize, t: usize) -> bool;
    /// Whether one is whose light walk, or sensor walk, has more vertices than this, and is made of that walk.
    fn has_more(&self, end: Subpath, vertices: usize) -> bool;
    /// What one of them contributes: to the element, or to where the sensor sees it, to be [`spread`].
    fn take(&mut self, strategy: [usize; 2], value: S, raster: Option<[Real; 2]>);
}

/// All of them that can contribute.
struct All<'w, 's, 'a, S: Spectrum, F> {
    scene: View<'s, 'a, S>,
    element: &'w Element,
    possible: Possible,
    sum: S,
    splat: &'w mut F,
}

impl<S: Spectrum, F: FnMut([u32; 2], S)> Strategies<S> for All<'_, '_, '_, S, F> {
    #[inline(always)]
    fn has(&self, _: usize, _: usize) -> bool {
        true
    }
    #[inline(always)]
    fn has_more(&self, end: Subpath, vertices: usize) -> bool {
        end == Subpath::Sensor || vertices == 0 || self.possible.joins
    }
    #[inline(always)]
    fn take(&mut self, _: [usize; 2], value: S, raster: Option<[Real; 2]>) {
        match raster {
            None => self.sum += value,
            Some(raster) => {
                let Self { scene, element, .. } = self;
                spread(scene, element, raster, value, &mut self.sum, self.splat);
            }
        }
    }
}

/// One sample.
#[inline(always)]
pub(super) fn estimate<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
    splat: &mut impl FnMut([u32; 2], K::S),
) -> K::S {
    let scene = trace.scene;
    let mut all = All {
        scene,
        element,
        possible: scene.possible(),
        sum: K::S::BLACK,
        splat,
    };
    join(
        trace,
        settings,
        settings.limit(),
        element,
        &mut all,
        sampler,
        scratch,
    );
    all.sum
}

/// Both walks, of paths of `limit` edges at most, and all ways of joining them that are wanted.
#[inline(always)]
pub(super) fn join<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    limit: u32,
    element: &Element,
    wanted: &mut impl Strategies<K::S>,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
) {
    let Some(mis) = begin(trace, settings, limit, element, scratch) else {
        return;
    };
    if wanted.has_more(Subpath::Light, 0) {
        light_side(trace, limit, &mis, element, wanted, sampler, scratch);
    }
    if wanted.has_more(Subpath::Sensor, 1) {
        sensor_side(trace, limit, &mis, element, wanted, sampler, scratch);
    }
}

/// Nothing stored yet, and what all weights have in common; `None` if there are no paths so short.
#[inline(always)]
fn begin<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    settings: &Settings,
    limit: u32,
    element: &Element,
    scratch: &mut Workspace<'_, K::S>,
) -> Option<Mis> {
    scratch.light.clear();
    scratch.links.clear();
    scratch.sensor.clear();
    let capacity = scratch.light.capacity();
    (limit > 0).then(|| super::mis(settings, element.light_paths(&trace.scene), capacity))
}

/// Walks from a light, stores the walk, and joins each of its vertices to the sensor (t = 1).
#[inline(always)]
fn light_side<T: Tracer, K: Instance, P: Sampler, W: Strategies<K::S>>(
    trace: &mut Trace<'_, '_, T, K>,
    limit: u32,
    mis: &Mis,
    element: &Element,
    wanted: &mut W,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
) {
    let Some(emission) = emit(trace, sampler) else {
        return;
    };
    let x0 = emission_terms(&emission);
    let _ = scratch.links.push(link(&x0));
    let see = |seen: Option<Seen<K::S>>,
               terms: &Terms,
               links: &[Link],
               none: &HistoryView,
               to: &mut W| {
        let Some(seen) = seen else { return };
        let junction = Junction {
            light_vertices: links.len(),
            sensor_vertices: 1,
            x_ratio: seen.density / (terms.forward * mis.light_paths),
            x_reverse: seen.reverse,
            ..Junction::default()
        };
        let weight = mis.weight(&junction, terms, &Terms::default(), links, none);
        let raster = Some(seen.projection.raster);
        to.take([links.len(), 1], seen.value * weight, raster);
    };
    let joins = |wanted: &W, s| mis.light_paths > 0.0 && wanted.has(s, 1);
    if joins(wanted, 1) {
        let seen = see_light(trace, element, &emission, sampler);
        see(seen, &x0, scratch.links, scratch.sensor, wanted);
    }
    let mut walk = Walk::from_light(trace, &emission);
    // x_i is joined to the sensor by a path of i + 1 edges.
    while walk.edges < limit && wanted.has_more(Subpath::Light, scratch.links.len()) {
        if scratch.links.is_full() {
            trace.counters.full_walks += 1;
            return;
        }
        let Arrival::Vertex(mut vertex, _) = walk.arrive(trace, sampler, mis) else {
            return;
        };
        if walk.edges == 1 {
            connect_first(trace, &emission, vertex.point.position, &mut vertex.terms);
        }
        let _ = scratch.links.push(link(&vertex.terms));
        let _ = scratch.light.push(vertex);
        if joins(wanted, scratch.links.len()) {
            let seen = see_vertex(trace, element, &vertex, sampler);
            see(seen, &vertex.terms, scratch.links, scratch.sensor, wanted);
        }
        let Some(step) = walk.leave(trace, &vertex, sampler) else {
            return;
        };
        if let [.., before, last] = scratch.links.as_mut_slice() {
            last.dirac = step.dirac;
            before.reverse = step.pdf_reverse * vertex.terms.back;
        }
    }
}

/// Walks from the sensor and joins each of its vertices to the light (s = 0, 1) and to the light walk (s ≥ 2).
#[inline(always)]
fn sensor_side<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    limit: u32,
    mis: &Mis,
    element: &Element,
    wanted: &mut impl Strategies<K::S>,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
) {
    let start = element.start(&trace.scene, sampler);
    let medium = super::surroundings(trace, element);
    let mut walk = Walk::<K::S>::from_sensor(&start, medium, mis.light_paths);
    let mut from = start.ray.origin;
    loop {
        let (vertex, distance) = match walk.arrive(trace, sampler, mis) {
            Arrival::Vertex(vertex, distance) => (vertex, distance),
            Arrival::Escaped(terms) => {
                scratch.sensor.push(link(&terms));
                if wanted.has(0, walk.edges as usize + 1) {
                    let value = escaped(trace, mis, &walk, &terms, scratch.sensor);
                    wanted.take([0, walk.edges as usize + 1], value, None);
                }
                return;
            }
            Arrival::Cut => return,
        };
        scratch.sensor.push(link(&vertex.terms));
        let t = walk.edges as usize + 1;
        if wanted.has(0, t) {
            let value = met_light(trace, mis, &walk, &vertex, from, distance, scratch.sensor);
            wanted.take([0, t], value, None);
        }
        if walk.edges >= limit {
            return;
        }
        if vertex.has_smooth::<K>(&trace.scene) {
            if wanted.has(1, t) {
                let value = next_event(trace, mis, &vertex, t, sampler, scratch.sensor);
                wanted.take([1, t], value, None);
            }
            for (i, x) in scratch.light.iter().enumerate() {
                // s = i + 2 light vertices and t sensor vertices make s + t − 1 edges.
                if walk.edges as usize + i + 2 > limit as usize {
                    break;
                }
                if wanted.has(i + 2, t) && x.has_smooth::<K>(&trace.scene) {
                    let (links, sensor) = (&*scratch.links, &*scratch.sensor);
                    let value = connect(trace, mis, x, &vertex, i + 2, t, sampler, links, sensor);
                    wanted.take([i + 2, t], value, None);
                }
            }
        }
        let ends = trace.scene.possible().ends(walk.edges, limit);
        if ends || !wanted.has_more(Subpath::Sensor, t) {
            return;
        }
        let Some(step) = walk.leave(trace, &vertex, sampler) else {
            return;
        };
        if let Some(last) = scratch.sensor.recent(0) {
            last.dirac = step.dirac;
        }
        if let Some(before) = scratch.sensor.recent(1) {
            before.reverse = step.pdf_reverse * vertex.terms.back;
        }
        from = vertex.point.position;
    }
}

#[inline(always)]
fn link(terms: &Terms) -> Link {
    Link {
        forward: terms.forward,
        reverse: 0.0,
        a: terms.a,
        dirac: false,
    }
}

/// s = 0 at infinity.
#[inline(always)]
fn escaped<T: Tracer, K: Instance>(
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
fn met_light<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    mis: &Mis,
    walk: &Walk<K::S>,
    y: &Vertex<K::S>,
    from: crate::real::Vec3,
    distance: Real,
    sensor: &HistoryView,
) -> K::S {
    let scene = trace.scene;
    #[cfg(feature = "media")]
    if K::MEDIA && y.scattering.is_some() {
        return met_glow(trace, mis, walk, y, sensor);
    }
    let Some(e) = scene
        .shape(y.point.shape)
        .and_then(|s| scene.emitter(s.emitter))
    else {
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

/// s = 1: a light point drawn for y.
#[inline(always)]
fn next_event<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    mis: &Mis,
    y: &Vertex<K::S>,
    t: usize,
    sampler: &mut P,
    sensor: &HistoryView,
) -> K::S {
    let (choice, xi) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
    let more = sampler.two(Purpose::Emission);
    let Some(light) = emitter::incident::<K::S>(trace.scene, y.point.position, choice, xi, more)
    else {
        return K::S::BLACK;
    };
    let Some(joint) = y.join::<K>(&trace.scene, light.direction, Mode::Radiance) else {
        return K::S::BLACK;
    };
    let sight = trace.sees(y, light.direction, light.end, sampler);
    if sight.value.is_black() {
        return K::S::BLACK;
    }
    let facing = y.facing(trace, light.direction);
    let mut walked = joint.pdf * sight.expected;
    let mut chances = K::S::WHITE;
    if K::MEDIA && light.medium != NONE {
        // The point has to lie in what emits, and a walk would have to collide there.
        if sight.medium != light.medium {
            return K::S::BLACK;
        }
        let at = |x0| medium::chances(trace.scene, light.medium, x0, trace.lead);
        let Some(at) = light.end.and_then(at) else {
            return K::S::BLACK;
        };
        chances = at;
        let medium = trace.scene.medium(light.medium);
        walked *= medium.map_or(0.0, |m| medium::density(trace.scene, m, trace.lead));
    }
    let x0 = Terms {
        forward: 1.0,
        a: if light.dirac { 0.0 } else { 1.0 },
        ..Terms::default()
    };
    let junction = Junction {
        light_vertices: 1,
        sensor_vertices: t,
        x_ratio: walked / light.pdf,
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
        * joined::<K>(trace.lead, y.ratio, chances, sight.value)
        * (weight / light.pdf)
}

/// s ≥ 2, t ≥ 2: joins x and y.
#[inline(always)]
#[allow(clippy::too_many_arguments)] // both ends, with their histories
fn connect<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    mis: &Mis,
    x: &Vertex<K::S>,
    y: &Vertex<K::S>,
    s: usize,
    t: usize,
    sampler: &mut P,
    light: &[Link],
    sensor: &HistoryView,
) -> K::S {
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
    let sight = trace.sees(y, direction, Some(x.point.leave(-direction)), sampler);
    if sight.value.is_black() {
        return K::S::BLACK;
    }
    let inverse_square = 1.0 / squared;
    let reached = inverse_square * sight.expected;
    let (facing_x, facing_y) = (x.facing(trace, direction), y.facing(trace, direction));
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
        * joined::<K>(trace.lead, x.ratio, y.ratio, sight.value)
        * (inverse_square * weight)
}
