//! Contact sheets: what a manifest lists is rendered to one picture, or refused with file and line.

use super::refusals::refused;
use super::{bytes, etendue, folder, succeed, text};
use std::path::Path;

/// The figures of the thesis.
const THESIS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/thesis");

#[test]
fn the_figures_of_the_thesis_make_a_sheet() {
    let (_keep, at) = folder();
    std::fs::create_dir(at.join("panels")).unwrap();
    let small = ["--spp-scale", "0.0001", "--scale", "0.0625"];
    let files = ["figures", THESIS, "-o", "sheet.png", "--keep", "panels"];
    let output = etendue(&at, &[&files, &small[..]].concat());
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(!said.contains("warning"), "{said}");

    let manifest = std::fs::read_to_string(Path::new(THESIS).join("figures.txt")).unwrap();
    let is_panel = |l: &&str| !l.starts_with('#') && l.contains(" | ");
    let panels = manifest.lines().filter(is_panel).count();
    for figure in 2..=14 {
        let name = format!("Figure {figure}.");
        assert!(manifest.contains(&name), "no {name}");
    }
    assert_eq!(said.lines().count(), panels, "{said}");
    // EXR and PNG of each.
    let kept = std::fs::read_dir(at.join("panels")).unwrap().count();
    assert_eq!(kept, 2 * panels);
    let first = image::open(at.join("panels/01-figure-02.png")).unwrap();
    assert_eq!((first.width(), first.height()), (67, 9));
    // Two margins around the widest row, which is four panels of 16 pixels with margins between them.
    let sheet = image::open(at.join("sheet.png")).unwrap();
    assert_eq!(sheet.width(), 4 * 16 + 5 * 14);
}

#[test]
fn a_sheet_has_its_panels_in_rows_and_doesnt_depend_on_threads() {
    let (_keep, at) = folder();
    let manifest = "# two rows\n\
        scene.xml --spp 2 | one\n\
        scene.xml --spp 2 -D grey=0.9 --estimator light --exposure 1 |  two words \n\n\n\
        scene.xml --max-depth 1 --tonemap reinhard | 3\n";
    std::fs::write(at.join("figures.txt"), manifest).unwrap();
    succeed(&at, &["figures", ".", "-o", "a.png", "--threads", "1"]);
    succeed(&at, &["figures", "figures.txt", "-o", "b.png", "--quiet"]);
    assert_eq!(bytes(&at, "a.png"), bytes(&at, "b.png"));
    // 16 × 12 pixels each, 14 around them; a caption is 6 apart, its lines, of two letters, are 12 high.
    let sheet = image::open(at.join("a.png")).unwrap().into_rgb8();
    let rows = [12 + 6 + 5 * 12, 12 + 6 + 12];
    assert_eq!(
        sheet.dimensions(),
        (2 * 16 + 3 * 14, rows[0] + rows[1] + 3 * 14)
    );
    // The lamp is in the middle of the third panel.
    assert_ne!(
        sheet.get_pixel(14 + 8, 14 + rows[0] + 14 + 4),
        sheet.get_pixel(0, 0)
    );
}

#[test]
fn broken_manifests_are_refused_with_their_line() {
    let (_keep, at) = folder();
    let with = |manifest: &str, parts: &[&str]| {
        std::fs::write(at.join("figures.txt"), manifest).unwrap();
        // The first panel is good, and must not be rendered for nothing.
        refused(&at, &["figures", ".", "-o", "x.png", "--keep", "."], parts);
    };
    let bad = |line: &str, parts: &[&str]| {
        let manifest = format!("scene.xml | good\n\n# and\n{line}\n");
        with(&manifest, &[&["figures.txt:4: "], parts].concat());
    };
    bad("scene.xml --spp 4", &["caption"]);
    bad("scene.xml | caf\u{e9}", &["ASCII"]);
    bad("scene.xml --spp none | x", &["--spp", "none"]);
    bad("scene.xml --estimator magic | x", &["magic"]);
    bad("scene.xml --output y.png | x", &["--output"]);
    bad("scene.xml other.xml | x", &["other.xml"]);
    bad("--spp 4 | x", &["SCENE"]);
    bad("nowhere.xml | x", &["nowhere.xml"]);
    bad("scene.xml -D grey=7 | x", &["scene.xml:10"]);
    with("# nothing\n", &["figures.txt: no panels"]);

    std::fs::write(at.join("figures.txt"), "scene.xml | good\n").unwrap();
    refused(&at, &["figures", "nowhere", "-o", "x.png"], &["nowhere"]);
    refused(&at, &["figures", ".", "-o", "x.exr"], &["x.exr", ".png"]);
    refused(
        &at,
        &["figures", ".", "-o", "x.png", "--keep", "nowhere"],
        &["nowhere"],
    );
}
