//! Light that scatters once more on its way from a small light to a walk: a point x₀ of the light is drawn first, then where on the walk's
//! way it scatters, by the angle under which x₀ sees the way (Kulla & Fajardo 2012). In `path` this shares by MIS with flying
//! there and drawing a point of the light, and with flying there and meeting the light (`transport.md` §7).

use super::Settings;
use super::path::Wanted;
use super::share::{Strategy, share};
use crate::blob::format::needs;
use crate::emitter::{self, Incident};
use crate::instance::Instance;
use crate::medium::density;
use crate::path::{Equiangular, Leg, Trace, Vertex, joined};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3};
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// Density per length of having flown along `leg` to `t` and collided there, as the weights assume it.
#[inline(always)]
fn flown<T: Tracer, K: Instance>(trace: &Trace<'_, '_, T, K>, leg: &Leg<K::S>, t: Real) -> Real {
    trace.along(leg, t).map_or(0.0, |way| {
        density(way.scene, way.medium, trace.lead) * way.expected(trace.lead)
    })
}

/// p(t | x₀) by angle over p(t) by flight, where a walk collided at the end of `leg`; 0 where the one doesn't exist.
#[inline(always)]
pub(super) fn rival<T: Tracer, K: Instance>(
    trace: &Trace<'_, '_, T, K>,
    leg: Option<&Leg<K::S>>,
    x0: Vec3,
) -> Real {
    let Some(leg) = leg else { return 0.0 };
    let ratio = Equiangular::new(&leg.ray, x0).pdf(leg.t) / flown(trace, leg, leg.t);
    if ratio.is_finite() { ratio } else { 0.0 }
}

/// Whether the scene is one for it.
#[inline(always)]
pub(super) fn wanted<T: Tracer, K: Instance>(trace: &Trace<'_, '_, T, K>) -> bool {
    K::MEDIA && trace.scene.has(needs::SMALL_LIGHTS)
}

/// One sample over `leg`, which is one of `count` that the walk has gone since it left a vertex with `throughput`.
#[inline(never)]
pub(super) fn estimate<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    leg: &Leg<K::S>,
    count: u32,
    throughput: K::S,
    sampler: &mut P,
    paths: &impl Wanted,
) -> K::S {
    let mut found = || {
        let (choice, xi) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
        let source = emitter::source(&trace.scene, choice, xi)?;
        let angles = Equiangular::new(&leg.ray, source.position());
        let t = angles.sample(sampler.one(Purpose::Flight))?;
        let y = leg.ray.origin + leg.ray.direction * t;
        let light: Incident<K::S> = source.shine(trace.scene, y)?;
        paths
            .lit(&light, true)
            .then(|| (light, t, y, angles.pdf(t)))
    };
    let Some((light, t, y, by_angle)) = found() else {
        return K::S::BLACK;
    };
    let Some(way) = trace.along(leg, t) else {
        return K::S::BLACK;
    };
    let (sigma, scattering) = way.matter(t);
    let leading = sigma.channel(trace.lead);
    if scattering.is_black() || leading <= 0.0 || by_angle <= 0.0 {
        return K::S::BLACK;
    }
    let vertex = Vertex::in_volume(
        y,
        -leg.ray.direction,
        leg.medium,
        scattering,
        K::S::WHITE,
        leg.carried.ratio,
    );
    let Some(joint) = vertex.join::<K>(&trace.scene, light.direction, Mode::Radiance) else {
        return K::S::BLACK;
    };
    let sight = trace.sees(&vertex, light.direction, light.end, sampler);
    if sight.value.is_black() {
        return K::S::BLACK;
    }
    let tau = trace.transmittance(&way, sampler) * sight.value;
    // The point of the light, drawn without knowing y: per solid angle at y.
    let blind = light.pdf * light.trace_over_connect;
    let own = by_angle * blind;
    let flown = flown(trace, leg, t);
    let met = if light.dirac {
        0.0
    } else {
        flown * joint.pdf * sight.expected / own
    };
    let rivals = [
        (Strategy::Met, met),
        (Strategy::Drawn, flown * light.pdf / own),
    ];
    let weight = share::<K>(settings.heuristic, Strategy::Equiangular, rivals);
    // As if the leading channel had collided at y: p̂_k has a factor σ_k ([`joined`]).
    throughput
        * leg.carried.throughput
        * joint.value
        * light.radiance
        * joined::<K>(trace.lead, leg.carried.ratio, sigma, tau)
        * (leading * weight * count as Real / own)
}
