//! Deterministic quadrature (`transport.md` §7). It makes
//!
//! ```text
//! emission   what the sensor sees directly, or through Dirac lobes alone, of which reflection and refraction are both followed
//! direct     light of area, point, spot and directional lights at the surfaces seen so: tensor Gauss–Legendre rules over every emitting
//!            triangle and sphere, the others exactly
//! single     light of point, spot and directional lights scattered once on the way to these surfaces: the trapezoid rule, along
//!            the line or (points, spots) in the angle under which the light sees it (Kulla & Fajardo 2012, §4.1), where 1/d² cancels
//! ```
//!
//! with transmittance in closed form or by regular tracking, and leaves out all else: it is biased by that, and by what its rules
//! miss, which shrinks with their order. [`Rest`] tells a path tracer which paths these are. What stays random is where in its filter and
//! on its lens a pixel looks, and whether a mask in between is there.

use super::path::{self, Wanted};
use super::rule::{Nodes, shift};
use super::scratch::Workspace;
use super::{LEVELS, Rule, Settings};
use crate::blob::Scene;
use crate::blob::format::{Choice, NONE, emitter as kind, needs};
use crate::emitter::{self, Incident};
use crate::instance::Instance;
use crate::medium::Way;
use crate::path::{MAX_STEPS, Meeting, Trace, Vertex};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3, atan2, square, tan, vec3};
use crate::sensor::Element;
use crate::shape::{Ray, Tracer};
use crate::spectrum::Spectrum;
use crate::surface::Mode;

/// Whether there is a light that the quadrature makes nothing of at surfaces.
pub(super) fn leaves_out_a_light(scene: &Scene<'_>) -> bool {
    scene.world().background != NONE || scene.has(needs::GLOWING)
}

/// What there is to know while one sample is made.
struct Sum<'r, S> {
    rule: &'r Rule,
    radiance: S,
    /// Evaluations that are left.
    left: u32,
}

/// A line of sight.
struct Line<S> {
    ray: Ray,
    throughput: S,
    /// p_k/p̄ by channel ([`crate::medium`]).
    ratio: S,
    medium: u32,
}

/// One sample.
#[inline(never)]
pub(super) fn estimate<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
) -> K::S {
    let rule = &settings.rule;
    let limit = settings.limit();
    let mut sum = Sum {
        rule,
        radiance: K::S::BLACK,
        left: MAX_STEPS,
    };
    if limit == 0 {
        return sum.radiance;
    }
    trace.exact = true;
    let medium = super::surroundings(trace, element);
    if let Element::Irradiance { position, normal } = *element {
        sum.patch(trace, position, normal, medium, sampler);
    } else {
        let start = element.start(&trace.scene, sampler);
        let first = Line {
            ray: start.ray,
            throughput: K::S::grey(start.scale),
            ratio: K::S::WHITE,
            medium,
        };
        let depth = depth(rule, scratch);
        sum.follow(trace, first, limit, depth, sampler, scratch);
    }
    if sum.left == 0 {
        trace.counters.cut_walks += 1;
    }
    trace.exact = false;
    sum.radiance
}

/// One sample of all light: what isn't made here by path tracing.
#[inline(never)]
pub(super) fn and_path<T: Tracer, K: Instance, P: Sampler>(
    trace: &mut Trace<'_, '_, T, K>,
    settings: &Settings,
    element: &Element,
    sampler: &mut P,
    scratch: &mut Workspace<'_, K::S>,
) -> K::S {
    let mut sum = estimate(trace, settings, element, sampler, scratch);
    let rest = &mut Rest::of(element, &settings.rule, scratch);
    sum += path::estimate(trace, settings, element, sampler, rest);
    sum
}

/// How many Dirac lobes one after the other are followed.
#[inline(always)]
fn depth<S: Spectrum>(rule: &Rule, scratch: &Workspace<'_, S>) -> usize {
    usize::from(rule.depth)
        .min(LEVELS)
        .min(scratch.light.capacity())
}

