//! Chains give what samples give, whatever the seed, the threads and the batches. Some of all scenes, unless tests are to be deep: chains change nothing
//! in what surfaces, lights and media are.

use super::{BLOCKS, Estimate, Named, estimates, media, panes, scenes, spectra};
use etendue::estimate::{Chain, Mutations};
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::Description;
use etendue_host::render::{Budget, Device, Options, Rendered, render};
use etendue_tests::render::blob;
use etendue_tests::{deep, samples, some};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// Renders that are independent of each other, pilots included: what spreads them is all the chance that there is.
const RUNS: u64 = 24;
/// Samples per pixel of each, and what chains make of them; four times as many if tests are to be deep.
const PASSES: u64 = 16;

fn rendered(bytes: &AlignedBlob, seed: u64, passes: u64, threads: usize, large: f32) -> Rendered {
    let scene = Scene::open(bytes.bytes()).unwrap();
    let mutations = Mutations {
        large,
        ..Mutations::default()
    };
    let options = Options {
        settings: Settings {
            estimator: Estimator::Metropolis,
            mutations,
            seed,
            ..Settings::default()
        },
        budget: Budget::Passes(passes),
        threads,
        device: Device::Cpu,
    };
    render(&scene, &options, &AtomicBool::new(false), &|_| ()).unwrap()
}

/// The means of blocks, as [`super::of_blob`] gives them, from independent renders.
fn blocks(d: &Description) -> Vec<Estimate> {
    let bytes = blob(d);
    let passes = if deep() { 4 * PASSES } else { PASSES };
    let runs: Vec<Vec<f64>> = (0..RUNS)
        .into_par_iter()
        .map(|seed| {
            let r = rendered(&bytes, seed, passes, 1, Mutations::default().large);
            assert_eq!(r.counters.rejected, 0);
            let [w, h] = r.size;
            let mut sums = vec![0.0; (BLOCKS * BLOCKS * 3) as usize];
            for (value, i) in r.image.iter().zip(0..) {
                let (x, y) = (i % w, i / w);
                let block = ((y * BLOCKS / h) * BLOCKS + x * BLOCKS / w) as usize * 3;
                for c in 0..3 {
                    sums[block + c] += f64::from(value[c]);
                }
            }
            let per_block = f64::from(w * h) / f64::from(BLOCKS * BLOCKS);
            sums.iter().map(|s| s / per_block).collect()
        })
        .collect();
    (0..runs[0].len())
        .map(|i| Estimate::of(&runs.iter().map(|r| r[i]).collect::<Vec<_>>()))
        .collect()
}

/// About 2500 comparisons with 23 degrees of freedom at least: P(|t| > 7.5) = 1.3e-7, so that right code fails about once in 3000 choices of seeds.
fn agree(scenes: Vec<Named>) {
    const T: f64 = 7.5;
    for (name, d, _) in &scenes {
        println!("{name}");
        let passes = samples(24);
        let truth = estimates(d, Estimator::Bidirectional, Heuristic::Power, None, passes);
        let chains = blocks(d);
        let mut spread = 0.0;
        for (i, (x, y)) in chains.iter().zip(&truth).enumerate() {
            let z = x.z(y);
            assert!(
                z.abs() < T,
                "{name}: block {i}: chains {x:?} against {y:?}: z = {z:.1}"
            );
            spread += x.error / truth.iter().map(|e| e.mean).sum::<f64>();
        }
        assert!(spread < 0.1, "{name}: too noisy to tell: {spread}");
    }
}

#[test]
fn on_surfaces() {
    agree(some(scenes::objects(), 2));
    agree(some(scenes::glossy(), 3));
}

#[test]
fn by_all_lights_and_sensors() {
    agree(some(scenes::lights(), 3));
    agree(some(scenes::sensors(), 2));
}

#[test]
fn in_media() {
    agree(some(media::fogs(), 3));
    agree(some(media::boundaries(), 3));
    agree(some(media::flames(), 3));
}

#[test]
fn through_glass_behind_glass() {
    // Not the sky: where it is seen all samples are the same, and rounding would be compared.
    let mut scenes = panes::panes();
    scenes.retain(|(name, ..)| !name.contains("sky"));
    agree(scenes);
}

