//! The lat-long panorama: every estimator sees a uniform world as uniform, and an environment as the image that it is.

use super::{BATCHES, Z};
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};
use etendue_host::description::{EmitterKind, Filter, Projection};
use etendue_tests::render::{blob, single};
use etendue_tests::scenes::Builder;

/// A panorama of `resolution` at the origin: +z in the middle, +x on the left, +y up, as environments have it.
fn panorama(resolution: [u32; 2], filter: Filter) -> Builder {
    let mut b = Builder::new();
    let s = &mut b.description.sensor;
    (s.projection, s.resolution, s.filter) = (Projection::Panorama, resolution, filter);
    b
}

/// White things under a white sky are as bright as it, in every direction; so is the sky seen by light tracing, at the poles and across
/// the seam, with filters that reach over both.
///
/// 3 · 2 · 48 means of 64 batches, |t| ≤ 5: one false alarm in 700 runs. Poles are noisy where light walks are splatted there.
#[test]
fn a_white_furnace_is_white_in_every_direction() {
    let narrow = Filter::Box { radius: 0.5 };
    let wide = Filter::Gaussian {
        sigma: 1.5,
        radius: 5.0,
    };
    for (resolution, filter) in [([16, 8], narrow), ([16, 8], wide), ([4, 4], wide)] {
        let mut b = panorama(resolution, filter);
        let white = Some(b.diffuse([1.0; 3]));
        b.sphere([0.0, 1.5, 0.0], 1.0, white);
        b.sphere([1.0, -0.3, -2.0], 0.8, white);
        b.light(EmitterKind::Constant { radiance: [1.0; 3] });
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        for estimator in [Estimator::Light, Estimator::Bidirectional] {
            let settings = Settings {
                estimator,
                heuristic: Heuristic::Balance,
                ..Settings::default()
            };
            // As many walks for few pixels as for many.
            let passes = 3840 / (resolution[0] * resolution[1]);
            let all = single::blocks::<32>(&scene, &settings, 4, passes.into(), BATCHES);
            // Towards the poles pixels shrink without end, and with them the light walks that meet one: `light` has no
            // variance there that a test could use.
            let blocks = match estimator {
                Estimator::Light => &all[12..36],
                _ => &all[..],
            };
            for e in blocks {
                let z = (e.mean - 1.0) / e.error;
                assert!(
                    e.error < 0.03 && z.abs() < Z,
                    "{resolution:?} {estimator:?}: {e:?}, z = {z:.1}"
                );
            }
        }
    }
}

/// An environment seen by a panorama in its frame is its image: bilinear between columns at their centres and rows from pole to pole.
#[test]
fn an_environment_is_seen_where_it_says() {
    let (width, height) = (7u32, 5u32);
    let texel = |i: u32| [(i * 29 % 31) as f32 / 31.0, (i % 7) as f32, (i / 7) as f32];
    let mut b = panorama([21, 12], Filter::Box { radius: 1e-3 });
    b.light(EmitterKind::LatLong {
        width,
        height,
        texels: (0..width * height).map(texel).collect(),
        scale: 1.0,
        to_local: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    });
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let mut scratch = Scratch::<8>::new();
    for (i, j) in (0..12).flat_map(|j| (0..21).map(move |i| (i, j))) {
        let u = (f64::from(i) + 0.5) / 21.0 * f64::from(width) - 0.5;
        let v = (f64::from(j) + 0.5) / 12.0 * f64::from(height - 1);
        let (column, row) = (u.floor(), v.floor());
        let at = |c: f64, r: f64| texel(r as u32 * width + c.rem_euclid(f64::from(width)) as u32);
        let mix = |x: f32, y: f32, t: f64| f64::from(x) * (1.0 - t) + f64::from(y) * t;
        let seen = scene.estimate(
            &Settings::default(),
            [i, j],
            0,
            &mut scratch,
            &mut |_, _| (),
        );
        for (c, seen) in seen.to_array().into_iter().enumerate() {
            let along = |r: f64| mix(at(column, r)[c], at(column + 1.0, r)[c], u - column);
            let truth = along(row) * (1.0 - (v - row)) + along(row + 1.0) * (v - row);
            // A thousandth of a pixel, where neighbouring texels differ by at most 6.
            let error = (f64::from(seen) - truth).abs();
            assert!(
                error < 0.02,
                "pixel {i}, {j}, channel {c}: {seen}, expected {truth}"
            );
        }
    }
}
