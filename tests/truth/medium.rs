//! Phase functions, free flight and transmittance against closed forms and quadrature, in both precisions.

#![allow(clippy::duplicate_mod)] // on purpose: the same files, on the same kernel source compiled twice
#![allow(clippy::unnecessary_cast)] // necessary in one of the two

#[path = "medium"]
mod single {
    use etendue as kernel;

    mod extremes;
    mod flight;
    mod grid;
    mod majorants;
    mod phase;
    mod ways;
}

#[path = "medium"]
mod double {
    use etendue_f64 as kernel;

    mod extremes;
    mod flight;
    mod grid;
    mod majorants;
    mod phase;
    mod ways;
}
