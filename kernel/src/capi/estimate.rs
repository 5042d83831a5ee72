//! Estimates: settings, scratch, and the calls that give light.

use super::arguments::{Sized32, input, optional, output, slice, slice_mut};
use super::control::Control;
use super::film::EtdSum;
#[cfg(feature = "capi")]
use super::foreign::{Foreign, Numbers};
use super::hooks::{EtdHooks, direction, position};
use super::scene::{EtdScene, scene};
use super::status::{
    ETD_E_ARGUMENT, ETD_E_CANCELLED, ETD_E_HANDLE, ETD_E_MISALIGNED, ETD_E_NULL, ETD_E_SIZE,
    ETD_E_SPLAT, EtdStatus, status_of,
};
use crate::blob::Scene;
#[cfg(feature = "capi")]
use crate::estimate::estimate_with;
use crate::estimate::{Estimator, Scratch, ScratchView, Settings, pixel_id};
use crate::film::{Refused, Step};
use crate::path::{Counters, Heuristic};
use crate::sensor::Element;
use crate::spectrum::Rgb;
use core::ffi::c_void;

/// A walk from the sensor, with a light sampled at each vertex.
pub const ETD_PATH: u32 = 0;
/// A walk from a light, each vertex joined to the sensor. Reports splats.
pub const ETD_LIGHT: u32 = 1;
/// Both walks and all connections between them. Reports splats.
pub const ETD_BIDIRECTIONAL: u32 = 2;

/// Weights in proportion to densities.
pub const ETD_BALANCE: u32 = 0;
/// Weights in proportion to squared densities.
pub const ETD_POWER: u32 = 1;
/// Balance, without strategies of less than a tenth of the best one's density.
pub const ETD_CUTOFF: u32 = 2;
/// The densest strategy alone.
pub const ETD_MAXIMUM: u32 = 3;

/// How to estimate. `etd_settings_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdSettings {
    /// sizeof(EtdSettings).
    pub struct_size: u32,
    /// `ETD_PATH`, `ETD_LIGHT` or `ETD_BIDIRECTIONAL`.
    pub estimator: u32,
    /// `ETD_BALANCE`, `ETD_POWER`, `ETD_CUTOFF` or `ETD_MAXIMUM`.
    pub heuristic: u32,
    /// The most edges of a path (1: emitters seen directly, 2: direct light, …); −1: no limit.
    pub max_edges: i32,
    /// Selects the random numbers.
    pub seed: u64,
}

/// A rectangle of the image, and which samples of its pixels.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdTile {
    /// sizeof(EtdTile).
    pub struct_size: u32,
    /// First column.
    pub x: u32,
    /// First row, from the top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples of each pixel, at least 1.
    pub samples: u32,
    /// Index of the first of them: the next call for more goes on where this one ended.
    pub first_sample: u64,
}

/// What happened since the scratch was made or its counters were last cleared.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdCounters {
    /// sizeof(EtdCounters), set by the caller.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// Rays for which the closest hit was asked.
    pub closest_rays: u64,
    /// Segments that were asked to be free.
    pub shadow_rays: u64,
    /// Walks from a light.
    pub light_walks: u64,
    /// Walks cut by the limit of steps.
    pub cut_walks: u64,
    /// Light walks that ended because the scratch's capacity was reached.
    pub full_walks: u64,
    /// Contributions refused because they were NaN, infinite or negative, or too large for a film.
    pub rejected: u64,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdSettings {}
// SAFETY: as above.
unsafe impl Sized32 for EtdTile {}
// SAFETY: as above.
unsafe impl Sized32 for EtdCounters {}

/// What scratch memory must be aligned to.
pub const ETD_SCRATCH_ALIGN: usize = 16;

/// The memory that estimates work in, made by `etd_scratch_init` in memory of the caller. One thread at a time; one for each thread.
#[derive(Clone, Copy)]
pub struct EtdScratch {
    magic: u64,
    capacity: u32,
}

