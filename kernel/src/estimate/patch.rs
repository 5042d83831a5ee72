//! Light of points, spots and far stars that arrives at an irradiance sensor straight. Nobody meets such a light, and no walk has a
//! vertex before the sensor itself at which to draw one: this path of one edge is made here, for all estimators alike.

use crate::emitter;
use crate::instance::Instance;
use crate::path::{Trace, Vertex, joined};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::Vec3;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;

/// One sample; black where a light is drawn that walks can meet.
#[inline(never)]
pub(super) fn direct<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    position: Vec3,
    normal: Vec3,
    medium: u32,
    sampler: &mut P,
) -> K::S {
    sampler.at(Subpath::Sensor, 0);
    let (choice, xi) = (sampler.two(Purpose::Choice), sampler.two(Purpose::Position));
    let more = sampler.two(Purpose::Emission);
    let light = emitter::incident::<K::S>(trace.scene, position, choice, xi, more);
    let Some(light) = light.filter(|l| l.dirac) else {
        return K::S::BLACK;
    };
    let cos = light.direction.dot(normal);
    if cos <= 0.0 {
        return K::S::BLACK;
    }
    let white = K::S::WHITE;
    let vertex = Vertex::in_volume(position, normal, medium, K::S::BLACK, white, white);
    let sight = trace.sees(&vertex, light.direction, light.end, sampler);
    light.radiance * joined::<K>(trace.lead, white, white, sight.value) * (cos / light.pdf)
}
