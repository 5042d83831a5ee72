//! `etendue figures`.

mod manifest;

use super::render::{DEFAULT_SAMPLES, catch_interrupt};
use super::{Failure, warn};
use crate::develop::{AS_IT_IS, Format, Linear, Output, Picture, sheet, write};
use crate::render::{Budget, Device, Options, Rendered, losses, render};
use crate::scene::{Changes, Prepared, prepare};
use etendue::{Estimator, Scene, Settings};
use manifest::Entry;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// The manifest's name in a folder.
const MANIFEST: &str = "figures.txt";

/// Render the figures that a manifest lists to one contact sheet
///
/// A line of the manifest is a scene with flags of `etendue render` (those of estimators, --spp, -D, --exposure, --tonemap),
/// then " | " and a caption; an empty line begins a new row. All scenes are loaded before any is rendered. Ctrl-C ends it
/// without a sheet.
#[derive(clap::Args, Debug)]
pub struct Figures {
    /// Folder with figures.txt in it, or another manifest
    #[arg(value_name = "FOLDER")]
    pub(super) from: PathBuf,
    /// Contact sheet to write (.png)
    #[arg(short, long, value_name = "SHEET")]
    output: PathBuf,
    /// Folder to which each panel is written too, as EXR and PNG
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
    /// Factor for all numbers of samples; a pixel has one at least
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = factor)]
    spp_scale: f64,
    /// Factor for columns and rows of all panels
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = factor)]
    scale: f64,
    /// Threads; the sheet doesn't depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// No warnings, no progress
    #[arg(long)]
    quiet: bool,
}

/// A factor.
pub(super) fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|x| (1e-6..=1e6).contains(x))
        .ok_or_else(|| "expected a number from 0.000001 to 1000000".into())
}

/// A panel that can be rendered.
struct Ready {
    entry: Entry,
    prepared: Prepared,
    settings: Settings,
    /// Samples per pixel.
    samples: u64,
    /// Its files, if it is kept.
    outputs: Vec<Output>,
}

impl Figures {
    pub(super) fn run(self) -> Result<(), Failure> {
        if Format::of(&self.output)? != Format::Png {
            let output = self.output.display();
            return Err(
                format!("{output}: a sheet is a PNG: expected a name that ends in .png").into(),
            );
        }
        let output = Output::open(&self.output)?;
        let manifest = if self.from.is_dir() {
            self.from.join(MANIFEST)
        } else {
            self.from.clone()
        };
        // What can't be loaded, rendered or written is refused before anything is.
        let mut number = 0;
        let mut rows = Vec::new();
        for row in manifest::read(&manifest)? {
            let mut ready = Vec::new();
            for entry in row {
                number += 1;
                let place = format!("{}:{}", manifest.display(), entry.line);
                let panel = self.prepare(entry, &manifest, number);
                ready.push(panel.map_err(|e| format!("{place}: {e}"))?);
            }
            rows.push(ready);
        }
        let stop = catch_interrupt()?;
        let mut pictures = Vec::new();
        let mut done = 0;
        for row in rows {
            let mut shown = Vec::new();
            for ready in row {
                done += 1;
                shown.push(self.picture(ready, &stop, [done, number])?);
            }
            pictures.push(shown);
        }
        let Some(sheet) = sheet(&pictures) else {
            let output = self.output.display();
            return Err(format!("{output}: not enough memory for the sheet").into());
        };
        write(&[output], &sheet, AS_IT_IS)?;
        Ok(())
    }

    /// Loads what a line of the manifest asks for.
    fn prepare(&self, entry: Entry, manifest: &Path, number: usize) -> Result<Ready, String> {
        let panel = &entry.panel;
        let path = manifest.with_file_name(&panel.scene);
        let changes = Changes {
            scale: (self.scale != 1.0).then_some(self.scale),
            ..panel.reading.changes()
        };
        let prepared = prepare(&path, &panel.reading.define, changes)?;
        if !self.quiet {
            warn(&prepared.warnings);
        }
        let settings = panel.how.settings(prepared.advice.max_depth);
        if let Some(reason) = settings.estimator.refuses(&open(&prepared)?) {
            return Err(format!("{}: {reason}", path.display()));
        }
        let advised = prepared.advice.samples.map(u64::from);
        let samples = panel.spp.or(advised).unwrap_or(DEFAULT_SAMPLES);
        let outputs = match &self.keep {
            None => Vec::new(),
            Some(folder) => {
                let name = panel.scene.file_stem().unwrap_or_default();
                let name = format!("{number:02}-{}", name.to_string_lossy());
                let files = ["exr", "png"].map(|e| folder.join(format!("{name}.{e}")));
                let open = |file: &PathBuf| Output::open(file).map_err(|e| e.to_string());
                files.iter().map(open).collect::<Result<_, _>>()?
            }
        };
        Ok(Ready {
            settings,
            samples: ((samples as f64 * self.spp_scale).round() as u64).max(1),
            outputs,
            prepared,
            entry,
        })
    }

    /// Renders a panel, and keeps it if it is to be kept.
    fn picture(
        &self,
        ready: Ready,
        stop: &AtomicBool,
        [number, all]: [usize; 2],
    ) -> Result<Picture, Failure> {
        let Entry { panel, caption, .. } = ready.entry;
        let options = Options {
            settings: ready.settings,
            budget: Budget::Passes(ready.samples),
            threads: self.threads.unwrap_or(0) as usize,
            device: Device::Cpu,
        };
        let scene = open(&ready.prepared)?;
        let rendered = render(&scene, &options, stop, &|_| ())
            .map_err(|e| format!("{}: {e}", panel.scene.display()))?;
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        if !self.quiet {
            let estimator = ready.settings.estimator;
            report(&panel.scene, &rendered, estimator, [number, all]);
        }
        let picture = Picture {
            image: Linear {
                size: rendered.size,
                pixels: rendered.image,
            },
            tone: panel.screen.tone(),
            caption,
        };
        write(&ready.outputs, &picture.image, picture.tone)?;
        Ok(picture)
    }
}

/// The scene in a blob that has been opened before.
fn open(prepared: &Prepared) -> Result<Scene<'_>, String> {
    Scene::open(prepared.blob.bytes()).map_err(|e| e.to_string())
}

fn report(scene: &Path, r: &Rendered, estimator: Estimator, [number, all]: [usize; 2]) {
    let scene = scene.display();
    eprintln!(
        "{number}/{all} {scene}: {} × {}, {} samples per pixel in {:.1} s",
        r.size[0], r.size[1], r.passes, r.seconds
    );
    let losses = losses(r, estimator);
    let losses: Vec<_> = losses.iter().map(|l| format!("{scene}: {l}")).collect();
    warn(&losses);
}
