//! `etendue render`.

use super::how::How;
use super::reading::Reading;
use super::screen::Screen;
use super::{Failure, print, warn};
use crate::develop::{Linear, Output, write};
use crate::reach::unreachable;
use crate::render::{
    Budget, CONFIDENCE, Device, Options, Progress, RenderError, Rendered, doubts, render,
};
use crate::scene::{Changes, prepare};
use clap::ValueEnum;
use etendue::Scene;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Samples per pixel if neither the command line nor the scene says.
pub(super) const DEFAULT_SAMPLES: u64 = 64;

/// Render a scene to images
///
/// Ctrl-C ends the render at a whole pass over the image, writes what there is and exits with 130; a second
/// one ends it at once and writes nothing.
#[derive(clap::Args, Debug)]
pub struct Render {
    /// Mitsuba 3 scene (.xml) or compiled blob (.etd)
    pub(super) scene: PathBuf,
    /// Image to write: .exr or .hdr (linear), .png (tone-mapped, sRGB); may be repeated
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    output: Vec<PathBuf>,
    #[command(flatten)]
    how: How,
    /// Samples per pixel [default: what the scene says, or 64]; with --error at most [default: 65536]
    #[arg(long, value_name = "N", conflicts_with = "time", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    spp: Option<u64>,
    /// Rendering time (500ms, 30s, 2m, 1h), without loading; ends with a whole pass over the image; with --error at most
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time: Option<Duration>,
    /// Render until the error is not above E (0.01 or 1%) with 95 % confidence, with more samples where there is more noise
    ///
    /// The error is the root mean square of the whole image's noise, relative to the root mean square of the image. What no sample has met yet isn't known,
    /// nor what rules and precision do to an image.
    #[arg(long, value_name = "E", value_parser = relative_error)]
    error: Option<f64>,
    /// Threads; the image doesn't depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// What renders; the image doesn't depend on it
    #[arg(long, value_enum, default_value_t = DeviceName::Cpu)]
    device: DeviceName,
    #[command(flatten)]
    reading: Reading,
    /// Columns of the image; with --width alone the shape is kept, with both the field of view across
    #[arg(long, value_name = "W")]
    width: Option<u32>,
    /// Rows of the image; with --height alone the shape is kept
    #[arg(long, value_name = "H")]
    height: Option<u32>,
    #[command(flatten)]
    screen: Screen,
    /// End with one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// No progress, no summary
    #[arg(long)]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DeviceName {
    /// all cores, or --threads
    Cpu,
    /// a GPU of NVIDIA's
    Cuda,
}

/// A number with a unit.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let expected = || format!("expected a time like 500ms, 30s, 2m or 1h, found {text:?}");
    let split = text
        .find(|c: char| c.is_ascii_alphabetic())
        .ok_or_else(expected)?;
    let (number, unit) = text.split_at(split);
    let scale = match unit {
        "ms" => 1e-3,
        "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        _ => return Err(expected()),
    };
    let seconds: f64 = number.parse::<f64>().map_err(|_| expected())? * scale;
    Duration::try_from_secs_f64(seconds)
        .ok()
        .filter(|d| !d.is_zero())
        .ok_or_else(expected)
}

/// A number, or one in percent.
fn relative_error(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    let error = number.trim().parse::<f64>().ok().map(|x| x * scale);
    error.filter(|e| *e > 0.0 && *e <= 1.0).ok_or_else(|| {
        format!("expected a number above 0 and up to 1, like 0.01 or 1%, found {text:?}")
    })
}

impl Render {
    /// When it ends.
    fn budget(&self, advised: Option<u32>) -> Budget {
        match (self.error, self.time) {
            (Some(relative), time) => Budget::Error {
                relative,
                passes: self.spp.unwrap_or(Budget::MOST_PASSES),
                time,
            },
            (None, Some(time)) => Budget::Time(time),
            (None, None) => {
                let samples = self.spp.or(advised.map(u64::from));
                Budget::Passes(samples.unwrap_or(DEFAULT_SAMPLES))
            }
        }
    }

    pub(super) fn run(self) -> Result<(), Failure> {
        // What can't be written is refused before anything is rendered.
        let outputs = self
            .output
            .iter()
            .map(|path| Output::open(path))
            .collect::<Result<Vec<_>, _>>()?;
        let size = Changes {
            width: self.width,
            height: self.height,
            ..self.reading.changes()
        };
        let prepared = prepare(&self.scene, &self.reading.define, size)?;
        if !self.quiet {
            warn(&prepared.warnings);
        }
        let scene = Scene::open(prepared.blob.bytes()).map_err(|e| e.to_string())?;
        let mut settings = self.how.settings(prepared.advice.max_depth);
        let failed = |e: RenderError| format!("{}: {e}", self.scene.display());
        let threads = self.threads.unwrap_or(0) as usize;
        let budget = self.budget(prepared.advice.samples);
        let time = match budget {
            Budget::Time(time) => Some(time),
            Budget::Error { time, .. } => time,
            Budget::Passes(_) => None,
        };
        let chosen = self.how.choose(&mut settings, &scene, threads, time);
        let chosen = chosen.map_err(failed)?;
        let pixels = scene.size().map(|n| n as usize).iter().product();
        if let Some(choice) = chosen.as_ref().filter(|_| !self.quiet) {
            eprintln!("{}", choice.line(Some((budget, pixels))));
        }
        let options = Options {
            settings,
            budget,
            threads,
            device: match self.device {
                DeviceName::Cpu => Device::Cpu,
                DeviceName::Cuda => Device::Cuda,
            },
        };
        let stop = catch_interrupt()?;
        let bar = self.progress_bar();
        let started = Instant::now();
        let watch = |p: Progress| show(&bar, p, started.elapsed());
        let rendered = render(&scene, &options, &stop, &watch).map_err(failed)?;
        bar.finish_and_clear();
        let image = Linear {
            size: rendered.size,
            pixels: rendered.image.clone(),
        };
        write(&outputs, &image, self.screen.tone())?;
        let pilot = chosen.map(|c| {
            serde_json::json!({
                "chosen": c.name,
                "seconds": c.seconds,
                "rays": c.rays,
                "share": c.share(budget, pixels),
            })
        });
        let (r, settings) = (&rendered, &options.settings);
        // Of finer rules nobody asks who doesn't listen.
        let doubts = match self.quiet {
            true => Vec::new(),
            false => doubts(&scene, settings, r),
        };
        self.report(r, pilot, &doubts, &unreachable(&scene, settings))?;
        if rendered.interrupted {
            Err(Failure::Interrupted)
        } else {
            Ok(())
        }
    }

