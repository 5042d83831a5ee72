//! What errors are taken against.

use super::measure::{Reference, Subject, cpu_seconds, image};
use crate::develop::Linear;
use etendue::Settings;
use std::sync::atomic::{AtomicBool, Ordering};

/// The mean of a reference's variance over pixels and channels, and of variance/(value² + 0.01 m²), from half the difference of two independent halves: its
/// square is the variance, with one degree of freedom.
pub fn noise(half: &[[f32; 3]], image: &Linear) -> [f64; 2] {
    let values = image.pixels.as_flattened();
    let n = values.len() as f64;
    let mean = values.iter().map(|&x| f64::from(x)).sum::<f64>() / n;
    let pairs = half.as_flattened().iter().zip(values);
    pairs.fold([0.0; 2], |[absolute, relative], (&d, &x)| {
        let (d, x) = (f64::from(d), f64::from(x));
        let scale = x * x + 0.01 * mean * mean;
        [
            absolute + d * d / n,
            relative + if d == 0.0 { 0.0 } else { d * d / scale / n },
        ]
    })
}

/// Renders a reference in two halves of so many CPU seconds together. `None` if `stop` was set.
///
/// # Errors
/// What a render says.
pub fn reference(
    subject: &Subject,
    seconds: f64,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Option<Reference>, String> {
    let begun = cpu_seconds();
    let half = |passes: u64, which: u64| {
        let settings = Settings {
            // No variant has these.
            seed: subject.settings.seed ^ (0x7265_6600_0000_0000 + which),
            ..subject.settings
        };
        image(subject, settings, passes, threads, stop)
    };
    // What a pass takes, by ever longer renders.
    let (mut passes, mut took) = (1, half(1, 2)?.1);
    while took < 0.05 * seconds && cpu_seconds() - begun < 0.2 * seconds {
        passes *= 4;
        took = half(passes, 2)?.1;
    }
    let left = seconds - (cpu_seconds() - begun);
    let passes = ((0.5 * left / took * passes as f64) as u64).max(passes);
    let ((a, _), (b, _)) = (half(passes, 0)?, half(passes, 1)?);
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let pairs = || a.pixels.iter().zip(&b.pixels);
    let mean = |(p, q): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| 0.5 * (p[c] + q[c]));
    let half = |(p, q): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| 0.5 * (p[c] - q[c]));
    let image = Linear {
        size: a.size,
        pixels: pairs().map(mean).collect(),
    };
    let differences: Vec<[f32; 3]> = pairs().map(half).collect();
    Ok(Some(Reference {
        noise: Some(noise(&differences, &image)),
        unreachable: subject.unreachable()?,
        origin: format!(
            "rendered here by {}: two halves of {passes} samples per pixel.",
            format!("{:?}", subject.settings.estimator).to_lowercase()
        ),
        image,
    }))
}
