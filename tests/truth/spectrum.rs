//! Wavelengths: the observer, what colours stand for, four wavelengths per path, and glass that disperses.
//!
//! `tests/data/README.md` says where the numbers of the prism are from.

#![allow(clippy::duplicate_mod)] // the same tests, on the same kernel source compiled twice
#![allow(clippy::unnecessary_cast)] // necessary in one of the two

#[path = "spectrum"]
mod single {
    use etendue as kernel;

    mod hero;
    mod metal;
    mod observer;
    mod prism;
}

#[path = "spectrum"]
mod double {
    use etendue_f64 as kernel;

    mod hero;
    mod metal;
    mod observer;
    mod prism;
}
