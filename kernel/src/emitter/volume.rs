//! Media that emit: a point drawn uniformly from a box around them, light in all directions. Whether the point lies within the
//! medium only the scene's surfaces know: who asks for light finds out on the way to it.

use super::{Emission, Incident};
use crate::blob::View;
use crate::blob::format::{Emitter, NONE};
use crate::medium;
use crate::real::{INV_PI, PI, Real, Vec3, sqrt, vec3};
use crate::spectrum::Spectrum;
use crate::warp;

/// Density per solid angle with which a light walk leaves.
pub const DIRECTION_PDF: Real = 0.25 * INV_PI;

/// A point of the box.
#[inline(always)]
fn position(e: &Emitter, xi: [Real; 3]) -> Vec3 {
    let [a, b, c] = e.to_local.map(vec3);
    vec3(e.position) + a * xi[0] + b * xi[1] + c * xi[2]
}

/// p(x₀) per volume, by any strategy.
#[inline(always)]
pub fn trace_density(e: &Emitter) -> Real {
    Real::from(e.density)
}

/// Light that arrives at `y`.
#[inline(never)] // so that what other lights fill in is not written in parts, for 0.3 % of a path
pub(super) fn incident<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    y: Vec3,
    xi: [Real; 3],
) -> Option<Incident<S>> {
    let x0 = position(e, xi);
    let to_light = x0 - y;
    let squared = to_light.length_squared();
    if squared <= 0.0 {
        return None;
    }
    let distance = sqrt(squared);
    Some(Incident {
        direction: to_light * (1.0 / distance),
        end: Some(x0),
        radiance: medium::matter(scene, scene.medium(e.medium)?, x0).1,
        // As if it faced y: p_V·d².
        pdf: trace_density(e) * squared,
        dirac: false,
        trace_over_connect: 1.0,
        emission: DIRECTION_PDF / squared,
        medium: e.medium,
    })
}

/// Light that leaves.
#[inline(always)]
pub(super) fn emission<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    xi: [Real; 3],
    direction: [Real; 2],
) -> Option<Emission<S>> {
    let position = position(e, xi);
    let trace = trace_density(e);
    let (_, emitted) = medium::matter(scene, scene.medium(e.medium)?, position);
    let visible = emitted * (1.0 / trace);
    (!visible.is_black()).then(|| Emission {
        position,
        origin: position,
        direction: warp::sphere(direction),
        normal: None,
        throughput: visible * (4.0 * PI),
        visible,
        trace,
        direction_pdf: DIRECTION_PDF,
        distant: false,
        dirac: false,
        emitter: NONE,
        primitive: NONE,
        medium: e.medium,
        volume: true,
    })
}
