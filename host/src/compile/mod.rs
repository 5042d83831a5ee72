//! From descriptions to blobs.

pub mod bvh;
