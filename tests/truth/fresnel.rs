//! Fresnel's equations: oracles, textbook amplitudes, and how many digits single precision keeps.
//!
//! `tests/data/README.md` says where the oracles are from.

#![allow(clippy::duplicate_mod)] // the same tests, on the same kernel source compiled twice
#![allow(clippy::unnecessary_cast)] // necessary in one of the two

#[path = "fresnel"]
mod single {
    use etendue as kernel;

    mod digits;
    mod hemisphere;
    mod oracles;
}

#[path = "fresnel"]
mod double {
    use etendue_f64 as kernel;

    mod digits;
    mod hemisphere;
    mod oracles;
}
