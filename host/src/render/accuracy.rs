//! How accurate an image is, as two independent images of the same say.

use crate::statistics::fisher_quantile;

/// The confidence that a stated error holds with.
pub const CONFIDENCE: f64 = 0.95;

/// How accurate a render got that was asked to be accurate.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// The relative error that was asked for: the root of the squared error's mean over that of the image's square.
    pub asked: f64,
    /// Its estimate; infinite if the image is black or too little of it was rendered.
    pub found: f64,
    /// Whether it is not above what was asked for with a confidence of [`CONFIDENCE`].
    pub met: bool,
    /// How often that was looked at.
    pub checkpoints: u32,
    /// Samples of the pixel that has the fewest, and of the one that has the most.
    pub samples: [u64; 2],
}

/// The chance of a false verdict, out of all there may be, that the two at `checkpoint` have: Σ 6/π²/(k + 1)² = 1.
pub(super) fn risk(checkpoint: u32) -> f64 {
    let k = f64::from(checkpoint) + 1.0;
    let share = 6.0 / (std::f64::consts::PI * k).powi(2);
    0.5 * (1.0 - CONFIDENCE) * share
}

/// What two independent images say about the error of their mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    /// Squared error, mean over pixels and channels.
    pub variance: f64,
    /// The degrees of freedom of that: 1 if it is one pixel's.
    freedom: f64,
    /// Square of the image without error, mean over pixels and channels.
    energy: f64,
}

impl Verdict {
    pub fn of(a: &[[f32; 3]], b: &[[f32; 3]]) -> Self {
        let (mut sum, mut squares, mut energy) = (0.0, 0.0, 0.0);
        for (a, b) in a.iter().zip(b) {
            let (mut error, mut square) = (0.0, 0.0);
            for (&a, &b) in a.iter().zip(b) {
                let (a, b) = (f64::from(a), f64::from(b));
                // E (a − b)² is the sum of both variances, and that of the mean a quarter of it.
                error += 0.25 * (a - b) * (a - b) / 3.0;
                square += 0.25 * (a + b) * (a + b) / 3.0;
            }
            sum += error;
            squares += error * error;
            energy += square;
        }
        let pixels = a.len() as f64;
        Self {
            variance: sum / pixels,
            // (Σ E x)²/Σ (E x)², were they known (Satterthwaite 1946): of squares of normal errors 3 (Σ x)²/Σ x² for many pixels, 1 for one. Fewer
            // are counted, because that of a few pixels is itself uncertain. Longer tails have fewer.
            freedom: if squares > 0.0 {
                2.0 * sum * sum / squares - 1.0
            } else {
                1.0
            },
            energy: (energy - sum) / pixels,
        }
    }

    /// What the relative error of an image with `share` of this one's squared error exceeds with a chance of `risk`: errors and their estimate are independent
    /// sums of squares.
    pub fn bound(&self, share: f64, risk: f64) -> f64 {
        relative(
            share * self.variance * fisher_quantile(risk, self.freedom, self.freedom),
            self.energy,
        )
    }
}

/// Relative error; infinite where there is nothing to relate it to.
pub(super) fn relative(variance: f64, energy: f64) -> f64 {
    if energy > 0.0 {
        (variance / energy).sqrt()
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue::random::{Pcg, Purpose, Sampler};

    #[test]
    fn risks_add_up_to_what_confidence_leaves() {
        let sum: f64 = (0..100_000).map(|k| 2.0 * risk(k)).sum();
        assert!((sum - 0.05).abs() < 1e-5, "{sum}");
    }

    /// Of normal errors, of one pixel or of some, that differ from pixel to pixel, the realised error exceeds the bound no more often than it may: over 20,000 pairs, by
    /// 5 standard deviations of a count.
    #[test]
    fn bounds_hold_at_their_rate() {
        const TRIALS: u64 = 20_000;
        const RISK: f64 = 0.05;
        for pixels in [1, 3, 30] {
            let mut exceeded = 0.0;
            for trial in 0..TRIALS {
                let normal = |image: u64, pixel: u64| {
                    let [a, b] = Pcg::new(trial, image, pixel).two(Purpose::Position);
                    let size = 0.01 * (1.0 + pixel as f32);
                    let x = (-2.0 * (1.0 - a).ln()).sqrt() * (std::f32::consts::TAU * b).cos();
                    // Grey, as if one channel were all.
                    [1.0 + size * x; 3]
                };
                let image = |i| (0..pixels).map(|p| normal(i, p)).collect::<Vec<_>>();
                let (a, b, c, d) = (image(0), image(1), image(2), image(3));
                let bound = Verdict::of(&a, &b).bound(1.0, RISK);
                let errors = c.iter().zip(&d).map(|(c, d)| 0.5 * (c[0] + d[0]) - 1.0);
                let error = errors.map(|e| f64::from(e * e)).sum::<f64>() / pixels as f64;
                exceeded += f64::from(u8::from(error.sqrt() > bound));
            }
            let allowed = RISK * TRIALS as f64;
            assert!(
                exceeded < allowed + 5.0 * allowed.sqrt(),
                "{pixels}: {exceeded}"
            );
        }
    }
}
