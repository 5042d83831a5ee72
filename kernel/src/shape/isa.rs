//! Instruction sets: which there are, which one the processor has, and how traversal is compiled for it.
//!
//! An [`Isa`] is a token that exists only where its instructions do; it chooses the [`Lanes`] types
//! and wraps traversal in a function compiled for it. All give the same bits.
#![allow(unsafe_code)] // functions with target features, and the processor's own description

use super::bvh::{self, Bvh};
use super::lanes::{Array, Lanes, Load, LoadPair};
use super::ray::{Hit, Ray};

#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
use super::lanes_x86::{F4, F4x2, F8};

/// An instruction set, as a proof that the processor has it.
pub trait Isa: Copy {
    /// What the lanes ask for.
    type Token: Copy;
    /// Eight lanes: the children of a node, two packets of triangles.
    type Eight: Load<8> + LoadPair<4> + Lanes<Token = Self::Token>;
    /// Four lanes: one packet of triangles.
    type Four: Load<4> + Lanes<Token = Self::Token>;
    /// Whether two packets cost less than twice one.
    const PAIRS: bool;

    /// The lanes' token.
    fn token(self) -> Self::Token;
    /// [`super::Tracer::closest`], compiled for this instruction set.
    fn closest(bvh: &Bvh<Self>, ray: &Ray) -> Option<Hit>;
    /// [`super::Tracer::occluded`], compiled for this instruction set.
    fn occluded(bvh: &Bvh<Self>, ray: &Ray) -> bool;
    /// Asks for the cache line at `address`, where that is possible.
    #[inline(always)]
    fn prefetch<T>(address: *const T) {
        let _ = address;
    }
}

/// What every target has; compilers still vectorise it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scalar;

impl Isa for Scalar {
    type Token = ();
    type Eight = Array<8>;
    type Four = Array<4>;
    const PAIRS: bool = false;

    #[inline(always)]
    fn token(self) {}
    fn closest(bvh: &Bvh<Self>, ray: &Ray) -> Option<Hit> {
        bvh::closest(bvh, ray)
    }
    fn occluded(bvh: &Bvh<Self>, ray: &Ray) -> bool {
        bvh::occluded(bvh, ray)
    }
}

/// What every x86-64 processor has.
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
#[derive(Clone, Copy, Debug, Default)]
pub struct Sse2;

#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
impl Isa for Sse2 {
    type Token = Self;
    type Eight = F4x2<Self>;
    type Four = F4<Self>;
    const PAIRS: bool = false;

    #[inline(always)]
    fn token(self) -> Self {
        self
    }
    fn closest(bvh: &Bvh<Self>, ray: &Ray) -> Option<Hit> {
        bvh::closest(bvh, ray)
    }
    fn occluded(bvh: &Bvh<Self>, ray: &Ray) -> bool {
        bvh::occluded(bvh, ray)
    }
    #[inline(always)]
    fn prefetch<T>(address: *const T) {
        Sse2::prefetch(address);
    }
}

/// AVX2, on x86-64 processors since 2013: made by [`Avx2::detect`].
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
impl Avx2 {
    /// Asks the processor and the system (Intel SDM vol. 1, §14.3 and §14.7.1): leaf 1 must report AVX
    /// and OSXSAVE, XCR0 must say that the system saves the wide registers, leaf 7 must report AVX2.
    pub fn detect() -> Option<Self> {
        use core::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};
        const OSXSAVE_AVX: u32 = 1 << 27 | 1 << 28;
        const XMM_YMM: u64 = 1 << 1 | 1 << 2;
        const AVX2: u32 = 1 << 5;

        #[target_feature(enable = "xsave")]
        fn enabled_state() -> u64 {
            // SAFETY: register 0 exists wherever OSXSAVE is set, which the caller has checked.
            unsafe { _xgetbv(0) }
        }

        if __cpuid(0).eax < 7 || __cpuid(1).ecx & OSXSAVE_AVX != OSXSAVE_AVX {
            return None;
        }
        // SAFETY: OSXSAVE says that `xgetbv` is there and enabled.
        let saved = unsafe { enabled_state() };
        if saved & XMM_YMM != XMM_YMM || __cpuid_count(7, 0).ebx & AVX2 == 0 {
            return None;
        }
        Some(Self(()))
    }
}

#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
impl Isa for Avx2 {
    type Token = Self;
    type Eight = F8;
    type Four = F4<Self>;
    const PAIRS: bool = true;

    #[inline(always)]
    fn token(self) -> Self {
        self
    }
    #[inline]
    fn closest(bvh: &Bvh<Self>, ray: &Ray) -> Option<Hit> {
        #[target_feature(enable = "avx2")]
        fn wide(bvh: &Bvh<Avx2>, ray: &Ray) -> Option<Hit> {
            bvh::closest(bvh, ray)
        }
        // SAFETY: the token in `bvh` proves AVX2.
        unsafe { wide(bvh, ray) }
    }
    #[inline]
    fn occluded(bvh: &Bvh<Self>, ray: &Ray) -> bool {
        #[target_feature(enable = "avx2")]
        fn wide(bvh: &Bvh<Avx2>, ray: &Ray) -> bool {
            bvh::occluded(bvh, ray)
        }
        // SAFETY: the token in `bvh` proves AVX2.
        unsafe { wide(bvh, ray) }
    }
    #[inline(always)]
    fn prefetch<T>(address: *const T) {
        Sse2::prefetch(address);
    }
}

/// The instruction sets by name, to store and to override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IsaKind {
    /// [`Scalar`].
    Scalar,
    /// `Sse2`.
    Sse2,
    /// `Avx2`.
    Avx2,
}

impl IsaKind {
    /// The fastest that this processor has.
    pub fn best() -> Self {
        [Self::Avx2, Self::Sse2]
            .into_iter()
            .find(|kind| kind.available())
            .unwrap_or(Self::Scalar)
    }

    /// Whether this processor has it.
    pub fn available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
            Self::Sse2 => true,
            #[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "f64")))]
            Self::Avx2 => Avx2::detect().is_some(),
            #[cfg(not(all(
                target_arch = "x86_64",
                target_feature = "sse2",
                not(feature = "f64")
            )))]
            _ => false,
        }
    }
}

/// An instruction set that has been found on this processor, with its proof: what a scene keeps, so that
/// nobody asks the processor again (on virtual machines that costs more than a path).
#[derive(Clone, Copy, Debug)]
pub enum Instructions {
    /// [`Scalar`].
    Scalar(Scalar),
    /// [`Sse2`].
    #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
    Sse2(Sse2),
    /// [`Avx2`].
    #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
    Avx2(Avx2),
}

impl Instructions {
    /// `kind`, or the best below it that this processor has.
    pub fn select(kind: IsaKind) -> Self {
        match kind {
            #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
            IsaKind::Avx2 => Avx2::detect().map_or(Self::Sse2(Sse2), Self::Avx2),
            #[cfg(all(target_arch = "x86_64", not(feature = "f64")))]
            IsaKind::Sse2 => Self::Sse2(Sse2),
            _ => Self::Scalar(Scalar),
        }
    }
}
