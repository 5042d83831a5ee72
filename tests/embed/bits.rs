//! The same bits on every target: hashes of a suite of renders (`tests/data/bits.txt`), one line each.
//!
//! `ETENDUE_BLESS=1 cargo test --release -p etendue-tests --test embed bits` writes blobs and hashes anew.

use etendue::estimate::{Rule, Tree};
use etendue::film::{Refused, Step, Sum};
use etendue::random::Sequence;
use etendue::real::Vec3;
use etendue::shape::IsaKind;
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_tests::bits::{hash, scenes};
use etendue_tests::place::root;
use etendue_tests::render::blob;
use std::fmt::Write;
use std::path::PathBuf;

/// Where the blobs are, and the hashes.
pub fn data(file: &str) -> PathBuf {
    root().join("tests/data").join(file)
}

/// The lines that every target has to print.
pub fn expected() -> String {
    std::fs::read_to_string(data("bits.txt")).unwrap_or_default()
}

/// What is rendered, as the lines say it. The second half of a name says which strategies, or which numbers.
const SUITE: [(&str, Estimator, Heuristic, Sequence); 12] = {
    use {Estimator as E, Heuristic as H, Sequence::*};
    [
        ("path balance", E::Path, H::Balance, Independent),
        ("path maximum", E::Path, H::Maximum, Independent),
        ("path sobol", E::Path, H::Power, Sobol),
        ("light power", E::Light, H::Power, Independent),
        (
            "bidirectional balance",
            E::Bidirectional,
            H::Balance,
            Independent,
        ),
        (
            "bidirectional power",
            E::Bidirectional,
            H::Power,
            Independent,
        ),
        (
            "bidirectional cutoff",
            E::Bidirectional,
            H::Cutoff,
            Independent,
        ),
        (
            "bidirectional maximum",
            E::Bidirectional,
            H::Maximum,
            Independent,
        ),
        ("bidirectional sobol", E::Bidirectional, H::Power, Sobol),
        ("distributed power", E::Distributed, H::Power, Independent),
        ("quadrature power", E::Quadrature, H::Power, Independent),
        (
            "quadrature+path power",
            E::QuadratureAndPath,
            H::Power,
            Independent,
        ),
    ]
};

/// Ray trees and rules that a microcontroller has the time for.
const TREE: Tree = Tree {
    branching: [2, 2, 1, 0, 0, 0, 0, 0],
    lights: 2,
};
const RULE: Rule = Rule {
    order: 2,
    steps: 4,
    depth: 8,
    shift: false,
};

const PASSES: u64 = 2;

/// The image of a whole film, by the kernel's own functions.
fn image(scene: &Scene<'_>, settings: &Settings, scratch: &mut Scratch<8>) -> Vec<f32> {
    let [w, h] = scene.size();
    let step = Step::new(scene.film_exponent());
    let mut refused = Refused::default();
    let mut samples: Vec<Sum> = vec![[0; 3]; (w * h) as usize];
    let mut splats = samples.clone();
    for y in 0..h {
        for x in 0..w {
            for index in 0..PASSES {
                let mut more = Refused::default();
                let own = scene.estimate(settings, [x, y], index, scratch, &mut |[x, y], v| {
                    step.add(&mut splats[(y * w + x) as usize], v, &mut more);
                });
                step.add(&mut samples[(y * w + x) as usize], own, &mut refused);
            }
        }
    }
    let pixel = |(own, others)| step.resolve(own, others, PASSES, PASSES, 1);
    let pixels = samples.iter().zip(&splats).map(pixel);
    pixels.flat_map(|p| p.map(|c| c as f32)).collect()
}

/// Irradiance at the middle of the scene, and radiance along a ray from there.
fn probes(scene: &Scene<'_>, settings: &Settings, scratch: &mut Scratch<8>) -> Vec<f32> {
    let center = Vec3::from(scene.world().center);
    let mut values = Vec::new();
    for index in 0..8 {
        let e = scene.irradiance(settings, center, Vec3::Z, 1, index, scratch);
        let l = scene.radiance(settings, center, -Vec3::Z, 2, index, scratch);
        values.extend(e.to_array().into_iter().chain(l.to_array()));
    }
    values
}

fn lines(isa: IsaKind) -> String {
    let mut text = String::new();
    for (name, _) in scenes() {
        let bytes = AlignedBlob::read(&data(&format!("bits/{name}.etd"))).unwrap();
        let scene = Scene::open(bytes.bytes()).unwrap().with_isa(isa);
        for (what, estimator, heuristic, sequence) in SUITE {
            // Lights that quadrature makes nothing of.
            if estimator.refuses(&scene).is_some() {
                continue;
            }
            let settings = Settings {
                estimator,
                heuristic,
                sequence,
                seed: 3,
                tree: TREE,
                rule: RULE,
                ..Settings::default()
            };
            let scratch = &mut Scratch::<8>::new();
            let pixels = hash(&image(&scene, &settings, scratch));
            let probes = hash(&probes(&scene, &settings, scratch));
            writeln!(text, "{name} {what} {pixels:016x} {probes:016x}").unwrap();
        }
    }
    text
}

/// The blobs are those that the compiler makes, and hold what they should.
#[test]
fn blobs_are_what_they_were() {
    let mut needs = 0;
    for (name, description) in scenes() {
        let made = blob(&description);
        let file = data(&format!("bits/{name}.etd"));
        if std::env::var_os("ETENDUE_BLESS").is_some() {
            std::fs::create_dir_all(data("bits")).unwrap();
            std::fs::write(&file, made.bytes()).unwrap();
        }
        let known = std::fs::read(&file).unwrap_or_default();
        assert!(known == made.bytes(), "{} differs", file.display());
        needs |= Scene::open(made.bytes()).unwrap().needs();
    }
    assert_eq!(needs, etendue::blob::format::needs::KNOWN);
}

#[test]
fn hashes_are_what_they_were_on_every_instruction_set() {
    let scalar = lines(IsaKind::Scalar);
    for isa in [IsaKind::Sse2, IsaKind::Avx2] {
        assert_eq!(lines(isa), scalar, "{isa:?}");
    }
    if std::env::var_os("ETENDUE_BLESS").is_some() {
        std::fs::write(data("bits.txt"), &scalar).unwrap();
    }
    assert_eq!(scalar, expected());
}
