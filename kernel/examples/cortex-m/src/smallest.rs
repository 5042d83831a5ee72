//! The least that renders: opens a blob that somebody put at a known address and writes one sample of every pixel to
//! another. It exists to be measured.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m as _;
use cortex_m_rt::entry;
use etendue::{Estimator, Scene, Scratch, Settings};

#[entry]
fn main() -> ! {
    let blob: &[u8] = black_box(&[]);
    let estimators = [
        Estimator::Path,
        #[cfg(feature = "light")]
        Estimator::Light,
        #[cfg(feature = "bidirectional")]
        Estimator::Bidirectional,
        #[cfg(feature = "distributed")]
        Estimator::Distributed,
        #[cfg(feature = "quadrature")]
        Estimator::QuadratureAndPath,
    ];
    if let Ok(scene) = Scene::open(blob) {
        let mut scratch = Scratch::<8>::new();
        let [w, h] = scene.size();
        for estimator in estimators {
            let settings = Settings {
                estimator: black_box(estimator),
                ..Settings::default()
            };
            for pixel in 0..w * h {
                let pixel = [pixel % w, pixel / w];
                let mut splat = |pixel, value| {
                    black_box((pixel, value));
                };
                black_box(scene.estimate(&settings, pixel, 0, &mut scratch, &mut splat));
            }
        }
        #[cfg(feature = "metropolis")]
        chains(&scene, &mut scratch);
    }
    loop {}
}

/// One chain, from the first sample of its bootstrap.
#[cfg(feature = "metropolis")]
fn chains(scene: &Scene<'_>, scratch: &mut Scratch<8>) {
    use etendue::estimate::Chain;
    let settings = Settings {
        estimator: Estimator::Metropolis,
        ..Settings::default()
    };
    let scratch = &mut scratch.view(scene);
    let scale = scene.bootstrap(&settings, 0, scratch, &mut |_, _| ());
    let mut chain = Chain::<16>::new();
    chain.start(scene, &settings, 0, 0, scratch);
    let mut splat = |pixel, value| {
        black_box((pixel, value));
    };
    chain.advance(scene, &settings, scale, 64, scratch, &mut splat);
}

/// The division by the image's width is the only panic, and the gate has seen to it.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
