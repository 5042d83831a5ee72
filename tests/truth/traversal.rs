//! Traversal against brute force and closed forms: which primitive, where, and never through a crack.

use etendue::blob::format::{LANES, NONE, Node, Packet, Sphere};
use etendue::real::Vec3;
use etendue::shape::{self, Avx2, Bvh, Hit, Isa, IsaKind, Ray, Scalar, Sse2, Tracer};
use etendue_host::compile::bvh::{self, Built};

type Triangle = [[f32; 3]; 3];

/// A tree and what it was built from.
struct World {
    built: Built,
    spheres: Vec<Sphere>,
}

impl World {
    fn new(triangles: &[Triangle], spheres: &[([f32; 3], f32)]) -> Self {
        let built = bvh::build(triangles, spheres).expect("finite input");
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

    fn bvh<I: Isa>(&self, isa: I) -> Bvh<'_, I> {
        // SAFETY: `check::tree` has verified all that is asked for.
        unsafe { Bvh::new(&self.built.nodes, &self.built.packets, &self.spheres, isa) }
    }

    /// The closest hit, which all instruction sets must agree about, as must `occluded`.
    fn closest(&self, ray: &Ray) -> Option<Hit> {
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
    fn brute_force(&self, singles: &[(u32, World)], ray: &Ray) -> Option<Hit> {
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
    fn singles(&self, triangles: &[Triangle], spheres: &[([f32; 3], f32)]) -> Vec<(u32, World)> {
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

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|h| [h.t.to_bits(), h.primitive, h.u.to_bits(), h.v.to_bits()])
}

fn assert_same(a: Option<Hit>, b: Option<Hit>, ray: &Ray) {
    assert_eq!(bits(a), bits(b), "{a:?} {b:?} {ray:?}");
}

/// A tiny generator (SplitMix64), so that the inputs never change.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }
    /// In [0, 1).
    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 16_777_216.0
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    /// In [−1, 1)³.
    fn cube(&mut self) -> Vec3 {
        Vec3::from_array(core::array::from_fn(|_| self.unit() * 2.0 - 1.0))
    }
    fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if v.length_squared() < 1.0 && v.length_squared() > 0.01 {
                return v.normalize();
            }
        }
    }
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        origin,
        direction,
        t_min: 0.0,
        t_max: f32::INFINITY,
    }
}

fn soup(random: &mut Random, count: usize, size: f32) -> Vec<Triangle> {
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

#[test]
fn agrees_with_brute_force() {
    let mut random = Random(1);
    for (count, size, rays) in [
        (1, 1.0, 300),
        (5, 0.8, 300),
        (40, 0.5, 500),
        (700, 0.2, 2000),
    ] {
        let triangles = soup(&mut random, count, size);
        let spheres: Vec<_> = (0..count / 7)
            .map(|_| (random.cube().to_array(), 0.01 + 0.2 * random.unit()))
            .collect();
        let world = World::new(&triangles, &spheres);
        let singles = world.singles(&triangles, &spheres);
        let mut hits = 0;
        for _ in 0..rays {
            let origin = random.cube() * 2.0;
            let [a, b, c] = triangles[random.below(count)].map(Vec3::from);
            let target = (a + b + c) / 3.0 + random.cube() * (0.3 * size);
            let mut ray = ray(origin, (target - origin).normalize());
            if random.below(2) == 0 {
                ray.t_min = random.unit();
                ray.t_max = ray.t_min + 2.0 * random.unit();
            }
            let hit = world.closest(&ray);
            assert_same(hit, world.brute_force(&singles, &ray), &ray);
            hits += u32::from(hit.is_some());
        }
        assert!(hits > 20, "{hits} of {rays} hit: this would test nothing");
    }
}

/// A closed sphere of quads, `n` of them from pole to pole: corners shared bit by bit.
fn globe(n: usize, corner: impl Fn(Vec3) -> Vec3) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let mut vertices = vec![corner(Vec3::Y), corner(-Vec3::Y)];
    let row = |i: usize, j: usize| 2 + (i - 1) * 2 * n + j % (2 * n);
    let mut faces = Vec::new();
    for i in 1..n {
        for j in 0..2 * n {
            let (theta, phi) = (i as f32 / n as f32, j as f32 / n as f32);
            let (st, ct) = (theta * core::f32::consts::PI).sin_cos();
            let (sp, cp) = (phi * core::f32::consts::PI).sin_cos();
            vertices.push(corner(Vec3::new(st * cp, ct, st * sp)));
            if i == 1 {
                faces.push([0, row(1, j), row(1, j + 1)]);
            } else {
                faces.push([row(i - 1, j), row(i, j), row(i, j + 1)]);
                faces.push([row(i - 1, j), row(i, j + 1), row(i - 1, j + 1)]);
            }
            if i == n - 1 {
                faces.push([row(i, j), 1, row(i, j + 1)]);
            }
        }
    }
    (vertices, faces)
}

