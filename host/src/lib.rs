//! The host: scene files to blobs, blobs to images.

pub mod compile;
pub mod description;
