//! `etendue bake`.

use super::how::How;
use super::reading::Reading;
use super::{Failure, print, warn};
use crate::compile::compile;
use crate::description::{Description, Geometry, Mesh, Shape};
use crate::develop::{Curve, Linear, Output, Tone, write};
use crate::load;
use crate::render::{Bake as Options, bake};
use crate::scene::is_blob;
use etendue::Scene;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::Instant;

/// Samples per texel if neither the command line nor the scene says.
const DEFAULT_SAMPLES: u64 = 64;
/// The widest and highest map.
const MOST: u32 = 1 << 14;
/// Names that an error lists.
const NAMES: usize = 8;

/// Bake a light map: irradiance on a mesh with texture coordinates, as an image
///
/// A texel is the part of the mesh that its square of the map covers; row 0 is v = 0. Ctrl-C ends it and writes nothing. The pilot of
/// `auto` is one of images: here `auto` is `path`.
#[derive(clap::Args, Debug)]
pub struct Bake {
    /// Mitsuba 3 scene (.xml)
    pub(super) scene: PathBuf,
    /// Id of the shape whose light is baked; its triangles must not overlap on the map
    #[arg(long, value_name = "ID")]
    shape: String,
    /// Image to write: .exr or .hdr (irradiance, W/m²), .png (clamped, sRGB); may be repeated
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    output: Vec<PathBuf>,
    /// Columns of the map
    #[arg(long, value_name = "W", default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST)))]
    width: u32,
    /// Rows of the map
    #[arg(long, value_name = "H", default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST)))]
    height: u32,
    /// Samples per texel [default: what the scene says, or 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    spp: Option<u64>,
    /// Texels by which the borders of what is covered spread outwards; the others stay 0
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=i64::from(MOST)))]
    dilate: u32,
    #[command(flatten)]
    how: How,
    /// Threads; the map doesn't depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    #[command(flatten)]
    reading: Reading,
    /// End with one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// No progress, no summary
    #[arg(long)]
    quiet: bool,
}

impl Bake {
    pub(super) fn run(self) -> Result<(), Failure> {
        // What can't be written is refused before anything is rendered.
        let outputs = self
            .output
            .iter()
            .map(|path| Output::open(path))
            .collect::<Result<Vec<_>, _>>()?;
        let file = self.scene.display();
        if is_blob(&self.scene) {
            return Err(format!(
                "{file}: a compiled scene has no names of shapes: bake needs the scene file"
            )
            .into());
        }
        let loaded = load::load(&self.scene, &self.reading.define).map_err(|e| e.to_string())?;
        if !self.quiet {
            warn(&loaded.warnings);
        }
        let mut description = loaded.description;
        let changes = self.reading.changes();
        changes
            .apply(&mut description)
            .map_err(|e| format!("{file}: {e}"))?;
        let (shape, mesh) = self.mesh(&description)?;
        let blob = compile(&description)
            .map_err(|e| e.in_file(&self.scene).to_string())?
            .blob;
        let scene = Scene::open(blob.bytes()).map_err(|e| e.to_string())?;
        let advised = description.advice.samples.map(u64::from);
        let options = Options {
            settings: self.how.settings(description.advice.max_depth),
            size: [self.width, self.height],
            samples: self.spp.or(advised).unwrap_or(DEFAULT_SAMPLES),
            dilate: self.dilate,
            threads: self.threads.unwrap_or(0) as usize,
        };
        let bar = self.progress_bar();
        let started = Instant::now();
        let watch = |share: f64| bar.set_position((share * 1000.0) as u64);
        let baked = bake(&scene, mesh, &options, &watch)
            .map_err(|e| format!("{file}:{}: {}: {e}", shape.place.line, shape.name))?;
        bar.finish_and_clear();
        let seconds = started.elapsed().as_secs_f64();
        let map = Linear {
            size: options.size,
            pixels: baked.texels,
        };
        let tone = Tone {
            exposure: 0.0,
            curve: Curve::None,
        };
        write(&outputs, &map, tone)?;
        if self.json {
            let object = serde_json::json!({
                "width": self.width,
                "height": self.height,
                "covered": baked.covered,
                "samples_per_texel": options.samples,
                "seconds": seconds,
                "closest_rays": baked.counters.closest_rays,
                "shadow_rays": baked.counters.shadow_rays,
                "rejected_values": baked.counters.rejected,
            });
            print(&format!("{object}\n"))?;
        } else if !self.quiet {
            eprintln!(
                "{} × {}, {} texels covered, {} samples per texel in {seconds:.2} s",
                self.width, self.height, baked.covered, options.samples
            );
        }
        if baked.counters.rejected > 0 && !self.quiet {
            eprintln!(
                "warning: {} values were not finite or negative, and were left out",
                baked.counters.rejected
            );
        }
        Ok(())
    }

    /// The shape, and its mesh.
    fn mesh<'d>(&self, d: &'d Description) -> Result<(&'d Shape, &'d Mesh), String> {
        let file = self.scene.display();
        let Some(shape) = d.shapes.iter().find(|s| s.name == self.shape) else {
            let mut names: Vec<_> = d.shapes.iter().map(|s| format!("{:?}", s.name)).collect();
            let more = names.len().saturating_sub(NAMES);
            names.truncate(NAMES);
            let rest = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            return Err(format!(
                "{file}: there is no shape {:?}, expected one of {}{rest}",
                self.shape,
                names.join(", ")
            ));
        };
        match &shape.geometry {
            Geometry::Mesh(mesh) => Ok((shape, mesh)),
            Geometry::Sphere { .. } => Err(format!(
                "{file}:{}: {}: an exact sphere has no texture coordinates, expected a mesh",
                shape.place.line, shape.name
            )),
        }
    }

    fn progress_bar(&self) -> ProgressBar {
        let bar = ProgressBar::new(1000);
        if self.quiet || self.json || !std::io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %") {
            bar.set_style(style);
        }
        bar
    }
}
