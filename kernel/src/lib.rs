//! Étendue: a light-transport kernel to embed. `no_std`, no allocation; one flat blob in, light out.
//!
//! # The tour
//!
//! 1. [`Scene::open`] checks a blob and views it as a scene. Any bytes give a scene or a reason.
//! 2. [`Settings`] say how: [`Estimator`], [`Heuristic`], depth, seed.
//! 3. [`Scratch`] is the memory that an estimate works in. It is yours; its capacity bounds the stored light
//!    walk, not the length of paths.
//! 4. [`Scene::estimate`] gives one sample of a pixel (and its splats), [`Scene::radiance`] one along a ray,
//!    [`Scene::irradiance`] one at a point with a normal. [`film`] sums samples without rounding them twice.
//!
//! ```no_run
//! use etendue::{Estimator, Scene, Scratch, Settings, real::Vec3};
//!
//! # fn blob() -> &'static [u8] { &[] }
//! let scene = Scene::open(blob())?;
//! let settings = Settings { estimator: Estimator::Path, ..Settings::default() };
//! let mut scratch = Scratch::<32>::new();
//! let mut sum = 0.0;
//! for index in 0..256 {
//!     sum += scene.irradiance(&settings, Vec3::ZERO, Vec3::Z, 0, index, &mut scratch).g;
//! }
//! println!("green irradiance: {} W/m²", sum / 256.0);
//! # Ok::<(), etendue::blob::BlobError>(())
//! ```
//!
//! An engine that has its own acceleration structure or random numbers implements [`shape::Tracer`] or
//! [`random::Sampler`] and calls [`estimate_with`].
//!
//! # The rooms
//!
//! In the order in which they depend on each other: [`real`], [`spectrum`] and [`instance`], [`random`], [`warp`]; [`blob`] and [`shape`] (the scene
//! and its geometry); [`surface`]; [`medium`]; [`emitter`]; [`sensor`]; [`path`]; [`mod@estimate`]; [`film`]. A new local model is one file in
//! `surface/` and one line in its `mod.rs`; a new estimator likewise.
//!
//! # The same bits
//!
//! What sample (pixel, index) contributes is a pure function of (blob, settings, index): no FMA, no fast-math, all
//! transcendentals from `libm`, the same operations in the same order on every instruction set.
#![no_std]
#![deny(unsafe_code)]
// The compiler for GPUs is a nightly one in any case.
#![cfg_attr(
    target_arch = "nvptx64",
    feature(abi_ptx, core_float_math, stdarch_nvptx)
)]

pub mod blob;
#[cfg(feature = "capi-core")]
pub mod capi;
pub mod emitter;
pub mod estimate;
pub mod film;
#[cfg(any(all(target_arch = "nvptx64", feature = "gpu"), test))]
pub mod gpu;
pub mod instance;
pub mod medium;
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
