//! Trees to ask, and random things to build them from.

use etendue::blob::format::{LANES, NONE, Node, Packet, Sphere};
use etendue::real::Vec3;
use etendue::shape::{Avx2, Bvh, Hit, Isa, Ray, Scalar, Sse2, Tracer};
use etendue_host::compile::bvh::{self, Built};

pub type Triangle = [[f32; 3]; 3];

/// A tree and what it was built from.
pub struct World {
    pub built: Built,
    pub spheres: Vec<Sphere>,
}

impl World {
    pub fn new(triangles: &[Triangle], spheres: &[([f32; 3], f32)]) -> Self {
        let built = bvh::build(triangles, spheres).expect("finite input");
        Self::of(built, triangles, spheres)
    }

    /// Around a tree that somebody built.
    pub fn of(built: Built, triangles: &[Triangle], spheres: &[([f32; 3], f32)]) -> Self {
        let spheres = built
            .sphere_order
            .iter()
            .map(|&i| {
                let (center, radius) = spheres[i as usize];
                Sphere {
                    center,
                    radius,
                    shape: 0,
                    flipped: 0,
                    reserved: [0; 2],
                }
            })
            .collect();
        let world = Self { built, spheres };
        check::tree(&world.built, triangles, &world.spheres);
        world
    }

    pub fn bvh<I: Isa>(&self, isa: I) -> Bvh<'_, I> {
        // SAFETY: `check::tree` has verified all that is asked for.
        unsafe { Bvh::new(&self.built.nodes, &self.built.packets, &self.spheres, isa) }
    }

    /// The closest hit, which all instruction sets must agree about, as must `occluded`.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.bvh(Scalar).closest(ray);
        assert_eq!(self.bvh(Scalar).occluded(ray), hit.is_some(), "{ray:?}");
        assert_same(hit, self.bvh(Sse2).closest(ray), ray);
        assert_eq!(self.bvh(Sse2).occluded(ray), hit.is_some(), "{ray:?}");
        if let Some(avx2) = Avx2::detect() {
            assert_same(hit, self.bvh(avx2).closest(ray), ray);
            assert_eq!(self.bvh(avx2).occluded(ray), hit.is_some(), "{ray:?}");
        }
        hit
    }

    /// The closest hit by asking every primitive on its own: a tree of one, so boxes hardly matter.
    pub fn brute_force(&self, singles: &[(u32, World)], ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (primitive, single) in singles {
            if let Some(mut hit) = single.bvh(Scalar).closest(ray) {
                hit.primitive = *primitive;
                if best.is_none_or(|b| (hit.t, hit.primitive) < (b.t, b.primitive)) {
                    best = Some(hit);
                }
            }
        }
        best
    }

    /// Every primitive as a world of its own, with its id here.
    pub fn singles(
        &self,
        triangles: &[Triangle],
        spheres: &[([f32; 3], f32)],
    ) -> Vec<(u32, World)> {
        let slots = self
            .built
            .slots
            .iter()
            .enumerate()
            .filter(|(_, source)| **source != NONE);
        let base = self.built.slots.len();
        slots
            .map(|(slot, &source)| (slot, World::new(&triangles[source as usize..][..1], &[])))
            .chain(
                self.built
                    .sphere_order
                    .iter()
                    .enumerate()
                    .map(|(i, &source)| {
                        (base + i, World::new(&[], &spheres[source as usize..][..1]))
                    }),
            )
            .map(|(id, world)| (id as u32, world))
            .collect()
    }
}

pub fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|h| [h.t.to_bits(), h.primitive, h.u.to_bits(), h.v.to_bits()])
}

pub fn assert_same(a: Option<Hit>, b: Option<Hit>, ray: &Ray) {
    assert_eq!(bits(a), bits(b), "{a:?} {b:?} {ray:?}");
}

/// A tiny generator (SplitMix64), so that the inputs never change.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }
    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 16_777_216.0
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    /// In [−1, 1)³.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::from_array(core::array::from_fn(|_| self.unit() * 2.0 - 1.0))
    }
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if v.length_squared() < 1.0 && v.length_squared() > 0.01 {
                return v.normalize();
            }
        }
    }
}

