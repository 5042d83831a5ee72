//! Shared by the truth, agreement and golden tests.

pub mod bits;
pub mod fresnel;
pub mod fuzz;
pub mod media;
pub mod oracles;
pub mod place;
pub mod render;
pub mod scenes;
pub mod statistics;

/// Whether tests take more cases and samples (`ETENDUE_DEEP=1`) than what every change can wait for.
pub fn deep() -> bool {
    std::env::var_os("ETENDUE_DEEP").is_some_and(|v| !v.is_empty() && v != "0")
}

/// Samples of a comparison that takes so many if tests are deep: half of them if they aren't.
pub fn samples(all: u64) -> u64 {
    if deep() { all } else { all.div_ceil(2) }
}

/// The noise up to which such a comparison is of use: √2 times as much with half of the samples.
pub fn noise(all: f64) -> f64 {
    if deep() {
        all
    } else {
        all * std::f64::consts::SQRT_2
    }
}
