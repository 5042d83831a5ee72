//! The C functions of the kernel (`etendue::capi`) as a WebAssembly module, and a panic handler.
#![no_std]

pub use etendue::capi::*;

/// The kernel has no panic to handle; if it had one, the module would trap, which JavaScript sees as an exception.
#[cfg(target_arch = "wasm32")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
