//! Bidirectional path tracing (Lafortune & Willems 1993; Veach 1997, ch. 10): a walk from a light, a
//! walk from the sensor, and every way (s, t) of joining a prefix of one to a prefix of the other.
//!
//! ```text
//! s = 0   the sensor walk meets a light          s = 1   a light point drawn anew (next-event estimation)
//! t = 1   a light vertex seen by the sensor: a splat            else    connect x_{s−1} y_{t−1}
//! ```
//!
//! The light walk is stored; the sensor walk connects as it goes and keeps only what weights need. Connections that would carry little
//! of what the sample has already are looked at by Russian roulette (Veach 1997, §10.4). Where s = 0 is the only way, the sensor walk is split
//! ([`caustic`]).

mod caustic;
mod contribution;

use super::Settings;
use super::light::{Seen, emit, see_light, see_vertex, spread};
use super::scratch::Workspace;
use crate::blob::format::needs;
use crate::blob::{Possible, Scene, View};
use crate::instance::Instance;
use crate::path::{
    Arrival, HistoryView, Junction, Link, Mis, Terms, Trace, Walk, connect_first, emission_terms,
};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::Real;
use crate::sensor::Element;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use caustic::{Ways, again};
use contribution::{connect, escaped, met_light, next_event};

/// Connections that carry less than this share of their sample so far, times [`Settings::roulette`], are looked at by Russian roulette. Of 0.02 to
/// 0.2 (times 0.5) this is where fewer rays and more noise balance on SmallVCM's boxes.
pub(super) const LITTLE: Real = 0.1;

/// How many walks more leave a vertex whose light through Dirac vertices s = 0 alone can find. Efficiency with 0, 1, 4, 8, 16 of them on SmallVCM's
/// boxes 5 and 6: 4.2, 5.4, 7.2, 7.7, 7.8 and 2.8, 4.6, 6.3, 6.3, 6.4; what they cost where light is easily found (a translucent block in glass under a
/// large lamp) is 10 % with 4, 20 % with 8.
const MORE: u32 = 4;

/// Which ways of joining the walks are wanted, and where what they contribute goes.
pub(super) trait Strategies<S> {
    /// Whether this one is.
    fn has(&self, s: usize, t: usize) -> bool;
    /// Whether the light walk is the one of the sample before.
    #[inline(always)]
    fn keeps_light(&self) -> bool {
        false
    }
    /// Whether one is whose light walk, or sensor walk, has more vertices than this, and is made of that walk.
    fn has_more(&self, end: Subpath, vertices: usize) -> bool;
    /// What one of them contributes, and the share that counts: to the element, or to where the sensor sees it, to be [`spread`].
    fn take(&mut self, strategy: [usize; 2], value: S, share: Real, raster: Option<[Real; 2]>);
    /// What s = 0 contributes by a walk aside, and the share that counts; whether the walk's numbers are to be kept.
    fn take_aside(&mut self, t: usize, value: S, share: Real) -> bool;
    /// What a connection has to carry to be looked at for certain; 0: all are.
    fn little(&self) -> Real;
    /// What one that carries `share` of that, less than 1, is multiplied by if it is looked at; 0 if it isn't. 1 in the mean, where it matters.
    fn luck<P: Sampler>(&mut self, share: Real, sampler: &mut P) -> Real;
    /// How many walks more are sent where s = 0 is the only way.
    fn more(&self) -> u32;
}

/// All of them that can contribute.
struct All<'w, 's, 'a, S: Spectrum, F> {
    scene: View<'s, 'a, S>,
    element: &'w Element,
    possible: Possible,
    /// Of `sum`, what is little.
    share: Real,
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
        has_more(self.possible, end, vertices)
    }
    #[inline(always)]
    fn take(&mut self, _: [usize; 2], value: S, share: Real, raster: Option<[Real; 2]>) {
        match raster {
            None => self.sum += value * share,
            Some(raster) => {
                let Self { scene, element, .. } = self;
                spread(scene, element, raster, value, &mut self.sum, self.splat);
            }
        }
    }
    #[inline(always)]
    fn little(&self) -> Real {
        self.share * self.sum.max_channel()
    }
    #[inline(always)]
    fn luck<P: Sampler>(&mut self, share: Real, sampler: &mut P) -> Real {
        roulette(share, sampler)
    }
    #[inline(always)]
    fn take_aside(&mut self, _: usize, value: S, share: Real) -> bool {
        self.sum += value * share;
        false
    }
    #[inline(always)]
    fn more(&self) -> u32 {
        more(&self.scene, self.possible)
    }
}

