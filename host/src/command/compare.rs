//! `etendue compare`.

use super::{Failure, print};
use crate::develop::{AS_IT_IS, Linear, Output, distance, read, write};
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

/// Signed difference of the mean channel: white is none, red is A brighter, blue is B brighter. The square
/// root makes small differences visible.
fn difference(a: &Linear, b: &Linear, largest: f64) -> Linear {
    let pixels = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .map(|(p, q)| {
            let d = if largest > 0.0 {
                (Linear::grey(p) - Linear::grey(q)) / largest
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
