//! Points: isotropic, and spots whose intensity falls off linearly in angle.

use super::{Emission, Incident};
use crate::blob::View;
use crate::blob::format::{Emitter, NONE, emitter as kind};
use crate::real::{INV_PI, PI, Real, Vec3, acos, vec3};
use crate::spectrum::Spectrum;
use crate::warp;

/// Factor of the intensity towards `direction` (away from the light): 1, or the spot's fall-off.
#[inline(always)]
fn falloff(e: &Emitter, direction: Vec3) -> Real {
    if e.kind == kind::POINT {
        return 1.0;
    }
    let cos = direction.dot(vec3(e.direction)).clamp(-1.0, 1.0);
    let (inner, outer) = (Real::from(e.cos_inner), Real::from(e.cos_outer));
    if cos >= inner {
        1.0
    } else if cos <= outer {
        0.0
    } else {
        (acos(outer) - acos(cos)) / (acos(outer) - acos(inner))
    }
}

/// Density per solid angle with which a light walk leaves towards `direction`.
#[inline(always)]
fn direction_pdf(e: &Emitter, direction: Vec3) -> Real {
    if e.kind == kind::POINT {
        return 0.25 * INV_PI;
    }
    let outer = Real::from(e.cos_outer);
    if direction.dot(vec3(e.direction)) < outer {
        0.0
    } else {
        0.5 * INV_PI / (1.0 - outer)
    }
}

/// Light that arrives at `y`.
#[inline(always)]
pub(super) fn incident<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    y: Vec3,
) -> Option<Incident<S>> {
    let to_light = vec3(e.position) - y;
    let square = to_light.length_squared();
    if square <= 0.0 {
        return None;
    }
    let distance = crate::real::sqrt(square);
    let direction = to_light * (1.0 / distance);
    let factor = falloff(e, -direction);
    if factor <= 0.0 {
        return None;
    }
    Some(Incident {
        direction,
        end: Some(vec3(e.position)),
        radiance: scene.emitted(e) * (factor / square),
        pdf: Real::from(e.density),
        dirac: true,
        trace_over_connect: 1.0,
        emission: direction_pdf(e, -direction) / square,
        medium: NONE,
    })
}

/// Light that leaves: uniform over the sphere, or over the spot's cone.
#[inline(always)]
pub(super) fn emission<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    xi: [Real; 2],
) -> Option<Emission<S>> {
    let direction = if e.kind == kind::POINT {
        warp::sphere(xi)
    } else {
        let frame = crate::real::Frame::around(vec3(e.direction));
        frame.world(warp::cone(1.0 - Real::from(e.cos_outer), xi))
    };
    let direction_pdf = if e.kind == kind::POINT {
        0.25 * INV_PI
    } else {
        1.0 / (2.0 * PI * (1.0 - Real::from(e.cos_outer)))
    };
    let trace = Real::from(e.density);
    let position = vec3(e.position);
    let throughput = scene.emitted(e) * (falloff(e, direction) / (trace * direction_pdf));
    (!throughput.is_black()).then_some(Emission {
        position,
        origin: position,
        direction,
        normal: None,
        throughput,
        visible: S::BLACK,
        trace,
        direction_pdf,
        distant: false,
        dirac: true,
        emitter: NONE,
        primitive: NONE,
        medium: e.medium,
        volume: false,
    })
}
