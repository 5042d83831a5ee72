//! Scenes written to a folder and read back: every kind of refusal, and the values that matter.

use super::transform;
use crate::description::*;
use crate::load::{Loaded, load};
use std::path::Path;
use tempfile::TempDir;

mod media;
mod refusals;
mod values;

const SENSOR: &str = "<sensor type='perspective'/>";

/// A folder with files; `scene.xml` is the one to load.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let dir = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        std::fs::write(dir.path().join(name), text).expect("a file");
    }
    dir
}

fn scene(body: &str) -> String {
    format!("<scene version='3.0.0'>\n{SENSOR}\n{body}\n</scene>")
}

fn try_in(dir: &TempDir, defines: &[(&str, &str)]) -> Result<Loaded, String> {
    let defines: Vec<_> = defines
        .iter()
        .map(|(a, b)| (a.to_string(), b.to_string()))
        .collect();
    let prefix = format!("{}/", dir.path().display());
    load(&dir.path().join("scene.xml"), &defines).map_err(|e| e.to_string().replace(&prefix, ""))
}

fn try_scene(body: &str) -> Result<Loaded, String> {
    try_in(&folder(&[("scene.xml", &scene(body))]), &[])
}

fn good(body: &str) -> Loaded {
    try_scene(body).unwrap_or_else(|e| panic!("{e}\n{body}"))
}

fn bad(body: &str) -> String {
    let error = try_scene(body).expect_err(body);
    assert!(!error.contains('\n'), "one line: {error}");
    error
}

#[track_caller]
fn refused(body: &str, message: &str) {
    assert_eq!(bad(body), message);
}

fn first_mesh(loaded: &Loaded) -> &Mesh {
    match &loaded.description.shapes[0].geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

fn matrix(steps: &str) -> glam::DMat4 {
    try_matrix(steps).unwrap_or_else(|e| panic!("{e}"))
}

fn try_matrix(steps: &str) -> Result<glam::DMat4, String> {
    let dir = folder(&[(
        "t.xml",
        &format!("<scene><transform name='t'>{steps}</transform></scene>"),
    )]);
    let document =
        super::Document::read(&dir.path().join("t.xml"), &[]).map_err(|e| e.to_string())?;
    transform::parse(&document, &document.nodes[1]).map_err(|e| e.to_string())
}

fn close(a: glam::DVec3, b: [f64; 3]) -> bool {
    a.distance(b.into()) < 1e-12
}

fn sensor(inner: &str) -> Result<Sensor, String> {
    let text = format!("<scene version='3.0.0'><sensor {inner}</sensor></scene>");
    try_in(&folder(&[("scene.xml", &text)]), &[]).map(|l| l.description.sensor)
}

fn material(bsdf: &str) -> Result<Loaded, String> {
    try_scene(&format!("<shape type='cube'>{bsdf}</shape>"))
}

/// A PNG of 8-bit colours.
fn png(path: &Path, width: u32, pixels: &[[u8; 3]]) {
    let bytes: Vec<u8> = pixels.iter().flatten().copied().collect();
    let height = pixels.len() as u32 / width;
    image::save_buffer(path, &bytes, width, height, image::ColorType::Rgb8).expect("a PNG");
}
