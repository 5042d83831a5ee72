//! What the kernel uses: no memory but the caller's, a bounded number of steps.

use etendue::estimate::Chain;
use etendue::path::MAX_STEPS;
use etendue::random::Sequence;
use etendue::real::Vec3;
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{ColorSource, Geometry, Model};
use etendue_tests::bits::scenes;
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, with a count of each thread's calls.
struct Counting;

// SAFETY: hands everything to the system's allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: as the caller's.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: as the caller's.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: as the caller's.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const ESTIMATORS: [(Estimator, Sequence); 8] = {
    use {Estimator as E, Sequence::*};
    [
        (E::Path, Independent),
        (E::Path, Sobol),
        (E::Light, Independent),
        (E::Bidirectional, Independent),
        (E::Bidirectional, Sobol),
        (E::Distributed, Independent),
        (E::Quadrature, Independent),
        (E::QuadratureAndPath, Independent),
    ]
};
const HEURISTICS: [Heuristic; 4] = [
    Heuristic::Balance,
    Heuristic::Power,
    Heuristic::Cutoff,
    Heuristic::Maximum,
];

/// How often `f` calls the allocator.
fn allocations(f: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.with(Cell::get);
    f();
    ALLOCATIONS.with(Cell::get) - before
}

/// Chains from the first samples that carry light.
fn chains<const N: usize>(scene: &Scene<'_>, scratch: &mut Scratch<N>) -> f32 {
    let settings = Settings {
        estimator: Estimator::Metropolis,
        ..Settings::default()
    };
    let view = &mut scratch.view(scene);
    let mut chain = Chain::<16>::new();
    let mut sum = 0.0;
    for sample in 0..50 {
        if scene.bootstrap(&settings, sample, view, &mut |_, _| ()) > 0.0 {
            chain.start(scene, &settings, sample, sample, view);
            chain.advance(scene, &settings, 1.0, 20, view, &mut |_, v| sum += v.g);
        }
    }
    sum
}

fn everything<const N: usize>(bytes: &[u8], scratch: &mut Scratch<N>) -> f32 {
    let scene = Scene::open(bytes).unwrap();
    let [w, h] = scene.size();
    let center = Vec3::from(scene.world().center);
    let mut sum = chains(&scene, scratch);
    for (estimator, sequence) in ESTIMATORS {
        for heuristic in HEURISTICS {
            let settings = Settings {
                estimator,
                heuristic,
                sequence,
                ..Settings::default()
            };
            for i in 0..w * h {
                let pixel = [i % w, i / w];
                let own = scene.estimate(&settings, pixel, 0, scratch, &mut |_, v| sum += v.g);
                sum += own.g;
            }
            for i in 0..8 {
                sum += scene
                    .irradiance(&settings, center, Vec3::Z, 0, i, scratch)
                    .g;
                sum += scene.radiance(&settings, center, Vec3::Z, 0, i, scratch).g;
            }
        }
    }
    sum
}

#[test]
fn the_kernel_allocates_nothing() {
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(1)))), 2);
    for (name, description) in scenes() {
        let bytes = blob(&description);
        let (mut small, mut large) = (Scratch::<8>::new(), Box::new(Scratch::<128>::new()));
        let mut light = 0.0;
        let count = allocations(|| {
            light = everything(bytes.bytes(), &mut small) + everything(bytes.bytes(), &mut large);
        });
        assert_eq!(count, 0, "{name}");
        assert!(light > 0.0);
        // Refusing allocates nothing either.
        let broken = AlignedBlob::copy_of(&bytes.bytes()[..bytes.bytes().len() - 64]);
        let count = allocations(|| assert!(Scene::open(broken.bytes()).is_err()));
        assert_eq!(count, 0, "{name}, refused");
    }
}

/// In a perfect white furnace with no way out walks end at the limit, and say so; with thousands of masks on the way all rays of a
/// sample share one limit.
#[test]
fn walks_that_cannot_end_are_cut_and_counted() {
    let mut closed = Builder::new();
    let white = closed.diffuse([1.0; 3]);
    closed.cuboid([-1.0; 3], [1.0; 3], true, Some(white));
    let mut masked = Builder::new();
    let white = Some(masked.diffuse([1.0; 3]));
    masked.cuboid([-1.0; 3], [1.0; 3], true, white);
    for i in 0..2000 {
        let radius = 0.5 + 0.0002 * i as f32;
        masked.sphere([0.0; 3], radius, white).opacity = Some(ColorSource::Constant([1e-6; 3]));
    }
    for (builder, passes) in [(closed, false), (masked, true)] {
        let bytes = blob(&builder.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        for estimator in [Estimator::Path, Estimator::Bidirectional] {
            let settings = Settings {
                estimator,
                ..Settings::default()
            };
            let mut scratch = Scratch::<8>::new();
            scene.radiance(&settings, Vec3::ZERO, Vec3::Z, 0, 0, &mut scratch);
            let c = scratch.counters;
            assert_eq!(c.cut_walks, 1, "{estimator:?} {c:?}");
            assert!(
                c.rays() <= 2 * u64::from(MAX_STEPS) + 16,
                "{estimator:?} {c:?}"
            );
            assert!(passes || c.closest_rays >= u64::from(MAX_STEPS), "{c:?}");
        }
    }
    // Glass of total reflection all around: Dirac walks end as well.
    let mut mirror = Builder::new();
    let perfect = mirror.mirror(1.0);
    mirror.shape(
        Geometry::Sphere {
            center: [0.0; 3],
            radius: 1.0,
            flipped: true,
        },
        Some(perfect),
    );
    let null = mirror.material(Model::Null);
    mirror.sphere([0.0; 3], 0.5, Some(null));
    let bytes = blob(&mirror.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let mut scratch = Scratch::<8>::new();
    scene.radiance(
        &Settings::default(),
        Vec3::new(0.1, 0.0, 0.0),
        Vec3::Z,
        0,
        0,
        &mut scratch,
    );
    assert_eq!(scratch.counters.cut_walks, 1);
}
