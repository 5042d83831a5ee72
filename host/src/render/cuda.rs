//! Renders on a GPU of NVIDIA's, through the driver that is there at run time: nothing is linked. The kernel's own source
//! runs there (`kernel/src/gpu.rs`, as the PTX module `kernel/ptx/etendue.ptx.gz`), adds into the same integers, and so gives the
//! CPU's bits.
#![allow(unsafe_code)] // calls into the driver

use super::{Budget, Options, Progress, RenderError, Rendered};
use bytemuck::{Pod, Zeroable};
use cudarc::driver::result::{self, module};
use cudarc::driver::{CudaContext, CudaSlice, CudaStream, DevicePtr, DriverError, sys};
use etendue::film::{Refused, Step, Sum};
use etendue::random::Sequence;
use etendue::{Counters, Estimator, Heuristic, Scene};
use std::ffi::{CString, c_void};
use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

static MODULE: &[u8] = include_bytes!("../../../kernel/ptx/etendue.ptx.gz");

/// Threads of a block: few, because each needs many registers.
const BLOCK: u32 = 64;
/// Bytes of device memory that hold the opened scene.
const ROOM: usize = 1024;
/// Words of a pixel's sum.
const WORDS: usize = 6;

/// What to render, as `kernel/src/gpu.rs` reads it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Job {
    estimator: u32,
    heuristic: u32,
    max_edges: u32,
    samples: u32,
    seed: u64,
    first_sample: u64,
    first_pixel: u64,
    pixels: u64,
    branching: [u8; 8],
    lights: u32,
    order: u32,
    steps: u32,
    depth_and_shift: u32,
    sequence: u32,
    roulette: f32,
}

fn failed(what: &'static str) -> impl Fn(DriverError) -> RenderError {
    move |e| RenderError::Gpu(format!("{what}: {e}"))
}

/// The module's entries, loaded.
struct Entries {
    open: sys::CUfunction,
    render: sys::CUfunction,
}

impl Entries {
    fn load() -> Result<Self, RenderError> {
        let mut text = Vec::new();
        flate2::read::GzDecoder::new(MODULE)
            .read_to_end(&mut text)
            .map_err(|e| RenderError::Gpu(format!("the module is damaged: {e}")))?;
        text.push(0);
        // SAFETY: the module's text, ended by a zero.
        let loaded = unsafe { module::load_data(text.as_ptr().cast::<c_void>()) }
            .map_err(failed("the driver can't compile the kernel"))?;
        let entry = |name: &str| {
            let name = CString::new(name).unwrap_or_default();
            // SAFETY: the module stays loaded as long as the process runs.
            unsafe { module::get_function(loaded, name) }.map_err(failed("an entry is missing"))
        };
        Ok(Self {
            open: entry("etd_open")?,
            render: entry("etd_render")?,
        })
    }
}

/// Device memory of one render.
struct Gpu {
    stream: Arc<CudaStream>,
    entries: Entries,
    scene: CudaSlice<u8>,
    /// The scene refers to it.
    _blob: CudaSlice<u8>,
    samples: CudaSlice<u64>,
    splats: CudaSlice<u64>,
    counters: CudaSlice<u64>,
}

impl Gpu {
    fn new(scene: &Scene<'_>, splats: bool) -> Result<Self, RenderError> {
        // SAFETY: looks for a library, and loads it, which runs what it does when it is loaded.
        if !unsafe { sys::is_culib_present() } {
            return Err(RenderError::Gpu(
                "there is no NVIDIA driver on this machine (libcuda can't be loaded)".into(),
            ));
        }
        let context = CudaContext::new(0).map_err(failed("there is no usable NVIDIA GPU"))?;
        let stream = context.default_stream();
        let entries = Entries::load()?;
        let memory = failed("not enough memory on the GPU");
        let [width, height] = scene.size().map(|n| n as usize);
        let words = width * height * WORDS;
        let blob = stream.clone_htod(scene.bytes()).map_err(&memory)?;
        let gpu = Self {
            entries,
            scene: stream.alloc_zeros(ROOM).map_err(&memory)?,
            _blob: blob,
            samples: stream.alloc_zeros(words).map_err(&memory)?,
            splats: stream
                .alloc_zeros(if splats { words } else { WORDS })
                .map_err(&memory)?,
            counters: stream.alloc_zeros(8).map_err(&memory)?,
            stream,
        };
        gpu.open(scene.bytes().len() as u64)?;
        Ok(gpu)
    }

    /// Calls an entry with parameters of 8 bytes each.
    fn launch(
        &self,
        entry: sys::CUfunction,
        threads: u64,
        parameters: &[u64],
    ) -> Result<(), DriverError> {
        let mut values = parameters.to_vec();
        let mut pointers: Vec<*mut c_void> = values
            .iter_mut()
            .map(|v| std::ptr::from_mut(v).cast::<c_void>())
            .collect();
        let blocks = threads.div_ceil(u64::from(BLOCK)) as u32;
        let block = (threads as u32).min(BLOCK);
        let stream = self.stream.cu_stream();
        // SAFETY: the entries take so many parameters of 8 bytes; pointers among them are to device memory that lives as
        // long as `self`, of the sizes that are passed along.
        unsafe {
            result::launch_kernel(
                entry,
                (blocks, 1, 1),
                (block, 1, 1),
                0,
                stream,
                &mut pointers,
            )
        }?;
        self.stream.synchronize()
    }

