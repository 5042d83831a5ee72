//! `etendue stability`.

use super::how::name;
use super::{Failure, print};
use crate::develop::{check_writable, write_files};
use crate::stability::{Budget, Row, html, manifest, prepare, run, table};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// Run the atlas of scenes at which methods break, and compare with what is written down
///
/// Each scene of the atlas is rendered by every estimator, in single and in double precision. Exits with 1 if an outcome differs from what the manifest
/// states.
#[derive(clap::Args, Debug)]
pub struct Stability {
    /// Page to write (.html), with why each outcome is expected
    #[arg(short, long, value_name = "REPORT")]
    output: Option<PathBuf>,
    /// Only the cases whose names contain this; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Factor for all numbers of samples
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = super::figures::factor)]
    spp_scale: f64,
    /// Selects the random numbers: the same seed gives the same outcomes
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// End with one JSON object on standard output in place of the table
    #[arg(long)]
    json: bool,
    /// List the cases, run nothing
    #[arg(long)]
    list: bool,
    /// No progress
    #[arg(long)]
    quiet: bool,
}

impl Stability {
    pub(super) fn run(self) -> Result<(), Failure> {
        let mut cases = manifest()?;
        if let Some(unknown) = self
            .only
            .iter()
            .find(|o| !cases.iter().any(|c| c.name.contains(*o)))
        {
            let names: Vec<_> = cases.iter().map(|c| c.name.as_str()).collect();
            return Err(format!(
                "--only {unknown}: expected a part of one of {}",
                names.join(", ")
            )
            .into());
        }
        cases.retain(|c| self.only.is_empty() || self.only.iter().any(|o| c.name.contains(o)));
        if self.list {
            let lines: Vec<_> = cases
                .iter()
                .map(|c| format!("{:<27} {}\n", c.name, c.about))
                .collect();
            return print(&lines.concat());
        }
        // What can't be written is refused before anything is rendered.
        if let Some(path) = &self.output {
            is_page(path)?;
            check_writable(path)?;
        }
        let ready = prepare(cases)?;
        let bar =
            self.progress_bar(ready.iter().map(|r| r.case.expected.len()).sum::<usize>() as u64);
        let budget = Budget {
            scale: self.spp_scale,
            seed: self.seed,
        };
        let rows = run(&ready, &budget, &|case, estimator| {
            bar.set_message(format!("{case}, {}", name(estimator)));
            bar.inc(1);
        })?;
        bar.finish_and_clear();
        if let Some(path) = &self.output {
            write_files(&[(path, html(&ready, &rows).as_bytes())])?;
        }
        print(&if self.json { json(&rows) } else { table(&rows) })?;
        let differ = rows.iter().filter(|r| !r.is_met()).count();
        if differ > 0 {
            let all = rows.len();
            return Err(
                format!("{differ} of {all} outcomes differ from what is written down").into(),
            );
        }
        Ok(())
    }

    fn progress_bar(&self, length: u64) -> ProgressBar {
        let bar = ProgressBar::new(length);
        if self.quiet || self.json || !std::io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos:>3}/{len}  {msg}") {
            bar.set_style(style);
        }
        bar
    }
}

/// Refuses what isn't the name of one.
fn is_page(path: &Path) -> Result<(), String> {
    if path
        .extension()
        .is_none_or(|e| !e.eq_ignore_ascii_case("html"))
    {
        return Err(format!(
            "{}: a report is a page: expected a name that ends in .html",
            path.display()
        ));
    }
    Ok(())
}

/// All rows as one object.
fn json(rows: &[Row]) -> String {
    let row = |r: &Row| {
        let m = &r.found.single;
        serde_json::json!({
            "case": r.case.name,
            "estimator": r.name(),
            "expected": r.expected.what.to_string(),
            "why": r.expected.why,
            "found": r.outcome.to_string(),
            "met": r.is_met(),
            "differs": r.differs,
            "truth": r.case.truth.value,
            "truth_source": r.case.truth.source,
            "mean": m.mean.map(|e| e.mean),
            "error": m.mean.map(|e| e.error),
            "mean_f64": r.found.double.mean.map(|e| e.mean),
            "z": if r.z.is_finite() { serde_json::json!(r.z) } else { serde_json::json!(null) },
            "p": r.p,
            "energy": r.found.energy(&r.case).map(|e| serde_json::json!({
                "over_truth": e.value,
                "low": e.low,
                "high": e.high,
            })),
            "f32_over_f64_minus_1": r.single_over_double,
            "tail_index": m.tail.index,
            "largest_over_mean": m.tail.largest,
            "largest_share": m.tail.share,
            "top_share": m.tail.top,
            "samples": m.tail.samples,
            "samples_alive": m.tail.alive,
            "unreachable": r.found.unreachable,
            "refused": r.found.refused,
            "warnings": r.found.warnings.iter().chain(&r.found.loss).collect::<Vec<_>>(),
            "diagnostics": {
                "rejected_values": m.rejected,
                "walks_cut_by_step_limit": m.cut,
                "light_walks_cut_by_capacity": m.full,
                "film_refused": m.refused,
                "violations_at_the_ends_of_xi": r.found.ends,
            },
        })
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    format!(
        "{}\n",
        serde_json::json!({"false_alarm": crate::stability::FALSE_ALARM, "rows": rows})
    )
}
