//! `Real`, the number everything is computed in, and the functions on it under their field names.
//!
//! One source, two precisions: package `etendue` has `Real = f32`, package `etendue-f64` (the same
//! files) has `Real = f64`. All transcendentals come from `libm`, so that every target computes the
//! same bits (`std`'s differ by platform); nothing here or elsewhere contracts to FMA.

#[cfg(not(feature = "f64"))]
mod precision {
    /// The number everything is computed in: `f32` in this package.
    pub type Real = f32;
    /// Three `Real`s. `Vec3A` is never used: its `normalize` differs between instruction sets.
    pub type Vec3 = glam::Vec3;
    pub use core::f32::consts;
    #[cfg(not(target_arch = "nvptx64"))]
    pub use libm::sqrtf as sqrt;
    pub use libm::{
        acosf as acos, asinf as asin, atan2f as atan2, cbrtf as cbrt, erff as erf, expf as exp,
        expm1f as expm1, log1pf as log1p, logf as log, powf as pow, sincosf as sin_cos,
        tanf as tan,
    };

    /// √x by the GPU's own instruction: correctly rounded like libm's, and many times faster than it is there.
    #[cfg(target_arch = "nvptx64")]
    #[inline(always)]
    pub fn sqrt(x: f32) -> f32 {
        core::f32::math::sqrt(x)
    }

    /// ξ ∈ [0, 1) from 32 random bits: the upper 24, so that the result is exact and below 1.
    #[inline(always)]
    pub fn unit(bits: u32) -> Real {
        (bits >> 8) as f32 * UNIT_STEP
    }

    /// The step of [`unit()`].
    pub const UNIT_STEP: Real = 1.0 / 16_777_216.0;
    /// The largest `Real` below 1.
    pub const ONE_MINUS: Real = 1.0 - f32::EPSILON / 2.0;
}

#[cfg(feature = "f64")]
mod precision {
    /// The number everything is computed in: `f64` in this package.
    pub type Real = f64;
    /// Three `Real`s.
    pub type Vec3 = glam::DVec3;
    pub use core::f64::consts;
    pub use libm::{
        acos, asin, atan2, cbrt, erf, exp, expm1, log, log1p, pow, sincos as sin_cos, sqrt, tan,
    };

    /// ξ ∈ [0, 1) from 32 random bits, all of them: the same ξ as in single precision up to rounding,
    /// so that the two precisions walk the same paths.
    #[inline(always)]
    pub fn unit(bits: u32) -> Real {
        f64::from(bits) * UNIT_STEP
    }

    /// The step of [`unit()`].
    pub const UNIT_STEP: Real = 1.0 / 4_294_967_296.0;
    /// The largest `Real` below 1.
    pub const ONE_MINUS: Real = 1.0 - f64::EPSILON / 2.0;
}

pub use precision::*;

/// π.
pub const PI: Real = consts::PI;
/// 1/π.
pub const INV_PI: Real = consts::FRAC_1_PI;
/// Half the distance between 1 and the next `Real`: the bound on one rounding.
pub const UNIT_ROUNDOFF: Real = Real::EPSILON * 0.5;

/// γₙ = n·u / (1 − n·u): the bound on the relative error of n roundings (Higham 2002, §3.1).
pub const fn gamma(n: u32) -> Real {
    let nu = n as Real * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// x².
#[inline(always)]
pub fn square(x: Real) -> Real {
    x * x
}

/// √x of what rounding may have pushed below zero: 0 there.
#[inline(always)]
pub fn safe_sqrt(x: Real) -> Real {
    sqrt(if x > 0.0 { x } else { 0.0 })
}

/// A blob's vector as a [`Vec3`].
#[inline(always)]
#[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
pub fn vec3(v: [f32; 3]) -> Vec3 {
    Vec3::new(v[0] as Real, v[1] as Real, v[2] as Real)
}

/// A right-handed orthonormal frame around the unit vector `n`: (tangent, bitangent).
/// Duff et al. 2017, "Building an orthonormal basis, revisited", listing 3.
#[inline(always)]
pub fn tangents(n: Vec3) -> (Vec3, Vec3) {
    let sign = (1.0 as Real).copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}

/// An orthonormal shading frame; `z` is the normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Tangent.
    pub x: Vec3,
    /// Bitangent.
    pub y: Vec3,
    /// Normal.
    pub z: Vec3,
}

impl Frame {
    /// The frame around the unit normal `n`.
    #[inline(always)]
    pub fn around(n: Vec3) -> Self {
        let (x, y) = tangents(n);
        Self { x, y, z: n }
    }

    /// World to local.
    #[inline(always)]
    pub fn local(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    /// Local to world.
    #[inline(always)]
    pub fn world(&self, w: Vec3) -> Vec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}
