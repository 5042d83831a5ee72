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
