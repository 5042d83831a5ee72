//! [`Lanes`] in the registers of x86-64: SSE2, which every such processor has, and AVX2.
#![allow(unsafe_code)] // vector instructions, and loads that are as wide as their source

use core::arch::x86_64::*;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use super::isa::{Avx2, Sse2};
use super::lanes::{Lanes, Load, LoadPair, MOST, Mask};

/// Four lanes. `T` is the token that stands behind them: with [`Avx2`] the same operations come out
/// in three-operand form.
#[derive(Clone, Copy)]
pub struct F4<T>(__m128, T);

/// Eight lanes as two registers of SSE2.
#[derive(Clone, Copy)]
pub struct F4x2<T>(F4<T>, F4<T>);

/// Eight lanes as a register of AVX.
#[derive(Clone, Copy)]
pub struct F8(__m256);

/// Comparisons of [`F4`].
#[derive(Clone, Copy)]
pub struct M4(__m128);

/// Comparisons of [`F4x2`].
#[derive(Clone, Copy)]
pub struct M4x2(__m128, __m128);

/// Comparisons of [`F8`].
#[derive(Clone, Copy)]
pub struct M8(__m256);

/// Implements an operator for four and eight lanes.
macro_rules! operator {
    ($trait:ident, $method:ident, $four:ident, $eight:ident) => {
        impl<T> $trait for F4<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                // SAFETY: SSE2 is part of x86-64.
                Self(unsafe { $four(self.0, b.0) }, self.1)
            }
        }
        impl<T> $trait for F4x2<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                Self(self.0.$method(b.0), self.1.$method(b.1))
            }
        }
        impl $trait for F8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                // SAFETY: an `F8` is only made with an `Avx2`, which proves the instructions.
                Self(unsafe { $eight(self.0, b.0) })
            }
        }
    };
}
operator!(Add, add, _mm_add_ps, _mm256_add_ps);
operator!(Sub, sub, _mm_sub_ps, _mm256_sub_ps);
operator!(Mul, mul, _mm_mul_ps, _mm256_mul_ps);
operator!(Div, div, _mm_div_ps, _mm256_div_ps);

/// Implements an operator for masks.
macro_rules! mask_operator {
    ($trait:ident, $method:ident, $four:ident, $eight:ident) => {
        impl $trait for M4 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                // SAFETY: SSE2 is part of x86-64.
                Self(unsafe { $four(self.0, b.0) })
            }
        }
        impl $trait for M4x2 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                // SAFETY: SSE2 is part of x86-64.
                Self(unsafe { $four(self.0, b.0) }, unsafe { $four(self.1, b.1) })
            }
        }
        impl $trait for M8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                // SAFETY: an `M8` comes from `F8`s, which are only made with an `Avx2`.
                Self(unsafe { $eight(self.0, b.0) })
            }
        }
    };
}
mask_operator!(BitAnd, bitand, _mm_and_ps, _mm256_and_ps);
mask_operator!(BitOr, bitor, _mm_or_ps, _mm256_or_ps);

impl Mask for M4 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: SSE2 is part of x86-64.
        unsafe { _mm_movemask_ps(self.0) as u32 }
    }
}

impl Mask for M4x2 {
    #[inline(always)]
    fn bits(self) -> u32 {
        M4(self.0).bits() | M4(self.1).bits() << 4
    }
}

impl Mask for M8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: an `M8` comes from `F8`s, which are only made with an `Avx2`.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

impl<T: Copy> Lanes for F4<T> {
    type Token = T;
    type Mask = M4;