    fn address<T>(&self, memory: &CudaSlice<T>) -> u64 {
        memory.device_ptr(&self.stream).0
    }

    fn open(&self, length: u64) -> Result<(), RenderError> {
        let status: CudaSlice<u64> = self
            .stream
            .alloc_zeros(1)
            .map_err(failed("not enough memory on the GPU"))?;
        let parameters = [
            self.address(&self._blob),
            length,
            self.address(&self.scene),
            ROOM as u64,
            self.address(&status),
        ];
        let refused = failed("the GPU can't open the scene");
        self.launch(self.entries.open, 1, &parameters)
            .map_err(&refused)?;
        let status = self.stream.clone_dtoh(&status).map_err(&refused)?;
        if status != [1] {
            return Err(RenderError::Gpu("the GPU refuses the scene".into()));
        }
        Ok(())
    }

    fn render(&self, job: &Job) -> Result<(), RenderError> {
        let broken = failed("rendering on the GPU failed");
        let upload = self
            .stream
            .clone_htod(bytemuck::bytes_of(job))
            .map_err(&broken)?;
        let words = self.samples.len() as u64;
        let parameters = [
            self.address(&self.scene),
            self.address(&upload),
            self.address(&self.samples),
            self.address(&self.splats),
            words,
            self.address(&self.counters),
        ];
        self.launch(self.entries.render, job.pixels, &parameters)
            .map_err(&broken)
    }

    fn download(&self, film: &CudaSlice<u64>) -> Result<Vec<Sum>, RenderError> {
        let words = self
            .stream
            .clone_dtoh(film)
            .map_err(failed("the image can't be fetched from the GPU"))?;
        let wide = |pair: &[u64]| {
            pair.iter()
                .rev()
                .fold(0, |sum, word| sum << 64 | i128::from(*word))
        };
        let sum =
            |pixel: &[u64]| std::array::from_fn(|c| pixel.get(2 * c..2 * c + 2).map_or(0, wide));
        Ok(words.chunks_exact(WORDS).map(sum).collect())
    }
}

/// [`super::render`] on the first GPU.
///
/// # Errors
/// If there is none, or it can't do what it should.
pub(super) fn render(
    scene: &Scene<'_>,
    options: &Options,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Rendered, RenderError> {
    let settings = &options.settings;
    let splats = settings.estimator.splats();
    let gpu = Gpu::new(scene, splats)?;
    let pixels = scene.size().map(u64::from).iter().product::<u64>();
    let mut job = Job {
        estimator: match settings.estimator {
            Estimator::Path => 0,
            Estimator::Light => 1,
            Estimator::Bidirectional => 2,
            Estimator::Metropolis => {
                return Err(RenderError::Gpu(
                    "chains run on the CPU: choose --device cpu".into(),
                ));
            }
            Estimator::Distributed => 3,
            Estimator::Quadrature => 4,
            Estimator::QuadratureAndPath => 5,
        },
        heuristic: match settings.heuristic {
            Heuristic::Balance => 0,
            Heuristic::Power => 1,
            Heuristic::Cutoff => 2,
            Heuristic::Maximum => 3,
        },
        max_edges: settings.max_edges.unwrap_or(u32::MAX),
        samples: 1,
        seed: settings.seed,
        first_sample: 0,
        first_pixel: 0,
        pixels,
        branching: settings.tree.branching,
        lights: settings.tree.lights.into(),
        order: settings.rule.order.into(),
        steps: settings.rule.steps.into(),
        depth_and_shift: u32::from(settings.rule.depth) | u32::from(settings.rule.shift) << 16,
        sequence: match settings.sequence {
            Sequence::Independent => 0,
            Sequence::Sobol => 1,
        },
        roulette: settings.roulette,
    };
    let started = Instant::now();
    let budget: Budget = options.budget;
    let spending = budget.begin();
    let (mut done, mut interrupted) = (0, false);
    while let Some(batch) = spending.next(done, started.elapsed()) {
        if stop.load(Ordering::Relaxed) && done > 0 {
            interrupted = true;
            break;
        }
        job.first_sample = done;
        job.samples = batch as u32;
        gpu.render(&job)?;
        done += batch;
        watch(Progress {
            passes: done,
            samples: done * pixels,
            done: spending.share(done as f64, started.elapsed()),
        });
    }
    let seconds = started.elapsed().as_secs_f64();
    let own = gpu.download(&gpu.samples)?;
    let others = if splats {
        gpu.download(&gpu.splats)?
    } else {
        Vec::new()
    };
    let step = Step::new(scene.film_exponent());
    let image = own
        .iter()
        .enumerate()
        .map(|(at, sum)| {
            let splat = others.get(at).unwrap_or(&[0; 3]);
            step.resolve(sum, splat, done, done, 1).map(|x| x as f32)
        })
        .collect();
    let counted = gpu
        .stream
        .clone_dtoh(&gpu.counters)
        .map_err(failed("the counters can't be fetched from the GPU"))?;
    let count = |i: usize| counted.get(i).copied().unwrap_or(0);
    Ok(Rendered {
        size: scene.size(),
        image,
        passes: done,
        seconds,
        counters: Counters {
            closest_rays: count(0),
            shadow_rays: count(1),
            light_walks: count(2),
            cut_walks: count(3),
            full_walks: count(4),
            rejected: count(5),
        },
        refused: Refused {
            saturated: count(6),
            underflowed: 0,
            invalid: count(7),
        },
        interrupted,
        chains: None,
        accuracy: None,
        tail: None,
    })
}
