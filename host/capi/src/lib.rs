//! `libetendue_host.a`: all C functions of the kernel (`etendue.h`), and those that build, load and render scenes
//! (`etendue_host.h`).
//!
//! One room, one rule each: `boundary` lets nothing unwind into C; [`hooks`] are the caller's allocator, log and threads' number;
//! [`blob`] hands out memory; [`builder`] keeps a scene that C describes (`described`), with [`camera`], [`surface`], [`object`] and [`light`]
//! turning its structs into the host's description; [`load`] reads scene files; [`render`] renders.
// A pointer's contract stands in the function's own documentation, which is C's header.
#![allow(clippy::missing_safety_doc)]

pub use etendue::capi::*;

// The kernel's own: its rules for pointers and the control word are this library's, and stay private to both.
#[allow(dead_code)]
#[path = "../../../kernel/src/capi/arguments.rs"]
mod arguments;
#[path = "../../../kernel/src/capi/control.rs"]
mod control;

pub mod blob;
mod boundary;
pub mod builder;
pub mod camera;
mod described;
pub mod hooks;
pub mod light;
pub mod load;
pub mod medium;
pub mod object;
pub mod render;
pub mod surface;

// What the header asserts of C's side.
const _: () = {
    let pointer = size_of::<usize>();
    assert!(
        pointer != 8
            || size_of::<hooks::EtdHost>() == 8 + 4 * pointer
                && size_of::<blob::EtdBlob>() == 8 + 4 * pointer
                && size_of::<builder::EtdBuilt>() == 24
                && size_of::<camera::EtdCamera>() == 108
                && size_of::<surface::EtdMaterial>() == 120
                && size_of::<surface::EtdTexture>() == 72 + 2 * pointer
                && size_of::<object::EtdMesh>() == 40 + 4 * pointer
                && size_of::<object::EtdSphere>() == 48
                && size_of::<light::EtdLight>() == 104 + 2 * pointer
                && size_of::<medium::EtdMedium>() == 144 + 3 * (24 + 2 * pointer)
                && size_of::<load::EtdAdvice>() == 12
                && size_of::<render::EtdRender>() == 32 + 3 * pointer
                && size_of::<render::EtdRendered>() == 80
    );
};
