//! The host: scene files to blobs, blobs to images.

pub mod blob;
pub mod compile;
pub mod description;
pub mod load;
