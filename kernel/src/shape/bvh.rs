//! The blob's tree and its traversal: one loop, an explicit stack, no recursion.
//!
//! A node's eight boxes are tested at once. Children that may be met go to the stack as one integer
//! each, entry distance above reference, so that sorting them is sorting integers; the nearest is
//! visited next. Entries that have fallen behind the closest hit are dropped when they come up, those
//! *at* its distance are not: an equal hit of lower id may wait there. Shadow rays don't sort.
#![allow(unsafe_code)] // unchecked indices, proven by blob/check; a stack that isn't cleared for every ray

use core::mem::MaybeUninit;

use super::isa::Isa;
use super::lanes::{Load, LoadPair};
use super::ray::{Hit, Ray, Tracer};
use super::slab::{Bounds, Slabs};
use super::triangle::{Axis, Met, Shear, Triangles};
use super::{sphere, triangle};
use crate::blob::format::{LANES, MAX_DEPTH, Node, Packet, Sphere, WIDTH, child};
use crate::real::{Real, Vec3, vec3};

/// A view of the blob's tree that answers rays with the instructions of `I`.
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a, I: Isa> {
    nodes: &'a [Node],
    packets: &'a [Packet],
    spheres: &'a [Sphere],
    sphere_base: u32,
    bounds: Bounds,
    isa: I,
}

impl<'a, I: Isa> Bvh<'a, I> {
    /// A view of a tree that has been checked.
    ///
    /// # Safety
    /// The sections must be as [`crate::blob::format`] says, "Tree" and "Primitives"; in particular:
    /// there is a node 0; every child that isn't [`child::EMPTY`] refers to a node, a run of packets or
    /// a run of spheres that exists; nodes form a tree below node 0 that is at most [`MAX_DEPTH`] deep.
    pub unsafe fn new(
        nodes: &'a [Node],
        packets: &'a [Packet],
        spheres: &'a [Sphere],
        isa: I,
    ) -> Self {
        // SAFETY: as the caller says; there is a node 0.
        unsafe {
            let bounds = Bounds::of(nodes.get_unchecked(0));
            Self::within(bounds, nodes, packets, spheres, isa)
        }
    }

    /// The same, where the bounds of node 0 are known.
    ///
    /// # Safety
    /// As for [`Self::new`].
    #[inline(always)]
    unsafe fn within(
        bounds: Bounds,
        nodes: &'a [Node],
        packets: &'a [Packet],
        spheres: &'a [Sphere],
        isa: I,
    ) -> Self {
        let sphere_base = (packets.len() * LANES) as u32;
        Self {
            nodes,
            packets,
            spheres,
            sphere_base,
            bounds,
            isa,
        }
    }
}

impl<'a> crate::blob::Scene<'a> {
    /// The blob's own ray tracer under instruction set `isa`.
    #[inline(always)]
    pub fn tracer<I: Isa>(&self, isa: I) -> Bvh<'a, I> {
        // SAFETY: a Scene exists only after `blob/check` has verified exactly this: at least one node
        // (open), children, parents and levels of nodes, and the spans of leaves (check_node).
        unsafe {
            let (nodes, packets) = (self.nodes(), self.packets());
            Bvh::within(self.bounds(), nodes, packets, self.sphere_records(), isa)
        }
    }
}

impl<I: Isa> Tracer for Bvh<'_, I> {
    #[inline(always)]
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        I::closest(self, ray)
    }
    #[inline(always)]
    fn occluded(&self, ray: &Ray) -> bool {
        I::occluded(self, ray)
    }
}

/// The vertices of a triangle slot; zeros if there is no such slot.
pub fn vertices(packets: &[Packet], slot: u32) -> [Vec3; 3] {
    let lane = slot as usize % LANES;
    match packets.get(slot as usize / LANES) {
        Some(Packet { v: [a, b, c], .. }) => {
            let corner = |[x, y, z]: &[[f32; LANES]; 3]| vec3([x[lane], y[lane], z[lane]]);
            [corner(a), corner(b), corner(c)]
        }
        None => [Vec3::ZERO; 3],
    }
}

