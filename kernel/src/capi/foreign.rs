//! The caller's own ray tracer and random numbers as the kernel's (feature `capi`, not `capi-core`).

use super::hooks::{EtdHit, EtdHooks, EtdRay};
use crate::blob::Scene;
use crate::estimate::Settings;
use crate::random::{self, Purpose, Sampler, Subpath};
use crate::real::{ONE_MINUS, Real};
use crate::shape::{Hit, Ray, Tracer, Tree};

/// The caller's ray tracer, or ours. Asked at every ray, as [`Tree`] asks for its instruction set: the estimators are compiled once for both.
pub(super) enum Rays<'h> {
    Own(Tree<'h>),
    Foreign(&'h EtdHooks),
}

impl<'h> Rays<'h> {
    /// The caller's, if there is one; otherwise the scene's.
    pub(super) fn new(hooks: &'h EtdHooks, scene: &Scene<'h>) -> Self {
        if hooks.closest.is_some() {
            Rays::Foreign(hooks)
        } else {
            Rays::Own(scene.tree())
        }
    }
}

impl Tracer for Rays<'_> {
    #[inline(always)]
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Rays::Own(tree) => tree.closest(ray),
            Rays::Foreign(hooks) => closest(hooks, ray),
        }
    }
    #[inline(always)]
    fn occluded(&self, ray: &Ray) -> bool {
        match self {
            Rays::Own(tree) => tree.occluded(ray),
            Rays::Foreign(hooks) => occluded(hooks, ray),
        }
    }
}

fn outward(ray: &Ray) -> EtdRay {
    EtdRay {
        struct_size: size_of::<EtdRay>() as u32,
        reserved: 0,
        origin: ray.origin.to_array(),
        direction: ray.direction.to_array(),
        t_min: ray.t_min,
        t_max: ray.t_max,
    }
}

#[inline(never)]
fn closest(hooks: &EtdHooks, ray: &Ray) -> Option<Hit> {
    let closest = hooks.closest?;
    let mut hit = EtdHit {
        struct_size: size_of::<EtdHit>() as u32,
        primitive: u32::MAX,
        t: 0.0,
        u: 0.0,
        v: 0.0,
    };
    // SAFETY: the caller's function, called as it is documented, with a ray and a hit that live.
    let found = unsafe { closest(hooks.user, &outward(ray), &mut hit) } != 0;
    // NaN is in no range.
    let inside = hit.t > ray.t_min && hit.t < ray.t_max;
    let unit = |x: Real| if x > 0.0 { x.min(1.0) } else { 0.0 };
    let u = unit(hit.u);
    (found && inside).then(|| Hit {
        t: hit.t,
        primitive: hit.primitive,
        u,
        v: unit(hit.v).min(1.0 - u),
    })
}

#[inline(never)]
fn occluded(hooks: &EtdHooks, ray: &Ray) -> bool {
    hooks.occluded.is_some_and(|occluded| {
        // SAFETY: the caller's function, called as it is documented, with a ray that lives.
        unsafe { occluded(hooks.user, &outward(ray)) != 0 }
    })
}

/// The caller's random numbers, or ours.
pub(super) enum Numbers<'h> {
    Own(random::Numbers),
    Foreign {
        hooks: &'h EtdHooks,
        subpath: u32,
        vertex: u32,
    },
}

impl<'h> Numbers<'h> {
    /// The caller's, if there are any; otherwise those of this element and sample.
    pub(super) fn new(hooks: &'h EtdHooks, settings: &Settings, id: u64, index: u64) -> Self {
        if hooks.random.is_some() {
            Numbers::Foreign {
                hooks,
                subpath: 0,
                vertex: 0,
            }
        } else {
            Numbers::Own(settings.numbers(id, index))
        }
    }
}

impl Sampler for Numbers<'_> {
    #[inline(always)]
    fn at(&mut self, to: Subpath, index: u32) {
        match self {
            Numbers::Own(numbers) => numbers.at(to, index),
            Numbers::Foreign {
                subpath, vertex, ..
            } => {
                *subpath = match to {
                    Subpath::Sensor => 0,
                    Subpath::Light => 1,
                    Subpath::Aside => 2,
                };
                *vertex = index;
            }
        }
    }

    #[inline(always)]
    fn one(&mut self, purpose: Purpose) -> Real {
        match self {
            Numbers::Own(numbers) => numbers.one(purpose),
            Numbers::Foreign {
                hooks,
                subpath,
                vertex,
            } => foreign(hooks, *subpath, *vertex, purpose),
        }
    }

    #[inline(always)]
    fn two(&mut self, purpose: Purpose) -> [Real; 2] {
        match self {
            Numbers::Own(numbers) => numbers.two(purpose),
            Numbers::Foreign { .. } => {
                let x = self.one(purpose);
                [x, self.one(purpose)]
            }
        }
    }
}

#[inline(never)]
fn foreign(hooks: &EtdHooks, subpath: u32, vertex: u32, purpose: Purpose) -> Real {
    let number = match purpose {
        Purpose::Filter => 0,
        Purpose::Lens => 1,
        Purpose::Choice => 2,
        Purpose::Position => 3,
        Purpose::Emission => 4,
        Purpose::Lobe => 5,
        Purpose::Direction => 6,
        Purpose::Opacity => 7,
        Purpose::Roulette => 8,
        Purpose::Lead => 9,
        Purpose::Flight => 10,
        Purpose::Blend => 11,
    };
    let Some(random) = hooks.random else {
        return 0.0;
    };
    // SAFETY: the caller's function, called as it is documented.
    let x = unsafe { random(hooks.user, subpath, vertex, number) };
    if x > 0.0 { x.min(ONE_MINUS) } else { 0.0 }
}