    #[inline(always)]
    fn splat(token: T, x: f32) -> Self {
        // SAFETY: SSE2 is part of x86-64.
        Self(unsafe { _mm_set1_ps(x) }, token)
    }
    #[inline(always)]
    fn gather(token: T, x: &[f32; MOST]) -> Self {
        // SAFETY: SSE2 is part of x86-64; 16 of the array's 32 bytes, unaligned.
        Self(unsafe { _mm_loadu_ps(x.as_ptr()) }, token)
    }
    #[inline(always)]
    fn spill(self) -> [f32; MOST] {
        let mut out = [0.0; MOST];
        // SAFETY: SSE2 is part of x86-64; 16 of the array's 32 bytes, unaligned.
        unsafe { _mm_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: SSE2 is part of x86-64.
        Self(unsafe { _mm_min_ps(self.0, b.0) }, self.1)
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: SSE2 is part of x86-64.
        Self(unsafe { _mm_max_ps(self.0, b.0) }, self.1)
    }
    #[inline(always)]
    fn lt(self, b: Self) -> M4 {
        // SAFETY: SSE2 is part of x86-64.
        M4(unsafe { _mm_cmplt_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn le(self, b: Self) -> M4 {
        // SAFETY: SSE2 is part of x86-64.
        M4(unsafe { _mm_cmple_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn eq(self, b: Self) -> M4 {
        // SAFETY: SSE2 is part of x86-64.
        M4(unsafe { _mm_cmpeq_ps(self.0, b.0) })
    }
}

impl<T: Copy> Load<4> for F4<T> {
    #[inline(always)]
    fn load(token: T, row: &[f32; 4]) -> Self {
        // SAFETY: SSE2 is part of x86-64; the row's 16 bytes, unaligned.
        Self(unsafe { _mm_loadu_ps(row.as_ptr()) }, token)
    }
}

impl<T: Copy> Lanes for F4x2<T> {
    type Token = T;
    type Mask = M4x2;

    #[inline(always)]
    fn splat(token: T, x: f32) -> Self {
        Self(F4::splat(token, x), F4::splat(token, x))
    }
    #[inline(always)]
    fn gather(token: T, x: &[f32; MOST]) -> Self {
        Self::load(token, x)
    }
    #[inline(always)]
    fn spill(self) -> [f32; MOST] {
        let mut out = [0.0; MOST];
        // SAFETY: SSE2 is part of x86-64; the array's 32 bytes, unaligned.
        unsafe {
            _mm_storeu_ps(out.as_mut_ptr(), self.0.0);
            _mm_storeu_ps(out.as_mut_ptr().add(4), self.1.0);
        }
        out
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(self.0.min(b.0), self.1.min(b.1))
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(self.0.max(b.0), self.1.max(b.1))
    }
    #[inline(always)]
    fn lt(self, b: Self) -> M4x2 {
        M4x2(self.0.lt(b.0).0, self.1.lt(b.1).0)
    }
    #[inline(always)]
    fn le(self, b: Self) -> M4x2 {
        M4x2(self.0.le(b.0).0, self.1.le(b.1).0)
    }
    #[inline(always)]
    fn eq(self, b: Self) -> M4x2 {
        M4x2(self.0.eq(b.0).0, self.1.eq(b.1).0)
    }
}

impl<T: Copy> Load<8> for F4x2<T> {
    #[inline(always)]
    fn load(token: T, row: &[f32; 8]) -> Self {
        // SAFETY: SSE2 is part of x86-64; the row's 32 bytes, unaligned.
        let (a, b) = unsafe {
            (
                _mm_loadu_ps(row.as_ptr()),
                _mm_loadu_ps(row.as_ptr().add(4)),
            )
        };
        Self(F4(a, token), F4(b, token))
    }
}

impl<T: Copy> LoadPair<4> for F4x2<T> {
    #[inline(always)]
    fn load_pair(token: T, a: &[f32; 4], b: &[f32; 4]) -> Self {
        Self(F4::load(token, a), F4::load(token, b))
    }
}

impl Lanes for F8 {
    type Token = Avx2;
    type Mask = M8;

    #[inline(always)]
    fn splat(_: Avx2, x: f32) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn gather(token: Avx2, x: &[f32; MOST]) -> Self {
        Self::load(token, x)
    }
    #[inline(always)]
    fn spill(self) -> [f32; MOST] {
        let mut out = [0.0; MOST];
        // SAFETY: an `F8` is only made with an `Avx2`; the array's 32 bytes, unaligned.
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: an `F8` is only made with an `Avx2`.
        Self(unsafe { _mm256_min_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: an `F8` is only made with an `Avx2`.
        Self(unsafe { _mm256_max_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn lt(self, b: Self) -> M8 {
        // SAFETY: an `F8` is only made with an `Avx2`.
        M8(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0) })
    }
    #[inline(always)]
    fn le(self, b: Self) -> M8 {
        // SAFETY: an `F8` is only made with an `Avx2`.
        M8(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0) })
    }
    #[inline(always)]
    fn eq(self, b: Self) -> M8 {
        // SAFETY: an `F8` is only made with an `Avx2`.
        M8(unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, b.0) })
    }
}

impl Load<8> for F8 {
    #[inline(always)]
    fn load(_: Avx2, row: &[f32; 8]) -> Self {
        // SAFETY: the token proves AVX2; the row's 32 bytes, unaligned.
        Self(unsafe { _mm256_loadu_ps(row.as_ptr()) })
    }
}

impl LoadPair<4> for F8 {
    #[inline(always)]
    fn load_pair(_: Avx2, a: &[f32; 4], b: &[f32; 4]) -> Self {
        // SAFETY: the token proves AVX2; the rows' 16 bytes each, unaligned.
        Self(unsafe {
            let low = _mm256_castps128_ps256(_mm_loadu_ps(a.as_ptr()));
            _mm256_insertf128_ps::<1>(low, _mm_loadu_ps(b.as_ptr()))
        })
    }
}

impl Sse2 {
    /// Asks for the cache line at `address`; any address will do.
    #[inline(always)]
    pub(super) fn prefetch<T>(address: *const T) {
        // SAFETY: SSE is part of x86-64, and a prefetch of any address is harmless.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) };
    }
}
