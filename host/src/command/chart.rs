//! `etendue chart`.

mod sweep;

use super::render::{catch_interrupt, duration};
use super::screen::Screen;
use super::{Failure, warn};
use crate::chart::{
    Facts, Plan, Reference, Subject, equal, html, json, measure, plots, png, reference, svg,
};
use crate::develop::{AS_IT_IS, Format, Linear, check_writable, encode, read, write_files};
use crate::scene::{Changes, prepare};
use clap::Args;
use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Duration;
use sweep::{Sweep, Variant, own, product, sweep, variant};

/// Chart speed against accuracy: variants of a render on a ladder of budgets
///
/// Each variant is rendered with 1, 2, 4, … samples per pixel until its share of the budget is spent, several seeds each, and compared with a reference.
/// The report is one HTML file: error against CPU time and against samples, efficiencies with their intervals, images, error maps, tails. Ctrl-C ends it
/// without a report.
#[derive(Args, Debug)]
pub struct Chart {
    /// Mitsuba 3 scene (.xml) or compiled blob (.etd)
    pub(super) scene: PathBuf,
    /// Estimators to compare; the same as --sweep estimator=A,B,…
    #[arg(long, value_name = "A,B,…")]
    estimators: Option<String>,
    /// Values of any flag that says how light is estimated or the scene is read: mis=balance,power; sampler=independent,sobol; max-depth=4,8,-1;
    /// fresnel=exact,schlick; color=rgb,spectral; precision=single,double; branching=8,4,2;4,4,4 (values that have commas: semicolons in between);
    /// shift=false,true. May be repeated: all combinations
    #[arg(long, value_name = "KEY=V1,V2…", value_parser = sweep)]
    sweep: Vec<Sweep>,
    /// CPU time of all variants together, without the reference
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration)]
    budget: Duration,
    /// Image that errors are taken against; REF_noise.exr beside it, half the difference of two halves, tells its own noise
    #[arg(long, value_name = "REF", conflicts_with = "reference_budget")]
    reference: Option<PathBuf>,
    /// CPU time of a reference that is rendered here, in two halves that tell its noise [default: 2 × --budget]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    reference_budget: Option<Duration>,
    /// Estimator of that reference: one that makes all light of the scene
    #[arg(long, value_name = "ESTIMATOR", default_value = "bidirectional")]
    reference_estimator: String,
    /// Renders of each budget
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(2..=64))]
    seeds: u64,
    /// Report to write (.html)
    #[arg(short, long, value_name = "REPORT")]
    output: PathBuf,
    /// All numbers as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder to which each plot is written too, as SVG and PNG; made if it isn't there
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Columns of the image
    #[arg(long, value_name = "W")]
    width: Option<u32>,
    /// Rows of the image
    #[arg(long, value_name = "H")]
    height: Option<u32>,
    #[command(flatten)]
    variant: Variant,
    #[command(flatten)]
    screen: Screen,
    /// No progress
    #[arg(long)]
    quiet: bool,
}

impl Chart {
    pub(super) fn run(self) -> Result<(), Failure> {
        let mut files = vec![self.output.clone()];
        files.extend(self.json.clone());
        for file in &files {
            check_writable(file)?;
        }
        match &self.plots {
            Some(folder) if folder.is_dir() => check_writable(&folder.join("plot"))?,
            Some(file) if file.exists() => {
                return Err(format!("{}: is a file, expected a folder", file.display()).into());
            }
            // It is made when there is something for it.
            Some(folder) => check_writable(folder)?,
            None => {}
        }
        let line = own(std::env::args_os().skip(2));
        let mut warnings = Vec::new();
        let subjects = self.subjects(&line, &mut warnings)?;
        let seconds = self.budget.as_secs_f64();
        let threads = self.threads.unwrap_or(0) as usize;
        let stop = catch_interrupt()?;
        let progress = |text: String| {
            if !self.quiet {
                eprintln!("{text}");
            }
        };

        let given = self.reference.as_deref().map(given).transpose()?;
        let reference = match given {
            Some(reference) => reference,
            None => {
                let budget = self
                    .reference_budget
                    .map_or(2.0 * seconds, |b| b.as_secs_f64());
                progress(format!(
                    "reference: {budget:.0} CPU s of {}",
                    self.reference_estimator
                ));
                let change = [("estimator".into(), self.reference_estimator.clone())];
                let how = variant(&line, &change)?;
                let subject =
                    self.subject("reference", how, &mut HashMap::new(), &mut Vec::new())?;
                let made = reference(&subject, budget, threads, &stop);
                made.map_err(|e| format!("{}: {e}", self.scene.display()))?
                    .ok_or(Failure::Interrupted)?
            }
        };
        let plan = Plan {
            seconds: seconds / subjects.len() as f64,
            seeds: self.seeds,
            threads,
        };
        let mut all = Vec::new();
        for subject in subjects {
            let scene =
                etendue::Scene::open(subject.prepared.blob.bytes()).map_err(|e| e.to_string())?;
            if scene.size() != reference.image.size {
                let ([w, h], [x, y]) = (scene.size(), reference.image.size);
                return Err(format!("{}: the reference is {x} × {y}, the scene {w} × {h}: expected images of one size", self.scene.display()).into());
            }
            let name = subject.name.clone();
            let watch = &mut |passes: u64, done: f64| {
                progress(format!(
                    "{name}: {passes} samples per pixel, {:.0} % of its budget",
                    100.0 * done
                ));
            };
            let measured = measure(subject, &reference, &plan, &stop, watch)
                .map_err(|e| format!("{}: {e}", self.scene.display()))?;
            all.push(measured.ok_or(Failure::Interrupted)?);
        }
        if let Some(reason) = all
            .iter()
            .map(|m| m.refused.clone())
            .collect::<Option<Vec<_>>>()
        {
            return Err(format!(
                "{}: every variant is refused: {}",
                self.scene.display(),
                reason.join("; ")
            )
            .into());
        }
        progress("images at equal time".into());
        let shown = equal::images(&mut all, &reference, &plan, &stop);
        if !shown.map_err(|e| format!("{}: {e}", self.scene.display()))? {
            return Err(Failure::Interrupted);
        }
        let facts = Facts {
            scene: self
                .scene
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            command: command_line(),
            warnings,
            tone: self.screen.tone(),
            seeds: self.seeds,
        };
        self.write(&all, &reference, &facts)
    }

