//! Path tracing (Kajiya 1986): a walk from the sensor. At each vertex a light is sampled (s = 1) and
//! the walk itself may meet one (s = 0); the two share by MIS (Veach 1997, §9.2), with a third where small lights stand
//! in media.

use super::share::{Strategy, share};
use super::{Settings, equiangular};
use crate::blob::format::NONE;
use crate::emitter::{self, Incident};
use crate::instance::Instance;
use crate::path::{Arrival, Leg, Trace, Walk, joined};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3, square};
use crate::sensor::Element;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// Which paths are wanted, where another estimator makes the others.
pub(super) trait Wanted {
    /// What glows on the way that the walk has come.
    fn glow(&self) -> bool;
    /// The light that the walk has met, if `distant` behind all surfaces.
    fn met(&self, distant: bool) -> bool;
    /// A light drawn at the vertex where the walk is, in a volume or not.
    fn lit<S>(&self, light: &Incident<S>, in_volume: bool) -> bool;
    /// The walk has left a vertex.
    fn left(&mut self, dirac: bool, in_volume: bool);
}

/// All paths.
pub(super) struct Everything;

impl Wanted for Everything {
    #[inline(always)]
    fn glow(&self) -> bool {
        true
    }
    #[inline(always)]
    fn met(&self, _: bool) -> bool {
        true
    }
    #[inline(always)]
    fn lit<S>(&self, _: &Incident<S>, _: bool) -> bool {
        true
    }
    #[inline(always)]
    fn left(&mut self, _: bool, _: bool) {}
}

/// One sample.
#[inline(always)]
pub(super) fn estimate<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    wanted: &mut impl Wanted,
) -> K::S {
    let limit = settings.limit();
    let mut radiance = K::S::BLACK;
    if limit == 0 {
        return radiance;
    }
    let scene = trace.scene;
    let start = element.start(&scene, sampler);
    let mis = super::mis(settings, 0.0, 1);
    let medium = super::surroundings(trace, element);
    let mut walk = Walk::<K::S>::from_sensor(&start, medium, 0.0);
    // Where the walk comes from, and how it got there through a medium: the densities of having drawn a point of the light
    // for it, and it for a point of the light, compete.
    let mut from: Option<(Vec3, Option<Leg<K::S>>)> = None;
    loop {
        let before = walk.throughput;
        let (vertex, distance) = match walk.arrive(trace, sampler, &mis) {
            Arrival::Vertex(vertex, distance) => (vertex, distance),
            Arrival::Escaped(_) => {
                if K::MEDIA {
                    radiance += on_the_way(trace, settings, &walk, before, sampler, wanted);
                }
                if wanted.met(true)
                    && let Some((background, density)) =
                        emitter::background::<K::S>(scene, walk.ray.direction)
                {
                    let weight = if from.is_some() {
                        let rivals = [
                            (Strategy::Drawn, density / walked::<K>(&walk)),
                            (Strategy::Equiangular, 0.0),
                        ];
                        share::<K>(settings.heuristic, Strategy::Met, rivals)
                    } else {
                        1.0
                    };
                    radiance += walk.throughput * background * weight;
                }
                break;
            }
            Arrival::Cut => break,
        };
        if K::MEDIA {
            radiance += on_the_way(trace, settings, &walk, before, sampler, wanted);
        }
        let walked = walked::<K>(&walk);
        // s = 0.
        if wanted.met(false)
            && let Some(e) = emitter::on(&scene, vertex.point.shape)
        {
            let emitted = emitter::radiance(scene, e, &vertex.point, vertex.previous);
            if !emitted.is_black() {
                let weight = match from {
                    Some((y, leg)) => {
                        let density = emitter::connect_density(
                            &scene,
                            e,
                            &vertex.point,
                            y,
                            walk.ray.direction,
                            distance,
                        );
                        let by_angle = if K::MEDIA {
                            let cos = vertex.previous.dot(vertex.point.normal);
                            let blind = emitter::trace_density(e) * square(distance) / cos;
                            let x0 = vertex.point.position;
                            equiangular::rival(trace, leg.as_ref(), x0) * blind
                        } else {
                            0.0
                        };
                        let rivals = [
                            (Strategy::Drawn, density / walked),
                            (Strategy::Equiangular, by_angle / walked),
                        ];
                        share::<K>(settings.heuristic, Strategy::Met, rivals)
                    }
                    None => 1.0,
                };
                radiance += walk.throughput * emitted * weight;
            }
        }
        if walk.edges >= limit {
            break;
        }
        let in_volume = K::MEDIA && vertex.scattering.is_some();
        let leg = walk.leg.filter(|_| in_volume && equiangular::wanted(trace));
        // s = 1.
        if vertex.has_smooth::<K>(&scene) {
            let (choice, xi) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
            let more = sampler.two(Purpose::Emission);
            if let Some(light) =
                emitter::incident::<K::S>(scene, vertex.point.position, choice, xi, more)
                // What glows is met on the way.
                && (!K::MEDIA || light.medium == NONE)
                && wanted.lit(&light, in_volume)
                && let Some(joint) = vertex.join::<K>(&scene, light.direction, Mode::Radiance)
            {
                let sight = trace.sees(&vertex, light.direction, light.end, sampler);
                if !sight.value.is_black() {
                    let met = if light.dirac {
                        0.0
                    } else {
                        joint.pdf * sight.expected / light.pdf
                    };
                    let by_angle = match light.end {
                        Some(x0) if K::MEDIA => equiangular::rival(trace, leg.as_ref(), x0),
                        _ => 0.0,
                    };
                    let rivals = [
                        (Strategy::Met, met),
                        (Strategy::Equiangular, by_angle * light.trace_over_connect),
                    ];
                    let weight = share::<K>(settings.heuristic, Strategy::Drawn, rivals);
                    radiance += walk.throughput
                        * joint.value
                        * light.radiance
                        * joined::<K>(trace.lead, walk.ratio, K::S::WHITE, sight.value)
                        * (weight / light.pdf);
                }
            }
        }
        if scene.possible().ends(walk.edges, limit) {
            break;
        }
        let Some(step) = walk.leave(trace, &vertex, sampler) else {
            break;
        };
        wanted.left(step.dirac, in_volume);
        from = (!walk.dirac()).then_some((vertex.point.position, leg));
    }
    radiance
}

/// Density with which a walk would have come to where it is: by its direction, and through the media on the way.
#[inline(always)]
fn walked<K: Instance>(walk: &Walk<K::S>) -> Real {
    if K::MEDIA {
        walk.pdf() * walk.expected
    } else {
        walk.pdf()
    }
}

/// What the way through media brought on which `walk` is, having set off with `throughput`.
#[inline(always)]
fn on_the_way<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    walk: &Walk<K::S>,
    throughput: K::S,
    sampler: &mut P,
    wanted: &impl Wanted,
) -> K::S {
    let mut radiance = K::S::BLACK;
    if wanted.glow() {
        // What glows, by its integral along the line: no other strategy makes it.
        radiance += walk.glow;
    }
    if let Some((leg, count)) = walk.drawn
        && walk.edges < settings.limit()
    {
        radiance +=
            equiangular::estimate(trace, settings, &leg, count, throughput, sampler, wanted);
    }
    radiance
}
