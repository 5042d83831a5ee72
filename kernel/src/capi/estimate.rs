//! Estimates: the calls that give light.

use super::arguments::{Sized32, input, optional, slice, slice_mut};
use super::control::Control;
use super::film::EtdSum;
#[cfg(feature = "capi")]
use super::foreign::{Numbers, Rays};
use super::hooks::{EtdHooks, direction, position};
use super::scene::{EtdScene, scene};
use super::scratch::{EtdScratch, scratch};
use super::settings::{EtdSettings, settings};
use super::status::{
    ETD_E_ARGUMENT, ETD_E_CANCELLED, ETD_E_SIZE, ETD_E_SPLAT, ETD_E_UNSUPPORTED, EtdStatus,
    status_of,
};
use crate::blob::Scene;
use crate::estimate::{ScratchView, Settings, estimate_with, pixel_id};
use crate::film::{Refused, Step};
use crate::sensor::Element;
use crate::spectrum::Rgb;

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

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdTile {}

/// What all estimating calls have in common.
pub(super) struct Call<'a> {
    pub scene: &'a Scene<'static>,
    pub settings: Settings,
    pub hooks: EtdHooks,
    pub scratch: ScratchView<'a>,
    _control: Control,
}

impl Call<'_> {
    pub fn new(
        handle: *const EtdScene,
        with: *const EtdSettings,
        hooks: *const EtdHooks,
        memory: *mut EtdScratch,
    ) -> Result<Self, EtdStatus> {
        let (scene, settings) = (scene(handle)?, settings(with)?);
        if settings.estimator.refuses(scene).is_some() {
            return Err(ETD_E_UNSUPPORTED);
        }
        Ok(Self {
            scene,
            settings,
            hooks: optional(hooks)?.unwrap_or(EtdHooks::NONE).check()?,
            scratch: scratch(memory, scene)?,
            _control: Control::set(),
        })
    }

    /// Whether samples of pixels add to other pixels.
    fn splats(&self) -> bool {
        self.settings.estimator.splats()
    }

    pub fn needs_splat(&self) -> Result<(), EtdStatus> {
        if self.splats() && self.hooks.splat.is_none() {
            return Err(ETD_E_SPLAT);
        }
        Ok(())
    }

    pub fn poll(&self) -> Result<(), EtdStatus> {
        if self.hooks.cancelled() {
            return Err(ETD_E_CANCELLED);
        }
        Ok(())
    }

    /// One sample, by the scene's own tracer or the caller's.
    #[inline(never)]
    pub fn sample(&mut self, element: &Element, id: u64, index: u64, sink: &mut Sink<'_>) -> Rgb {
        let Self {
            scene,
            settings,
            scratch,
            ..
        } = self;
        let splat = &mut |pixel, value| sink.take(pixel, value);
        #[cfg(feature = "capi")]
        let numbers = &mut Numbers::new(&self.hooks, settings, id, index);
        #[cfg(not(feature = "capi"))]
        let numbers = &mut settings.numbers(id, index);
        #[cfg(feature = "capi")]
        let rays = &Rays::new(&self.hooks, scene);
        #[cfg(not(feature = "capi"))]
        let rays = &scene.tree();
        estimate_with(scene, rays, settings, element, numbers, scratch, splat)
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
pub(super) enum Sink<'f> {
    /// The element reports none.
    None,
    /// To the sum of their squares.
    #[cfg(feature = "pilot")]
    Squares(f64),
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
            #[cfg(feature = "pilot")]
            Sink::Squares(sum) => *sum += crate::estimate::pilot::square(value),
            Sink::Hook(hooks) => hooks.splat(pixel, value.to_array()),
            Sink::Film { film, sums, width } => film.add(sums, *width, pixel, value),
        }
    }
}

/// How a film adds, and what it had to refuse.
#[derive(Clone, Copy)]
pub(super) struct Film {
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
/// `hooks` may be null. Where paths carry wavelengths (bit 14 of `needs`), a channel of one sample may be negative, here and in the functions
/// below: one wavelength is beyond the gamut of any red, green and blue.
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
