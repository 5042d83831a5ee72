//! The kernel on a GPU: two entries. [`etd_open`] runs once and checks the blob, on the device, where its addresses are;
//! [`etd_render`] takes samples of pixels, a thread each, into the same exact integers as everywhere else: the image has the bits
//! that the CPU's has.
#![allow(unsafe_code)] // device memory that the host owns, special registers

use super::sums::contribute;
use crate::estimate::{Rule, Tree, estimate_with, pixel_id};
use crate::film::{Refused, Step};
use crate::random::Sequence;
use crate::sensor::Element;
use crate::{Estimator, Heuristic, Scene, Scratch, Settings};
use core::arch::nvptx::{_block_dim_x, _block_idx_x, _thread_idx_x};
use core::sync::atomic::{AtomicU64, Ordering};

/// Vertices that a light walk keeps: as many as on the CPU, because the bits depend on it.
const CAPACITY: usize = 32;

/// What to render; the host fills it in (`host/src/render/cuda.rs` has the same).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Job {
    /// 0 path, 1 light, 2 bidirectional, 3 distributed, 4 quadrature, 5 quadrature and path.
    pub estimator: u32,
    /// 0 balance, 1 power, 2 cutoff, 3 maximum.
    pub heuristic: u32,
    /// The most edges of a path; `u32::MAX`: no limit.
    pub max_edges: u32,
    /// Samples of each pixel.
    pub samples: u32,
    /// Selects the random numbers.
    pub seed: u64,
    /// Index of the first sample.
    pub first_sample: u64,
    /// First pixel, counted row by row, and how many.
    pub first_pixel: u64,
    /// Pixels of this launch.
    pub pixels: u64,
    /// distributed: [`crate::estimate::Tree::branching`].
    pub branching: [u8; 8],
    /// distributed: [`crate::estimate::Tree::lights`].
    pub lights: u32,
    /// Quadrature: [`crate::estimate::Rule`], its `shift` as 0 or 1.
    pub order: u32,
    /// Its steps.
    pub steps: u32,
    /// Its depth in the lower half, its shift in the upper.
    pub depth_and_shift: u32,
    /// 0 independent, 1 Sobol'.
    pub sequence: u32,
    /// [`Settings::roulette`].
    pub roulette: f32,
}

/// Checks the blob and writes a scene. Run by one thread. `status` becomes 1 if it is a scene, 2 if not.
///
/// # Safety
/// `blob` is `length` bytes of device memory, aligned to 64, that stay; `scene` has room for a [`Scene`].
#[unsafe(no_mangle)]
pub unsafe extern "ptx-kernel" fn etd_open(
    blob: *const u8,
    length: u64,
    scene: *mut Scene<'static>,
    room: u64,
    status: *mut u64,
) {
    // SAFETY: as the caller says.
    let bytes = unsafe { core::slice::from_raw_parts(blob, length as usize) };
    let fits = room as usize >= size_of::<Scene<'_>>();
    let value = match Scene::open(bytes) {
        Ok(opened) if fits => {
            // SAFETY: there is room.
            unsafe { scene.write(opened) };
            1
        }
        _ => 2,
    };
    // SAFETY: the caller's to write.
    unsafe { status.write(value) };
}

/// Takes samples of `job.pixels` pixels from `job.first_pixel` on, one thread a pixel. Both films have 6 words for each pixel of the
/// image; `counters` has 8: closest rays, shadow rays, light walks, cut walks, full walks, rejected, saturated, invalid.
///
/// # Safety
/// `scene` was written by [`etd_open`], and its blob is still there; the films have `words` words each.
#[unsafe(no_mangle)]
pub unsafe extern "ptx-kernel" fn etd_render(
    scene: *const Scene<'static>,
    job: *const Job,
    samples: *const AtomicU64,
    splats: *const AtomicU64,
    words: u64,
    counters: *const AtomicU64,
) {
    // SAFETY: reading special registers, and what the caller says.
    let (thread, scene, job, samples, splats, counters) = unsafe {
        (
            _block_idx_x() as u64 * _block_dim_x() as u64 + _thread_idx_x() as u64,
            &*scene,
            *job,
            core::slice::from_raw_parts(samples, words as usize),
            core::slice::from_raw_parts(splats, words as usize),
            core::slice::from_raw_parts(counters, 8),
        )
    };
    let [width, height] = scene.size();
    let pixel = job.first_pixel + thread;
    if thread >= job.pixels || pixel >= u64::from(width) * u64::from(height) {
        return;
    }
    let settings = Settings {
        estimator: match job.estimator {
            0 => Estimator::Path,
            1 => Estimator::Light,
            2 => Estimator::Bidirectional,
            3 => Estimator::Distributed,
            4 => Estimator::Quadrature,
            _ => Estimator::QuadratureAndPath,
        },
        heuristic: match job.heuristic {
            0 => Heuristic::Balance,
            1 => Heuristic::Power,
            2 => Heuristic::Cutoff,
            _ => Heuristic::Maximum,
        },
        max_edges: (job.max_edges != u32::MAX).then_some(job.max_edges),
        sequence: match job.sequence {
            0 => Sequence::Independent,
            _ => Sequence::Sobol,
        },
        seed: job.seed,
        roulette: job.roulette,
        tree: Tree {
            branching: job.branching,
            lights: job.lights as u8,
        },
        rule: Rule {
            order: job.order as u8,
            steps: job.steps as u16,
            depth: job.depth_and_shift as u8,
            shift: job.depth_and_shift >> 16 != 0,
        },
        ..Settings::default()
    };
    let step = Step::new(scene.film_exponent());
    let mut scratch = Scratch::<CAPACITY>::new();
    let mut refused = Refused::default();
    let mut splatted = Refused::default();
    let row = pixel.checked_div(u64::from(width)).unwrap_or(0);
    let place = [(pixel - row * u64::from(width)) as u32, row as u32];
    for i in 0..u64::from(job.samples) {
        let splat = &mut |[x, y]: [u32; 2], value| {
            let at = u64::from(y) * u64::from(width) + u64::from(x);
            contribute(step, splats, at, value, &mut splatted);
        };
        let numbers = &mut settings.numbers(pixel_id(place), job.first_sample + i);
        let (tree, element) = (&scene.tree(), &Element::Pixel(place));
        let scratch = &mut scratch.view(scene);
        let own = estimate_with(scene, tree, &settings, element, numbers, scratch, splat);
        contribute(step, samples, pixel, own, &mut refused);
    }
    refused += splatted;
    let c = scratch.counters;
    let values = [
        c.closest_rays,
        c.shadow_rays,
        c.light_walks,
        c.cut_walks,
        c.full_walks,
        c.rejected,
        refused.saturated,
        refused.invalid,
    ];
    for (counter, value) in counters.iter().zip(values) {
        if value != 0 {
            counter.fetch_add(value, Ordering::Relaxed);
        }
    }
}

/// Nothing in the kernel panics: the module has no call to this.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn etd_panic_is_reachable() -> !;
    }
    // SAFETY: never linked: `kernel/ptx/build` fails if this name is in the module.
    unsafe { etd_panic_is_reachable() }
}
