//! Several numbers at once: what the box and triangle tests are written in.
//!
//! A test is written once, over [`Lanes`]; scalar arrays, SSE2 and AVX2 registers implement it. Every
//! operation is one correctly rounded IEEE operation per lane and has the same answer in all of them,
//! also for NaN and signed zeros: that is why the instruction set never changes a bit of the result.

use core::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use crate::real::Real;

/// The most lanes that any [`Lanes`] has.
pub const MOST: usize = 8;

/// One answer per lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Lane i's answer as bit i.
    fn bits(self) -> u32;
}

/// A vector of `Real`s. A value can be made only with a `Token`, which exists only where the
/// instructions do; whoever holds a value may therefore compute with it.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Proof that the instructions exist.
    type Token: Copy;
    /// What comparisons give.
    type Mask: Mask;

    /// `x` in every lane.
    fn splat(token: Self::Token, x: Real) -> Self;
    /// The first lanes of an array.
    fn gather(token: Self::Token, x: &[Real; MOST]) -> Self;
    /// The lanes as an array; those that don't exist are 0.
    fn spill(self) -> [Real; MOST];
    /// Per lane `a < b ? a : b`, as x86's `minps`: `b` if either is NaN or both are zeros.
    fn min(self, b: Self) -> Self;
    /// Per lane `a > b ? a : b`, as x86's `maxps`: `b` if either is NaN or both are zeros.
    fn max(self, b: Self) -> Self;
    /// Whether a < b; false for NaN.
    fn lt(self, b: Self) -> Self::Mask;
    /// Whether a ≤ b; false for NaN.
    fn le(self, b: Self) -> Self::Mask;
    /// Whether a = b; false for NaN.
    fn eq(self, b: Self) -> Self::Mask;
}

/// Lanes that can be loaded from blob rows of `N` numbers.
pub trait Load<const N: usize>: Lanes {
    /// A row.
    fn load(token: Self::Token, row: &[f32; N]) -> Self;
}

/// Lanes that can be loaded from two rows of `N` numbers.
pub trait LoadPair<const N: usize>: Lanes {
    /// Row `a` in the lower lanes, row `b` in the upper ones.
    fn load_pair(token: Self::Token, a: &[f32; N], b: &[f32; N]) -> Self;
}

/// Lanes for every target: an array, which compilers turn into the vectors that the target always has.
#[derive(Clone, Copy)]
pub struct Array<const N: usize>([Real; N]);

/// Comparisons of [`Array`]s.
#[derive(Clone, Copy)]
pub struct Bits(u32);

impl BitAnd for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        Self(self.0 & b.0)
    }
}

impl BitOr for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, b: Self) -> Self {
        Self(self.0 | b.0)
    }
}

impl Mask for Bits {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
    }
}

impl<const N: usize> Array<N> {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(Real, Real) -> Real) -> Self {
        let mut out = self.0;
        for (x, y) in out.iter_mut().zip(b.0) {
            *x = f(*x, y);
        }
        Self(out)
    }

    #[inline(always)]
    fn compare(self, b: Self, f: impl Fn(Real, Real) -> bool) -> Bits {
        let mut bits = 0;
        for (lane, (x, y)) in self.0.into_iter().zip(b.0).enumerate() {
            bits |= u32::from(f(x, y)) << lane;
        }
        Bits(bits)
    }
}

macro_rules! array_operator {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<const N: usize> $trait for Array<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                self.zip(b, |x, y| x $operator y)
            }
        }
    };
}
array_operator!(Add, add, +);
array_operator!(Sub, sub, -);
array_operator!(Mul, mul, *);
array_operator!(Div, div, /);

impl<const N: usize> Lanes for Array<N> {
    type Token = ();
    type Mask = Bits;

    #[inline(always)]
    fn splat((): (), x: Real) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn gather((): (), x: &[Real; MOST]) -> Self {
        let mut out = [0.0; N];
        for (to, from) in out.iter_mut().zip(x) {
            *to = *from;
        }
        Self(out)
    }
    #[inline(always)]
    fn spill(self) -> [Real; MOST] {
        let mut out = [0.0; MOST];
        for (to, from) in out.iter_mut().zip(self.0) {
            *to = from;
        }
        out
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        self.zip(b, |x, y| if x < y { x } else { y })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.zip(b, |x, y| if x > y { x } else { y })
    }
    #[inline(always)]
    fn lt(self, b: Self) -> Bits {
        self.compare(b, |x, y| x < y)
    }
    #[inline(always)]
    fn le(self, b: Self) -> Bits {
        self.compare(b, |x, y| x <= y)
    }
    #[inline(always)]
    fn eq(self, b: Self) -> Bits {
        self.compare(b, |x, y| x == y)
    }
}

#[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
impl<const N: usize> Load<N> for Array<N> {
    #[inline(always)]
    fn load((): (), row: &[f32; N]) -> Self {
        let mut out = [0.0; N];
        for (to, from) in out.iter_mut().zip(row) {
            *to = *from as Real;
        }
        Self(out)
    }
}

#[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
impl LoadPair<4> for Array<8> {
    #[inline(always)]
    fn load_pair((): (), a: &[f32; 4], b: &[f32; 4]) -> Self {
        let mut out = [0.0; 8];
        for (to, from) in out.iter_mut().zip(a.iter().chain(b)) {
            *to = *from as Real;
        }
        Self(out)
    }
}