const MAGIC: u64 = 0x7461_7263_5364_7445; // "EtdScrat"

#[repr(C)]
struct Held<const N: usize> {
    head: EtdScratch,
    scratch: Scratch<N>,
}

const _: () = assert!(align_of::<Held<8>>() <= ETD_SCRATCH_ALIGN);

/// Calls `$f` with the type that has this capacity.
macro_rules! with_capacity {
    ($capacity:expr, $f:ident $(, $argument:expr)*) => {
        match $capacity {
            8 => Ok($f::<8>($($argument),*)),
            32 => Ok($f::<32>($($argument),*)),
            128 => Ok($f::<128>($($argument),*)),
            _ => Err(ETD_E_ARGUMENT),
        }
    };
}

fn held_size<const N: usize>() -> usize {
    size_of::<Held<N>>()
}

/// Makes a scratch in place.
///
/// # Safety
/// `memory` is large and aligned enough for `Held<N>`, and nobody else's.
unsafe fn make<const N: usize>(memory: *mut c_void) {
    let held = memory.cast::<Held<N>>();
    let head = EtdScratch {
        magic: MAGIC,
        capacity: N as u32,
    };
    // SAFETY: as the caller says.
    unsafe {
        (&raw mut (*held).head).write(head);
        (&raw mut (*held).scratch).write(Scratch::new());
    }
}

/// The scratch behind a handle, of any capacity.
fn scratch<'a>(handle: *mut EtdScratch) -> Result<ScratchView<'a>, EtdStatus> {
    if handle.is_null() {
        return Err(ETD_E_NULL);
    }
    if handle.align_offset(ETD_SCRATCH_ALIGN) != 0 {
        return Err(ETD_E_MISALIGNED);
    }
    // SAFETY: not null and aligned; live memory of the caller's, by the caller's word.
    let head = unsafe { handle.read() };
    if head.magic != MAGIC {
        return Err(ETD_E_HANDLE);
    }
    fn view<'a, const N: usize>(handle: *mut EtdScratch) -> ScratchView<'a> {
        // SAFETY: only `make::<N>` writes the number and this capacity, with a scratch of it behind; one thread at
        // a time uses it, by the caller's word.
        unsafe { &mut (*handle.cast::<Held<N>>()).scratch }.view()
    }
    with_capacity!(head.capacity, view, handle).map_err(|_| ETD_E_HANDLE)
}

/// Bytes of memory that a scratch of `capacity` needs: 8, 32 or 128 vertices of a stored light walk (it bounds which
/// bidirectional strategies exist, not the length of paths; `ETD_PATH` needs none). 0 for another capacity.
#[unsafe(no_mangle)]
pub extern "C" fn etd_scratch_size(capacity: u32) -> usize {
    with_capacity!(capacity, held_size).unwrap_or(0)
}

/// Makes a scratch of `capacity` in `memory`: `memory_size` ≥ `etd_scratch_size(capacity)` bytes, aligned to `ETD_SCRATCH_ALIGN`, the
/// caller's to free when no longer used. `*out` will point into it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scratch_init(
    memory: *mut c_void,
    memory_size: usize,
    capacity: u32,
    out: *mut *mut EtdScratch,
) -> EtdStatus {
    status_of((|| {
        if memory.is_null() || out.is_null() {
            return Err(ETD_E_NULL);
        }
        if memory.align_offset(ETD_SCRATCH_ALIGN) != 0 || !out.is_aligned() {
            return Err(ETD_E_MISALIGNED);
        }
        let size = with_capacity!(capacity, held_size)?;
        if memory_size < size {
            return Err(ETD_E_SIZE);
        }
        // SAFETY: large and aligned enough, and the caller's to give.
        unsafe {
            match capacity {
                8 => make::<8>(memory),
                32 => make::<32>(memory),
                _ => make::<128>(memory),
            }
            out.write(memory.cast());
        }
        Ok(())
    })())
}

