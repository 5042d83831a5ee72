//! Renders for tests: block sums with their spread, in either precision.

use etendue_host::blob::AlignedBlob;
use etendue_host::compile::compile;
use etendue_host::description::Description;
use etendue_host::statistics;

/// Compiles a description that must compile.
pub fn blob(d: &Description) -> AlignedBlob {
    compile(d).unwrap_or_else(|e| panic!("{e}")).blob
}

/// Mean and standard error of independent batches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate {
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
}

impl Estimate {
    /// Of batches.
    pub fn of(batches: &[f64]) -> Self {
        let statistics::Estimate { mean, error, .. } = statistics::Estimate::of(batches);
        Self { mean, error }
    }

    /// How many standard errors two estimates are apart.
    pub fn z(&self, other: &Self) -> f64 {
        let error = (self.error * self.error + other.error * other.error).sqrt();
        if error == 0.0 {
            if self.mean == other.mean {
                0.0
            } else {
                f64::INFINITY
            }
        } else {
            (self.mean - other.mean) / error
        }
    }
}

macro_rules! renderer {
    ($(#[$doc:meta])* $name:ident, $kernel:ident) => {
        $(#[$doc])*
        pub mod $name {
            use super::Estimate;
            use $kernel::{Scene, Scratch, Settings};

            /// Renders `passes` samples per pixel in each of `batches` independent batches, and returns the
            /// estimate of the mean of each block (`blocks` by `blocks` over the image; red, green, blue in turn).
            pub fn blocks<const N: usize>(scene: &Scene<'_>, settings: &Settings, blocks: u32, passes: u64, batches: u64) -> Vec<Estimate> {
                let [w, h] = scene.size();
                let mut sums = vec![vec![0.0f64; batches as usize]; (blocks * blocks * 3) as usize];
                let block = |p: [u32; 2]| ((p[1] * blocks / h) * blocks + p[0] * blocks / w) as usize * 3;
                let mut scratch = Scratch::<N>::new();
                for batch in 0..batches {
                    let b = batch as usize;
                    for pass in 0..passes {
                        for y in 0..h {
                            for x in 0..w {
                                let mut add = |p: [u32; 2], v: $kernel::Rgb| {
                                    for (i, c) in v.to_array().into_iter().enumerate() {
                                        sums[block(p) + i][b] += f64::from(c);
                                    }
                                };
                                let own = scene.estimate(settings, [x, y], batch * passes + pass, &mut scratch, &mut add);
                                add([x, y], own);
                            }
                        }
                    }
                }
                assert_eq!(scratch.counters.rejected, 0, "values were refused");
                let per_block = f64::from(w * h) / f64::from(blocks * blocks) * passes as f64;
                sums.iter_mut().for_each(|s| s.iter_mut().for_each(|x| *x /= per_block));
                sums.iter().map(|s| Estimate::of(s)).collect()
            }
        }
    };
}

renderer!(
    /// In single precision.
    single, etendue
);
#[cfg(feature = "suite")]
renderer!(
    /// In double precision.
    double, etendue_f64
);