impl<S: Spectrum> Sum<'_, S> {
    /// Takes note of an evaluation; false if that was one too many.
    #[inline(always)]
    fn count(&mut self) -> bool {
        self.left = self.left.saturating_sub(1);
        self.left > 0
    }

    /// The line of sight `line` and all that follow from it by Dirac lobes: depth first, with the vertices of one chain
    /// on the stack.
    #[inline(always)]
    fn follow<T: Tracer, K: Instance<S = S>>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        mut line: Line<S>,
        limit: u32,
        depth: usize,
        sampler: &mut impl Sampler,
        scratch: &mut Workspace<'_, S>,
    ) {
        let stack = &mut *scratch.light;
        stack.clear();
        let mut parts = [0; LEVELS];
        while self.count() {
            let further = (stack.len() as u32).saturating_add(1) < limit;
            if let Some(vertex) = self.look(trace, line, further, sampler)
                && further
            {
                if vertex.has_smooth::<K>(&trace.scene) {
                    self.direct(trace, &vertex, sampler);
                }
                if stack.len() < depth
                    && let Some(part) = parts.get_mut(stack.len())
                    && stack.push(vertex).is_ok()
                {
                    *part = 0;
                }
            }
            // The next Dirac lobe of the last vertex that has one left.
            line = loop {
                let level = stack.len().wrapping_sub(1);
                let (Some(vertex), Some(part)) = (stack.last(), parts.get_mut(level)) else {
                    return;
                };
                let Some(step) = vertex.dirac_lobe::<K>(&trace.scene, *part) else {
                    stack.pop();
                    continue;
                };
                *part += 1;
                let mut ratio = vertex.ratio;
                let throughput = vertex.throughput * step.taken::<K>(&mut ratio);
                if throughput.is_black() {
                    continue;
                }
                break Line {
                    ray: Ray {
                        origin: vertex.point.leave(step.direction),
                        direction: step.direction,
                        t_min: 0.0,
                        t_max: Real::INFINITY,
                    },
                    throughput,
                    ratio,
                    medium: vertex.medium_towards(step.direction),
                };
            };
        }
    }

    /// Follows a line of sight to a surface: adds what emits on the way and at its end and, if paths may be one edge longer, what the
    /// media on the way scatter.
    #[inline(always)]
    fn look<T: Tracer, K: Instance<S = S>>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        line: Line<S>,
        further: bool,
        sampler: &mut impl Sampler,
    ) -> Option<Vertex<S>> {
        let Line {
            ray,
            mut throughput,
            ratio,
            mut medium,
        } = line;
        let mut numbers = Numbers(sampler.one(Purpose::Flight));
        let meeting = trace.straight(ray, &mut medium, sampler, |trace, way, medium, margin| {
            let scattered = self.way(trace, way, (medium, margin), further, &mut numbers);
            self.radiance += throughput * scattered;
            throughput *= way.exact();
        });
        match meeting {
            Meeting::Surface(point, _) => {
                let previous = -ray.direction;
                let scene = trace.scene;
                if let Some(e) = emitter::on(&scene, point.shape) {
                    self.radiance += throughput * emitter::radiance(scene, e, &point, previous);
                }
                let mut vertex =
                    Vertex::on_surface(trace, point, previous, medium, throughput, ratio, sampler);
                if K::MEDIA {
                    vertex.look_around(&scene);
                }
                Some(vertex)
            }
            Meeting::Escaped => {
                if let Some((seen, _)) = emitter::background::<S>(trace.scene, ray.direction) {
                    self.radiance += throughput * seen;
                }
                None
            }
            _ => None,
        }
    }

    /// Direct light at `vertex`.
    #[inline(never)]
    fn direct<T: Tracer, K: Instance<S = S>>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        vertex: &Vertex<S>,
        sampler: &mut impl Sampler,
    ) {
        self.lights(
            trace,
            vertex.point.position,
            sampler,
            |trace, light, sampler| {
                let joint = vertex.join::<K>(&trace.scene, light.direction, Mode::Radiance)?;
                let sight = trace.sees(vertex, light.direction, light.end, sampler);
                Some(vertex.throughput * joint.value * sight.value)
            },
        );
    }

    /// Irradiance at a point, whose sensor scatters in its way: direct light alone.
    #[inline(never)]
    fn patch<T: Tracer, K: Instance<S = S>>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        position: Vec3,
        normal: Vec3,
        medium: u32,
        sampler: &mut impl Sampler,
    ) {
        let vertex = Vertex::in_volume(position, normal, medium, S::BLACK, S::WHITE, S::WHITE);
        self.lights(trace, position, sampler, |trace, light, sampler| {
            let cos = light.direction.dot(normal);
            if cos <= 0.0 {
                return None;
            }
            let sight = trace.sees(&vertex, light.direction, light.end, sampler);
            Some(sight.value * cos)
        });
    }

    /// Adds up all lights that arrive at `y`, by what `response` says of light that arrives.
    #[inline(always)]
    fn lights<T: Tracer, K: Instance<S = S>, P: Sampler>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        y: Vec3,
        sampler: &mut P,
        mut response: impl FnMut(&mut Trace<'_, '_, T, K>, &Incident<S>, &mut P) -> Option<S>,
    ) {
        let scene = trace.scene;
        for choice in scene.choices() {
            let Some(emitter) = scene.emitter(choice.emitter) else {
                continue;
            };
            let across = match emitter.kind {
                kind::POINT | kind::SPOT | kind::DIRECTIONAL => None,
                kind::AREA => Some(rules(&scene, choice, self.rule, sampler)),
                _ => continue,
            };
            // By every choice its own rule: nothing is left to chance, so its probability cancels.
            let probability = emitter::probability(&scene, choice);
            let mut add = |xi: [Real; 2], weight: Real| {
                if !self.count() {
                    return;
                }
                let light = emitter::incident_from::<S>(scene, choice, y, xi, [0.0; 2]);
                if let Some(light) = light
                    && let Some(f) = response(trace, &light, sampler)
                {
                    self.radiance += f * light.radiance * (weight * probability / light.pdf);
                }
            };
            let Some((a, b, triangle)) = across else {
                add([0.0; 2], 1.0);
                continue;
            };
            for i in 0..a.count() {
                let (x, wx) = a.get(i);
                for j in 0..b.count() {
                    let (y, wy) = b.get(j);
                    if triangle {
                        let (xi, jacobian) = collapsed(x, y);
                        add(xi, wx * wy * jacobian);
                    } else {
                        add([x, y], wx * wy);
                    }
                }
            }
        }
    }

    /// What the way through `medium` sends back along itself: what it emits and, if `further`, what it scatters of point, spot
    /// and directional lights. `margin` before its end a point is certainly still inside.
    #[inline(never)]
    fn way<T: Tracer, K: Instance<S = S>>(
        &mut self,
        trace: &mut Trace<'_, '_, T, K>,
        way: &Way<'_, '_, S>,
        (medium, margin): (u32, Real),
        further: bool,
        sampler: &mut impl Sampler,
    ) -> S {
        let Some((start, end)) = way.extent() else {
            return S::BLACK;
        };
        // What ends the way is as far as rounding says; no node may lie behind it, where other lights shine.
        let inside = (end - margin).max(0.5 * (start + end));
        let steps = self.rule.steps.max(1);
        let part = shift(self.rule, sampler);
        let mut found = S::BLACK;
        if let Some(glow) = way.shine() {
            found += glow;
        } else if let Some(even) = Steps::even(start, end) {
            found += self.trapezoid(way, (start, end, inside), &even, steps, part, |_, t| {
                Some(way.emission(t))
            });
        }
        if !further {
            return found;
        }
        let scene = trace.scene;
        for choice in scene.choices() {
            let Some(emitter) = scene.emitter(choice.emitter) else {
                continue;
            };
            let nodes = match emitter.kind {
                kind::POINT | kind::SPOT => {
                    Steps::around(&way.ray, vec3(emitter.position), start, end)
                }
                kind::DIRECTIONAL => Steps::even(start, end),
                _ => None,
            };
            let Some(nodes) = nodes else { continue };
            let probability = emitter::probability(&scene, choice);
            found += self.trapezoid(way, (start, end, inside), &nodes, steps, part, |x, t| {
                let (_, scattering) = way.matter(t);
                if scattering.is_black() {
                    return None;
                }
                let light = emitter::incident_from::<S>(scene, choice, x, [0.0; 2], [0.0; 2])?;
                let vertex = Vertex::in_volume(
                    x,
                    -way.ray.direction,
                    medium,
                    scattering,
                    S::WHITE,
                    S::WHITE,
                );
                let joint = vertex.join::<K>(&scene, light.direction, Mode::Radiance)?;
                let sight = trace.sees(&vertex, light.direction, light.end, sampler);
                Some(joint.value * light.radiance * sight.value * (probability / light.pdf))
            });
        }
        found
    }

    /// ∫f·τ over `way` by `steps` steps: the trapezoid rule, or the same steps moved on by `part`.
    #[inline(always)]
    fn trapezoid(
        &mut self,
        way: &Way<'_, '_, S>,
        (start, end, inside): (Real, Real, Real),
        nodes: &Steps,
        steps: u16,
        part: Real,
        mut f: impl FnMut(Vec3, Real) -> Option<S>,
    ) -> S {
        let mut sum = S::BLACK;
        let mut through = S::WHITE;
        let mut before = 0.0;
        let inverse = 1.0 / Real::from(steps);
        // Ends count half, but not where all is shifted.
        let last = if self.rule.shift { steps - 1 } else { steps };
        for i in 0..=last {
            if !self.count() {
                break;
            }
            let (u, weight) = if self.rule.shift {
                (Real::from(i) + 0.5 + part, 1.0)
            } else if i == 0 || i == steps {
                (Real::from(i), 0.5)
            } else {
                (Real::from(i), 1.0)
            };
            let (t, length) = nodes.at((u * inverse).clamp(0.0, 1.0));
            if !(t.is_finite() && length.is_finite()) {
                continue;
            }
            // `clamp` would ask for an order of its bounds.
            let t = t.min(end).max(start);
            through *= way.between(before, t).exact();
            before = t;
            let at = t.min(inside).max(start);
            if let Some(value) = f(way.ray.origin + way.ray.direction * at, t) {
                sum += value * through * (weight * length * inverse);
            }
        }
        sum
    }
}