/// What happened; `clear` other than 0 begins anew. Set `counters->struct_size` before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scratch_counters(
    handle: *mut EtdScratch,
    counters: *mut EtdCounters,
    clear: i32,
) -> EtdStatus {
    status_of((|| {
        let mut view = scratch(handle)?;
        let out = output(counters)?;
        let c = *view.counters();
        *out = EtdCounters {
            struct_size: out.struct_size,
            reserved: 0,
            closest_rays: c.closest_rays,
            shadow_rays: c.shadow_rays,
            light_walks: c.light_walks,
            cut_walks: c.cut_walks,
            full_walks: c.full_walks,
            rejected: c.rejected,
        };
        if clear != 0 {
            *view.counters() = Counters::ZERO;
        }
        Ok(())
    })())
}

/// Path tracing with the power heuristic, paths of any length, seed 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_settings_default(settings: *mut EtdSettings) -> EtdStatus {
    status_of((|| {
        if settings.is_null() {
            return Err(ETD_E_NULL);
        }
        if !settings.is_aligned() {
            return Err(ETD_E_MISALIGNED);
        }
        // SAFETY: not null and aligned; the caller's to give.
        unsafe {
            settings.write(EtdSettings {
                struct_size: size_of::<EtdSettings>() as u32,
                estimator: ETD_PATH,
                heuristic: ETD_POWER,
                max_edges: -1,
                seed: 0,
            });
        }
        Ok(())
    })())
}

fn settings(pointer: *const EtdSettings) -> Result<Settings, EtdStatus> {
    let s = input(pointer)?;
    Ok(Settings {
        estimator: match s.estimator {
            ETD_PATH => Estimator::Path,
            #[cfg(feature = "light")]
            ETD_LIGHT => Estimator::Light,
            #[cfg(not(feature = "light"))]
            ETD_LIGHT => return Err(super::status::ETD_E_UNSUPPORTED),
            #[cfg(feature = "bidirectional")]
            ETD_BIDIRECTIONAL => Estimator::Bidirectional,
            #[cfg(not(feature = "bidirectional"))]
            ETD_BIDIRECTIONAL => return Err(super::status::ETD_E_UNSUPPORTED),
            _ => return Err(ETD_E_ARGUMENT),
        },
        heuristic: match s.heuristic {
            ETD_BALANCE => Heuristic::Balance,
            ETD_POWER => Heuristic::Power,
            ETD_CUTOFF => Heuristic::Cutoff,
            ETD_MAXIMUM => Heuristic::Maximum,
            _ => return Err(ETD_E_ARGUMENT),
        },
        max_edges: match s.max_edges {
            -1 => None,
            n => Some(u32::try_from(n).map_err(|_| ETD_E_ARGUMENT)?),
        },
        seed: s.seed,
        explicit_weights: false,
    })
}

/// What all estimating calls have in common.
struct Call<'a> {
    scene: &'a Scene<'static>,
    settings: Settings,
    hooks: EtdHooks,
    scratch: ScratchView<'a>,
    _control: Control,
}

