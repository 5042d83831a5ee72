//! From numbers in [0, 1) to points and directions, with their densities.
//!
//! Everything accepts 0 and the largest number below 1 and answers with finite numbers.

use crate::real::{INV_PI, PI, Real, Vec3, cos, erf, exp, expm1, safe_sqrt, sin, sqrt};

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

/// A Gaussian of standard deviation σ, shifted down to reach 0 at ±`radius` r and cut there. With t = x/r and
/// q = r²/2σ²: f(t) = e^(−qt²) − e^(−q).
#[derive(Clone, Copy, Debug)]
pub struct Gaussian {
    radius: Real,
    q: Real,
    root: Real,
    /// e^(−q).
    floor: Real,
    /// ∫₀¹ f.
    half: Real,
}

/// Below this q f is a small difference, and takes forms that don't cancel.
const WIDE: Real = 1.0;
/// Terms of the series for wide Gaussians: WIDEᵏ/k! below an ulp.
const TERMS: u32 = 17;
/// Newton steps at most. They end at a relative change of 1e-6, which takes three or four, but more in the tail.
const STEPS: u32 = 40;

impl Gaussian {
    /// With half-width `radius`.
    #[inline]
    pub fn new(radius: Real, sigma: Real) -> Self {
        let ratio = radius / sigma;
        let q = 0.5 * ratio * ratio;
        let mut g = Self {
            radius,
            q,
            root: sqrt(q),
            floor: exp(-q),
            half: 1.0,
        };
        g.half = g.integral(1.0);
        g
    }

    /// f.
    #[inline(always)]
    fn value(&self, t: Real) -> Real {
        let f = if self.q < WIDE {
            exp(-self.q * t * t) * -expm1(-self.q * (1.0 - t) * (1.0 + t))
        } else {
            exp(-self.q * t * t) - self.floor
        };
        if t.abs() < 1.0 && f > 0.0 { f } else { 0.0 }
    }

    /// ∫₀ᵗ f = √(π/4q)·erf(t√q) − t·e^(−q) = e^(−q)·Σₖ qᵏ/k!·Iₖ with Iₖ = ∫₀ᵗ (1−s²)ᵏ, k ≥ 1, for which
    /// (2k+1)·Iₖ = t(1−t²)ᵏ + 2k·Iₖ₋₁: only positive terms.
    #[inline(always)]
    fn integral(&self, t: Real) -> Real {
        #[allow(clippy::excessive_precision)] // not excessive in the double-precision package
        const HALF_ROOT_PI: Real = 0.886_226_925_452_758;
        if self.q >= WIDE {
            return HALF_ROOT_PI / self.root * erf(t * self.root) - t * self.floor;
        }
        let base = (1.0 - t) * (1.0 + t);
        let (mut power, mut moment, mut coefficient, mut sum) = (1.0, t, self.floor, 0.0);
        for k in 1..=TERMS {
            let k = k as Real;
            power *= base;
            moment = (t * power + 2.0 * k * moment) / (2.0 * k + 1.0);
            coefficient *= self.q / k;
            sum += coefficient * moment;
        }
        sum
    }

    /// Density.
    #[inline]
    pub fn pdf(&self, x: Real) -> Real {
        0.5 * self.value(x / self.radius) / (self.half * self.radius)
    }

    /// Draws x by inverting the distribution. Its integral is concave on x > 0, so Newton's steps from 0 come
    /// to the root from below and never overshoot: a step back is rounding.
    #[inline]
    pub fn sample(&self, xi: Real) -> Real {
        let signed = 2.0 * xi - 1.0;
        let target = signed.abs() * self.half;
        let mut t = 0.0;
        for _ in 0..STEPS {
            let slope = self.value(t);
            if slope <= 0.0 {
                break;
            }
            let step = (target - self.integral(t)) / slope;
            t = (t + step).clamp(0.0, 1.0);
            if step <= 1e-6 * t {
                break;
            }
        }
        (self.radius * t).copysign(signed)
    }
}
