//! How far images are from each other.

use super::Linear;

impl Linear {
    /// The mean of a pixel's channels.
    pub fn grey(p: &[f32; 3]) -> f64 {
        p.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0
    }
}

/// How far one image is from another.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    /// Mean over pixels and channels of (a−b)².
    pub mse: f64,
    /// Mean of (a−b)²/(b² + 0.01·m²), m the mean of b.
    pub rel_mse: f64,
    /// Mean of a−b per channel.
    pub bias: [f64; 3],
    /// Mean of a−b over the mean of b.
    pub relative_bias: f64,
    /// The largest |a−b| of a channel.
    pub largest: f64,
    /// The largest |a−b| of the mean of the channels.
    pub largest_mean: f64,
}

/// The distance of `a` from `b`, an image of the same size.
pub fn distance(a: &Linear, b: &Linear) -> Distance {
    let n = a.pixels.len() as f64;
    let mean = |i: &Linear| {
        i.pixels
            .as_flattened()
            .iter()
            .map(|&x| f64::from(x))
            .sum::<f64>()
            / (3.0 * n)
    };
    let m = mean(b);
    let mut d = Distance {
        mse: 0.0,
        rel_mse: 0.0,
        bias: [0.0; 3],
        relative_bias: 0.0,
        largest: 0.0,
        largest_mean: 0.0,
    };
    for (p, q) in a.pixels.iter().zip(&b.pixels) {
        for c in 0..3 {
            let (x, y) = (f64::from(p[c]), f64::from(q[c]));
            let squared = (x - y) * (x - y);
            d.mse += squared / (3.0 * n);
            if squared > 0.0 {
                d.rel_mse += squared / (y * y + 0.01 * m * m) / (3.0 * n);
            }
            d.bias[c] += (x - y) / n;
            d.largest = d.largest.max((x - y).abs());
        }
        d.largest_mean = d
            .largest_mean
            .max((Linear::grey(p) - Linear::grey(q)).abs());
    }
    let bias = d.bias.iter().sum::<f64>() / 3.0;
    d.relative_bias = if bias == 0.0 { 0.0 } else { bias / m };
    d
}

#[cfg(test)]
mod tests {
    use super::{Linear, distance};

    #[test]
    fn distances_are_what_their_formulas_say() {
        let a = Linear {
            size: [2, 1],
            pixels: vec![[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]],
        };
        let b = Linear {
            size: [2, 1],
            pixels: vec![[1.0, 2.0, 1.0], [0.0, 0.0, 2.0]],
        };
        let d = distance(&a, &b);
        // Mean of b is 1: (4/(1 + .01) + 4/(4 + .01))/6.
        assert!((d.mse - 8.0 / 6.0).abs() < 1e-12);
        assert!((d.rel_mse - (4.0 / 1.01 + 4.0 / 4.01) / 6.0).abs() < 1e-12);
        assert_eq!((d.bias, d.largest), ([0.0, 0.0, 0.0], 2.0));
        assert_eq!(distance(&a, &a).rel_mse, 0.0);
    }
}
