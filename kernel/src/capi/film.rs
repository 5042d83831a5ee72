//! The film for C: exact sums that any number of threads, tiles and machines may add up in any order.

use super::arguments::{slice, slice_mut};
use super::scene::{EtdScene, scene};
use super::status::{ETD_E_ARGUMENT, ETD_E_SIZE, EtdStatus, status_of};
use crate::film::{Step, Sum, merge};

/// Exact sums of red, green and blue: integers of 128 bits (two's complement), low word first. All zero at the beginning. The same bits on
/// every machine; may be stored and sent.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct EtdSum {
    /// Low and high words of red, green and blue.
    pub words: [u64; 6],
}

impl EtdSum {
    pub(super) fn get(&self) -> Sum {
        let [r0, r1, g0, g1, b0, b1] = self.words;
        let wide = |low, high| (u128::from(low) | u128::from(high) << 64) as i128;
        [wide(r0, r1), wide(g0, g1), wide(b0, b1)]
    }

    pub(super) fn set(&mut self, [r, g, b]: Sum) {
        let (low, high) = (|x: i128| x as u64, |x: i128| (x >> 64) as u64);
        self.words = [low(r), high(r), low(g), high(g), low(b), high(b)];
    }
}

/// Adds the `pixels` sums of `from` to those of `to`, exactly: the order of merging doesn't matter. The two must not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_merge(
    to: *mut EtdSum,
    from: *const EtdSum,
    pixels: usize,
) -> EtdStatus {
    status_of((|| {
        let from = slice(from, pixels)?;
        let to = slice_mut(to, pixels)?;
        for (t, f) in to.iter_mut().zip(from) {
            let mut sum = t.get();
            merge(&mut sum, &f.get());
            t.set(sum);
        }
        Ok(())
    })())
}

/// Turns the sums of a whole image into linear RGB, 3 floats a pixel, row by row from the top: (samples + splats)/`samples_per_pixel`.
/// `splats` may be null if there are none. `pixels` is the image's width times its height.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_resolve(
    handle: *const EtdScene,
    samples: *const EtdSum,
    splats: *const EtdSum,
    pixels: usize,
    samples_per_pixel: u64,
    rgb: *mut f32,
) -> EtdStatus {
    status_of((|| {
        let scene = scene(handle)?;
        let [w, h] = scene.size();
        if w as usize * h as usize != pixels {
            return Err(ETD_E_SIZE);
        }
        if samples_per_pixel == 0 {
            return Err(ETD_E_ARGUMENT);
        }
        let samples = slice(samples, pixels)?;
        let splats = slice(splats, if splats.is_null() { 0 } else { pixels })?;
        let rgb = slice_mut(rgb, pixels.checked_mul(3).ok_or(ETD_E_SIZE)?)?;
        let _control = super::control::Control::set();
        let step = Step::new(scene.film_exponent());
        let none = core::iter::repeat(&EtdSum { words: [0; 6] });
        for ((out, own), others) in rgb
            .chunks_exact_mut(3)
            .zip(samples)
            .zip(splats.iter().chain(none))
        {
            // Splats carry 1/pixels already, and one light walk goes with each sample of each pixel.
            let n = samples_per_pixel;
            let value = step.resolve(&own.get(), &others.get(), n, n, 1);
            for (o, m) in out.iter_mut().zip(value) {
                *o = m as f32;
            }
        }
        Ok(())
    })())
}
