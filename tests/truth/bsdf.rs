//! Local models, textures and warps against what they claim of themselves and against closed forms.
//!
//! Every test runs on both precisions: the same files, on the same kernel source compiled twice.

#![allow(clippy::duplicate_mod)] // on purpose, see above
#![allow(clippy::unnecessary_cast)] // necessary in one of the two

#[path = "bsdf"]
mod single {
    use etendue as kernel;

    mod adjoint;
    mod blend;
    mod compiled;
    mod density;
    mod dirac;
    mod energy;
    mod extremes;
    mod filter;
    mod loss;
    mod oracles;
    mod texture;
    mod warp;
    mod zoo;
}

#[path = "bsdf"]
mod double {
    use etendue_f64 as kernel;

    mod adjoint;
    mod blend;
    mod compiled;
    mod density;
    mod dirac;
    mod energy;
    mod extremes;
    mod filter;
    mod loss;
    mod oracles;
    mod texture;
    mod warp;
    mod zoo;
}