/// Aims at shared vertices, at points of shared edges and at their neighbourhoods from inside.
fn assert_tight(
    random: &mut Random,
    vertices: &[Vec3],
    faces: &[[usize; 3]],
    center: Vec3,
    rays: usize,
) {
    let triangles: Vec<Triangle> = faces
        .iter()
        .map(|f| f.map(|i| vertices[i].to_array()))
        .collect();
    let world = World::new(&triangles, &[]);
    let scale = (vertices[0] - center).length();
    let best = Avx2::detect();
    for i in 0..rays {
        let origin = center + random.cube() * (0.4 * scale);
        let face = faces[random.below(faces.len())];
        let (a, b) = (vertices[face[0]], vertices[face[1 + random.below(2)]]);
        let target = match i % 3 {
            0 => a,
            1 => a + (b - a) * random.unit(),
            _ => a + (b - a) * (random.below(9) as f32 / 8.0),
        };
        let ray = ray(origin, (target - origin).normalize());
        // All instruction sets now and then; the fastest always.
        let hit = match best {
            Some(avx2) if i % 16 != 0 => world.bvh(avx2).closest(&ray),
            _ => world.closest(&ray),
        };
        assert!(hit.is_some(), "{ray:?} aimed at {target:?} escaped");
    }
}

#[test]
fn nothing_escapes_a_closed_mesh() {
    let mut random = Random(2);
    let (vertices, faces) = globe(40, |v| {
        v * (1.0 + 0.1 * (7.0 * v.x).sin() * (9.0 * v.z).cos())
    });
    assert_tight(&mut random, &vertices, &faces, Vec3::ZERO, 3_000_000);
}

#[test]
fn nothing_escapes_at_any_scale_or_place() {
    let mut random = Random(3);
    for scale in [1e-18, 1e-4, 1e-2, 1e3, 1e6, 1e17] {
        let (vertices, faces) = globe(24, |v| v * scale);
        assert_tight(&mut random, &vertices, &faces, Vec3::ZERO, 200_000);
    }
    for place in [
        Vec3::new(1e3, -2e3, 5e2),
        Vec3::new(-1e5, 1e5, 3e5),
        Vec3::new(0.0, 0.0, 1e6),
    ] {
        let (vertices, faces) = globe(24, |v| place + v);
        assert_tight(&mut random, &vertices, &faces, place, 200_000);
    }
}

/// Large triangles beside small ones: the shear's rounding grows with the far vertices.
#[test]
fn nothing_escapes_a_box_with_long_walls() {
    let mut random = Random(4);
    let corners: Vec<Vec3> = (0..8)
        .map(|i| {
            Vec3::new(
                (i & 1) as f32 * 1000.0,
                (i >> 1 & 1) as f32,
                (i >> 2) as f32,
            )
        })
        .collect();
    let faces: Vec<[usize; 3]> = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ]
    .iter()
    .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
    .collect();
    let triangles: Vec<Triangle> = faces
        .iter()
        .map(|f| f.map(|i| corners[i].to_array()))
        .collect();
    let world = World::new(&triangles, &[]);
    for _ in 0..500_000 {
        let origin = Vec3::new(
            1000.0 * random.unit(),
            0.01 + 0.98 * random.unit(),
            0.01 + 0.98 * random.unit(),
        );
        let (y, z) = (random.below(2) as f32, random.below(2) as f32);
        let near = origin.x + (random.unit() - 0.5) * 4.0;
        let target = match random.below(3) {
            0 => Vec3::new(near.clamp(0.0, 1000.0), y, z),
            1 => Vec3::new(1000.0 * random.below(2) as f32, y, z),
            _ => Vec3::new(near.clamp(0.0, 1000.0), y, random.unit()),
        };
        let ray = ray(origin, (target - origin).normalize());
        assert!(
            world.closest(&ray).is_some(),
            "{ray:?} aimed at {target:?} escaped"
        );
    }
}