    /// All variants, ready to render.
    fn subjects(
        &self,
        line: &[OsString],
        warnings: &mut Vec<String>,
    ) -> Result<Vec<Subject>, Failure> {
        let mut sweeps = Vec::new();
        if let Some(estimators) = &self.estimators {
            sweeps.push(sweep(&format!("estimator={estimators}"))?);
        }
        sweeps.extend(self.sweep.iter().cloned());
        let mut scenes = HashMap::new();
        let mut subjects = Vec::new();
        for changes in product(&sweeps) {
            let how = variant(line, &changes)?;
            let name = if changes.is_empty() {
                "as it is".into()
            } else {
                let words = changes.iter().map(|(key, value)| match key.as_str() {
                    "estimator" => value.clone(),
                    _ => format!("{key} {value}"),
                });
                words.collect::<Vec<_>>().join(", ")
            };
            subjects.push(self.subject(&name, how, &mut scenes, warnings)?);
        }
        Ok(subjects)
    }

    /// One of them. Scenes that are read alike are read once.
    fn subject(
        &self,
        name: &str,
        variant: Variant,
        scenes: &mut HashMap<String, Rc<crate::scene::Prepared>>,
        warnings: &mut Vec<String>,
    ) -> Result<Subject, String> {
        let key = format!("{:?}", variant.reading);
        if !scenes.contains_key(&key) {
            let changes = Changes {
                width: self.width,
                height: self.height,
                ..variant.reading.changes()
            };
            let prepared = prepare(&self.scene, &variant.reading.define, changes)?;
            for warning in &prepared.warnings {
                if !warnings.contains(warning) {
                    warnings.push(warning.clone());
                }
            }
            if !self.quiet && scenes.is_empty() {
                warn(&prepared.warnings);
            }
            scenes.insert(key.clone(), Rc::new(prepared));
        }
        let prepared = Rc::clone(&scenes[&key]);
        let mut settings = variant.how.settings(prepared.advice.max_depth);
        let scene = etendue::Scene::open(prepared.blob.bytes()).map_err(|e| e.to_string())?;
        let threads = self.threads.unwrap_or(0) as usize;
        let chosen = variant.how.choose(&mut settings, &scene, threads, None);
        let mut name = name.to_owned();
        if let Some(choice) = chosen.map_err(|e| format!("{}: {e}", self.scene.display()))? {
            if !self.quiet {
                eprintln!("{name}: {}", choice.line(None));
            }
            name = format!("{name} ({})", choice.name);
        }
        Ok(Subject {
            name,
            settings,
            double: variant.double(),
            prepared,
        })
    }

    /// Writes everything, or nothing.
    fn write(
        &self,
        all: &[crate::chart::Measured],
        reference: &Reference,
        facts: &Facts,
    ) -> Result<(), Failure> {
        let mut made: Vec<(PathBuf, Vec<u8>)> = vec![(
            self.output.clone(),
            html(all, reference, facts)?.into_bytes(),
        )];
        if let Some(file) = &self.json {
            let text = format!("{:#}\n", json(all, reference, facts));
            made.push((file.clone(), text.into_bytes()));
        }
        if let Some(folder) = &self.plots {
            if !folder.is_dir() {
                std::fs::create_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            }
            for (name, plot) in plots(all, facts.seeds) {
                made.push((folder.join(format!("{name}.svg")), svg(&plot)?.into_bytes()));
                let pixels = png(&plot)?
                    .into_iter()
                    .map(|p| p.map(|c| f32::from(c) / 255.0));
                let image = Linear {
                    size: crate::chart::SIZE.into(),
                    pixels: pixels.collect(),
                };
                let file = encode(Format::Png, &image, AS_IT_IS).map_err(|e| e.to_string())?;
                made.push((folder.join(format!("{name}.png")), file));
            }
        }
        let files: Vec<(&Path, &[u8])> = made
            .iter()
            .map(|(p, b)| (p.as_path(), b.as_slice()))
            .collect();
        write_files(&files)?;
        Ok(())
    }
}

/// A reference from a file.
fn given(path: &Path) -> Result<Reference, String> {
    let image = read(path).map_err(|e| e.to_string())?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!("{name}_noise.exr"));
    let noise = if beside.exists() {
        let half = read(&beside).map_err(|e| e.to_string())?;
        if half.size != image.size {
            return Err(format!(
                "{}: expected the size of {}",
                beside.display(),
                path.display()
            ));
        }
        Some(crate::chart::noise(&half.pixels, &image))
    } else {
        None
    };
    Ok(Reference {
        image,
        origin: format!("{}.", path.display()),
        noise,
        unreachable: Vec::new(),
    })
}

/// The command, as it can be given again.
fn command_line() -> String {
    let quoted = std::env::args().skip(1).map(|a| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./:,+".contains(c);
        if a.chars().all(plain) {
            a
        } else {
            format!("'{}'", a.replace('\'', "'\\''"))
        }
    });
    format!("etendue {}", quoted.collect::<Vec<_>>().join(" "))
}
