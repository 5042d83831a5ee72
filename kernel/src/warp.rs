//! From numbers in [0, 1) to points and directions, with their densities.
//!
//! Everything accepts 0 and the largest number below 1 and answers with finite numbers.

use crate::real::consts::FRAC_1_SQRT_2;
use crate::real::{INV_PI, PI, Real, Vec3, cos, erf, exp, safe_sqrt, sin, sqrt};

/// Uniform in the unit disc: concentric, so that neighbours stay neighbours (Shirley & Chiu 1997).
#[inline(always)]
pub fn disc(xi: [Real; 2]) -> [Real; 2] {
    let (x, y) = (2.0 * xi[0] - 1.0, 2.0 * xi[1] - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0, 0.0];
    }
    let (r, phi) = if x.abs() > y.abs() {
        (x, 0.25 * PI * (y / x))
    } else {
        (y, 0.5 * PI - 0.25 * PI * (x / y))
    };
    [r * cos(phi), r * sin(phi)]
}

/// Directions about +z with density cos θ/π: the disc lifted onto the hemisphere (Malley).
#[inline(always)]
pub fn cosine_hemisphere(xi: [Real; 2]) -> Vec3 {
    let [x, y] = disc(xi);
    Vec3::new(x, y, safe_sqrt(1.0 - x * x - y * y))
}

/// Density of [`cosine_hemisphere`] per solid angle.
#[inline(always)]
pub fn cosine_hemisphere_pdf(cos: Real) -> Real {
    if cos > 0.0 { cos * INV_PI } else { 0.0 }
}

/// Directions with density 1/4π.
#[inline(always)]
pub fn sphere(xi: [Real; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * xi[0];
    // 1 − z² as a product of what doesn't cancel near the poles.
    let r = 2.0 * sqrt(xi[0] * (1.0 - xi[0]));
    let phi = 2.0 * PI * xi[1];
    Vec3::new(r * cos(phi), r * sin(phi), z)
}

/// Directions about +z within the cone of half-angle θ, given 1 − cos θ: uniform per solid angle, and
/// without cancellation however narrow the cone.
#[inline(always)]
pub fn cone(one_minus_cos: Real, xi: [Real; 2]) -> Vec3 {
    let h = one_minus_cos * xi[0];
    let r = safe_sqrt(h * (2.0 - h));
    let phi = 2.0 * PI * xi[1];
    Vec3::new(r * cos(phi), r * sin(phi), 1.0 - h)
}

/// Barycentric weights of vertices 1 and 2, uniform over a triangle (Heitz 2019, "A low-distortion map").
#[inline(always)]
pub fn triangle(xi: [Real; 2]) -> [Real; 2] {
    let [a, b] = xi;
    if b > a {
        let u = 0.5 * a;
        [u, b - u]
    } else {
        let v = 0.5 * b;
        [a - v, v]
    }
}

/// A tent of half-width `radius`: density (1 − |x|/r)/r.
#[inline(always)]
pub fn tent(radius: Real, xi: Real) -> Real {
    let offset = if xi < 0.5 {
        sqrt(2.0 * xi) - 1.0
    } else {
        1.0 - sqrt(2.0 * (1.0 - xi))
    };
    radius * offset
}

/// Density of [`tent`].
#[inline(always)]
pub fn tent_pdf(radius: Real, x: Real) -> Real {
    let t = 1.0 - x.abs() / radius;
    if t > 0.0 { t / radius } else { 0.0 }
}

/// A Gaussian of standard deviation σ, shifted down to reach 0 at ±`radius` and cut there:
/// f(x) = e^(−x²/2σ²) − e^(−r²/2σ²).
#[derive(Clone, Copy, Debug)]
pub struct Gaussian {
    radius: Real,
    sigma: Real,
    /// f before the shift, at the radius.
    floor: Real,
    /// ∫₀ʳ f.
    half: Real,
}

/// Newton steps at most: they end at a relative change of 1e-6, which takes three or four but far out.
const STEPS: u32 = 16;

impl Gaussian {
    /// With half-width `radius`.
    #[inline]
    pub fn new(radius: Real, sigma: Real) -> Self {
        let ratio = radius / sigma;
        let mut g = Self {
            radius,
            sigma,
            floor: exp(-0.5 * ratio * ratio),
            half: 1.0,
        };
        g.half = g.integral(radius);
        g
    }

    /// f.
    #[inline(always)]
    fn value(&self, x: Real) -> Real {
        let ratio = x / self.sigma;
        let f = exp(-0.5 * ratio * ratio) - self.floor;
        if x.abs() < self.radius && f > 0.0 {
            f
        } else {
            0.0
        }
    }

    /// ∫₀ˣ f = σ√(π/2)·erf(x/σ√2) − x·e^(−r²/2σ²).
    #[inline(always)]
    fn integral(&self, x: Real) -> Real {
        let root_half_pi = sqrt(0.5 * PI);
        let whole = self.sigma * root_half_pi * erf(x / self.sigma * FRAC_1_SQRT_2);
        whole - x * self.floor
    }

    /// Density.
    #[inline]
    pub fn pdf(&self, x: Real) -> Real {
        0.5 * self.value(x) / self.half
    }

    /// Draws x by inverting the distribution. Its integral is concave on x > 0, so Newton's steps from 0 come
    /// to the root from below and never overshoot.
    #[inline]
    pub fn sample(&self, xi: Real) -> Real {
        let signed = 2.0 * xi - 1.0;
        let target = signed.abs() * self.half;
        let mut x = 0.0;
        for _ in 0..STEPS {
            let slope = self.value(x);
            if slope <= 0.0 {
                break;
            }
            let step = (target - self.integral(x)) / slope;
            x = (x + step).clamp(0.0, self.radius);
            if step.abs() <= 1e-6 * self.radius {
                break;
            }
        }
        x.copysign(signed)
    }
}
