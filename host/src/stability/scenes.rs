//! The atlas's scenes: files that the program has in it, and what it adds to them where a file would be large.

use super::manifest::Case;
use crate::blob::AlignedBlob;
use crate::compile::compile;
use crate::description::{Description, Emitter, EmitterKind, Geometry, Mesh, Place};
use crate::load;

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// Files of `scenes/stability`.
        const FILES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../../scenes/stability/", $name)))),*];
    };
}

files![
    "ball-caustic-lamp.xml",
    "ball-caustic.xml",
    "camera-on-boundary.xml",
    "chromatic-absorption.xml",
    "chromatic-scattering.xml",
    "close-light.xml",
    "coplanar.xml",
    "enclosure.xml",
    "floor.xml",
    "furnace-rough-glass.xml",
    "furnace-smooth-rough-glass.xml",
    "glass-pane.xml",
    "grazing-light.xml",
    "grazing-view.xml",
    "index-near-1.xml",
    "lamp-in-glass.xml",
    "many-lights.xml",
    "mirror-hall.xml",
    "peak-backward.xml",
    "peak-forward.xml",
    "phong-sharp.xml",
    "room.xml",
    "sinking-light.xml",
    "slab-thick.xml",
    "slab-thin.xml",
    "tilted-normals.xml",
    "tilted.obj",
    "tiny-light.xml",
    "touching-light.xml",
    "touching-media.xml",
    "twin-lights.xml",
    "water-above.xml",
    "water-below.xml",
    "white-floor.xml",
];

/// The scene of a case as a blob, with what compiling it warned of.
///
/// # Errors
/// What can't be loaded or compiled, in one line.
pub fn build(case: &Case) -> Result<(AlignedBlob, Vec<String>), String> {
    let folder = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
    for (name, text) in FILES {
        std::fs::write(folder.path().join(name), text).map_err(|e| format!("{name}: {e}"))?;
    }
    let path = folder.path().join(format!("{}.xml", case.scene));
    let loaded = load::load(&path, &case.defines).map_err(|e| e.to_string())?;
    let mut description = loaded.description;
    match case.added.as_deref() {
        None => {}
        Some("slivers") => cut_into_slivers(&mut description),
        Some("duplicates") => repeat(&mut description),
        Some("degenerate") => degenerate(&mut description),
        Some("lights") => many_lights(&mut description),
        Some(other) => return Err(format!("nothing is called {other:?}")),
    }
    let compiled = compile(&description).map_err(|e| e.in_file(&path).to_string())?;
    // The folder is nobody's business, and gone by the time that it is read.
    let folder = format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR);
    let warnings = loaded.warnings.into_iter().chain(compiled.warnings);
    let warnings = warnings.map(|w| w.replace(&folder, ""));
    Ok((compiled.blob, warnings.collect()))
}

/// The edges that paths of a case's scene may have.
pub fn advised_depth(case: &Case) -> Option<u32> {
    let (_, text) = FILES
        .iter()
        .find(|(name, _)| name.strip_suffix(".xml") == Some(case.scene.as_str()))?;
    let (_, rest) = text.split_once("name=\"max_depth\" value=\"")?;
    rest.split_once('"')?.0.parse().ok()
}

/// The first shape's mesh: the floor.
fn floor(d: &mut Description) -> Option<&mut Mesh> {
    match d.shapes.first_mut().map(|s| &mut s.geometry) {
        Some(Geometry::Mesh(mesh)) => Some(mesh),
        _ => None,
    }
}

/// The floor [−1, 1]² in strips across: a sliver 2·10⁻⁶ wide and 2 long beside each of 1000 wide ones.
fn cut_into_slivers(d: &mut Description) {
    let Some(mesh) = floor(d) else { return };
    let mut x: Vec<f32> = Vec::new();
    for i in 0..1000 {
        let left = -1.0 + i as f32 * 2e-3;
        x.extend([left, left + 2e-6]);
    }
    x.push(1.0);
    *mesh = Mesh::default();
    for (i, &x) in x.iter().enumerate() {
        mesh.positions.extend([[x, -1.0, 0.0], [x, 1.0, 0.0]]);
        if i > 0 {
            let [a, b] = [2 * i as u32 - 2, 2 * i as u32];
            mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
}

/// The floor's triangles three times.
fn repeat(d: &mut Description) {
    if let Some(mesh) = floor(d) {
        let once = mesh.triangles.clone();
        mesh.triangles.extend(&once);
        mesh.triangles.extend(once);
    }
}

/// Beside the floor's triangles a thousand that are points, and a thousand that are segments of lines in it.
fn degenerate(d: &mut Description) {
    let Some(mesh) = floor(d) else { return };
    (mesh.normals, mesh.uvs) = (None, None);
    for i in 0..1000 {
        let t = -1.0 + i as f32 * 2e-3;
        let base = mesh.positions.len() as u32;
        mesh.positions
            .extend([[t, t, 0.0], [-t, t, 0.0], [0.0, t, 0.0]]);
        mesh.triangles
            .extend([[base; 3], [base, base + 1, base + 2]]);
    }
}

/// 400 × 250 point lights at height 1, light number k of intensity 10⁻⁵·(1 + k mod 7).
fn many_lights(d: &mut Description) {
    for k in 0..100_000u32 {
        let x = -1.0 + ((k % 400) as f32 + 0.5) / 200.0;
        let y = -1.0 + ((k / 400) as f32 + 0.5) / 125.0;
        let intensity = 1e-5 * (1 + k % 7) as f32;
        d.emitters.push(Emitter {
            name: format!("light {k}"),
            place: Place::default(),
            kind: EmitterKind::Point {
                position: [x, y, 1.0],
                intensity: [intensity; 3],
            },
            medium: None,
            spectrum: None,
        });
    }
}
