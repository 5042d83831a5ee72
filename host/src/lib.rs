//! The host: scene files to blobs, blobs to images.

pub mod description;
pub mod load;