/// A number that a rule is shifted by, the same along a line of sight.
struct Numbers(Real);

impl Sampler for Numbers {
    #[inline(always)]
    fn at(&mut self, _: crate::random::Subpath, _: u32) {}
    #[inline(always)]
    fn one(&mut self, _: Purpose) -> Real {
        self.0
    }
}

/// The rules across the emitting primitive of `choice` in both directions, and whether it is a triangle.
#[inline(always)]
fn rules(
    scene: &Scene<'_>,
    choice: &Choice,
    rule: &Rule,
    sampler: &mut impl Sampler,
) -> (Nodes, Nodes, bool) {
    let a = Nodes::gauss(rule, sampler);
    if scene.sphere(choice.primitive).is_some() {
        // Around the axis all is periodic.
        (a, Nodes::steps(rule, sampler), false)
    } else {
        (a, Nodes::gauss(rule, sampler), true)
    }
}

/// From the square to a triangle, smoothly (Duffy 1982): barycentric (u, v) = (a(1 − b), ab), whose area is 2a relative to the mean. As the numbers
/// from which [`crate::warp::triangle`] makes them.
#[inline(always)]
fn collapsed(a: Real, b: Real) -> ([Real; 2], Real) {
    let (u, v) = (a * (1.0 - b), a * b);
    let xi = if v > u {
        [2.0 * u, u + v]
    } else {
        [u + v, 2.0 * v]
    };
    (xi, 2.0 * a)
}

