//! Bits: small renders have the hashes they had, whatever the instruction set, the threads and the order; and no
//! bytes, however broken, make the kernel do anything but refuse them or estimate finite light.
//!
//! `ETENDUE_BLESS=1 cargo test --release -p etendue-tests --test golden` writes the hashes anew.

use etendue::blob::format::needs;
use etendue::film::{Refused, Step, Sum};
use etendue::random::{Pcg, Purpose, Sampler, Sequence};
use etendue::shape::IsaKind;
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::render::{Budget, Crew, Device, Options, render, render_double};
use etendue_host::scene::{Changes, prepare};
use etendue_tests::bits::{self, hash};
use etendue_tests::render::blob;
use etendue_tests::scenes::room;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data")
        .join(file)
}

/// Small scenes, compiled.
fn scenes() -> Vec<(&'static str, AlignedBlob)> {
    let size = Changes {
        width: Some(24),
        ..Changes::default()
    };
    let file = |name: &str| {
        prepare(&data(&format!("scenes/{name}.xml")), &[], size)
            .unwrap()
            .blob
    };
    let furnished = room(|b| {
        let glass = Some(b.glass(1.5));
        let white = Some(b.diffuse([0.8; 3]));
        b.sphere([0.45, 0.1, 0.35], 0.3, glass);
        b.sphere([-0.4, 0.1, 0.35], 0.3, white).emission = Some([1.0, 2.0, 3.0]);
        b.light(etendue_host::description::EmitterKind::Constant {
            radiance: [0.1, 0.2, 0.3],
        });
    });
    let all = bits::scenes();
    let (_, fog) = all.iter().find(|(name, _)| *name == "fog").unwrap();
    vec![
        ("cornell_diffuse", file("cornell_diffuse")),
        ("cornell_spheres", file("cornell_spheres")),
        ("room", blob(&furnished.description)),
        // Every phase function, grids by every way of tracking, what glows.
        ("fog", blob(fog)),
    ]
}

const ESTIMATORS: [(Estimator, Heuristic, Sequence); 10] = {
    use {Estimator as E, Heuristic as H, Sequence::*};
    [
        (E::Path, H::Power, Independent),
        (E::Path, H::Power, Sobol),
        (E::Light, H::Power, Independent),
        (E::Bidirectional, H::Power, Independent),
        (E::Bidirectional, H::Power, Sobol),
        (E::Bidirectional, H::Maximum, Independent),
        (E::Distributed, H::Power, Independent),
        (E::QuadratureAndPath, H::Power, Independent),
        (E::QuadratureAndPath, H::Power, Sobol),
        (E::Metropolis, H::Power, Independent),
    ]
};

/// Its hash, and how many chains it took.
fn image(scene: &Scene<'_>, settings: Settings, threads: usize) -> (String, u64) {
    // Chains start once there is enough for one.
    let chains = settings.estimator == Estimator::Metropolis;
    let options = Options {
        settings,
        budget: Budget::Passes(if chains { 128 } else { 4 }),
        threads,
        device: Device::Cpu,
    };
    let rendered = render(scene, &options, &AtomicBool::new(false), &|_| ()).unwrap();
    let chains = rendered.chains.map_or(0, |report| report.chains);
    (
        format!("{:016x}", hash(rendered.image.as_flattened())),
        chains,
    )
}

#[test]
fn hashes_are_what_they_were_on_every_instruction_set_and_thread_count() {
    let (mut found, mut chains) = (BTreeMap::new(), 0);
    for (name, bytes) in scenes() {
        for (estimator, heuristic, sequence) in ESTIMATORS {
            let settings = Settings {
                estimator,
                heuristic,
                sequence,
                seed: 3,
                ..Settings::default()
            };
            let of = |isa, threads| {
                let scene = Scene::open(bytes.bytes()).unwrap().with_isa(isa);
                image(&scene, settings, threads)
            };
            let mut what = format!("{name} {estimator:?} {heuristic:?}");
            if sequence != Sequence::Independent {
                what += &format!(" {sequence:?}");
            }
            let first = of(IsaKind::Scalar, 1);
            for (isa, threads) in [
                (IsaKind::Sse2, 1),
                (IsaKind::Avx2, 1),
                (IsaKind::Avx2, 2),
                (IsaKind::Scalar, 3),
            ] {
                assert_eq!(
                    first,
                    of(isa, threads),
                    "{what}: {isa:?} on {threads} threads"
                );
            }
            let (hash, started) = first;
            chains += started;
            found.insert(what, hash);
        }
    }
    assert!(chains > 16, "{chains} chains");
    let file = data("golden.json");
    if std::env::var_os("ETENDUE_BLESS").is_some() {
        std::fs::write(&file, serde_json::to_string_pretty(&found).unwrap() + "\n").unwrap();
    }
    let known: BTreeMap<String, String> =
        serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!(known, found);
}

/// Samples may be taken in any order.
#[test]
fn the_order_of_samples_does_not_matter() {
    let (_, bytes) = scenes().swap_remove(2);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let settings = Settings {
        estimator: Estimator::Bidirectional,
        ..Settings::default()
    };
    let [w, h] = scene.size();
    let sums = |backwards: bool| {
        let step = Step::new(scene.film_exponent());
        let mut film: Vec<Sum> = vec![[0; 3]; (w * h) as usize];
        let mut scratch = Scratch::<32>::new();
        let mut order: Vec<u32> = (0..w * h).collect();
        if backwards {
            order.reverse();
        }
        for i in order {
            let mut add = |[x, y]: [u32; 2], v| {
                step.add(&mut film[(y * w + x) as usize], v, &mut Refused::default())
            };
            let own = scene.estimate(&settings, [i % w, i / w], 0, &mut scratch, &mut add);
            add([i % w, i / w], own);
        }
        film
    };
    assert_eq!(sums(false), sums(true));
}

