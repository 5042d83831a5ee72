//! Splitting (Arvo & Kirk 1990) where nothing but a sensor walk that runs into the light makes the path: caustics seen in mirrors and through glass.
//!
//! ```text
//! sensor ─ Dirac … ─ y ─ Dirac … ─ light          no two neighbours that aren't Dirac: no (s, t) but s = 0
//! ```
//!
//! Such a path has weight 1. From y, n more walks look for the light through Dirac vertices, and each of the n + 1 counts 1/(n + 1), so that no weight
//! changes. Whatever else the first of them meets counts whole.

use super::Strategies;
use crate::blob::View;
use crate::emitter;
use crate::instance::Instance;
use crate::path::{Arrival, Mis, Trace, Vertex, Walk};
use crate::random::Sampler;
use crate::real::Real;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;

/// What ways there are of joining the path that a sensor walk is on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ways {
    /// Whether two neighbours so far could have been joined.
    joined: bool,
    /// Whether the last vertex, or the sensor, could be joined to the next.
    smooth: bool,
    /// Whether the last vertex that isn't Dirac is one that was split.
    split: bool,
    /// Whether the walk has left a Dirac vertex since.
    led: bool,
}

impl Ways {
    /// At the sensor, which a light walk may see or not.
    #[inline(always)]
    pub(super) fn new(seen: bool) -> Self {
        Self {
            joined: false,
            smooth: seen,
            split: false,
            led: false,
        }
    }

    /// Whether what a vertex that isn't Dirac gets by way of Dirac ones is found by s = 0 alone.
    #[inline(always)]
    pub(super) fn is_alone(&self) -> bool {
        !self.joined && !self.smooth
    }

    /// Leaves a vertex by a lobe, Dirac or not, where others left too or not.
    #[inline(always)]
    pub(super) fn leave(&mut self, dirac: bool, split: bool) {
        if dirac {
            self.led = true;
        } else {
            (self.split, self.led) = (split, false);
        }
        self.joined |= self.smooth && !dirac;
        self.smooth = !dirac;
    }

    /// What light that this walk meets now counts.
    #[inline(always)]
    pub(super) fn share(&self, more: u32) -> Real {
        if self.split && self.led {
            1.0 / (more + 1) as Real
        } else {
            1.0
        }
    }
}

/// What more walks find that leave `y` like `walk`, of the light that gets there through Dirac vertices, with their share.
#[inline(never)]
pub(super) fn again<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    mis: &Mis,
    walk: &Walk<K::S>,
    y: &Vertex<K::S>,
    limit: u32,
    wanted: &mut impl Strategies<K::S>,
    sampler: &mut P,
) {
    let more = wanted.more();
    let share = 1.0 / (more + 1) as Real;
    for _ in 0..more {
        let (mut walk, mut vertex) = (walk.aside(), *y);
        walk.announce(sampler);
        let mut led = false;
        while walk.edges < limit
            && let Some(step) = walk.leave(trace, &vertex, sampler)
            && step.dirac == led
        {
            match walk.arrive(trace, sampler, mis) {
                Arrival::Vertex(next, _) => vertex = next,
                Arrival::Escaped(_) => {
                    if led
                        && let Some((radiance, _)) =
                            emitter::background::<K::S>(trace.scene, walk.ray.direction)
                    {
                        take(wanted, &walk, walk.throughput * radiance, share, sampler);
                    }
                    break;
                }
                Arrival::Cut => break,
            }
            if led {
                let value = walk.throughput * emitted::<K>(trace.scene, &walk, &vertex);
                take(wanted, &walk, value, share, sampler);
            }
            led = true;
        }
    }
    walk.announce(sampler);
}

/// What a walk aside has found.
#[inline(always)]
fn take<S: Spectrum, P: Sampler>(
    wanted: &mut impl Strategies<S>,
    walk: &Walk<S>,
    value: S,
    share: Real,
    sampler: &mut P,
) {
    if wanted.take_aside(walk.edges as usize + 1, value, share) {
        sampler.keep();
    }
}

/// What `y`, where `walk` has arrived, emits towards where it came from.
#[inline(always)]
fn emitted<K: Instance>(scene: View<'_, '_, K::S>, walk: &Walk<K::S>, y: &Vertex<K::S>) -> K::S {
    if K::MEDIA && y.scattering.is_some() {
        return walk.emission;
    }
    let light = emitter::on(&scene, y.point.shape);
    light.map_or(K::S::BLACK, |e| {
        emitter::radiance(scene, e, &y.point, y.previous)
    })
}
