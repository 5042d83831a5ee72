//! Student's and Fisher's distributions.

/// Two-sided p-value of Student's t with `degrees` degrees of freedom (Abramowitz & Stegun 1964, 26.7.1 and 26.5.27).
pub fn student(t: f64, degrees: u32) -> f64 {
    if t.is_nan() || degrees == 0 {
        return 1.0;
    }
    let n = f64::from(degrees);
    regularised_beta(n / (n + t * t), 0.5 * n, 0.5)
}

/// The 97.5 % quantile of Student's t with `degrees` of freedom, whole or not; infinite with fewer than one.
pub fn student_quantile(degrees: f64) -> f64 {
    if degrees < 1.0 {
        return f64::INFINITY;
    }
    // t² is Fisher's with 1 and `degrees`, both its tails in one.
    fisher_quantile(0.05, 1.0, degrees).sqrt()
}

/// What Fisher's F of `a` and `b` degrees of freedom exceeds with probability `p`.
pub fn fisher_quantile(p: f64, a: f64, b: f64) -> f64 {
    // P(F > f) = I(b/(b + a·f); b/2, a/2), which falls with f: by bisection in the logarithm.
    let exceeds = |f: f64| regularised_beta(b / (b + a * f), 0.5 * b, 0.5 * a) > p;
    let (mut low, mut high) = (-700.0f64, 700.0f64);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if exceeds(middle.exp()) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high.exp()
}

/// The regularised incomplete beta function I(x; a, b).
fn regularised_beta(x: f64, a: f64, b: f64) -> f64 {
    if x < (a + 1.0) / (a + b + 2.0) {
        beta(x, a, b)
    } else {
        1.0 - beta(1.0 - x, b, a)
    }
}

/// The same for x < (a + 1)/(a + b + 2), by Lentz's continued fraction (Press et al. 2007, §6.4).
fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p()).exp();
    let guard = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..500 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        for step in [even, odd] {
            d = 1.0 / guard(1.0 + step * d);
            c = guard(1.0 + step / c);
            h *= d * c;
        }
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h / a
}

/// ln Γ(x) for x > 0 by Stirling's series, after the recurrence has lifted x above 10.
pub fn ln_gamma(mut x: f64) -> f64 {
    let mut product = 1.0;
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y / 1680.0))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - f64::ln(product)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of Student's distribution (NIST).
    #[test]
    fn p_values_are_the_tables() {
        for (t, degrees, p) in [
            (12.706_204_736, 1, 0.05),
            (2.228_138_852, 10, 0.05),
            (3.169_272_673, 10, 0.01),
            (2.039_513_446, 31, 0.05),
            (0.682_486_3, 31, 0.5),
            (3.633_456, 31, 0.001),
        ] {
            assert!(
                (student(t, degrees) / p - 1.0).abs() < 1e-5,
                "{t} {degrees}: {}",
                student(t, degrees)
            );
        }
        assert_eq!(student(f64::INFINITY, 3), 0.0);
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, t) in [
            (1.0, 12.706),
            (5.0, 2.571),
            (11.0, 2.201),
            (30.0, 2.042),
            (1e9, 1.96),
        ] {
            assert!(
                (student_quantile(degrees) / t - 1.0).abs() < 1e-3,
                "{degrees}"
            );
        }
        assert!(student_quantile(0.0).is_infinite());
    }

    /// Tables of Fisher's distribution (NIST), and its symmetry: what F of (a, b) exceeds with p, 1/F of (b, a) exceeds with 1 − p.
    #[test]
    fn fishers_quantiles_are_the_tables() {
        for (p, a, b, f) in [
            (0.05, 1.0, 1.0, 161.448),
            (0.05, 3.0, 10.0, 3.708),
            (0.01, 5.0, 5.0, 10.967),
            (0.1, 20.0, 60.0, 1.543),
        ] {
            let found = fisher_quantile(p, a, b);
            assert!((found / f - 1.0).abs() < 5e-4, "{p} {a} {b}: {found}");
            let other = 1.0 / fisher_quantile(1.0 - p, b, a);
            assert!((found / other - 1.0).abs() < 1e-6, "{p} {a} {b}: {other}");
        }
        assert!((fisher_quantile(1e-3, 1e5, 1e5) - 1.0).abs() < 0.03);
    }
}