/// [`Tracer::closest`], to be inlined into a function with the features of `I`.
#[inline(always)]
pub(super) fn closest<I: Isa>(bvh: &Bvh<I>, ray: &Ray) -> Option<Hit> {
    // A hit at t_max doesn't undercut primitive 0: the interval is open.
    let mut query = Closest {
        best: Hit {
            t: ray.t_max,
            primitive: 0,
            u: 0.0,
            v: 0.0,
        },
        found: false,
    };
    traverse(bvh, ray, &mut query);
    query.found.then_some(query.best)
}

/// [`Tracer::occluded`], to be inlined into a function with the features of `I`.
#[inline(always)]
pub(super) fn occluded<I: Isa>(bvh: &Bvh<I>, ray: &Ray) -> bool {
    let mut query = Any {
        t_max: ray.t_max,
        found: false,
    };
    traverse(bvh, ray, &mut query);
    query.found
}

/// What a traversal is after.
trait Query {
    /// Whether to visit near subtrees first.
    const SORTED: bool;
    /// Beyond which hits are of no interest.
    fn t_max(&self) -> Real;
    /// Takes note of a hit at t ≤ `t_max`; true ends traversal.
    fn accept(&mut self, hit: Hit) -> bool;
}

struct Closest {
    best: Hit,
    found: bool,
}

impl Query for Closest {
    const SORTED: bool = true;
    #[inline(always)]
    fn t_max(&self) -> Real {
        self.best.t
    }
    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> bool {
        let best = &self.best;
        if hit.t < best.t || (hit.t == best.t && hit.primitive < best.primitive) {
            self.best = hit;
            self.found = true;
        }
        false
    }
}

struct Any {
    t_max: Real,
    found: bool,
}

impl Query for Any {
    const SORTED: bool = false;
    #[inline(always)]
    fn t_max(&self) -> Real {
        self.t_max
    }
    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> bool {
        self.found |= hit.t < self.t_max;
        self.found
    }
}

/// Offers what the ray meets at t_min < t ≤ query.t_max to the query.
#[inline(always)]
fn traverse<I: Isa, Q: Query>(bvh: &Bvh<I>, ray: &Ray, query: &mut Q) {
    let Some(slabs) = Slabs::new(ray, &bvh.bounds) else {
        return;
    };
    let shear = Shear::new(ray);
    let token = bvh.isa.token();
    let mut keys = Keys([const { MaybeUninit::uninit() }; STACK]);
    let mut stack = Stack {
        keys: &mut keys.0,
        len: 0,
    };
    let mut reference = 0;
    loop {
        if reference & child::LEAF == 0 {
            // SAFETY: `reference` is 0 or was a child, isn't a leaf (so not EMPTY), thus a node that exists.
            let node = unsafe { bvh.nodes.get_unchecked(reference as usize) };
            let (mut mask, entry) = slabs.test::<I::Eight>(token, node, query.t_max());
            let take = |mask: &mut u32| {
                let i = mask.trailing_zeros() as usize % WIDTH;
                *mask &= *mask - 1;
                prefetch(bvh, node.children[i]);
                key(entry[i], node.children[i])
            };
            if mask != 0 {
                let first = take(&mut mask);
                if mask == 0 {
                    reference = first as u32;
                    continue;
                }
                let second = take(&mut mask);
                let (mut nearest, farther) = if !Q::SORTED || first < second {
                    (first, second)
                } else {
                    (second, first)
                };
                let base = stack.len;
                // SAFETY: at most 7 of 8 children are pushed per node of the path to here.
                unsafe { stack.push(farther) };
                while mask != 0 {
                    let next = take(&mut mask);
                    if !Q::SORTED {
                        // SAFETY: as above.
                        unsafe { stack.push(next) };
                    } else {
                        let (low, high) = if next < nearest {
                            (next, nearest)
                        } else {
                            (nearest, next)
                        };
                        nearest = low;
                        // SAFETY: as above.
                        unsafe { stack.insert(base, high) };
                    }
                }
                reference = nearest as u32;
                continue;
            }
        } else if reference & child::SPHERES == 0 {
            if leaf(bvh, &shear, reference, ray.t_min, query) {
                return;
            }
        } else if reference != child::EMPTY {
            let (start, count) = run(reference);
            for i in start..start + count {
                // SAFETY: `reference` is a child, so a run of spheres that exists.
                let sphere = unsafe { bvh.spheres.get_unchecked(i) };
                if let Some(t) = sphere::intersect(sphere, ray, ray.t_min, query.t_max()) {
                    let primitive = bvh.sphere_base + i as u32;
                    if query.accept(Hit {
                        t,
                        primitive,
                        u: 0.0,
                        v: 0.0,
                    }) {
                        return;
                    }
                }
            }
        }
        loop {
            let Some(next) = stack.pop() else { return };
            if !Q::SORTED || entry_of(next) <= query.t_max() {
                reference = next as u32;
                break;
            }
        }
    }
}

