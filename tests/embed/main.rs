//! The kernel embedded: in C, without a system, in a microcontroller, in a browser, on a GPU.

mod cornell;
mod headers;
mod hosted;
mod misuse;
