//! The host: scene files to blobs, blobs to images.
//!
//! ```text
//! scene file ──load──▶ description ──compile──▶ blob ──etendue::Scene::open──▶ render ──develop──▶ images
//! ```

pub mod blob;
#[cfg(feature = "program")]
pub mod chart;
#[cfg(feature = "program")]
pub mod command;
pub mod compile;
pub mod description;
pub mod develop;
pub mod load;
pub mod memory;
pub mod reach;
pub mod render;
pub mod scene;
mod spectra;
#[cfg(feature = "program")]
pub mod stability;
pub mod statistics;