impl Call<'_> {
    fn new(
        handle: *const EtdScene,
        with: *const EtdSettings,
        hooks: *const EtdHooks,
        memory: *mut EtdScratch,
    ) -> Result<Self, EtdStatus> {
        Ok(Self {
            scene: scene(handle)?,
            settings: settings(with)?,
            hooks: optional(hooks)?.unwrap_or(EtdHooks::NONE).check()?,
            scratch: scratch(memory)?,
            _control: Control::set(),
        })
    }

    /// Whether samples of pixels add to other pixels.
    fn splats(&self) -> bool {
        self.settings.estimator != Estimator::Path
    }

    fn needs_splat(&self) -> Result<(), EtdStatus> {
        if self.splats() && self.hooks.splat.is_none() {
            return Err(ETD_E_SPLAT);
        }
        Ok(())
    }

    fn poll(&self) -> Result<(), EtdStatus> {
        if self.hooks.cancelled() {
            return Err(ETD_E_CANCELLED);
        }
        Ok(())
    }

    /// One sample, by the scene's own tracer or the caller's.
    #[inline(never)]
    fn sample(&mut self, element: &Element, id: u64, index: u64, sink: &mut Sink<'_>) -> Rgb {
        #[cfg(feature = "capi")]
        let mut numbers = Numbers::new(&self.hooks, self.settings.seed, id, index);
        #[cfg(not(feature = "capi"))]
        let mut numbers = crate::random::Pcg::new(self.settings.seed, id, index);
        let mut splat = |pixel, value| sink.take(pixel, value);
        #[cfg(feature = "capi")]
        if self.hooks.closest.is_some() {
            return estimate_with(
                self.scene,
                &Foreign(&self.hooks),
                &self.settings,
                element,
                &mut numbers,
                &mut self.scratch,
                &mut splat,
            );
        }
        self.scene.estimate_element(
            &self.settings,
            element,
            &mut numbers,
            &mut self.scratch,
            &mut splat,
        )
    }

    /// The mean of samples `first` … `first + samples` of one element.
    fn mean(
        &mut self,
        element: &Element,
        id: u64,
        first: u64,
        samples: u32,
        sink: &mut Sink<'_>,
    ) -> Result<[f32; 3], EtdStatus> {
        let mut sum = [0.0f64; 3];
        for i in 0..u64::from(samples) {
            self.poll()?;
            let value = self.sample(element, id, first.wrapping_add(i), sink);
            for (s, v) in sum.iter_mut().zip(value.to_array()) {
                *s += f64::from(v);
            }
        }
        Ok(sum.map(|s| (s / f64::from(samples)) as f32))
    }

    /// Means of `count` elements into `rgb`.
    fn batch(
        &mut self,
        element: impl Fn(usize) -> Option<Element>,
        count: usize,
        samples: &EtdSamples,
        rgb: *mut f32,
    ) -> Result<(), EtdStatus> {
        let rgb = slice_mut(rgb, count.checked_mul(3).ok_or(ETD_E_SIZE)?)?;
        if samples.samples == 0 {
            return Err(ETD_E_ARGUMENT);
        }
        // All of the input is looked at before any of the output is written.
        if (0..count).any(|i| element(i).is_none()) {
            return Err(ETD_E_ARGUMENT);
        }
        for (i, out) in rgb.chunks_exact_mut(3).enumerate() {
            let element = element(i).ok_or(ETD_E_ARGUMENT)?;
            let id = samples.first_id.wrapping_add(i as u64);
            let mean = self.mean(
                &element,
                id,
                samples.first_sample,
                samples.samples,
                &mut Sink::None,
            )?;
            for (o, m) in out.iter_mut().zip(mean) {
                *o = m;
            }
        }
        Ok(())
    }

    /// The tile, within the image.
    fn tile(&self, tile: *const EtdTile) -> Result<EtdTile, EtdStatus> {
        let t = input(tile)?;
        let [w, h] = self.scene.size();
        let fits = |from: u32, n: u32, size: u32| {
            n >= 1 && from.checked_add(n).is_some_and(|end| end <= size)
        };
        if t.samples == 0 || !fits(t.x, t.width, w) || !fits(t.y, t.height, h) {
            return Err(ETD_E_ARGUMENT);
        }
        Ok(t)
    }
}

/// Where splats go.
enum Sink<'f> {
    /// The element reports none.
    None,
    /// To the caller.
    Hook(EtdHooks),
    /// To a film of the whole image.
    Film {
        film: Film,
        sums: &'f mut [EtdSum],
        width: u32,
    },
}