/// A variable that goes over a way as it goes from 0 to 1.
enum Steps {
    /// The distance.
    Even { start: Real, length: Real },
    /// The angle under which a point sees it: `nearest` is where the line passes it, at distance `off`.
    Around {
        nearest: Real,
        off: Real,
        first: Real,
        angle: Real,
    },
}

impl Steps {
    /// `None` over an infinite way.
    #[inline(always)]
    fn even(start: Real, end: Real) -> Option<Self> {
        let length = end - start;
        (length > 0.0 && length.is_finite()).then_some(Self::Even { start, length })
    }

    /// About `light`; by distance where it lies on the line, all but.
    #[inline(always)]
    fn around(ray: &Ray, light: Vec3, start: Real, end: Real) -> Option<Self> {
        let to_light = light - ray.origin;
        let nearest = to_light.dot(ray.direction);
        let off = (to_light - ray.direction * nearest).length();
        if off <= 1e-6 * to_light.length() {
            return Self::even(start, end);
        }
        let first = atan2(start - nearest, off);
        let last = atan2(end - nearest, off);
        (last > first).then_some(Self::Around {
            nearest,
            off,
            first,
            angle: last - first,
        })
    }

    /// The distance at `u`, and how it grows with u.
    #[inline(always)]
    fn at(&self, u: Real) -> (Real, Real) {
        match *self {
            Self::Even { start, length } => (start + length * u, length),
            Self::Around {
                nearest,
                off,
                first,
                angle,
            } => {
                let s = off * tan(first + angle * u);
                // dt = D/cos²θ dθ = (D² + s²)/D dθ.
                let growth = (square(off) + square(s)) / off * angle;
                (nearest + s, growth)
            }
        }
    }
}

