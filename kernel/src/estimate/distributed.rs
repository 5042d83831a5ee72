//! Ray trees (Whitted 1980; "distributed ray tracing", Cook, Porter & Carpenter 1984): from every vertex several rays go on, fewer
//! the deeper it is, and at every vertex lights are sampled. The historical baseline: each level multiplies the work, and the tree ends at a
//! stated depth, so the estimate lacks all longer paths.
//!
//! Emitters are seen by the rays from the sensor and by those that left by a Dirac lobe; all other light comes from sampling
//! lights. So no light is counted twice, and none is left out up to the tree's depth.
//!
//! The rays of a vertex are jittered (Cook 1984, §3): of n, each has a stratum of its own of the numbers that choose the lobe and the direction. The tree is
//! walked depth first, with the vertices of one branch on a stack in the scratch, whose capacity bounds the depth as well.

use super::scratch::Workspace;
use super::{LEVELS, Settings};
use crate::blob::format::{NONE, needs};
use crate::emitter;
use crate::instance::Instance;
use crate::path::{Arrival, MAX_STEPS, Mis, Trace, Vertex, Walk, joined};
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::{ONE_MINUS, Real};
use crate::sensor::Element;
use crate::shape::Tracer;
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// One sample.
#[inline(never)]
pub(super) fn estimate<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
) -> K::S {
    let mut radiance = K::S::BLACK;
    let levels = settings.tree.levels().min(scratch.light.capacity() as u32);
    if levels < settings.tree.levels() {
        trace.counters.full_walks += 1;
    }
    // A vertex of the last level still has light sampled: an edge more than there are levels.
    let limit = settings.limit().min(levels + 1);
    if limit == 0 {
        return radiance;
    }
    let start = element.start(&trace.scene, sampler);
    let mis = super::mis(settings, 0.0, 1);
    let medium = super::surroundings(trace, element);
    let root = Walk::<K::S>::from_sensor(&start, medium, 0.0);
    let stack = &mut *scratch.light;
    stack.clear();
    let mut fans = [Fan::SPENT; LEVELS];
    let mut walk = root;
    let mut seen = true;
    // The settings may ask for more than there is time for.
    for _ in 0..MAX_STEPS {
        if let Some(vertex) = look(trace, &mut walk, sampler, &mis, seen, &mut radiance)
            && walk.edges < limit
        {
            light(trace, settings, &vertex, sampler, &mut radiance);
            let rays = settings.tree.rays(walk.edges - 1);
            if let Some(fan) = fans.get_mut(stack.len())
                && stack.push(vertex).is_ok()
            {
                *fan = Fan::open(trace, &vertex, rays, sampler);
            }
        }
        // The next ray of the deepest vertex that has one left.
        walk = loop {
            let depth = stack.len();
            let Some(vertex) = stack.last() else {
                return radiance;
            };
            let Some(fan) = fans.get_mut(depth - 1).filter(|fan| fan.left > 0) else {
                stack.pop();
                continue;
            };
            let edges = depth as u32;
            sampler.at(Subpath::Sensor, edges);
            let mut jittered = fan.jitter(sampler);
            let step = vertex.scatter::<K>(&trace.scene, Mode::Radiance, &mut jittered);
            let Some(step) = step else {
                fan.left -= 1;
                continue;
            };
            // There is no other way to go: one ray stands for all that are left.
            let rays = if step.dirac && step.pdf >= 1.0 {
                fan.left
            } else {
                1
            };
            fan.left -= rays;
            seen = step.dirac;
            // What could a last ray see that isn't made by sampling lights?
            let last = edges + 1 >= limit;
            let glows = K::MEDIA && trace.scene.has(needs::GLOWING);
            if last && !seen && !glows {
                continue;
            }
            let share = rays as Real / fan.rays as Real;
            break root.branch(trace, vertex, &step, share, edges);
        };
    }
    trace.counters.cut_walks += 1;
    radiance
}

/// Follows a ray; adds what emits along it and, if `seen`, at its end. The vertex that it meets.
#[inline(always)]
fn look<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    walk: &mut Walk<K::S>,
    sampler: &mut P,
    mis: &Mis,
    seen: bool,
    radiance: &mut K::S,
) -> Option<Vertex<K::S>> {
    let arrival = walk.arrive(trace, sampler, mis);
    if K::MEDIA {
        *radiance += walk.glow;
    }
    match arrival {
        Arrival::Vertex(vertex, _) => {
            if seen && let Some(e) = emitter::on(&trace.scene, vertex.point.shape) {
                *radiance += walk.throughput
                    * emitter::radiance(trace.scene, e, &vertex.point, vertex.previous);
            }
            Some(vertex)
        }
        Arrival::Escaped(_) => {
            let background = emitter::background::<K::S>(trace.scene, walk.ray.direction);
            if seen && let Some((background, _)) = background {
                *radiance += walk.throughput * background;
            }
            None
        }
        Arrival::Cut => None,
    }
}

