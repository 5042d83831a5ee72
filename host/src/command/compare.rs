//! `etendue compare`.

use super::Failure;
use crate::develop::{Curve, Linear, Output, Tone, read};
use std::path::PathBuf;

/// Compare two linear images
#[derive(clap::Args, Debug)]
pub struct Compare {
    /// Image to judge (.exr or .hdr)
    a: PathBuf,
    /// Reference of the same size
    b: PathBuf,
    /// One JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Difference image: red where A is brighter, blue where B is; full colour at the largest difference
    #[arg(short, long = "output", value_name = "DIFF.png")]
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
    /// The largest |a−b|.
    largest: f64,
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
    }
    let bias = d.bias.iter().sum::<f64>() / 3.0;
    d.relative_bias = if bias == 0.0 { 0.0 } else { bias / m };
    d
}

impl Compare {
    pub(super) fn run(self) -> Result<(), Failure> {
        let output = self
            .output
            .as_deref()
            .map(Output::open)
            .transpose()
            .map_err(|e| e.to_string())?;
        let (a, b) = (
            read(&self.a).map_err(|e| e.to_string())?,
            read(&self.b).map_err(|e| e.to_string())?,
        );
        if a.size != b.size {
            let [[w, h], [x, y]] = [a.size, b.size];
            let (a, b) = (self.a.display(), self.b.display());
            return Err(
                format!("{a} is {w} × {h}, {b} is {x} × {y}: expected images of one size").into(),
            );
        }
        let d = distance(&a, &b);
        if let Some(output) = output {
            let image = difference(&a, &b, d.largest);
            let tone = Tone {
                exposure: 0.0,
                curve: Curve::Gamma {
                    a: 1.0,
                    c: 0.0,
                    gamma: 1.0,
                },
            };
            output.write(&image, tone).map_err(|e| e.to_string())?;
        }
        if self.json {
            let object = serde_json::json!({
                "mse": d.mse,
                "rel_mse": d.rel_mse,
                "bias": d.bias,
                "relative_bias": d.relative_bias,
                "largest_difference": d.largest,
            });
            println!("{object}");
        } else {
            println!("MSE            {:.6e}", d.mse);
            println!("relMSE         {:.6e}", d.rel_mse);
            println!(
                "bias of mean   {:+.6e} {:+.6e} {:+.6e} ({:+.4} %)",
                d.bias[0],
                d.bias[1],
                d.bias[2],
                100.0 * d.relative_bias
            );
            println!("largest        {:.6e}", d.largest);
        }
        Ok(())
    }
}

/// Signed difference of the mean channel: white is none, red is A brighter, blue is B brighter. The square
/// root makes small differences visible.
fn difference(a: &Linear, b: &Linear, largest: f64) -> Linear {
    let mean = |p: &[f32; 3]| f64::from(p[0] + p[1] + p[2]) / 3.0;
    let pixels = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .map(|(p, q)| {
            let d = if largest > 0.0 {
                (mean(p) - mean(q)) / largest
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