/// Opens bytes; if they are accepted, estimates a few pixels with everything.
fn exercise(bytes: &[u8]) -> bool {
    let Ok(scene) = Scene::open(bytes) else {
        return false;
    };
    let [w, h] = scene.size();
    let mut scratch = Scratch::<8>::new();
    for (estimator, heuristic, sequence) in ESTIMATORS {
        for isa in [IsaKind::Scalar, IsaKind::Avx2] {
            let scene = scene.with_isa(isa);
            for i in 0..4u32 {
                let settings = Settings {
                    estimator,
                    heuristic,
                    sequence,
                    max_edges: Some(20),
                    ..Settings::default()
                };
                let pixel = [i * 7919 % w, i * 104_729 % h];
                let fine = |v: etendue::Rgb| {
                    // A single wavelength is beyond sRGB's gamut.
                    let signed = scene.has(needs::SPECTRAL);
                    let good = |x: &f32| x.is_finite() && (signed || *x >= 0.0);
                    v.to_array().iter().all(good)
                };
                let mut ok = true;
                let own = scene.estimate(
                    &settings,
                    pixel,
                    u64::from(i),
                    &mut scratch,
                    &mut |[x, y], v| {
                        ok &= x < w && y < h && fine(v);
                    },
                );
                assert!(ok && fine(own), "{estimator:?} {own:?}");
            }
        }
    }
    true
}

fn below(rng: &mut Pcg, n: usize) -> usize {
    ((rng.one(Purpose::Choice) * n as f32) as usize).min(n - 1)
}

#[test]
fn no_bytes_break_the_kernel() {
    let blobs = scenes();
    let mut accepted = 0;
    let mut rng = Pcg::from_seed(11);
    for round in 0..12_000 {
        let source = blobs[round % blobs.len()].1.bytes();
        let mut bytes = source.to_vec();
        match round % 5 {
            // Single bits, anywhere or in the header and table.
            0 | 1 => {
                let reach = if round % 2 == 0 { bytes.len() } else { 544 };
                for _ in 0..=below(&mut rng, 3) {
                    let at = below(&mut rng, reach);
                    bytes[at] ^= 1 << below(&mut rng, 8);
                }
            }
            // A word of special meaning.
            2 => {
                let words = [
                    0,
                    1,
                    u32::MAX,
                    0x7fc0_0000,
                    0x7f80_0000,
                    0xff7f_ffff,
                    1 << 31,
                    0x3f80_0000,
                ];
                let at = below(&mut rng, bytes.len() / 4) * 4;
                bytes[at..at + 4]
                    .copy_from_slice(&words[below(&mut rng, words.len())].to_le_bytes());
            }
            // Cut.
            3 => bytes.truncate(below(&mut rng, source.len())),
            // A piece of another blob.
            _ => {
                let other = blobs[(round / 5) % blobs.len()].1.bytes();
                let n = 1 + below(&mut rng, 256.min(other.len()).min(bytes.len()) - 1);
                let (from, to) = (
                    below(&mut rng, other.len() - n),
                    below(&mut rng, bytes.len() - n),
                );
                bytes[to..to + n].copy_from_slice(&other[from..from + n]);
            }
        }
        accepted += u32::from(exercise(AlignedBlob::copy_of(&bytes).bytes()));
    }
    // Flipped bits of a coordinate or a colour mostly make another valid scene: the second half is tested too.
    assert!(accepted > 1000, "only {accepted} mutants were accepted");
}

#[test]
fn refusals_have_reasons() {
    use etendue::blob::Problem;
    let (_, good) = scenes().swap_remove(0);
    let refuse = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.bytes().to_vec();
        change(&mut bytes);
        Scene::open(AlignedBlob::copy_of(&bytes).bytes())
            .unwrap_err()
            .rule
            .problem()
    };
    assert_eq!(refuse(&|b| b.truncate(100)), Problem::Truncated);
    assert_eq!(refuse(&Vec::clear), Problem::Truncated);
    assert_eq!(refuse(&|b| b[0] = 0), Problem::Magic);
    assert_eq!(refuse(&|b| b[8] = 1), Problem::Version);
    assert_eq!(refuse(&|b| b[12] = 14), Problem::Section);
    assert_eq!(refuse(&|b| b[27] = 0x80), Problem::Needs);
    assert_eq!(refuse(&|b| b[28] = 120), Problem::Range);
    assert_eq!(refuse(&|b| b[40] = 1), Problem::Reserved);
    assert_eq!(refuse(&|b| b[64] = 2), Problem::Section);
    let padded = AlignedBlob::copy_of(&[&[0; 8], good.bytes()].concat());
    assert_eq!(
        Scene::open(&padded.bytes()[8..])
            .unwrap_err()
            .rule
            .problem(),
        Problem::Misaligned
    );
}

/// Double precision has no integer sums: the parts of its image are added in the same order whoever made them.
#[test]
fn double_precision_has_the_same_bits_on_any_number_of_threads() {
    let settings = Settings {
        estimator: Estimator::Bidirectional,
        ..Settings::default()
    };
    let (_, room) = &scenes()[2];
    let image = |threads| {
        let crew = Crew::Own(threads);
        let image = render_double(room.bytes(), &settings, 40, crew, &AtomicBool::new(false));
        hash(image.unwrap().as_flattened())
    };
    assert_eq!(image(1), image(2));
    assert_eq!(image(1), image(3));
}
