//! Russian roulette changes what an image costs and how noisy it is, not what it is: none, and always, against the default.
//!
//! By the whole image's brightness, as roulette knows no places: 3 scenes, 3 estimators, 2 values and 3 channels, 54 comparisons with numbers of their own, of which one fails
//! by chance in 1 of 600,000 runs (P(|t| > 5.9) = 3e-8, as elsewhere here).

use super::{BATCHES, NOISE, assert_agree_up_to};
use etendue::{Estimator, Scene, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::Description;
use etendue_tests::matrix::{media, scenes};
use etendue_tests::render::{Estimate, blob, single};
use etendue_tests::{noise, samples};
use rayon::prelude::*;

fn estimates(
    bytes: &AlignedBlob,
    estimator: Estimator,
    roulette: f32,
    passes: u64,
) -> Vec<Estimate> {
    let scene = Scene::open(bytes.bytes()).unwrap();
    let settings = Settings {
        estimator,
        roulette,
        // Of the same numbers, images would differ by less than independent ones.
        seed: u64::from(roulette.to_bits()),
        ..Settings::default()
    };
    single::blocks::<32>(&scene, &settings, 1, passes, BATCHES)
}

fn unbiased(name: &str, d: &Description) {
    println!("{name}");
    let bytes = blob(d);
    let default = Settings::default().roulette;
    let estimators = [
        (Estimator::Path, 20),
        (Estimator::Light, 12),
        (Estimator::Bidirectional, 6),
    ];
    estimators.into_par_iter().for_each(|(estimator, passes)| {
        let of = |roulette| estimates(&bytes, estimator, roulette, samples(passes));
        let expected = of(default);
        for roulette in [0.0, 1.0] {
            let what = format!("{name}: {estimator:?}, roulette {roulette}");
            assert_agree_up_to(noise(NOISE), &what, &of(roulette), &expected);
        }
    });
}

#[test]
fn roulette_leaves_means_as_they_are() {
    unbiased("white things", &scenes::plain());
    let glossy = scenes::glossy();
    unbiased(glossy[0].0, &glossy[0].1);
    let fogs = media::fogs();
    unbiased(fogs[0].0, &fogs[0].1);
}
