//! Chains of `ETD_METROPOLIS` (cargo feature `metropolis`). They trace by the scene's own ray tracer, with random numbers of their own.

use super::arguments::slice_mut;
use super::estimate::Call;
use super::hooks::EtdHooks;
use super::scene::EtdScene;
use super::scratch::EtdScratch;
use super::settings::EtdSettings;
use super::status::{
    ETD_E_ARGUMENT, ETD_E_HANDLE, ETD_E_MISALIGNED, ETD_E_NULL, ETD_E_SIZE, EtdStatus, status_of,
};
use crate::estimate::{Chain, Estimator};
use core::ffi::c_void;

/// What chain memory must be aligned to.
pub const ETD_CHAIN_ALIGN: usize = 16;

/// A chain of paths, made by `etd_chain_start` in memory of the caller. One thread at a time.
#[derive(Clone, Copy)]
pub struct EtdChain {
    magic: u64,
}

const MAGIC: u64 = 0x6e69_6168_4364_7445; // "EtdChain"

#[repr(C)]
struct Held {
    head: EtdChain,
    chain: Chain,
}

const _: () = assert!(align_of::<Held>() <= ETD_CHAIN_ALIGN);

/// The chain behind a handle.
fn chain<'a>(handle: *mut EtdChain) -> Result<&'a mut Chain, EtdStatus> {
    if handle.is_null() {
        return Err(ETD_E_NULL);
    }
    if handle.align_offset(ETD_CHAIN_ALIGN) != 0 {
        return Err(ETD_E_MISALIGNED);
    }
    // SAFETY: not null and aligned; live memory of the caller's, by the caller's word.
    if unsafe { handle.read() }.magic != MAGIC {
        return Err(ETD_E_HANDLE);
    }
    // SAFETY: only `etd_chain_start` writes the number, with a chain behind it; one thread at a time uses it, by the caller's word.
    Ok(unsafe { &mut (*handle.cast::<Held>()).chain })
}

/// What calls for chains have in common.
fn call<'a>(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
) -> Result<Call<'a>, EtdStatus> {
    let call = Call::new(scene, with, hooks, memory)?;
    let own = call.hooks.closest.is_none() && call.hooks.random.is_none();
    if own && call.settings.estimator == Estimator::Metropolis {
        Ok(call)
    } else {
        Err(ETD_E_ARGUMENT)
    }
}

/// Bytes of memory that a chain needs.
#[unsafe(no_mangle)]
pub extern "C" fn etd_chain_size() -> usize {
    size_of::<Held>()
}

/// Estimates of the mean (over pixels and channels, radiance) of what chains are to give, by samples number `first` to `first + count`, one each, into
/// `estimates[count]`. Their mean is what `etd_chain_advance` scales by; each chain should start from one of these samples, drawn in proportion to its
/// estimate: tens of thousands are a good number, and a few of each pixel; as many in a row as the image has pixels begin in each once. What
/// `with->above` leaves to the samples goes to `hooks->splat`, which must be there if that isn't 0: with n samples per pixel, the image is the sum of
/// these splats/n, and what chains give. `with->estimator` is `ETD_METROPOLIS`; `hooks` may be null, `closest` and `random` have to be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_chain_bootstrap(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    first: u64,
    count: usize,
    estimates: *mut f32,
) -> EtdStatus {
    status_of((|| {
        let mut call = call(scene, with, hooks, memory)?;
        if call.settings.mutations.above > 0.0 {
            call.needs_splat()?;
        }
        for (out, i) in slice_mut(estimates, count)?.iter_mut().zip(0..) {
            call.poll()?;
            let (scene, hooks, index) = (call.scene, call.hooks, first.wrapping_add(i));
            let below = &mut |pixel, value: crate::Rgb| hooks.splat(pixel, value.to_array());
            *out = scene.bootstrap(&call.settings, index, &mut call.scratch, below);
        }
        Ok(())
    })())
}

/// Makes chain number `id` in `memory` (`memory_size` ≥ `etd_chain_size()` bytes, aligned to `ETD_CHAIN_ALIGN`, the caller's to free) at sample `sample` of
/// `etd_chain_bootstrap`, whose scene and settings are the same. The number selects the random numbers. `*out` will point into the memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_chain_start(
    scene: *const EtdScene,
    with: *const EtdSettings,
    scratch: *mut EtdScratch,
    id: u64,
    sample: u64,
    memory: *mut c_void,
    memory_size: usize,
    out: *mut *mut EtdChain,
) -> EtdStatus {
    status_of((|| {
        if memory.is_null() || out.is_null() {
            return Err(ETD_E_NULL);
        }
        if memory.align_offset(ETD_CHAIN_ALIGN) != 0 || !out.is_aligned() {
            return Err(ETD_E_MISALIGNED);
        }
        if memory_size < size_of::<Held>() {
            return Err(ETD_E_SIZE);
        }
        let mut call = call(scene, with, core::ptr::null(), scratch)?;
        let held = memory.cast::<Held>();
        // SAFETY: large and aligned enough, and the caller's to give.
        let chain = unsafe {
            (&raw mut (*held).head).write(EtdChain { magic: MAGIC });
            (&raw mut (*held).chain).write(Chain::new());
            out.write(memory.cast());
            &mut (*held).chain
        };
        chain.start(call.scene, &call.settings, id, sample, &mut call.scratch);
        Ok(())
    })())
}

/// The most that a call of `etd_chain_advance` hands out, so that what splats are made of is finite: 3 channels × 2³² pixels × this are.
const MOST: f32 = 1e28;

/// Takes `steps` steps of a chain. `scale` is the image's mean, from bootstrap estimates; 0 ≤ `scale` × `steps` ≤ 1e28. Splats go to
/// `hooks->splat`, which must be there: with n steps per pixel of the image by all chains together, pixel = sum of splats to it/n. `closest` and
/// `random` have to be null; `cancelled` is asked before the first step, and a call that has begun takes all of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_chain_advance(
    scene: *const EtdScene,
    with: *const EtdSettings,
    hooks: *const EtdHooks,
    memory: *mut EtdScratch,
    handle: *mut EtdChain,
    scale: f32,
    steps: u32,
) -> EtdStatus {
    status_of((|| {
        let mut call = call(scene, with, hooks, memory)?;
        call.needs_splat()?;
        if !(scale >= 0.0 && scale * steps.max(1) as f32 <= MOST) {
            return Err(ETD_E_ARGUMENT);
        }
        let chain = chain(handle)?;
        call.poll()?;
        let hooks = call.hooks;
        let splat = &mut |pixel, value: crate::Rgb| hooks.splat(pixel, value.to_array());
        let (scene, settings, steps) = (call.scene, &call.settings, steps.into());
        chain.advance(scene, settings, scale, steps, &mut call.scratch, splat);
        Ok(())
    })())
}

/// The share of small steps that a chain has accepted since it started, 0 to 1: `step_size` is good where it is about a half. Tune it with chains
/// that are thrown away.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_chain_accepted(handle: *mut EtdChain, share: *mut f32) -> EtdStatus {
    status_of((|| {
        *super::arguments::place(share)? = chain(handle)?.accepted();
        Ok(())
    })())
}
