//! Étendue: a light-transport kernel to embed.
#![no_std]
#![deny(unsafe_code)]

pub mod blob;
pub mod emitter;
pub mod estimate;
pub mod film;
pub mod path;
pub mod random;
pub mod real;
pub mod sensor;
pub mod shape;
pub mod spectrum;
pub mod surface;
pub mod warp;

pub use blob::Scene;
pub use estimate::{Estimator, Scratch, Settings, estimate_with};
pub use path::{Counters, Heuristic};
pub use spectrum::Rgb;
