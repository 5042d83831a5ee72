//! How much light a smooth boundary reflects. Exact, unpolarised; Schlick's approximation as an option.

use crate::real::{Real, safe_sqrt, sqrt, square};

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

/// Fresnel's equations for light in a medium of index 1 meeting one of index `eta` under `cos_i` ∈ [0, 1].
///
/// With a = cos_i, b = η·cos_t: R_s = ((a−b)/(a+b))², 1 − R_s = 4ab/(a+b)²; R_p likewise with
/// a = η·cos_i, b = cos_t. Neither form cancels: a − b is (a² − b²)/(a + b), and
/// a² − b² = 1 − η² whatever the angle (for p: a² − b² = (η² − 1)(1 − sin²(1 + 1/η²))).
#[inline(always)]
pub fn dielectric(eta: Real, cos_i: Real) -> Dielectric {
    let sin_squared = (1.0 - cos_i) * (1.0 + cos_i);
    // η² − sin²_i = (η² − 1) + cos²_i: no cancellation for indices close to 1.
    let excess = (eta - 1.0) * (eta + 1.0);
    let b_squared = excess + cos_i * cos_i;
    if b_squared <= 0.0 {
        return Dielectric {
            reflected: 1.0,
            transmitted: 0.0,
            cos_t: 0.0,
        };
    }
    let b = sqrt(b_squared);
    let cos_t = b / eta;
    let s = part(cos_i, b, -excess);
    let p = part(
        eta * cos_i,
        cos_t,
        excess * (1.0 - sin_squared * (1.0 + 1.0 / square(eta))),
    );
    Dielectric {
        reflected: 0.5 * (s.0 + p.0),
        transmitted: 0.5 * (s.1 + p.1),
        cos_t,
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

/// R₀ + (1−R₀)(1−cos)⁵ with the larger of both cosines' complements, i.e. the angle on the thinner side
/// (Schlick 1994, §3.1); total internal reflection stays exact.
#[inline(always)]
pub fn schlick(eta: Real, cos_i: Real) -> Dielectric {
    let exact = dielectric(eta, cos_i);
    if exact.transmitted == 0.0 {
        return exact;
    }
    let r0 = square((eta - 1.0) / (eta + 1.0));
    let cos = if eta > 1.0 { cos_i } else { exact.cos_t };
    let c = 1.0 - cos;
    let power = square(square(c)) * c;
    // 1 − R = (1 − R₀)(1 − (1−cos)⁵), exactly.
    Dielectric {
        reflected: r0 + (1.0 - r0) * power,
        transmitted: (1.0 - r0) * (1.0 - power),
        cos_t: exact.cos_t,
    }
}

/// Reflectance of a conductor of relative index η + ik under `cos_i` (Born & Wolf §14.2; in the form of
/// Lagarde 2013, "Memo on Fresnel equations").
#[inline(always)]
pub fn conductor(eta: Real, k: Real, cos_i: Real) -> Real {
    let cos_squared = cos_i * cos_i;
    let sin_squared = (1.0 - cos_i) * (1.0 + cos_i);
    let (eta_squared, k_squared) = (eta * eta, k * k);
    let t0 = eta_squared - k_squared - sin_squared;
    let a_b = sqrt(square(t0) + 4.0 * eta_squared * k_squared);
    let t1 = a_b + cos_squared;
    let a = safe_sqrt(0.5 * (a_b + t0));
    let t2 = 2.0 * a * cos_i;
    let s = (t1 - t2) / (t1 + t2);
    let t3 = cos_squared * a_b + square(sin_squared);
    let t4 = t2 * sin_squared;
    let p = if t3 + t4 > 0.0 {
        s * (t3 - t4) / (t3 + t4)
    } else {
        s
    };
    let r = 0.5 * (s + p);
    if r < 1.0 {
        if r > 0.0 { r } else { 0.0 }
    } else {
        1.0
    }
}
