//! The kernel embedded: in C, without a system, in a microcontroller, in a browser, on a GPU.

mod bits;
mod c;
mod cortex_m;
mod freestanding;
mod gpu;
mod headers;
mod tools;
mod versions;
