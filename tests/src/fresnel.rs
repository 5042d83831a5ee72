//! Fresnel's equations as textbooks write them: amplitudes, in double precision.
//!
//! They share no formula with the kernel, which rearranges them so that nothing cancels.

/// R and cos θ_t (0 under total internal reflection) of unpolarised light that goes from index `n1` to `n2`.
pub fn dielectric(n1: f64, n2: f64, cos_i: f64) -> (f64, f64) {
    let sin_t = n1 / n2 * (1.0 - cos_i * cos_i).sqrt();
    if sin_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let s = (n1 * cos_i - n2 * cos_t) / (n1 * cos_i + n2 * cos_t);
    let p = (n2 * cos_i - n1 * cos_t) / (n2 * cos_i + n1 * cos_t);
    (0.5 * (s * s + p * p), cos_t)
}

/// 1 − R from the transmitted amplitudes t_s, t_p: n₂cos θ_t/(n₁cos θ_i)·|t|².
pub fn transmitted(n1: f64, n2: f64, cos_i: f64) -> f64 {
    let (_, cos_t) = dielectric(n1, n2, cos_i);
    let s = 2.0 * n1 * cos_i / (n1 * cos_i + n2 * cos_t);
    let p = 2.0 * n1 * cos_i / (n2 * cos_i + n1 * cos_t);
    0.5 * n2 * cos_t / (n1 * cos_i) * (s * s + p * p)
}

/// Schlick's approximation, with the cosine on the thinner side.
pub fn schlick(n1: f64, n2: f64, cos_i: f64) -> f64 {
    let (r, cos_t) = dielectric(n1, n2, cos_i);
    if r == 1.0 {
        return r;
    }
    let r0 = ((n1 - n2) / (n1 + n2)).powi(2);
    let cos = if n1 < n2 { cos_i } else { cos_t };
    r0 + (1.0 - r0) * (1.0 - cos).powi(5)
}

/// R of a conductor of relative index m = η + ik, by complex amplitudes.
pub fn conductor(eta: f64, k: f64, cos_i: f64) -> f64 {
    let c = Complex(cos_i, 0.0);
    let m2 = Complex(eta, k).times(Complex(eta, k));
    // m·cos θ_t
    let t = m2.minus(Complex(1.0 - cos_i * cos_i, 0.0)).root();
    let s = c.minus(t).norm() / c.plus(t).norm();
    let mc = m2.times(c);
    let p = mc.minus(t).norm() / mc.plus(t).norm();
    0.5 * (s + p)
}

#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Complex {
    fn plus(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1)
    }
    fn minus(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1)
    }
    fn times(self, o: Self) -> Self {
        Self(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }
    /// |z|²
    fn norm(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }
    /// The root in the right half plane.
    fn root(self) -> Self {
        let (r, phi) = (self.norm().sqrt().sqrt(), 0.5 * self.1.atan2(self.0));
        Self(r * phi.cos(), r * phi.sin())
    }
}
