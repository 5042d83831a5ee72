//! How much light a smooth boundary reflects. Exact, unpolarised; Schlick's approximation as an option.

use crate::real::{Real, sqrt, square};

/// What a dielectric boundary does to light that arrives under a given angle.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    /// R, reflected.
    pub reflected: Real,
    /// 1 − R, transmitted; by its own formula, so that it keeps its digits at grazing angles.
    pub transmitted: Real,
    /// Cosine of the refracted direction; 0 under total internal reflection.
    pub cos_t: Real,
}

/// Fresnel's equations for light in a medium of index `from` meeting one of index `to` under `cos_i` ∈ [0, 1].
///
/// With a = n₁·cos_i, b = n₂·cos_t: R_s = ((a−b)/(a+b))², 1 − R_s = 4ab/(a+b)²; R_p likewise with
/// a = n₂·cos_i, b = n₁·cos_t. Neither form cancels: a − b is (a² − b²)/(a + b), and
/// a² − b² = n₁² − n₂² whatever the angle (for p: (n₂² − n₁²)(1 − sin²(1 + n₁²/n₂²))). The smaller of R
/// and 1 − R comes from its formula, the other is its complement: they add up to 1 even where b has lost
/// digits, close to the critical angle.
///
/// Both indices and not their quotient: seen from inside, 1/1.0001 would round 1 − 1/1.0001 by 3·10⁻⁴.
#[inline(always)]
pub fn dielectric(from: Real, to: Real, cos_i: Real) -> Dielectric {
    let sin_squared = sin_squared(cos_i);
    let b_squared = refracted_squared(from, to, cos_i, sin_squared);
    if b_squared <= 0.0 {
        return Dielectric {
            reflected: 1.0,
            transmitted: 0.0,
            cos_t: 0.0,
        };
    }
    let b = sqrt(b_squared);
    let cos_t = b / to;
    let excess = (to - from) * (to + from);
    let s = part(from * cos_i, b, -excess);
    let p = part(
        to * cos_i,
        from * cos_t,
        excess * (1.0 - sin_squared * (1.0 + square(from / to))),
    );
    let (r, t) = (0.5 * (s.0 + p.0), 0.5 * (s.1 + p.1));
    let (reflected, transmitted) = if r < t { (r, 1.0 - r) } else { (1.0 - t, t) };
    Dielectric {
        reflected,
        transmitted,
        cos_t,
    }
}

/// 1 − cos²; 0 for a cosine that rounding left above 1.
#[inline(always)]
fn sin_squared(cos: Real) -> Real {
    ((1.0 - cos) * (1.0 + cos)).max(0.0)
}

/// n₂² − n₁²sin²_i, which is (n₂cos_t)², in the form of which less is lost: at grazing angles
/// (n₂² − n₁²) + n₁²cos²_i, which keeps its digits for indices close to each other.
#[inline(always)]
fn refracted_squared(from: Real, to: Real, cos_i: Real, sin_squared: Real) -> Real {
    if sin_squared < 0.5 {
        square(to) - square(from) * sin_squared
    } else {
        (to - from) * (to + from) + square(from * cos_i)
    }
}

/// ((a−b)/(a+b))² and 4ab/(a+b)², given a² − b².
#[inline(always)]
fn part(a: Real, b: Real, difference_of_squares: Real) -> (Real, Real) {
    let sum = a + b;
    if sum <= 0.0 {
        return (1.0, 0.0);
    }
    let r = difference_of_squares / square(sum);
    (square(r), 4.0 * (a / sum) * (b / sum))
}

/// R₀ + (1−R₀)(1−cos)⁵ with the cosine on the thinner side (Schlick 1994, §3.1); total internal reflection
/// stays exact.
#[inline(always)]
pub fn schlick(from: Real, to: Real, cos_i: Real) -> Dielectric {
    let exact = dielectric(from, to, cos_i);
    if exact.transmitted == 0.0 {
        return exact;
    }
    let r0 = square((to - from) / (to + from));
    let cos = if to > from { cos_i } else { exact.cos_t };
    let c = 1.0 - cos;
    // 1 − R = (1 − R₀)(1 − c⁵), and 1 − c⁵ = cos·(1 + c + c² + c³ + c⁴) keeps its digits at grazing angles.
    let series = 1.0 + c * (1.0 + c * (1.0 + c * (1.0 + c)));
    Dielectric {
        reflected: r0 + (1.0 - r0) * square(square(c)) * c,
        transmitted: (1.0 - r0) * cos * series,
        cos_t: exact.cos_t,
    }
}

/// Reflectance of a conductor of relative index η + ik under `cos_i` (Born & Wolf §14.2).
///
/// With a + ib = √((η + ik)² − sin²): R_s = ((cos − a)² + b²)/((cos + a)² + b²) and
/// R_p = R_s·((a·cos − sin²)² + (b·cos)²)/((a·cos + sin²)² + (b·cos)²), all sums of squares.
#[inline(always)]
pub fn conductor(eta: Real, k: Real, cos_i: Real) -> Real {
    let sin_squared = sin_squared(cos_i);
    let real = refracted_squared(1.0, eta, cos_i, sin_squared) - square(k);
    let imaginary = 2.0 * eta * k;
    // The larger of a, b by the sum that doesn't cancel, the other from 2ab = imaginary: metals have η ≪ k,
    // where a² = (|·| + real)/2 would lose all its digits, and with them the absorption.
    let larger = sqrt(0.5 * (sqrt(square(real) + square(imaginary)) + real.abs()));
    let smaller = if larger > 0.0 {
        0.5 * imaginary / larger
    } else {
        0.0
    };
    let (a, b) = if real > 0.0 {
        (larger, smaller)
    } else {
        (smaller, larger)
    };
    let s = quotient(cos_i, a, b);
    let p = s * quotient(a * cos_i, sin_squared, b * cos_i);
    0.5 * (s + p)
}

/// ((x − y)² + z²)/((x + y)² + z²) for x, y ≥ 0: at most 1.
#[inline(always)]
fn quotient(x: Real, y: Real, z: Real) -> Real {
    let sum = square(x + y) + square(z);
    if sum > 0.0 {
        (square(x - y) + square(z)) / sum
    } else {
        1.0
    }
}
