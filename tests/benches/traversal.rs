//! Rays per second on every instruction set, beside Embree's robust single-ray mode where installed.
//!
//! `cargo bench -p etendue-tests --bench traversal [-- SCENE…]`, scenes `small`, `medium`, `large`.
//! All candidates trace the same rays in alternating blocks, so that a busy machine slows all of them;
//! time is the thread's own. The table gives millions of rays per second and, after a slash, the ratio to Embree.

#[cfg(embree)]
mod embree;
mod scenes;

use std::hint::black_box;

use etendue::blob::format::{Node, Packet, Triangle as Record};
use etendue::real::{Frame, Vec3};
use etendue::shape::{self, Avx2, Bvh, Isa, Ray, Scalar, Sse2, Tracer};
use etendue_host::compile::bvh::{self, Built};
use scenes::Triangle;

/// Rays of one kind.
struct Batch {
    name: &'static str,
    rays: Vec<Ray>,
    /// Closest hits, or any?
    closest: bool,
}

/// Number of hits of some rays, closest or any.
type Trace<'a> = dyn Fn(&[Ray], bool) -> usize + 'a;

/// Someone who traces rays.
struct Candidate<'a> {
    name: &'static str,
    trace: Box<Trace<'a>>,
    seconds: f64,
}

const EMBREE: &str = "Embree";
const SIDE: usize = 256;
/// Rays per turn: enough that nobody finds the caches warmed by who traced them before.
const BLOCK: usize = 16384;
/// Least time that every candidate is given per batch.
const SECONDS: f64 = 0.5;

fn main() {
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    for (name, make) in [
        ("small", scenes::cornell as fn() -> Vec<Triangle>),
        ("medium", || scenes::bumpy(69_000)),
        ("large", || scenes::bumpy(1_000_000)),
    ] {
        if wanted.is_empty() || wanted.iter().any(|w| w == name) {
            measure(name, &make());
        }
    }
}

fn measure(name: &str, triangles: &[Triangle]) {
    let start = std::time::Instant::now();
    let built = bvh::build(triangles, &[]).expect("finite input");
    let seconds = start.elapsed().as_secs_f64();
    let bytes = size_of_val(&built.nodes[..])
        + size_of_val(&built.packets[..])
        + built.slots.len() * size_of::<Record>();
    println!(
        "{name}: {} triangles, built in {seconds:.2} s, {:.1} bytes a triangle with its record",
        triangles.len(),
        bytes as f64 / triangles.len() as f64
    );
    println!("  {:?}, depth {}", built.quality, built.depth);

    let nodes = Aligned::new(&built.nodes);
    let mut candidates = candidates(&nodes, &built.packets, triangles);
    let batches = batches(&built);
    print!("  {:14}", "");
    candidates.iter().for_each(|c| print!("{:>16}", c.name));
    println!();
    for batch in &batches {
        print!("  {:14}", batch.name);
        let traced = race(&mut candidates, batch);
        let rate = |c: &Candidate| traced as f64 / c.seconds * 1e-6;
        let embree = candidates.iter().find(|c| c.name == EMBREE).map(rate);
        for c in &candidates {
            match embree {
                Some(embree) => print!("{:>9.2} /{:5.2}", rate(c), rate(c) / embree),
                None => print!("{:>16.2}", rate(c)),
            }
        }
        println!();
    }
}

fn candidates<'a>(
    nodes: &'a Aligned,
    packets: &'a [Packet],
    triangles: &[Triangle],
) -> Vec<Candidate<'a>> {
    let mut candidates = vec![
        ours("scalar", nodes, packets, Scalar),
        ours("SSE2", nodes, packets, Sse2),
    ];
    candidates.extend(Avx2::detect().map(|avx2| ours("AVX2", nodes, packets, avx2)));
    #[cfg(embree)]
    {
        let embree = embree::Embree::new(triangles);
        let trace = move |rays: &[Ray], closest: bool| {
            let hit = |ray: &&Ray| {
                if closest {
                    embree.closest(ray).is_some()
                } else {
                    embree.occluded(ray)
                }
            };
            rays.iter().filter(hit).count()
        };
        candidates.push(Candidate {
            name: EMBREE,
            trace: Box::new(trace),
            seconds: 0.0,
        });
    }
    let _ = triangles;
    candidates
}

/// Nodes at a multiple of 64 bytes, where a blob has them: no row lies across two cache lines.
struct Aligned(Vec<Line>, usize);

#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct Line(Node);

impl Aligned {
    fn new(nodes: &[Node]) -> Self {
        Self(nodes.iter().map(|node| Line(*node)).collect(), nodes.len())
    }

    fn nodes(&self) -> &[Node] {
        // SAFETY: a `Line` is a `Node` and nothing else, both of 256 bytes.
        unsafe { core::slice::from_raw_parts(self.0.as_ptr().cast(), self.1) }
    }
}

fn tree<'a, I: Isa>(nodes: &'a [Node], packets: &'a [Packet], isa: I) -> Bvh<'a, I> {
    // SAFETY: the builder's trees are as the format says.
    unsafe { Bvh::new(nodes, packets, &[], isa) }
}

