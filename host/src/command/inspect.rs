//! `etendue inspect`.

use super::how::estimators;
use super::reading::Reading;
use super::{Failure, print, warn};
use crate::reach::unreachable;
use crate::scene::prepare;
use etendue::blob::format::{
    Header, NONE, Toc, WIDTH, child, emitter, material, medium, needs, section, sensor,
};
use etendue::{Scene, Settings};
use std::fmt::{self, Write};
use std::path::PathBuf;

/// Say what a scene or a blob holds, and what the kernel leaves out
#[derive(clap::Args, Debug)]
pub struct Inspect {
    /// Mitsuba 3 scene (.xml) or compiled blob (.etd)
    pub(super) scene: PathBuf,
    #[command(flatten)]
    reading: Reading,
}

impl Inspect {
    pub(super) fn run(self) -> Result<(), Failure> {
        let prepared = prepare(&self.scene, &self.reading.define, self.reading.changes())?;
        warn(&prepared.warnings);
        let bytes = prepared.blob.bytes();
        let scene = Scene::open(bytes).map_err(|e| e.to_string())?;
        let report = report(&scene, bytes).map_err(|e| e.to_string())?;
        print(&report)
    }
}

fn report(scene: &Scene<'_>, bytes: &[u8]) -> Result<String, fmt::Error> {
    let mut out = String::new();
    contents(&mut out, scene)?;
    sizes(&mut out, scene, bytes)?;
    tree(&mut out, scene)?;
    left_out(&mut out, scene)?;
    paths(&mut out, scene)?;
    Ok(out)
}

fn count_kinds<T>(records: &[T], names: &[&str], kind: impl Fn(&T) -> u32) -> String {
    let parts: Vec<String> = names
        .iter()
        .enumerate()
        .map(|(k, name)| (records.iter().filter(|r| kind(r) == k as u32).count(), name))
        .filter(|(n, _)| *n > 0)
        .map(|(n, name)| format!("{n} {name}"))
        .collect();
    if parts.is_empty() {
        "none".into()
    } else {
        parts.join(", ")
    }
}

fn contents(out: &mut String, scene: &Scene<'_>) -> fmt::Result {
    let s = scene.sensor();
    let kind = match (s.kind, s.aperture > 0.0) {
        (sensor::ORTHOGRAPHIC, _) => "orthographic",
        (sensor::PANORAMA, _) => "panorama",
        (_, true) => "thin lens",
        _ => "pinhole",
    };
    let filter = match s.filter {
        sensor::BOX => "box",
        sensor::TENT => "tent",
        _ => "gaussian",
    };
    let [w, h] = scene.size();
    writeln!(
        out,
        "sensor      {kind}, {w} × {h} of {} × {}, {filter} filter of radius {}",
        s.resolution[0], s.resolution[1], s.filter_radius
    )?;
    let world = scene.world();
    writeln!(
        out,
        "world       centre {:?}, radius {}",
        world.center, world.radius
    )?;
    writeln!(out, "shapes      {}", scene.shapes().len())?;
    writeln!(
        out,
        "primitives  {} triangles, {} spheres",
        scene.triangles().count(),
        scene.sphere_records().len()
    )?;
    let names = [
        "diffuse",
        "mirror",
        "conductor",
        "dielectric",
        "null",
        "sheet",
        "Phong",
        "rough conductor",
        "rough dielectric",
        "plastic",
        "rough plastic",
        "blend",
        "dispersive",
    ];
    debug_assert_eq!(names.len() as u32, material::DISPERSIVE + 1);
    writeln!(
        out,
        "materials   {}",
        count_kinds(scene.materials(), &names, |m| m.kind)
    )?;
    let names = ["checkerboard", "sRGB image", "linear image", "float image"];
    writeln!(
        out,
        "textures    {}",
        count_kinds(scene.textures(), &names, |t| t.kind)
    )?;
    let names = [
        "area",
        "point",
        "spot",
        "directional",
        "constant",
        "lat-long",
        "cube map",
        "volume",
    ];
    debug_assert_eq!(names.len() as u32, emitter::VOLUME + 1);
    writeln!(
        out,
        "emitters    {} ({} ways to choose)",
        count_kinds(scene.emitters(), &names, |e| e.kind),
        scene.choices().len()
    )?;
    media(out, scene)
}