/// Which paths [`estimate`] doesn't make.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    depth: usize,
    stage: Stage,
}

/// How a walk from the sensor has begun.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// By so many Dirac lobes, all of surfaces.
    Seen(usize),
    /// By these, then by a lobe that isn't Dirac, on a surface or in a volume: the edge after it.
    Lit { in_volume: bool },
    /// Any other way.
    Other,
}

impl Rest {
    /// For walks from `element`.
    pub fn of<S: Spectrum>(element: &Element, rule: &Rule, scratch: &Workspace<'_, S>) -> Self {
        Self {
            depth: depth(rule, scratch),
            stage: match element {
                Element::Irradiance { .. } => Stage::Lit { in_volume: false },
                _ => Stage::Seen(0),
            },
        }
    }
}

impl Wanted for Rest {
    #[inline(always)]
    fn glow(&self) -> bool {
        !matches!(self.stage, Stage::Seen(_))
    }

    #[inline(always)]
    fn met(&self, distant: bool) -> bool {
        match self.stage {
            Stage::Seen(_) => false,
            Stage::Lit { in_volume } => distant || in_volume,
            Stage::Other => true,
        }
    }

    #[inline(always)]
    fn lit<S>(&self, light: &Incident<S>, in_volume: bool) -> bool {
        match self.stage {
            // A light of some size that isn't at infinity is an area.
            Stage::Seen(_) => !light.dirac && (in_volume || light.end.is_none()),
            _ => true,
        }
    }

    #[inline(always)]
    fn left(&mut self, dirac: bool, in_volume: bool) {
        self.stage = match self.stage {
            Stage::Seen(_) if !dirac => Stage::Lit { in_volume },
            Stage::Seen(n) if !in_volume && n < self.depth => Stage::Seen(n + 1),
            _ => Stage::Other,
        };
    }
}
