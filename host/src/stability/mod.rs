//! The atlas of scenes at which methods break: what is expected of each estimator, written down beforehand
//! (`scenes/stability/manifest.json`), and what is measured.
//!
//! A comparison with the truth gives the probability of being so far off by chance. All of an atlas stand or fall together: the limit
//! for each is [`FALSE_ALARM`] over their number (Bonferroni), so that right code fails at most that share of all seeds.

mod ends;
mod judge;
mod manifest;
mod measure;
mod report;
mod scenes;

pub use judge::{Found, Outcome, Row, judge};
pub use manifest::{Case, Expectation, Expected, Truth, manifest};
pub use measure::{Budget, Measured, Method, Precision};
pub use report::{html, table};
pub use scenes::build;

use crate::blob::AlignedBlob;
use rayon::prelude::*;

/// How often a run of the atlas would fail right code, over all seeds.
pub const FALSE_ALARM: f64 = 1e-4;

/// A case with its scene.
#[derive(Debug)]
pub struct Ready {
    /// What is expected.
    pub case: Case,
    /// The scene.
    pub blob: AlignedBlob,
    /// What compiling it warned of.
    pub warnings: Vec<String>,
}

/// Compiles the scenes of `cases`.
///
/// # Errors
/// The first scene that can't be compiled, in one line.
pub fn prepare(cases: Vec<Case>) -> Result<Vec<Ready>, String> {
    let ready = |case: Case| {
        let (blob, warnings) = build(&case).map_err(|e| format!("{}: {e}", case.name))?;
        Ok(Ready {
            case,
            blob,
            warnings,
        })
    };
    cases.into_iter().map(ready).collect()
}

/// Runs every estimator on every case, and judges. `watch` is told when a row is done.
///
/// # Errors
/// A scene that the kernel doesn't open.
pub fn run(
    ready: &[Ready],
    budget: &Budget,
    watch: &(dyn Fn(&str, Method) + Sync),
) -> Result<Vec<Row>, String> {
    let jobs: Vec<_> = ready
        .iter()
        .flat_map(|r| r.case.expected.iter().map(move |e| (r, e)))
        .collect();
    let found: Vec<Found> = jobs
        .par_iter()
        .map(|(r, e)| {
            let found = measure::measure(r, e.method, budget)?;
            watch(&r.case.name, e.method);
            Ok(found)
        })
        .collect::<Result<_, String>>()?;
    let comparisons: usize = found.iter().map(Found::comparisons).sum();
    let limit = FALSE_ALARM / comparisons.max(1) as f64;
    let rows = jobs.iter().zip(found);
    Ok(rows
        .map(|((r, e), f)| judge(&r.case, e, f, limit))
        .collect())
}
