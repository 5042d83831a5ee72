//! Rays and primitives: which triangle or sphere a ray meets first, and whether it meets any.
//!
//! [`Bvh`] is the kernel's own answer, over the tree in the blob; [`Tracer`] is the question, for
//! engines that bring their own. Same bits on every instruction set: `lanes.rs` says how.

mod bvh;
mod isa;
mod lanes;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
mod lanes_x86;
mod point;
mod ray;
mod slab;
mod sphere;
mod tree;
mod triangle;

pub use bvh::{Bvh, vertices};
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
pub use isa::{Avx2, Sse2};
pub use isa::{Instructions, Isa, IsaKind, Scalar};
pub use point::{Point, sphere_offset, triangle_normal, triangle_offset, unit_or_z};
pub use ray::{Hit, Ray, Tracer};
pub(crate) use slab::Bounds;
pub use tree::Tree;