/// Media one by one, as they may be large.
fn media(out: &mut String, scene: &Scene<'_>) -> fmt::Result {
    let names = ["homogeneous", "grid"];
    let kinds = count_kinds(scene.media(), &names, |m| m.kind);
    writeln!(out, "media       {kinds}")?;
    let place = |m: u32| {
        if m == NONE {
            "vacuum".into()
        } else {
            format!("medium {m}")
        }
    };
    if !scene.media().is_empty() {
        let (exterior, sensor) = (scene.world().exterior, scene.sensor().medium);
        writeln!(
            out,
            "  outside all objects is {}, the sensor is in {}",
            place(exterior),
            place(sensor)
        )?;
    }
    for (i, m) in scene.media().iter().enumerate() {
        let same = |c: [f32; 3]| match c {
            [r, g, b] if r == g && g == b => format!("{r}"),
            [r, g, b] => format!("{r} {g} {b}"),
        };
        write!(
            out,
            "  {i}: sigma_t {}, albedo {}",
            same(m.sigma_t),
            same(m.albedo)
        )?;
        if m.emission != [0.0; 3] {
            write!(out, ", emission {}", same(m.emission))?;
        }
        for l in m.phase.iter().filter(|l| l.weight > 0.0) {
            let name = match l.kind {
                medium::HENYEY_GREENSTEIN => format!("hg {}", l.g),
                medium::RAYLEIGH => "rayleigh".into(),
                medium::FORWARD => "forward".into(),
                _ => "isotropic".into(),
            };
            write!(out, ", {:.0} % {name}", 100.0 * l.weight)?;
        }
        writeln!(out)?;
        for (what, id) in [
            ("sigma_t", m.extinctions),
            ("albedo", m.albedos),
            ("emission", m.emissions),
        ] {
            let Some(g) = scene
                .grids()
                .get(id as usize)
                .filter(|_| m.kind == medium::GRID)
            else {
                continue;
            };
            let [x, y, z] = g.size;
            let bytes = 4 * u64::from(g.channels) * u64::from(x) * u64::from(y) * u64::from(z);
            let filter = if g.nearest != 0 {
                "nearest"
            } else {
                "trilinear"
            };
            writeln!(
                out,
                "     {what}: {x} × {y} × {z} texels of {} {filter}, {bytes} bytes",
                g.channels
            )?;
        }
        if m.kind == medium::GRID {
            let [x, y, z] = m.cells;
            let how = match m.flags {
                medium::REGULAR => "regular tracking",
                medium::RESIDUAL => "Woodcock and residual ratio tracking",
                _ => "Woodcock and ratio tracking",
            };
            writeln!(out, "     {how}, majorants of {x} × {y} × {z} boxes")?;
        }
    }
    Ok(())
}

fn sizes(out: &mut String, scene: &Scene<'_>, bytes: &[u8]) -> fmt::Result {
    let names = [
        "world",
        "sensor",
        "nodes",
        "packets",
        "triangles",
        "spheres",
        "normals",
        "uvs",
        "shapes",
        "materials",
        "textures",
        "texels",
        "emitters",
        "choices",
        "cells",
        "media",
        "grids",
    ];
    writeln!(out, "\nsection         records       bytes")?;
    let from = size_of::<Header>();
    let table: &[Toc] =
        bytemuck::cast_slice(&bytes[from..from + section::ALL.len() * size_of::<Toc>()]);
    let mut geometry = 0;
    for entry in table {
        let size = entry.count * u64::from(entry.stride);
        if (section::NODES..=section::UVS).contains(&entry.kind) {
            geometry += size;
        }
        writeln!(
            out,
            "{:<12} {:>10} {size:>11}",
            names[entry.kind as usize - 1],
            entry.count
        )?;
    }
    writeln!(out, "{:<12} {:>10} {:>11}", "whole", "", bytes.len())?;
    let triangles = scene.triangles().count();
    if triangles > 0 {
        writeln!(
            out,
            "geometry per triangle, shading data included: {:.1} bytes",
            geometry as f64 / triangles as f64
        )?;
    }
    Ok(())
}

/// Surface area of a box, halved.
fn half_area(low: [f32; 3], high: [f32; 3]) -> f64 {
    let [x, y, z] = std::array::from_fn(|i| f64::from(high[i] - low[i]).max(0.0));
    x * y + y * z + z * x
}