    fn progress_bar(&self) -> ProgressBar {
        let bar = ProgressBar::new(1000);
        if self.quiet || self.json || !std::io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        bar
    }

    fn report(
        &self,
        r: &Rendered,
        pilot: Option<serde_json::Value>,
        doubts: &[String],
        unreachable: &[String],
    ) -> Result<(), Failure> {
        let samples = r.passes * r.image.len() as u64;
        let rays = r.counters.rays();
        let per_second = |n: u64| n as f64 / r.seconds.max(1e-9);
        let mean: [f64; 3] = std::array::from_fn(|c| {
            r.image.iter().map(|p| f64::from(p[c])).sum::<f64>() / r.image.len() as f64
        });
        if self.json {
            let object = serde_json::json!({
                "width": r.size[0],
                "height": r.size[1],
                "passes": r.passes,
                "samples": samples,
                "seconds": r.seconds,
                "samples_per_second": per_second(samples),
                "rays": rays,
                "rays_per_second": per_second(rays),
                "mean_rgb": mean,
                "interrupted": r.interrupted,
                "pilot": pilot,
                "unreachable": unreachable,
                "accuracy": r.accuracy.map(|a| serde_json::json!({
                    "asked": a.asked,
                    "relative_error": a.found,
                    "confidence": CONFIDENCE,
                    "met": a.met,
                    "checkpoints": a.checkpoints,
                    "fewest_samples": a.samples[0],
                    "most_samples": a.samples[1],
                })),
                "chains": r.chains.map(|c| serde_json::json!({
                    "chains": c.chains,
                    "bootstrap_paths": c.bootstraps,
                    "mean": c.mean,
                    "mean_relative_error": c.error,
                    "above": c.above,
                    "largest_step": c.size,
                    "small_steps_accepted": c.accepted,
                })),
                "diagnostics": {
                    "closest_rays": r.counters.closest_rays,
                    "shadow_rays": r.counters.shadow_rays,
                    "light_walks": r.counters.light_walks,
                    "walks_cut_by_step_limit": r.counters.cut_walks,
                    "light_walks_cut_by_capacity": r.counters.full_walks,
                    "rejected_values": r.counters.rejected,
                    "film_saturated": r.refused.saturated,
                    "film_underflowed": r.refused.underflowed,
                    "film_invalid": r.refused.invalid,
                },
            });
            print(&format!("{object}\n"))?;
        } else if !self.quiet {
            eprintln!(
                "{} × {}, {} samples per pixel in {:.2} s: {:.2} M samples/s, {:.2} M rays/s",
                r.size[0],
                r.size[1],
                r.passes,
                r.seconds,
                per_second(samples) * 1e-6,
                per_second(rays) * 1e-6
            );
            if let Some(c) = &r.chains {
                eprintln!(
                    "{} chains for what contributions carry beyond {:.2e}, {:.0} % of small steps (up to {:.1e}) accepted; brightness of the whole to {:.2} % (one standard error)",
                    c.chains,
                    c.above,
                    100.0 * c.accepted,
                    c.size,
                    100.0 * c.error
                );
            }
        }
        if let Some(a) = r.accuracy.filter(|_| !self.quiet) {
            eprintln!(
                "error {:.2} %, {}; {} to {} samples of a pixel",
                100.0 * a.found,
                if a.met {
                    format!(
                        "with {:.0} % confidence not above {} %",
                        100.0 * CONFIDENCE,
                        100.0 * a.asked
                    )
                } else {
                    format!(
                        "more than {} %: the budget was spent before",
                        100.0 * a.asked
                    )
                },
                a.samples[0],
                a.samples[1]
            );
        }
        if !self.quiet {
            warn(doubts);
            warn(unreachable);
        }
        Ok(())
    }
}

/// The first Ctrl-C ends the render after its pass; the second ends the program.
pub(super) fn catch_interrupt() -> Result<Arc<AtomicBool>, String> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .map_err(|e| format!("can't listen for Ctrl-C: {e}"))?;
    Ok(stop)
}

fn show(bar: &ProgressBar, p: Progress, elapsed: Duration) {
    if bar.is_hidden() {
        return;
    }
    bar.set_position((p.done * 1000.0) as u64);
    let seconds = elapsed.as_secs_f64();
    let left = if p.done > 0.0 {
        seconds * (1.0 - p.done) / p.done
    } else {
        0.0
    };
    bar.set_message(format!(
        "{} spp, {:.2} M samples/s, {left:.0} s left",
        p.passes,
        p.samples as f64 / seconds.max(1e-9) * 1e-6
    ));
}