impl Sink<'_> {
    fn take(&mut self, pixel: [u32; 2], value: Rgb) {
        match self {
            Sink::None => (),
            Sink::Hook(hooks) => hooks.splat(pixel, value.to_array()),
            Sink::Film { film, sums, width } => film.add(sums, *width, pixel, value),
        }
    }
}

/// How a film adds, and what it had to refuse.
#[derive(Clone, Copy)]
struct Film {
    step: Step,
    refused: Refused,
}

impl Film {
    fn add(&mut self, sums: &mut [EtdSum], width: u32, [x, y]: [u32; 2], value: Rgb) {
        if let Some(place) = sums.get_mut(y as usize * width as usize + x as usize) {
            let mut sum = place.get();
            self.step.add(&mut sum, value, &mut self.refused);
            place.set(sum);
        }
    }
}

/// One sample of the pixel in column `x` and row `y` (from the top) into `rgb[3]`, linear RGB radiance. With n samples of each pixel,
/// pixel = (sum of what is returned + sum of splats to it)/n. The same (scene, settings, x, y, `sample`) always gives the same bits.
/// `hooks` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_estimate_pixel(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    x: u32,
    y: u32,
    sample: u64,
    rgb: *mut f32,
) -> EtdStatus {
    status_of((|| {
        let mut call = Call::new(scene, with, hooks, memory)?;
        let rgb = slice_mut(rgb, 3)?;
        let [w, h] = call.scene.size();
        if x >= w || y >= h {
            return Err(ETD_E_ARGUMENT);
        }
        call.needs_splat()?;
        let mut sink = Sink::Hook(call.hooks);
        let value = call.sample(&Element::Pixel([x, y]), pixel_id([x, y]), sample, &mut sink);
        for (out, v) in rgb.iter_mut().zip(value.to_array()) {
            *out = v;
        }
        Ok(())
    })())
}

/// Which samples of a batch.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdSamples {
    /// sizeof(EtdSamples).
    pub struct_size: u32,
    /// Samples of each element, at least 1.
    pub samples: u32,
    /// Index of the first of them.
    pub first_sample: u64,
    /// Number of the first element: with the sample's index it selects the random numbers. Element i has `first_id` + i.
    pub first_id: u64,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdSamples {}

/// The radiance that arrives along `count` rays: 3 floats each of `origins` (world units) and `directions` (from the origin outwards; any length but 0)
/// into 3 floats each of `rgb`, the mean of the samples. `ETD_LIGHT` is answered by `ETD_PATH`: no light walk meets a ray.
/// Cancelled: elements not yet done are left as they were. Wrong input: nothing is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_estimate_rays(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    origins: *const f32,
    directions: *const f32,
    count: usize,
    samples: *const EtdSamples,
    rgb: *mut f32,
) -> EtdStatus {
    status_of((|| {
        let mut call = Call::new(scene, with, hooks, memory)?;
        let (origins, directions) = (triples(origins, count)?, triples(directions, count)?);
        let element = |i: usize| {
            Some(Element::ray(
                position(origins.get(3 * i..3 * i + 3)?)?,
                direction(directions.get(3 * i..3 * i + 3)?)?,
            ))
        };
        call.batch(element, count, &input(samples)?, rgb)
    })())
}

/// The irradiance at `count` points: 3 floats each of `positions` (world units; they may lie on the scene's geometry) and `normals` (any length but 0),
/// on the side of the normal, into 3 floats each of `rgb`, the mean of the samples. Otherwise like `etd_estimate_rays`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_estimate_irradiance(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    positions: *const f32,
    normals: *const f32,
    count: usize,
    samples: *const EtdSamples,
    rgb: *mut f32,
) -> EtdStatus {
    status_of((|| {
        let mut call = Call::new(scene, with, hooks, memory)?;
        let (positions, normals) = (triples(positions, count)?, triples(normals, count)?);
        let scene = call.scene;
        let element = |i: usize| {
            Some(Element::irradiance(
                scene,
                position(positions.get(3 * i..3 * i + 3)?)?,
                direction(normals.get(3 * i..3 * i + 3)?)?,
            ))
        };
        call.batch(element, count, &input(samples)?, rgb)
    })())
}

