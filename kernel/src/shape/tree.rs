//! The blob's own ray tracer, whatever the instruction set.

use super::bvh::Bvh;
#[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
use super::isa::{Avx2, Sse2};
use super::isa::{Instructions, Scalar};
use super::ray::{Hit, Ray, Tracer};

/// A scene's [`Bvh`] under the instruction set that the scene holds. Which one that is is asked at every ray, so that what asks is compiled
/// once for all of them: a branch that always goes the same way, before a call that there is in any case.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // named like `Instructions`
pub enum Tree<'a> {
    Scalar(Bvh<'a, Scalar>),
    #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
    Sse2(Bvh<'a, Sse2>),
    #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
    Avx2(Bvh<'a, Avx2>),
}

/// Calls a tree's own function.
macro_rules! each {
    ($tree:expr, $bvh:ident => $call:expr) => {
        match $tree {
            Tree::Scalar($bvh) => $call,
            #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
            Tree::Sse2($bvh) => $call,
            #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
            Tree::Avx2($bvh) => $call,
        }
    };
}

impl Tracer for Tree<'_> {
    #[inline(always)]
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        each!(self, bvh => bvh.closest(ray))
    }
    #[inline(always)]
    fn occluded(&self, ray: &Ray) -> bool {
        each!(self, bvh => bvh.occluded(ray))
    }
}

impl<'a> crate::blob::Scene<'a> {
    /// The blob's own ray tracer.
    #[inline(always)]
    pub fn tree(&self) -> Tree<'a> {
        match self.isa() {
            Instructions::Scalar(isa) => Tree::Scalar(self.tracer(isa)),
            #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
            Instructions::Sse2(isa) => Tree::Sse2(self.tracer(isa)),
            #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
            Instructions::Avx2(isa) => Tree::Avx2(self.tracer(isa)),
        }
    }
}
