//! The C functions: what `etendue.h` declares (architecture: two static libraries, `kernel/capi` and `host/capi`).
//!
//! One room, one rule each:
//! [`status`] numbers what can go wrong; `arguments` turns pointers into references or a status;
//! `control` holds the floating-point control word; [`hooks`] holds the caller's functions, of which `foreign` makes a
//! [`crate::shape::Tracer`] and a [`crate::random::Sampler`]; [`scene`], [`settings`], [`scratch`], [`estimate`],
//! `chain`, `pilot`, [`film`] are the functions.
//!
//! No function allocates, keeps a pointer beyond the call (a scene keeps its blob), or unwinds: the kernel
//! has no panic to unwind with. What may be shared by threads is said at each type.
// Pointers from C, the control word.
#![allow(unsafe_code)]
// A pointer's contract stands in the function's own documentation, which is C's header.
#![allow(clippy::missing_safety_doc)]

mod arguments;
#[cfg(feature = "metropolis")]
pub mod chain;
mod control;
pub mod estimate;
pub mod film;
#[cfg(feature = "capi")]
mod foreign;
pub mod hooks;
#[cfg(feature = "pilot")]
pub mod pilot;
pub mod scene;
pub mod scratch;
pub mod settings;
pub mod status;

// What the header asserts of C's side.
const _: () = assert!(
    size_of::<settings::EtdSettings>() == 72
        && size_of::<estimate::EtdTile>() == 32
        && size_of::<estimate::EtdSamples>() == 24
        && size_of::<scratch::EtdCounters>() == 56
        && size_of::<hooks::EtdRay>() == 40
        && size_of::<hooks::EtdHit>() == 20
        && size_of::<film::EtdSum>() == 48
        && size_of::<scene::EtdBlobError>() == 16
        && size_of::<scene::EtdSceneInfo>() == 64
        && size_of::<hooks::EtdHooks>() == 8 + 6 * size_of::<usize>()
);
#[cfg(feature = "pilot")]
const _: () = assert!(size_of::<pilot::EtdPilot>() == 32);