/// Renders a tile: the mean of each pixel's samples into `rgb`, 3 floats a pixel, row by row, `floats` = 3 · width · height of the tile.
/// Splats, which may fall anywhere in the image, go to `hooks->splat`, undivided: add them up and divide by the samples per pixel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_render_tile(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    tile: *const EtdTile,
    rgb: *mut f32,
    floats: usize,
) -> EtdStatus {
    status_of((|| {
        let mut call = Call::new(scene, with, hooks, memory)?;
        let tile = call.tile(tile)?;
        let rgb = slice_mut(rgb, floats)?;
        if u64::from(tile.width) * u64::from(tile.height) * 3 != floats as u64 {
            return Err(ETD_E_SIZE);
        }
        call.needs_splat()?;
        let mut sink = Sink::Hook(call.hooks);
        for (out, pixel) in rgb.chunks_exact_mut(3).zip(pixels(&tile)) {
            let element = Element::Pixel(pixel);
            let id = pixel_id(pixel);
            let mean = call.mean(&element, id, tile.first_sample, tile.samples, &mut sink)?;
            for (o, m) in out.iter_mut().zip(mean) {
                *o = m;
            }
        }
        Ok(())
    })())
}

/// Renders a tile into exact sums of the whole image: `samples` for the pixels themselves, `splats` for what they add to others (may be null for
/// `ETD_PATH`, and may be the same array as no other). `pixels` is the image's width times its height. Give each thread its own sums, or its own
/// rows of `samples`; merge with `etd_film_merge`: any split of the work gives the same bits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_render_film(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    tile: *const EtdTile,
    samples: *mut EtdSum,
    splats: *mut EtdSum,
    pixels: usize,
) -> EtdStatus {
    status_of((|| {
        let mut call = Call::new(scene, with, hooks, memory)?;
        let tile = call.tile(tile)?;
        let [width, height] = call.scene.size();
        if u64::from(width) * u64::from(height) != pixels as u64 {
            return Err(ETD_E_SIZE);
        }
        if call.splats() && splats.is_null() {
            return Err(ETD_E_SPLAT);
        }
        if samples == splats {
            return Err(ETD_E_ARGUMENT);
        }
        let own = slice_mut(samples, pixels)?;
        let mut film = Film {
            step: Step::new(call.scene.film_exponent()),
            refused: Refused::default(),
        };
        let mut sink = Sink::Film {
            film,
            sums: slice_mut(splats, if splats.is_null() { 0 } else { pixels })?,
            width,
        };
        let result = (|| {
            for pixel in self::pixels(&tile) {
                for i in 0..u64::from(tile.samples) {
                    call.poll()?;
                    let index = tile.first_sample.wrapping_add(i);
                    let element = Element::Pixel(pixel);
                    let value = call.sample(&element, pixel_id(pixel), index, &mut sink);
                    film.add(own, width, pixel, value);
                }
            }
            Ok(())
        })();
        let mut refused = film.refused;
        if let Sink::Film { film, .. } = &sink {
            refused += film.refused;
        }
        call.scratch.counters().rejected += refused.saturated + refused.invalid;
        result
    })())
}

/// The pixels of a tile, row by row.
fn pixels(tile: &EtdTile) -> impl Iterator<Item = [u32; 2]> + use<> {
    let EtdTile {
        x,
        y,
        width,
        height,
        ..
    } = *tile;
    (y..y + height).flat_map(move |row| (x..x + width).map(move |column| [column, row]))
}

fn triples<'a>(pointer: *const f32, count: usize) -> Result<&'a [f32], EtdStatus> {
    slice(pointer, count.checked_mul(3).ok_or(ETD_E_SIZE)?)
}
