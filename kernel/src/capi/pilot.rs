//! Which estimator suits a scene (cargo feature `pilot`).

use super::arguments::{Sized32, output};
use super::estimate::{Call, Sink};
use super::hooks::EtdHooks;
use super::scene::EtdScene;
use super::scratch::EtdScratch;
use super::settings::EtdSettings;
use super::status::{EtdStatus, status_of};
use crate::estimate::{Pilot, pixel_id};
use crate::sensor::Element;

/// What a pilot found of an estimator. All 0 but `struct_size` before the first call.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdPilot {
    /// sizeof(EtdPilot).
    pub struct_size: u32,
    /// Whether a sample met light: 0 or 1. Where another estimator's did, one without any has missed it.
    pub bright: u32,
    /// Squared error of all samples together, mean over channels, radiance².
    pub squared_error: f64,
    /// Samples taken.
    pub samples: u64,
    /// Their rays.
    pub rays: u64,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdPilot {}

/// Adds to `*sum` what pixels number `first` to `first + count` of a pilot say of `with->estimator`: two samples each of pixels all over the image, with numbers that no
/// render has. An image of as many samples per pixel has `squared_error`/`samples` as its mean squared error after one pass, and a sample costs
/// `rays`/`samples`: choose the estimator whose product of both is least; a few thousand pixels tell. No splats are reported; `hooks` may be null.
/// Cancelled: what has been done is in `*sum`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_pilot(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    first: u64,
    count: u32,
    sum: *mut EtdPilot,
) -> EtdStatus {
    status_of((|| {
        let mut call = Call::new(scene, with, hooks, memory)?;
        let out = output(sum)?;
        call.settings = call.settings.independent();
        let mut pilot = Pilot {
            squared_error: out.squared_error,
            samples: out.samples,
            rays: out.rays,
            bright: out.bright != 0,
        };
        let before = call.scratch.counters().rays();
        let mut result = Ok(());
        for i in 0..u64::from(count) {
            result = call.poll();
            if result.is_err() {
                break;
            }
            let (size, seed) = (call.scene.size(), call.settings.seed);
            pilot.look(size, seed, first.wrapping_add(i), |pixel, index| {
                let mut sink = Sink::Squares(0.0);
                let element = Element::Pixel(pixel);
                let own = call.sample(&element, pixel_id(pixel), index, &mut sink);
                (
                    own,
                    if let Sink::Squares(sum) = sink {
                        sum
                    } else {
                        0.0
                    },
                )
            });
        }
        pilot.rays = pilot
            .rays
            .wrapping_add(call.scratch.counters().rays().wrapping_sub(before));
        *out = EtdPilot {
            struct_size: out.struct_size,
            bright: pilot.bright.into(),
            squared_error: pilot.squared_error,
            samples: pilot.samples,
            rays: pilot.rays,
        };
        result
    })())
}
