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