#[test]
fn the_lowest_of_equals_wins() {
    let mut random = Random(5);
    let one = soup(&mut random, 30, 0.5);
    let triangles: Vec<Triangle> = one.iter().cycle().take(30 * 40).copied().collect();
    let world = World::new(&triangles, &[]);
    let singles = world.singles(&triangles, &[]);
    for _ in 0..500 {
        let ray = ray(random.cube() * 2.0, random.direction());
        assert_same(world.closest(&ray), world.brute_force(&singles, &ray), &ray);
    }
}

#[test]
fn pathological_input_builds_in_time() {
    let mut random = Random(6);
    let start = std::time::Instant::now();
    let triangle = soup(&mut random, 1, 1.0)[0];
    for n in [5_000, 100_000] {
        World::new(&vec![triangle; n], &[]);
    }
    // A row of equal things at equal distances, exactly.
    let row: Vec<Triangle> = (0..60_000)
        .map(|i| {
            [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]]
                .map(|[x, y, z]: [f32; 3]| [x + i as f32, y, z])
        })
        .collect();
    World::new(&row, &[]);
    // Shells around one centre.
    let nested: Vec<Triangle> = (1..60_000)
        .map(|i| {
            [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]
                .map(|v: [f32; 3]| v.map(|x| x * i as f32))
        })
        .collect();
    World::new(&nested, &[]);
    // Sizes over all magnitudes.
    let sizes: Vec<Triangle> = (0..70)
        .flat_map(|e| {
            soup(&mut Random(e), 20, 0.5)
                .into_iter()
                .map(move |t| t.map(|v| v.map(|x| x * 10_f32.powi(e as i32 - 35))))
        })
        .collect();
    World::new(&sizes, &[]);
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn empty_and_bad_input() {
    let empty = World::new(&[], &[]);
    assert_eq!(empty.built.nodes.len(), 1);
    assert!(empty.closest(&ray(Vec3::ZERO, Vec3::X)).is_none());
    let good = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bad = [[0.0, f32::NAN, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(
        bvh::build(&[good, bad], &[]).err(),
        Some(bvh::BuildError::Triangle(1))
    );
    assert_eq!(
        bvh::build(&[], &[([0.0; 3], 0.0)]).err(),
        Some(bvh::BuildError::Sphere(0))
    );
    assert_eq!(
        bvh::build(&[], &[([3e38; 3], 3e38)]).err(),
        Some(bvh::BuildError::Sphere(0))
    );
    // No area: can't be hit, not even edge-on or at its corner.
    let line = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
    let flat = World::new(&[line, [[0.5; 3]; 3]], &[]);
    assert!(
        flat.closest(&ray(Vec3::new(-1.0, -1.0, -1.0), Vec3::ONE.normalize()))
            .is_none()
    );
    assert!(
        flat.closest(&ray(Vec3::new(0.5, 0.5, -1.0), Vec3::Z))
            .is_none()
    );
}

/// Rays without sense must do no harm, and meet nothing.
#[test]
fn senseless_rays() {
    let mut random = Random(7);
    let triangles = soup(&mut random, 200, 0.5);
    let world = World::new(&triangles, &[([0.0; 3], 0.5)]);
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        3e38,
        0.0,
        -0.0,
        1e-40,
    ];
    for _ in 0..20_000 {
        let mut any = |scale: f32| {
            Vec3::from_array(core::array::from_fn(|_| match random.below(3) {
                0 => odd[random.below(odd.len())],
                _ => (random.unit() - 0.5) * scale,
            }))
        };
        let (origin, direction) = (any(2.0), any(1.0));
        let t_min = any(1.0).x;
        let ray = Ray {
            origin,
            direction,
            t_min,
            t_max: any(10.0).y,
        };
        let hit = world.closest(&ray);
        if !origin.is_finite() || direction.is_nan() {
            assert!(hit.is_none(), "{hit:?} {ray:?}");
        }
        if let Some(hit) = hit {
            assert!(hit.t > ray.t_min && hit.t < ray.t_max, "{hit:?} {ray:?}");
        }
    }
}

/// Axis-parallel rays through a lattice of axis-parallel quads, many of them in the plane of box faces.
#[test]
fn axis_parallel_rays() {
    let n = 6;
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for i in 0..n {
            for j in 0..n {
                let at = |di: usize, dj: usize| {
                    let mut v = [0.0; 3];
                    v[axis] = 3.0;
                    v[(axis + 1) % 3] = (i + di) as f32;
                    v[(axis + 2) % 3] = (j + dj) as f32;
                    v
                };
                triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    let world = World::new(&triangles, &[]);
    for axis in 0..3 {
        for (i, j) in (0..=4 * n).flat_map(|i| (0..=4 * n).map(move |j| (i, j))) {
            for sign in [1.0, -1.0] {
                let mut origin = [0.0; 3];
                origin[axis] = 3.0 - 5.0 * sign;
                origin[(axis + 1) % 3] = i as f32 / 4.0;
                origin[(axis + 2) % 3] = j as f32 / 4.0;
                for zero in [0.0, -0.0] {
                    let mut direction = [zero; 3];
                    direction[axis] = sign;
                    let hit = world.closest(&ray(origin.into(), direction.into()));
                    let hit = hit.unwrap_or_else(|| panic!("{axis} {i} {j} {sign}"));
                    // Quads seen edge-on may be met first, those of the lattice's plane never missed.
                    assert!(hit.t <= 5.0, "{hit:?}");
                    if i != 12 && j != 12 {
                        assert_eq!(hit.t, 5.0);
                    }
                }
            }
        }
    }
}

#[test]
fn the_interval_is_open() {
    let triangle = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    let both = [
        World::new(&[triangle], &[]),
        World::new(&[], &[([0.0, 0.0, 3.0], 1.0)]),
    ];
    for world in both {
        let shot = |t_min, t_max| {
            world
                .closest(&Ray {
                    origin: Vec3::ZERO,
                    direction: Vec3::Z,
                    t_min,
                    t_max,
                })
                .map(|h| h.t)
        };
        assert_eq!(shot(0.0, f32::INFINITY), Some(2.0));
        assert_eq!(shot(0.0, 2.0), None);
        assert_eq!(shot(0.0, 2.0_f32.next_up()), Some(2.0));
        assert_eq!(shot(2.0_f32.next_down(), 3.0), Some(2.0));
        assert_eq!(shot(2.0, 3.0), None);
    }
}

/// The hit's distance and weights describe the same point, near the ray.
#[test]
fn hits_lie_on_ray_and_triangle() {
    let mut random = Random(8);
    let triangles = soup(&mut random, 300, 0.4);
    let world = World::new(&triangles, &[]);
    for _ in 0..5_000 {
        let ray = ray(random.cube() * 2.0, random.direction());
        let Some(hit) = world.closest(&ray) else {
            continue;
        };
        let [a, b, c] = shape::vertices(&world.built.packets, hit.primitive);
        let on_triangle = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
        let on_ray = ray.origin + ray.direction * hit.t;
        assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v < 1.000_001);
        // Slivers seen edge-on have weights of no more than single precision times their aspect.
        let normal = (b - a).cross(c - a).normalize();
        let slope = normal.dot(ray.direction).abs();
        assert!(
            (on_triangle - on_ray).length() * slope < 2e-5,
            "{hit:?} {ray:?}"
        );
    }
}

#[test]
fn spheres_meet_the_closed_form() {
    let mut random = Random(9);
    for _ in 0..100_000 {
        let radius = 10_f32.powf(random.unit() * 6.0 - 4.0);
        let center = random.cube() * 10.0;
        let far = radius * 10_f32.powf(random.unit() * 4.0);
        let outside = random.below(2) == 0;
        let origin = if outside {
            center + random.direction() * (radius + far)
        } else {
            center + random.cube() * (radius * 0.5)
        };
        let target = center + random.direction() * (radius * random.unit());
        let direction = (target - origin).normalize();
        let world = World::new(&[], &[(center.to_array(), radius)]);
        let hit = world.closest(&ray(origin, direction));

        let (o, d, c) = (origin.as_dvec3(), direction.as_dvec3(), center.as_dvec3());
        let f = o - c;
        let (a, b) = (d.dot(d), -f.dot(d));
        let l = f + d * (b / a);
        let r = f64::from(radius);
        let discriminant = r * r - l.dot(l);
        let size = f.length() + c.length();
        // How far from grazing the answer is beyond doubt.
        let margin = 1e-6 * size * r;
        if discriminant < -margin {
            assert!(hit.is_none());
        } else if discriminant > margin {
            let root = (a * discriminant).sqrt();
            let t = if b > root {
                (b - root) / a
            } else {
                (b + root) / a
            };
            let hit = hit.expect("meets the sphere");
            // The centre's and origin's own rounding moves the sphere by about size·2⁻²⁴.
            let tolerance = 1e-6 * size * (1.0 + r * r / discriminant).sqrt() + 1e-6 * t;
            assert!((f64::from(hit.t) - t).abs() < tolerance, "{hit:?} {t}");
        }
    }
}

#[test]
fn detection_agrees_with_std() {
    assert_eq!(
        Avx2::detect().is_some(),
        std::is_x86_feature_detected!("avx2")
    );
    assert!(IsaKind::best().available());
}

/// A ray along z from the origin shears nothing, so the exact answer is a matter of signs of differences
/// of products that are exact in double precision. Edges pass the ray within the last bits.
#[test]
fn edges_are_decided_exactly() {
    let mut random = Random(10);
    let mut answers = [0; 2];
    for i in 0..200_000 {
        let mut near = || (random.unit() + 0.5) * if random.below(2) == 0 { 1.0 } else { -1.0 };
        let (a, c) = ([near(), near()], [near(), near()]);
        let stretch = 0.5 + near().abs();
        let b = [-a[0] * stretch, -a[1] * stretch];
        let scale = [1.0, 1e-18, 1e17, 1e-6][i % 4];
        let triangle = [a, b, c].map(|[x, y]| [x * scale, y * scale, scale]);
        let side = |p: [f32; 3], q: [f32; 3]| {
            let (px_qy, py_qx) = (
                f64::from(p[0]) * f64::from(q[1]),
                f64::from(p[1]) * f64::from(q[0]),
            );
            px_qy.total_cmp(&py_qx) as i32
        };
        let [a, b, c] = triangle;
        let sides = [side(a, b), side(b, c), side(c, a)];
        let expected = !(sides.contains(&1) && sides.contains(&-1)) && sides != [0; 3];
        let world = World::new(&[triangle], &[]);
        let hit = world.closest(&ray(Vec3::ZERO, Vec3::Z));
        assert_eq!(hit.is_some(), expected, "{triangle:?} {sides:?}");
        if let Some(hit) = hit {
            assert!((hit.t / scale - 1.0).abs() < 1e-6, "{hit:?}");
        }
        answers[usize::from(expected)] += 1;
    }
    assert!(
        answers.iter().all(|n| *n > 20_000),
        "{answers:?}: one-sided"
    );
}

/// The same source in double precision meets the same primitives, but for rounding.
#[test]
fn double_precision_agrees() {
    use etendue_f64::blob::format as wide;
    use etendue_f64::shape::Tracer as _;

    let mut random = Random(11);
    let triangles = soup(&mut random, 500, 0.3);
    let spheres: Vec<_> = (0..50)
        .map(|_| (random.cube().to_array(), 0.01 + 0.1 * random.unit()))
        .collect();
    let world = World::new(&triangles, &spheres);
    let copy = |n: &Node| wide::Node {
        low: n.low,
        high: n.high,
        children: n.children,
        reserved: n.reserved,
    };
    let nodes: Vec<_> = world.built.nodes.iter().map(copy).collect();
    let packets: Vec<_> = world
        .built
        .packets
        .iter()
        .map(|p| wide::Packet { v: p.v })
        .collect();
    let copy = |s: &Sphere| wide::Sphere {
        center: s.center,
        radius: s.radius,
        shape: s.shape,
        flipped: s.flipped,
        reserved: s.reserved,
    };
    let spheres: Vec<_> = world.spheres.iter().map(copy).collect();
    // SAFETY: copies of what `check::tree` has verified.
    let reference = unsafe {
        etendue_f64::shape::Bvh::new(&nodes, &packets, &spheres, etendue_f64::shape::Scalar)
    };
    let (mut same, rays) = (0, 20_000);
    for _ in 0..rays {
        let ray = ray(random.cube() * 2.0, random.direction());
        let hit = world.closest(&ray);
        let exact = reference.closest(&etendue_f64::shape::Ray {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            t_min: 0.0,
            t_max: f64::INFINITY,
        });
        if hit.map(|h| h.primitive) == exact.map(|h| h.primitive) {
            same += 1;
            if let (Some(hit), Some(exact)) = (hit, exact) {
                assert!(
                    (f64::from(hit.t) - exact.t).abs() < 1e-4,
                    "{hit:?} {exact:?}"
                );
            }
        }
    }
    // Only rays that graze an edge may differ.
    assert!(same > rays - 10, "{same} of {rays}");
}
