//! `etendue compare`.

use super::{Failure, print};
use crate::develop::{AS_IT_IS, Linear, Output, read, write};
use std::path::PathBuf;

/// Compare two images: MSE, relMSE, bias, difference image
///
/// relMSE is the mean over pixels and channels of (a−b)²/(b² + 0.01·m²), m the mean of B. Images are compared
/// linear: a PNG's sRGB coding is undone first.
#[derive(clap::Args, Debug)]
pub struct Compare {
    /// Image to judge (.exr, .hdr or .png)
    pub(super) a: PathBuf,
    /// Reference of the same size
    b: PathBuf,
    /// One JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Difference image, by the mean of the channels: red where A is brighter, blue where B is, white where they
    /// are equal; colour grows as the square root, to the full at the largest difference, which is printed
    #[arg(short, long = "output", value_name = "DIFF")]
    output: Option<PathBuf>,
}

/// How far one image is from another.
#[derive(Clone, Copy, Debug)]
struct Distance {
    /// Mean over pixels and channels of (a−b)².
    mse: f64,
    /// Mean of (a−b)²/(b² + 0.01·m²), m the mean of b.
    rel_mse: f64,
    /// Mean of a−b per channel.
    bias: [f64; 3],
    /// Mean of a−b over the mean of b.
    relative_bias: f64,
    /// The largest |a−b| of a channel.
    largest: f64,
    /// The largest |a−b| of the mean of the channels.
    largest_mean: f64,
}

fn distance(a: &Linear, b: &Linear) -> Distance {
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
        d.largest_mean = d.largest_mean.max((grey(p) - grey(q)).abs());
    }
    let bias = d.bias.iter().sum::<f64>() / 3.0;
    d.relative_bias = if bias == 0.0 { 0.0 } else { bias / m };
    d
}

impl Compare {
    pub(super) fn run(self) -> Result<(), Failure> {
        let output = self.output.as_deref().map(Output::open).transpose()?;
        let (a, b) = (read(&self.a)?, read(&self.b)?);
        if a.size != b.size {
            let [[w, h], [x, y]] = [a.size, b.size];
            let (a, b) = (self.a.display(), self.b.display());
            return Err(
                format!("{a} is {w} × {h}, {b} is {x} × {y}: expected images of one size").into(),
            );
        }
        let d = distance(&a, &b);
        if let Some(output) = output {
            let image = difference(&a, &b, d.largest_mean);
            write(&[output], &image, AS_IT_IS)?;
        }
        if self.json {
            let object = serde_json::json!({
                "mse": d.mse,
                "rel_mse": d.rel_mse,
                "bias": d.bias,
                "relative_bias": d.relative_bias,
                "largest_difference": d.largest,
                "difference_scale": d.largest_mean,
            });
            print(&format!("{object}\n"))
        } else {
            let [r, g, b] = d.bias;
            let percent = 100.0 * d.relative_bias;
            print(&format!(
                "MSE            {:.6e}\n\
                 relMSE         {:.6e}\n\
                 bias of mean   {r:+.6e} {g:+.6e} {b:+.6e} ({percent:+.4} %)\n\
                 largest        {:.6e} in a channel, {:.6e} in their mean\n",
                d.mse, d.rel_mse, d.largest, d.largest_mean,
            ))
        }
    }
}

/// The mean of a pixel's channels.
fn grey(p: &[f32; 3]) -> f64 {
    p.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0
}

/// Signed difference of the mean channel: white is none, red is A brighter, blue is B brighter. The square
/// root makes small differences visible.
fn difference(a: &Linear, b: &Linear, largest: f64) -> Linear {
    let pixels = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .map(|(p, q)| {
            let d = if largest > 0.0 {
                (grey(p) - grey(q)) / largest
            } else {
                0.0
            };
            let rest = 1.0 - d.abs().min(1.0).sqrt() as f32;
            if d > 0.0 {
                [1.0, rest, rest]
            } else {
                [rest, rest, 1.0]
            }
        })
        .collect();
    Linear {
        size: a.size,
        pixels,
    }
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
