//! The atlas of scenes at which methods break: what is expected of each estimator, written down beforehand
//! (`scenes/stability/manifest.json`), and what is measured.
//!
//! A comparison with the truth gives the probability of being so far off by chance. All of an atlas stand or fall together: the limit
//! for each is [`FALSE_ALARM`] over their number (Bonferroni), so that right code fails at most that share of all seeds.
//!
//! Where few samples carry an image, its mean says little: neither about the truth nor about rounding. There each contribution is clipped at the mean of
//! those that aren't 0 before f32 is compared with f64: they have the same random numbers, and differences of bounded variance. Where hardly a sample is alive
//! nothing is compared, but that it is so in both.

mod ends;
mod judge;
mod manifest;
mod measure;
mod report;
mod sampling;
mod scenes;

pub use crate::command::how::{estimators, name};
pub use judge::{Found, Outcome, Row, judge};
pub use manifest::{Beside, Case, Expectation, Expected, Truth, manifest};
pub use measure::{Budget, Measured, settings};
pub use report::{html, table};
pub use scenes::build;

use crate::blob::AlignedBlob;
use etendue::Estimator;
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
    /// The scene without what the program adds to it, where a bias is seen against that.
    pub plain: Option<AlignedBlob>,
    /// The edges that paths may have.
    pub max_edges: Option<u32>,
}

/// Compiles the scenes of `cases`.
///
/// # Errors
/// The first scene that can't be compiled, in one line.
pub fn prepare(cases: Vec<Case>) -> Result<Vec<Ready>, String> {
    let ready = |case: Case| {
        let failed = |e: String| format!("{}: {e}", case.name);
        let (blob, warnings) = build(&case).map_err(failed)?;
        let wanted = |e: &Expected| e.beside == Some(Beside::Plain);
        let plain = case.expected.iter().any(wanted).then(|| {
            let added = None;
            build(&Case {
                added,
                ..case.clone()
            })
        });
        let plain = plain.transpose().map_err(failed)?;
        Ok(Ready {
            blob,
            warnings,
            plain: plain.map(|(blob, _)| blob),
            max_edges: scenes::advised_depth(&case),
            case,
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
    watch: &(dyn Fn(&str, Estimator) + Sync),
) -> Result<Vec<Row>, String> {
    let jobs: Vec<_> = ready
        .iter()
        .flat_map(|r| r.case.expected.iter().map(move |e| (r, e)))
        .collect();
    let found: Vec<Found> = jobs
        .par_iter()
        .map(|(r, e)| {
            let found = measure::measure(r, e.estimator, budget)?;
            watch(&r.case.name, e.estimator);
            Ok(found)
        })
        .collect::<Result<_, String>>()?;
    let comparisons: usize = found.iter().map(Found::comparisons).sum();
    let limit = FALSE_ALARM / comparisons.max(1) as f64;
    let rows = jobs.iter().zip(found);
    Ok(rows
        .map(|((r, e), f)| judge(&r.case, e, f, &r.warnings, limit))
        .collect())
}
