//! `libetendue.a`: the C functions of the kernel (`etendue::capi`) and a panic handler, nothing else. No allocator, no
//! libc. `include/etendue.h` says what is in it.
#![no_std]

pub use kernel::capi::*;

/// The kernel has no panic to handle; `prove-no-panic` lets the linker say so.
#[cfg(feature = "prove-no-panic")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn etd_panic_is_reachable() -> !;
    }
    // SAFETY: never runs: nobody defines it, so nothing links that could get here.
    unsafe { etd_panic_is_reachable() }
}

/// The kernel has no panic to handle.
#[cfg(not(feature = "prove-no-panic"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// Panics if `index` > 2: `prove-no-panic` must not link with it.
#[cfg(feature = "plant-a-panic")]
#[unsafe(no_mangle)]
pub extern "C" fn etd_planted_panic(index: usize) -> u8 {
    [7, 8, 9][index]
}
