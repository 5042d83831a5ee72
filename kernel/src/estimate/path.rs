//! Path tracing (Kajiya 1986): a walk from the sensor. At each vertex a light is sampled (s = 1) and
//! the walk itself may meet one (s = 0); the two share by MIS (Veach 1997, §9.2).

use super::Settings;
use crate::emitter;
use crate::path::{Arrival, Heuristic, Trace, Walk};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3, square};
use crate::sensor::Element;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use crate::surface::{Local, Mode};

/// One sample.
#[inline(always)]
pub(super) fn estimate<S: Spectrum, T: Tracer, P: Sampler>(
    trace: &mut Trace<'_, '_, T>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
) -> S {
    let limit = settings.limit();
    let mut radiance = S::BLACK;
    if limit == 0 {
        return radiance;
    }
    let scene = trace.scene;
    let start = element.start(scene, sampler);
    let mis = super::mis(settings, 0.0, 1);
    let mut walk = Walk::<S>::from_sensor(&start, 0.0);
    // Where the walk comes from: the density of having sampled the light from there competes.
    let mut from: Option<Vec3> = None;
    loop {
        let (vertex, distance) = match walk.arrive(trace, sampler, &mis) {
            Arrival::Vertex(vertex, distance) => (vertex, distance),
            Arrival::Escaped(_) => {
                if let Some((background, density)) =
                    emitter::background::<S>(scene, walk.ray.direction)
                {
                    let weight = if from.is_some() {
                        share(settings.heuristic, walk.pdf(), density, true)
                    } else {
                        1.0
                    };
                    radiance += walk.throughput * background * weight;
                }
                break;
            }
            Arrival::Cut => break,
        };
        // s = 0.
        if let Some(e) = scene
            .shape(vertex.point.shape)
            .and_then(|s| scene.emitter(s.emitter))
        {
            let emitted = emitter::radiance::<S>(e, &vertex.point, vertex.previous);
            if !emitted.is_black() {
                let weight = match from {
                    Some(y) => {
                        let density = emitter::connect_density(
                            scene,
                            e,
                            &vertex.point,
                            y,
                            walk.ray.direction,
                            distance,
                        );
                        share(settings.heuristic, walk.pdf(), density, true)
                    }
                    None => 1.0,
                };
                radiance += walk.throughput * emitted * weight;
            }
        }
        if walk.edges >= limit {
            break;
        }
        // s = 1.
        if vertex.surface.has_smooth() {
            let (choice, xi) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
            let more = sampler.two(Purpose::Emission);
            if let Some(light) =
                emitter::incident::<S>(scene, vertex.point.position, choice, xi, more)
                && let Some(joint) = vertex.join(light.direction, Mode::Radiance)
            {
                let free = trace.sees(&vertex.point, light.direction, light.end);
                if free > 0.0 {
                    let weight = if light.dirac {
                        1.0
                    } else {
                        share(settings.heuristic, light.pdf, joint.pdf, false)
                    };
                    radiance += walk.throughput
                        * joint.value
                        * light.radiance
                        * (weight * free / light.pdf);
                }
            }
        }
        if walk.leave(&vertex, sampler).is_none() {
            break;
        }
        from = (!walk.dirac()).then_some(vertex.point.position);
    }
    radiance
}

/// The weight of a strategy with density `own` that shares a path with one of density `other`;
/// `first` says which of them wins a tie.
#[inline(always)]
fn share(heuristic: Heuristic, own: Real, other: Real, first: bool) -> Real {
    let ratio = other / own;
    let w = match heuristic {
        Heuristic::Balance => 1.0 / (1.0 + ratio),
        Heuristic::Power => 1.0 / (1.0 + square(ratio)),
        Heuristic::Cutoff => {
            if ratio * crate::path::CUTOFF > 1.0 {
                0.0
            } else if ratio < crate::path::CUTOFF {
                1.0
            } else {
                1.0 / (1.0 + ratio)
            }
        }
        Heuristic::Maximum => {
            if ratio < 1.0 || (ratio == 1.0 && first) {
                1.0
            } else {
                0.0
            }
        }
    };
    if w.is_finite() { w } else { 0.0 }
}
