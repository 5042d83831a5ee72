//! The kernel embedded: in C, without a system, in a microcontroller, in a browser, on a GPU.

mod bits;
mod c;
mod cornell;
mod cortex_m;
mod described;
mod freestanding;
mod gpu;
mod headers;
mod hosted;
mod misuse;
mod readme;
mod report;
mod tools;
mod versions;
mod web;