#[test]
fn by_wavelengths() {
    agree(vec![spectra::dispersing()]);
}

/// A chain goes on from what its start was drawn for: steps that change next to nothing are accepted. Where the ways that walks are joined are
/// drawn as well (masks, grids) what they contribute differs from step to step, and scattering of large g multiplies what rounding does.
#[test]
fn starts_are_where_they_were_drawn() {
    let mut scenes = scenes::objects();
    scenes.extend(scenes::glossy());
    scenes.extend(media::boundaries());
    // And always where chains start from walks aside.
    for (name, d, _) in some(scenes, 2).into_iter().chain(panes::panes()) {
        let bytes = blob(&d);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let mean = brightness(&scene);
        for above in [0.0, 0.5 * mean] {
            let settings = Settings {
                mutations: Mutations {
                    large: 0.0,
                    view: 0.0,
                    size: 1e-6,
                    above,
                },
                ..Settings::default()
            };
            let mut scratch = Scratch::<32>::new();
            let view = &mut scratch.view(&scene);
            let (mut chain, mut starts, mut accepted) = (Chain::<16>::new(), 0, 0.0);
            for sample in 0..4000 {
                if scene.bootstrap(&settings, sample, view, &mut |_, _| ()) > 0.0 {
                    chain.start(&scene, &settings, sample, sample, view);
                    chain.advance(&scene, &settings, 1.0, 1, view, &mut |_, _| ());
                    (starts, accepted) = (starts + 1, accepted + f64::from(chain.accepted()));
                }
            }
            let share = accepted / f64::from(starts);
            println!("{name} above {above}: {share} of {starts}");
            assert!(starts > 100 && share > 0.98, "{name}: {share} of {starts}");
        }
    }
}

/// Where only the place in the image moves, the light walk is that of the step before. Steps taken one by one know of none before them: they trace
/// it anew, and come to the same places. Not where masks ask for more numbers than are kept: these are drawn anew, after those of the light walk.
#[test]
fn a_light_walk_that_is_kept_is_the_one_that_its_numbers_make() {
    let mut scenes = scenes::objects();
    scenes.extend(scenes::glossy());
    scenes.retain(|(name, ..)| !name.contains("mask"));
    for (name, d, _) in scenes {
        let bytes = blob(&d);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let settings = Settings::default();
        let mut scratch = Scratch::<32>::new();
        let view = &mut scratch.view(&scene);
        let starts = (0..).filter(|&sample| {
            let mut scratch = Scratch::<32>::new();
            scene.bootstrap(&settings, sample, &mut scratch.view(&scene), &mut |_, _| ()) > 0.0
        });
        for sample in starts.take(50) {
            let [whole, parts] = [1, 200].map(|parts| {
                let mut image: BTreeMap<[u32; 2], f64> = BTreeMap::new();
                let mut chain = Chain::<16>::new();
                chain.start(&scene, &settings, sample, sample, view);
                for _ in 0..parts {
                    chain.advance(&scene, &settings, 1.0, 200 / parts, view, &mut |at, v| {
                        *image.entry(at).or_default() += f64::from(v.r + v.g + v.b);
                    });
                }
                image
            });
            // The same splats, but for how they are rounded.
            assert!(whole.keys().eq(parts.keys()), "{name}, {sample}");
            for (a, b) in whole.values().zip(parts.values()) {
                assert!(
                    (a - b).abs() <= 1e-3 * a.abs().max(1e-3),
                    "{name}, {sample}: {a}, {b}"
                );
            }
        }
    }
}

/// The image's mean, by a thousand samples.
fn brightness(scene: &Scene<'_>) -> f32 {
    let (settings, mut scratch) = (Settings::default(), Scratch::<32>::new());
    let view = &mut scratch.view(scene);
    let samples = (0..1000).map(|i| scene.bootstrap(&settings, i, view, &mut |_, _| ()));
    samples.sum::<f32>() / 1000.0
}