fn tree(out: &mut String, scene: &Scene<'_>) -> fmt::Result {
    let nodes = scene.nodes();
    let mut children = 0;
    let mut leaves = 0;
    // Expected work of a random ray that meets the root: nodes visited and packets tested.
    let (mut visits, mut tests) = (0.0, 0.0);
    let mut root = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for (index, node) in nodes.iter().enumerate() {
        for i in (0..WIDTH).filter(|&i| node.children[i] != child::EMPTY) {
            let (low, high) = (node.low.map(|a| a[i]), node.high.map(|a| a[i]));
            if index == 0 {
                for axis in 0..3 {
                    root.0[axis] = root.0[axis].min(low[axis]);
                    root.1[axis] = root.1[axis].max(high[axis]);
                }
            }
            children += 1;
            if node.children[i] & child::LEAF == 0 {
                visits += half_area(low, high);
            } else {
                leaves += 1;
                let count = (node.children[i] >> child::COUNT_SHIFT & 15) + 1;
                tests += half_area(low, high) * f64::from(count);
            }
        }
    }
    let area = half_area(root.0, root.1).max(f64::MIN_POSITIVE);
    let slots = scene.packets().len() * etendue::blob::format::LANES;
    writeln!(
        out,
        "\ntree        {} nodes, {leaves} leaves, {} levels, {:.2} of {WIDTH} children used",
        nodes.len(),
        scene.world().depth + 1,
        f64::from(children) / nodes.len() as f64
    )?;
    if slots > 0 {
        writeln!(
            out,
            "packets     {:.1} % full",
            100.0 * scene.triangles().count() as f64 / slots as f64
        )?;
    }
    writeln!(
        out,
        "SAH         a random ray through the scene's box visits {:.2} nodes and tests {:.2} packets or spheres",
        1.0 + visits / area,
        tests / area
    )?;
    Ok(())
}

fn left_out(out: &mut String, scene: &Scene<'_>) -> fmt::Result {
    writeln!(out, "\nleft out, because the scene doesn't need it:")?;
    let lines = [
        (needs::SPECTRAL, "wavelengths: paths carry RGB"),
        (
            needs::DISPERSION,
            "dispersion: all channels go the same way",
        ),
        (needs::GLOSSY, "glossy models: lobes are diffuse or Dirac"),
        (needs::MEDIA, "media: no free flight, no transmittance"),
        (
            needs::GRIDS,
            "grids: no tracking, media are the same everywhere",
        ),
        (needs::GLOWING, "emission of media: no light along the way"),
        (
            needs::MASKS | needs::NULL,
            "masks and null boundaries: shadow rays stop at the first thing they meet",
        ),
        (needs::SPHERES, "spheres: the tree holds triangles only"),
        (needs::TEXTURES, "textures: colours are constants"),
        (
            needs::SMOOTH_NORMALS,
            "interpolated normals: no correction of light walks",
        ),
        (needs::DISTANT, "emitters at infinity"),
        (needs::DIRAC, "Dirac lobes: every vertex can be connected"),
        (needs::TRANSMISSION, "transmission: light stays on its side"),
    ];
    let media = scene.has(needs::MEDIA);
    for (bits, line) in lines {
        // What media may have goes without saying where there are none.
        let implied = !media && [needs::GRIDS, needs::GLOWING].contains(&bits);
        if !scene.has(bits) && !implied {
            writeln!(out, "  {line}")?;
        }
    }
    let possible = scene.possible();
    if !possible.joins {
        writeln!(out, "  light walks: no vertex can be joined to another")?;
    }
    if !possible.meets {
        writeln!(out, "  the last ray of a walk: it can't meet light")?;
    }
    if scene.world().background == NONE {
        writeln!(out, "  background: what leaves the scene is black")?;
    }
    if scene.choices().is_empty() {
        writeln!(out, "  light: nothing emits")?;
    }
    Ok(())
}

/// Light paths that estimators can't make; those that make all have no line.
fn paths(out: &mut String, scene: &Scene<'_>) -> fmt::Result {
    // Estimators that lack the same paths share a line.
    let mut lines: Vec<(String, Vec<String>)> = Vec::new();
    for (estimator, name) in estimators() {
        let settings = Settings {
            estimator,
            ..Settings::default()
        };
        let refused = settings.estimator.refuses(scene).map(str::to_owned);
        for text in refused.into_iter().chain(unreachable(scene, &settings)) {
            match lines.iter_mut().find(|(line, _)| *line == text) {
                Some((_, names)) => names.push(name.clone()),
                None => lines.push((text, vec![name.clone()])),
            }
        }
    }
    if !lines.is_empty() {
        writeln!(out, "\nlight paths that an estimator can't make here:")?;
        for (text, names) in &lines {
            writeln!(out, "  {}: {text}", names.join(", "))?;
        }
    }
    Ok(())
}
