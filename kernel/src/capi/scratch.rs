//! The memory that estimates work in, and what they count.

use super::arguments::{Sized32, output};
use super::status::{
    ETD_E_ARGUMENT, ETD_E_HANDLE, ETD_E_MISALIGNED, ETD_E_NULL, ETD_E_SIZE, EtdStatus, status_of,
};
use crate::blob::Scene;
use crate::estimate::{Scratch, ScratchView};
use crate::path::Counters;
use core::ffi::c_void;

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

/// The scratch behind a handle, of any capacity, for walks through `scene`.
pub(super) fn scratch<'a>(
    handle: *mut EtdScratch,
    scene: &Scene<'_>,
) -> Result<ScratchView<'a>, EtdStatus> {
    fn view<'a, const N: usize>(handle: *mut EtdScratch, scene: &Scene<'_>) -> ScratchView<'a> {
        held::<N>(handle).view(scene)
    }
    let capacity = capacity(handle)?;
    with_capacity!(capacity, view, handle, scene).map_err(|_| ETD_E_HANDLE)
}

/// What has been counted in the scratch behind a handle.
fn counters<'a>(handle: *mut EtdScratch) -> Result<&'a mut Counters, EtdStatus> {
    fn view<'a, const N: usize>(handle: *mut EtdScratch) -> &'a mut Counters {
        &mut held::<N>(handle).counters
    }
    let capacity = capacity(handle)?;
    with_capacity!(capacity, view, handle).map_err(|_| ETD_E_HANDLE)
}

/// The capacity that a handle's scratch was made with.
fn capacity(handle: *mut EtdScratch) -> Result<u32, EtdStatus> {
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
    Ok(head.capacity)
}

/// The scratch behind a handle that says `N`.
fn held<'a, const N: usize>(handle: *mut EtdScratch) -> &'a mut Scratch<N> {
    // SAFETY: only `make::<N>` writes the number and this capacity, with a scratch of it behind; one thread at
    // a time uses it, by the caller's word.
    unsafe { &mut (*handle.cast::<Held<N>>()).scratch }
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
        let counted = self::counters(handle)?;
        let out = output(counters)?;
        let c = *counted;
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
            *counted = Counters::ZERO;
        }
        Ok(())
    })())
}