fn ours<'a, I: Isa + 'a>(
    name: &'static str,
    nodes: &'a Aligned,
    packets: &'a [Packet],
    isa: I,
) -> Candidate<'a> {
    let bvh = tree(nodes.nodes(), packets, isa);
    let trace = move |rays: &[Ray], closest: bool| {
        let hit = |ray: &&Ray| {
            if closest {
                bvh.closest(ray).is_some()
            } else {
                bvh.occluded(ray)
            }
        };
        rays.iter().filter(hit).count()
    };
    Candidate {
        name,
        trace: Box::new(trace),
        seconds: 0.0,
    }
}

/// Traces the batch until everybody has had enough time: rays traced by each. Each of ours takes turns
/// with Embree, block by block, so that nobody finds the caches warmed by someone with the same tree.
fn race(candidates: &mut [Candidate], batch: &Batch) -> usize {
    let (ours, rival) = match candidates.split_last_mut() {
        Some((last, ours)) if last.name == EMBREE => (ours, Some(last)),
        _ => (candidates, None),
    };
    let mut traced = 0;
    let mut rival_seconds = 0.0;
    ours.iter_mut().for_each(|c| c.seconds = 0.0);
    while ours.iter().any(|c| c.seconds < SECONDS) {
        for block in batch.rays.chunks_exact(BLOCK) {
            for candidate in ours.iter_mut() {
                let (hits, seconds) = candidate.run(block, batch.closest);
                candidate.seconds += seconds;
                if let Some(rival) = &rival {
                    let (rival_hits, seconds) = rival.run(block, batch.closest);
                    rival_seconds += seconds;
                    // Rounding may decide a few rays differently; more would be a mistake.
                    assert!(
                        hits.abs_diff(rival_hits) <= BLOCK / 100,
                        "{hits} {rival_hits}"
                    );
                }
            }
            traced += BLOCK;
        }
    }
    if let Some(rival) = rival {
        rival.seconds = rival_seconds / ours.len() as f64;
    }
    traced
}

impl Candidate<'_> {
    /// Hits and seconds.
    fn run(&self, rays: &[Ray], closest: bool) -> (usize, f64) {
        let start = thread_seconds();
        let hits = black_box((self.trace)(black_box(rays), closest));
        (hits, thread_seconds() - start)
    }
}

/// Primary rays, first and third bounces, and segments between random hit points.
fn batches(built: &Built) -> Vec<Batch> {
    let bvh = tree(&built.nodes, &built.packets, Scalar);
    let mut random = Random(1);
    let mut rays: Vec<Ray> = (0..SIDE * SIDE)
        .map(|i| {
            let (x, y) = ((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5);
            let half = SIDE as f32 / 2.0;
            let direction = Vec3::new((x - half) / half * 0.6, (half - y) / half * 0.6, -1.0);
            Ray {
                origin: Vec3::new(0.02, 0.05, 0.98),
                direction: direction.normalize(),
                t_min: 0.0,
                t_max: f32::INFINITY,
            }
        })
        .collect();
    let mut batches = vec![Batch {
        name: "primary",
        rays: rays.clone(),
        closest: true,
    }];
    let mut points = Vec::new();
    for bounce in 1..=3 {
        rays = rays
            .iter()
            .filter_map(|ray| {
                let hit = bvh.closest(ray)?;
                let [a, b, c] = shape::vertices(&built.packets, hit.primitive);
                let normal = (b - a).cross(c - a).normalize();
                let normal = if normal.dot(ray.direction) > 0.0 {
                    -normal
                } else {
                    normal
                };
                let point = ray.origin + ray.direction * hit.t + normal * 1e-5;
                points.push(point);
                let (r, phi) = (random.unit().sqrt(), random.unit() * core::f32::consts::TAU);
                let local = Vec3::new(r * phi.cos(), r * phi.sin(), (1.0 - r * r).sqrt());
                let direction = Frame::around(normal).world(local);
                Some(Ray {
                    origin: point,
                    direction,
                    ..*ray
                })
            })
            .collect();
        // Bumpy spheres are closed and so is the room, but for rounding in the offset.
        assert!(
            rays.len() > SIDE * SIDE * 9 / 10,
            "{} rays left",
            rays.len()
        );
        let name = ["first bounce", "second bounce", "third bounce"][bounce - 1];
        batches.push(Batch {
            name,
            rays: rays.clone(),
            closest: true,
        });
    }
    let shadow = (0..SIDE * SIDE).filter_map(|_| {
        let mut pick = || points[random.below(points.len())];
        let (from, to) = (pick(), pick());
        let distance = (to - from).length();
        (distance > 1e-3).then(|| Ray {
            origin: from,
            direction: (to - from) / distance,
            t_min: 0.0,
            t_max: distance * 0.9999,
        })
    });
    batches.push(Batch {
        name: "occlusion",
        rays: shadow.collect(),
        closest: false,
    });
    batches.retain(|b| b.name != "second bounce");
    batches
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }
    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 16_777_216.0
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// The time this thread has computed.
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
fn thread_seconds() -> f64 {
    // SAFETY: POSIX, with the types of 64-bit Linux.
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut [i64; 2]) -> i32;
    }
    const THREAD_CPU_TIME: i32 = 3;
    let mut time = [0; 2];
    // SAFETY: `time` is a timespec: seconds and nanoseconds.
    unsafe { clock_gettime(THREAD_CPU_TIME, &mut time) };
    time[0] as f64 + time[1] as f64 * 1e-9
}

/// The time that has passed, where the thread's own isn't to be had.
#[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
fn thread_seconds() -> f64 {
    use std::sync::LazyLock;
    use std::time::Instant;
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}