pub fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        origin,
        direction,
        t_min: 0.0,
        t_max: f32::INFINITY,
    }
}

pub fn soup(random: &mut Random, count: usize, size: f32) -> Vec<Triangle> {
    (0..count)
        .map(|_| {
            let center = random.cube();
            [0; 3].map(|_| (center + random.cube() * size).to_array())
        })
        .collect()
}

/// The structure that `Bvh::new` relies on, checked the slow way.
mod check {
    use super::*;
    use etendue::blob::format::{MAX_DEPTH, WIDTH, child};

    pub fn tree(built: &Built, triangles: &[Triangle], spheres: &[Sphere]) {
        assert!(!built.nodes.is_empty());
        assert_eq!(built.slots.len(), built.packets.len() * LANES);
        let mut node_seen = vec![0; built.nodes.len()];
        let mut packet_seen = vec![0; built.packets.len()];
        let mut sphere_seen = vec![0; spheres.len()];
        node_seen[0] = 1;
        let mut deepest = 0;
        let mut open = vec![(0_usize, 0_u32)];
        while let Some((at, depth)) = open.pop() {
            deepest = deepest.max(depth);
            let node = &built.nodes[at];
            for i in 0..WIDTH {
                let reference = node.children[i];
                let bounds = bounds(node, i);
                if reference == child::EMPTY {
                    assert_eq!(bounds, [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]]);
                    continue;
                }
                let count = (reference >> child::COUNT_SHIFT & 15) as usize + 1;
                let start = (reference & child::START_MASK) as usize;
                if reference & child::LEAF == 0 {
                    let below = reference as usize;
                    assert!(below > at);
                    node_seen[below] += 1;
                    for j in 0..WIDTH {
                        assert!(contains(&bounds, &self::bounds(&built.nodes[below], j)));
                    }
                    open.push((below, depth + 1));
                } else if reference & child::SPHERES != 0 {
                    for s in start..start + count {
                        sphere_seen[s] += 1;
                        let (c, r) = (Vec3::from(spheres[s].center), spheres[s].radius);
                        assert!(contains(&bounds, &[(c - r).to_array(), (c + r).to_array()]));
                    }
                } else {
                    for (p, seen) in packet_seen.iter_mut().enumerate().skip(start).take(count) {
                        *seen += 1;
                        let slots = &built.slots[p * LANES..][..LANES];
                        packet(&built.packets[p], slots, triangles, &bounds);
                    }
                    assert!(start + count <= built.packets.len());
                }
            }
        }
        assert_eq!(deepest, built.depth);
        assert!(deepest <= MAX_DEPTH);
        assert!(
            node_seen
                .iter()
                .chain(&packet_seen)
                .chain(&sphere_seen)
                .all(|n| *n == 1)
        );
        let mut sources: Vec<u32> = built.slots.iter().copied().filter(|s| *s != NONE).collect();
        let present = sources.len();
        sources.sort_unstable();
        sources.dedup();
        assert_eq!(sources.len(), present, "every triangle once");
    }

    fn packet(packet: &Packet, slots: &[u32], triangles: &[Triangle], bounds: &[[f32; 3]; 2]) {
        for (lane, &source) in slots.iter().enumerate() {
            let vertices = packet.v.map(|v| v.map(|x| x[lane]));
            if source == NONE {
                assert_eq!(vertices[0], vertices[1], "no area");
            } else {
                assert_eq!(vertices, triangles[source as usize]);
            }
            assert!(vertices.iter().all(|v| contains(bounds, &[*v, *v])));
        }
    }

    fn bounds(node: &Node, i: usize) -> [[f32; 3]; 2] {
        [node.low.map(|row| row[i]), node.high.map(|row| row[i])]
    }

    fn contains(outer: &[[f32; 3]; 2], inner: &[[f32; 3]; 2]) -> bool {
        (0..3).all(|axis| outer[0][axis] <= inner[0][axis] && outer[1][axis] >= inner[1][axis])
    }
}