/// What is left to samples and what isn't are the whole, whatever the bound: sample by sample where roulette is off, else in the mean, as connections that
/// carry little and nothing for chains are then left to chance. False alarms: 1 in 15,000 for each scene (4 standard errors).
#[test]
fn samples_and_chains_share_each_contribution() {
    const SAMPLES: u64 = 1000;
    let mut scenes = scenes::objects();
    scenes.extend(scenes::glossy());
    scenes.extend(media::fogs());
    for (name, d, _) in some(scenes, 2) {
        let bytes = blob(&d);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let mean = brightness(&scene);
        let mut scratch = Scratch::<32>::new();
        let view = &mut scratch.view(&scene);
        for roulette in [0.0, Settings::default().roulette] {
            let [mut sums, mut amiss] = [[0.0; 2]; 2];
            for sample in 0..SAMPLES {
                let [whole, parts] = [0.0, 0.5 * mean].map(|above| {
                    let mutations = Mutations {
                        above,
                        ..Mutations::default()
                    };
                    let settings = Settings {
                        mutations,
                        roulette,
                        ..Settings::default()
                    };
                    let mut below = 0.0;
                    let add = &mut |_, v: etendue::Rgb| below += (v.r + v.g + v.b) / 3.0;
                    let beyond = scene.bootstrap(&settings, sample, view, add);
                    sums[usize::from(above > 0.0)] += beyond;
                    below + beyond
                });
                let error = parts - whole;
                let exact = error.abs() <= 1e-4 * whole;
                assert!(exact || roulette > 0.0, "{name}: {parts} for {whole}");
                amiss = [amiss[0] + error, amiss[1] + error * error];
            }
            // Both have a part.
            let [all, beyond] = sums;
            assert!(
                0.0 < beyond && beyond < 0.99 * all,
                "{name}: {beyond} of {all}"
            );
            // Rounding has its share.
            let [sum, squares] = amiss;
            let allowed = 4.0 * squares.sqrt() + 1e-5 * all;
            assert!(sum.abs() < allowed, "{name}: {sum} of {all}, {allowed}");
        }
    }
}

fn bits(r: &Rendered) -> Vec<u32> {
    r.image.as_flattened().iter().map(|x| x.to_bits()).collect()
}

/// Threads and batches are nothing to the bits; a seed is.
#[test]
fn any_threads_give_the_same_bits() {
    let bytes = blob(&scenes::plain());
    let one = rendered(&bytes, 3, 21, 1, 0.3);
    let three = rendered(&bytes, 3, 21, 3, 0.3);
    let other = rendered(&bytes, 4, 21, 3, 0.3);
    assert_eq!(bits(&one), bits(&three));
    assert_ne!(bits(&one), bits(&other));
    assert_eq!(one.passes, 21);
}

/// Where no path carries light the image is black, and nothing hangs.
#[test]
fn the_dark_is_dark() {
    let mut d = scenes::plain();
    // A lamp that shines away from everything.
    d.emitters.clear();
    d.shapes.iter_mut().for_each(|s| s.emission = None);
    let mut builder = etendue_tests::scenes::Builder::new();
    builder.light(etendue_host::description::EmitterKind::Spot {
        position: [0.0, 0.0, 1000.0],
        direction: [0.0, 0.0, 1.0],
        intensity: [1.0; 3],
        cutoff: 0.1,
        beam_width: 0.05,
    });
    d.emitters = builder.description.emitters;
    let r = rendered(&blob(&d), 0, 4, 2, 0.3);
    assert!(r.image.as_flattened().iter().all(|&x| x == 0.0));
}

/// The image's brightness is that of the samples, but for less than a chain (the energy of 1024/9 samples) for each 64 pixels, whatever the share of
/// large steps.
#[test]
fn brightness_is_that_of_the_samples() {
    const PASSES: u64 = 256;
    let bytes = blob(&scenes::plain());
    for large in [0.0, 0.3, 1.0] {
        let r = rendered(&bytes, 1, PASSES, 2, large);
        let mean = r
            .image
            .as_flattened()
            .iter()
            .map(|&x| f64::from(x))
            .sum::<f64>()
            / (3 * r.image.len()) as f64;
        let report = r.chains.unwrap();
        assert!(
            (mean / report.mean - 1.0).abs() < 1024.0 / 6.0 / (64.0 * PASSES as f64),
            "{mean} {report:?}"
        );
    }
}