/// Offers the hits in a run of packets; true ends traversal.
#[inline(always)]
fn leaf<I: Isa, Q: Query>(
    bvh: &Bvh<I>,
    shear: &Shear,
    reference: u32,
    t_min: Real,
    query: &mut Q,
) -> bool {
    let token = bvh.isa.token();
    let (start, count) = run(reference);
    // SAFETY: `reference` is a child, so a run of packets that exists.
    let mut packets = unsafe { bvh.packets.get_unchecked(start..start + count) };
    let mut slot = (start * LANES) as u32;
    if I::PAIRS {
        while let [a, b, rest @ ..] = packets {
            let pair = Pair::<I>(a, b, token);
            let met = triangle::intersect::<I::Eight>(token, shear, t_min, query.t_max(), &pair);
            if met.is_some_and(|met| offer(slot, &met, query)) {
                return true;
            }
            slot += 2 * LANES as u32;
            packets = rest;
        }
    }
    for packet in packets {
        let one = One::<I>(packet, token);
        let met = triangle::intersect::<I::Four>(token, shear, t_min, query.t_max(), &one);
        if met.is_some_and(|met| offer(slot, &met, query)) {
            return true;
        }
        slot += LANES as u32;
    }
    false
}

/// Offers the triangles met, lane 0 being triangle `slot`; true ends traversal.
#[inline(always)]
fn offer<Q: Query>(slot: u32, met: &Met, query: &mut Q) -> bool {
    let mut lanes = met.lanes;
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize % met.t.len();
        lanes &= lanes - 1;
        let hit = Hit {
            t: met.t[i],
            primitive: slot + i as u32,
            u: met.u[i],
            v: met.v[i],
        };
        if query.accept(hit) {
            return true;
        }
    }
    false
}

/// The triangles of a packet.
struct One<'a, I: Isa>(&'a Packet, I::Token);

impl<I: Isa> Triangles<I::Four> for One<'_, I> {
    #[inline(always)]
    fn coordinate(&self, i: usize, axis: Axis) -> I::Four {
        I::Four::load(self.1, row(self.0, i, axis))
    }
}

/// The triangles of two packets.
struct Pair<'a, I: Isa>(&'a Packet, &'a Packet, I::Token);

impl<I: Isa> Triangles<I::Eight> for Pair<'_, I> {
    #[inline(always)]
    fn coordinate(&self, i: usize, axis: Axis) -> I::Eight {
        I::Eight::load_pair(self.2, row(self.0, i, axis), row(self.1, i, axis))
    }
}

