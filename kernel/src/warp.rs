//! From numbers in [0, 1) to points and directions, with their densities.
//!
//! Everything accepts 0 and the largest number below 1 and answers with finite numbers.

use crate::real::{INV_PI, PI, Real, Vec3, erf, exp, expm1, safe_sqrt, sin_cos, sqrt};

/// The point at distance `r` and angle φ.
#[inline(always)]
pub fn polar(r: Real, phi: Real) -> [Real; 2] {
    let (sin, cos) = sin_cos(phi);
    [r * cos, r * sin]
}

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
    polar(r, phi)
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
    let [x, y] = polar(r, phi);
    Vec3::new(x, y, z)
}

/// Directions about +z within the cone of half-angle θ, given 1 − cos θ: uniform per solid angle, and
/// without cancellation however narrow the cone.
#[inline(always)]
pub fn cone(one_minus_cos: Real, xi: [Real; 2]) -> Vec3 {
    let h = one_minus_cos * xi[0];
    let r = safe_sqrt(h * (2.0 - h));
    let phi = 2.0 * PI * xi[1];
    let [x, y] = polar(r, phi);
    Vec3::new(x, y, 1.0 - h)
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
    /// f(0).
    top: Real,
    /// ∫₀¹ f.
    half: Real,
}

/// Below this q f is a small difference, and takes forms that don't cancel.
const WIDE: Real = 1.0;
/// Terms of the series for wide Gaussians: WIDEᵏ/k! below an ulp.
const TERMS: u32 = 17;
/// Halley's steps at most: two or three are enough, but in the tail.
const STEPS: u32 = 40;

impl Gaussian {
    /// With half-width `radius`.
    pub fn new(radius: Real, sigma: Real) -> Self {
        let ratio = radius / sigma;
        let q = 0.5 * ratio * ratio;
        let mut g = Self {
            radius,
            q,
            root: sqrt(q),
            floor: exp(-q),
            top: 1.0,
            half: 1.0,
        };
        (g.top, g.half) = (g.value(0.0, 1.0), g.integral(1.0));
        g
    }

    /// f, given e^(−qt²).
    #[inline(always)]
    fn value(&self, t: Real, bell: Real) -> Real {
        let f = if self.q < WIDE {
            bell * -expm1(-self.q * (1.0 - t) * (1.0 + t))
        } else {
            bell - self.floor
        };
        if t.abs() < 1.0 && f > 0.0 { f } else { 0.0 }
    }

    /// e^(−qt²).
    #[inline(always)]
    fn bell(&self, t: Real) -> Real {
        exp(-self.q * t * t)
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
    #[inline(always)]
    pub fn pdf(&self, x: Real) -> Real {
        let t = x / self.radius;
        0.5 * self.value(t, self.bell(t)) / (self.half * self.radius)
    }

    /// Draws x by inverting the distribution. Its integral is concave on x > 0, so that Newton's first step from 0 falls short of the root; from there
    /// go Halley's, t + n/(1 + n·f′/2f) with Newton's step n = −g/f, which leave the cube of what was amiss.
    #[inline(always)]
    pub fn sample(&self, xi: Real) -> Real {
        /// Steps this small, by how far either end is, were the last: what they leave is a millionth.
        const LAST: Real = 1e-2;
        let signed = 2.0 * xi - 1.0;
        let target = signed.abs() * self.half;
        let mut t = (target / self.top).min(1.0);
        for _ in 0..STEPS {
            let bell = self.bell(t);
            let f = self.value(t, bell);
            if f <= 0.0 {
                break;
            }
            let newton = (target - self.integral(t)) / f;
            // f′ = −2qt·e^(−qt²). At most twice Newton's: far from the root Halley's have no bound.
            let bend = 1.0 - newton * self.q * t * bell / f;
            let step = newton / bend.max(0.5);
            t = (t + step).clamp(0.0, 1.0);
            if step.abs() <= LAST * t.min(1.0 - t) {
                break;
            }
        }
        (self.radius * t).copysign(signed)
    }
}