/// Adds the light that arrives at `vertex`, by so many samples of all lights as the settings say.
#[inline(always)]
fn light<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    vertex: &Vertex<K::S>,
    sampler: &mut P,
    radiance: &mut K::S,
) {
    if !vertex.has_smooth::<K>(&trace.scene) {
        return;
    }
    let count = u32::from(settings.tree.lights.max(1));
    for i in 0..count {
        let [choice, fine] = sampler.two(Purpose::Choice);
        let choice = [stratum(choice, i, count), fine];
        let (xi, more) = (
            sampler.two(Purpose::Position),
            sampler.two(Purpose::Emission),
        );
        let y = vertex.point.position;
        if let Some(light) = emitter::incident::<K::S>(trace.scene, y, choice, xi, more)
            // What glows is met on the way.
            && light.medium == NONE
            && let Some(joint) = vertex.join::<K>(&trace.scene, light.direction, Mode::Radiance)
        {
            let sight = trace.sees(vertex, light.direction, light.end, sampler);
            if !sight.value.is_black() {
                *radiance += vertex.throughput
                    * joint.value
                    * light.radiance
                    * joined::<K>(trace.lead, vertex.ratio, K::S::WHITE, sight.value)
                    * (1.0 / (light.pdf * count as Real));
            }
        }
    }
}

/// The rays of one vertex.
#[derive(Clone, Copy, Debug)]
struct Fan {
    /// How many there are.
    rays: u32,
    /// How many haven't been sent yet.
    left: u32,
    /// By how many strata those of the direction are turned against those of the lobe: at random, so that together they are uniform.
    turn: u32,
}

impl Fan {
    const SPENT: Self = Self {
        rays: 0,
        left: 0,
        turn: 0,
    };

    /// Of `vertex`; where all lobes are Dirac's two rays do for reflection and refraction.
    #[inline(always)]
    fn open<T, K: Instance>(
        trace: &Trace<'_, '_, T, K>,
        vertex: &Vertex<K::S>,
        rays: u32,
        sampler: &mut impl Sampler,
    ) -> Self {
        let rays = if vertex.has_smooth::<K>(&trace.scene) {
            rays
        } else {
            rays.min(2)
        };
        Self {
            rays,
            left: rays,
            turn: (sampler.one(Purpose::Lobe) * rays as Real) as u32,
        }
    }

    /// Numbers for the next ray.
    #[inline(always)]
    fn jitter<'p, P>(&self, numbers: &'p mut P) -> Jittered<'p, P> {
        let ray = self.rays - self.left;
        let turned = ray + self.turn;
        Jittered {
            numbers,
            lobe: ray,
            direction: if turned < self.rays {
                turned
            } else {
                turned - self.rays
            },
            rays: self.rays,
        }
    }
}

/// Random numbers of which those for the lobe and the first for the direction are drawn from a stratum.
struct Jittered<'p, P> {
    numbers: &'p mut P,
    lobe: u32,
    direction: u32,
    rays: u32,
}

impl<P: Sampler> Sampler for Jittered<'_, P> {
    #[inline(always)]
    fn at(&mut self, subpath: Subpath, vertex: u32) {
        self.numbers.at(subpath, vertex);
    }

    #[inline(always)]
    fn one(&mut self, purpose: Purpose) -> Real {
        let xi = self.numbers.one(purpose);
        match purpose {
            Purpose::Lobe => stratum(xi, self.lobe, self.rays),
            _ => xi,
        }
    }

    #[inline(always)]
    fn two(&mut self, purpose: Purpose) -> [Real; 2] {
        let [x, y] = self.numbers.two(purpose);
        match purpose {
            Purpose::Direction => [stratum(x, self.direction, self.rays), y],
            _ => [x, y],
        }
    }
}

/// ξ in stratum `i` of `count`.
#[inline(always)]
fn stratum(xi: Real, i: u32, count: u32) -> Real {
    ((i as Real + xi) / count as Real).min(ONE_MINUS)
}