/// That coordinate of a packet's vertices `i`.
#[inline(always)]
fn row(packet: &Packet, i: usize, axis: Axis) -> &[f32; LANES] {
    // SAFETY: an axis is below 3.
    unsafe { packet.v[i].get_unchecked(axis.index()) }
}

/// Asks for what a child refers to: the lines of a node, or the first of a leaf's packets. Of three
/// children that a ray meets two wait on the stack for a while, enough for memory to answer.
#[inline(always)]
fn prefetch<I: Isa>(bvh: &Bvh<I>, reference: u32) {
    let (start, lines) = if reference & child::LEAF == 0 {
        (
            bvh.nodes
                .as_ptr()
                .wrapping_add(reference as usize)
                .cast::<[u8; 64]>(),
            4,
        )
    } else {
        (
            bvh.packets
                .as_ptr()
                .wrapping_add(run(reference).0)
                .cast::<[u8; 64]>(),
            3,
        )
    };
    for line in 0..lines {
        I::prefetch(start.wrapping_add(line));
    }
}

/// First and number of a leaf's packets or spheres.
#[inline(always)]
fn run(reference: u32) -> (usize, usize) {
    let start = reference & child::START_MASK;
    let count = (reference >> child::COUNT_SHIFT & 15) + 1;
    (start as usize, count as usize)
}

/// Entry distance (≥ +0, so that its bits are in order) above reference.
#[inline(always)]
fn key(entry: Real, reference: u32) -> u64 {
    u64::from(single(entry).to_bits()) << 32 | u64::from(reference)
}

/// The entry distance as a single that isn't above it.
#[cfg(not(feature = "f64"))]
#[inline(always)]
fn single(entry: f32) -> f32 {
    entry
}

/// The entry distance as a single that isn't above it.
#[cfg(feature = "f64")]
#[inline(always)]
fn single(entry: f64) -> f32 {
    (entry * (1.0 - f64::from(f32::EPSILON))) as f32
}

/// The entry distance in a key.
#[inline(always)]
#[allow(clippy::useless_conversion)] // not useless in the double-precision package
fn entry_of(key: u64) -> Real {
    f32::from_bits((key >> 32) as u32).into()
}

/// A path has at most `MAX_DEPTH + 1` nodes, and each leaves at most
/// `WIDTH − 1` children on the stack while one is visited.
const STACK: usize = (WIDTH - 1) * (MAX_DEPTH as usize + 1);

/// Aligned, so that the frame is: compilers don't align it for vectors that they spill.
#[repr(align(64))]
struct Keys([MaybeUninit<u64>; STACK]);

/// Subtrees still to visit, nearest on top.
struct Stack<'a> {
    /// Behind a reference, so that `len` can live in a register.
    keys: &'a mut [MaybeUninit<u64>; STACK],
    len: usize,
}

impl Stack<'_> {
    /// # Safety
    /// There must be room.
    #[inline(always)]
    unsafe fn push(&mut self, key: u64) {
        // SAFETY: there is room.
        unsafe { self.keys.get_unchecked_mut(self.len) }.write(key);
        self.len += 1;
    }

    /// Pushes `key` below those above `base` that are nearer.
    ///
    /// # Safety
    /// There must be room, and `base ≤ len`.
    #[inline(always)]
    unsafe fn insert(&mut self, base: usize, key: u64) {
        let mut at = self.len;
        while at > base {
            // SAFETY: base < at ≤ len, and all below len have been written.
            let below = unsafe { self.keys.get_unchecked(at - 1).assume_init() };
            if below >= key {
                break;
            }
            // SAFETY: at ≤ len, and there is room.
            unsafe { self.keys.get_unchecked_mut(at) }.write(below);
            at -= 1;
        }
        // SAFETY: at ≤ len, and there is room.
        unsafe { self.keys.get_unchecked_mut(at) }.write(key);
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: what was below len has been written, and len never exceeds the stack.
        Some(unsafe { self.keys.get_unchecked(self.len).assume_init() })
    }
}