/// The least probability of being looked at: 1 over it is a number, and a small one.
const LEAST: Real = 1e-6;

/// [`Strategies::luck`] by Russian roulette.
#[inline(always)]
pub(super) fn roulette<P: Sampler>(share: Real, random: &mut P) -> Real {
    let q = share.max(LEAST);
    if random.one(Purpose::Roulette) < q {
        1.0 / q
    } else {
        0.0
    }
}

/// [`Strategies::more`] of whole samples.
#[inline(always)]
pub(super) fn more(scene: &Scene<'_>, possible: Possible) -> u32 {
    let caustics = possible.meets && scene.has(needs::DIRAC);
    if caustics { MORE } else { 0 }
}

/// [`Strategies::has_more`] of all that can contribute.
#[inline(always)]
pub(super) fn has_more(possible: Possible, end: Subpath, vertices: usize) -> bool {
    end == Subpath::Sensor || vertices == 0 || possible.joins
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
        share: LITTLE * settings.roulette,
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
    if !wanted.keeps_light() {
        scratch.light.clear();
        scratch.links.clear();
        if wanted.has_more(Subpath::Light, 0) {
            light_side(trace, limit, &mis, element, wanted, sampler, scratch);
        }
    }
    if wanted.has_more(Subpath::Sensor, 1) {
        sensor_side(trace, limit, &mis, element, wanted, sampler, scratch);
    }
}

/// Nothing of the sensor walk stored yet, and what all weights have in common; `None` if there are no paths so short.
#[inline(always)]
fn begin<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    settings: &Settings,
    limit: u32,
    element: &Element,
    scratch: &mut Workspace<'_, K::S>,
) -> Option<Mis> {
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
        to.take([links.len(), 1], seen.value * weight, 1.0, raster);
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
    let more = wanted.more();
    let mut ways = Ways::new(mis.light_paths > 0.0);
    loop {
        let (vertex, distance) = match walk.arrive(trace, sampler, mis) {
            Arrival::Vertex(vertex, distance) => (vertex, distance),
            Arrival::Escaped(terms) => {
                scratch.sensor.push(link(&terms));
                let t = walk.edges as usize + 1;
                if wanted.has(0, t) {
                    let value = escaped(trace, mis, &walk, &terms, scratch.sensor);
                    wanted.take([0, t], value, ways.share(more), None);
                }
                return;
            }
            Arrival::Cut => return,
        };
        scratch.sensor.push(link(&vertex.terms));
        let t = walk.edges as usize + 1;
        if wanted.has(0, t) {
            let value = met_light(trace, mis, &walk, &vertex, from, distance, scratch.sensor);
            wanted.take([0, t], value, ways.share(more), None);
        }
        if walk.edges >= limit {
            return;
        }
        let smooth = vertex.has_smooth::<K>(&trace.scene);
        if smooth {
            if wanted.has(1, t) {
                let value = next_event(trace, mis, &vertex, t, wanted, sampler, scratch.sensor);
                wanted.take([1, t], value, 1.0, None);
            }
            for (i, x) in scratch.light.iter().enumerate() {
                // s = i + 2 light vertices and t sensor vertices make s + t − 1 edges.
                if walk.edges as usize + i + 2 > limit as usize {
                    break;
                }
                if wanted.has(i + 2, t) && x.has_smooth::<K>(&trace.scene) {
                    let (links, sensor) = (&*scratch.links, &*scratch.sensor);
                    let strategy = [i + 2, t];
                    let value = connect(
                        trace, mis, x, &vertex, strategy, wanted, sampler, links, sensor,
                    );
                    wanted.take(strategy, value, 1.0, None);
                }
            }
        }
        let ends = trace.scene.possible().ends(walk.edges, limit);
        if ends || !wanted.has_more(Subpath::Sensor, t) {
            return;
        }
        let splits = more > 0 && smooth && ways.is_alone();
        if splits {
            again(trace, mis, &walk, &vertex, limit, wanted, sampler);
        }
        let Some(step) = walk.leave(trace, &vertex, sampler) else {
            return;
        };
        ways.leave(step.dirac, splits);
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
