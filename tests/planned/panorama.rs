//! The lat-long panorama: every estimator sees a uniform world as uniform, and an environment as the image that it is.

use super::{BATCHES, Z};
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};
use etendue_host::description::{EmitterKind, Filter, Medium, Projection};
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

/// From within a ball that glows and absorbs, away from its middle: E/σ (1 − e^(−σs)) over the way s to its surface, in every direction; and from a
/// bubble in it. What is met by light walks goes as 1/d² near the sensor: `light` has a variance only from the bubble.
///
/// 9 · 48 means of 64 batches, P(|t| > 5.9) = 1.5e-7 each.
#[test]
fn a_glowing_ball_around_the_sensor() {
    let estimators = [
        Estimator::Path,
        Estimator::Distributed,
        Estimator::QuadratureAndPath,
        Estimator::Bidirectional,
        Estimator::Light,
    ];
    from_within_a_glow(0.0, &estimators[..4]);
    from_within_a_glow(0.3, &estimators);
}

fn from_within_a_glow(bubble: f32, estimators: &[Estimator]) {
    let (sigma, emission) = ([2.0f32, 1.0, 0.3], [4.0f32, 3.0, 0.6]);
    let origin = [0.3f32, 0.1, -0.4];
    let mut b = panorama([16, 8], Filter::Box { radius: 0.5 });
    let null = b.null();
    let ember = b.matter(Medium {
        sigma_t: sigma,
        albedo: [0.0; 3],
        emission,
        ..Medium::default()
    });
    b.ball([0.0; 3], 1.0, null, ember);
    b.description.sensor.origin = origin;
    // What is nearer isn't seen.
    b.description.sensor.clip = [1e-5, 1e3];
    if bubble > 0.0 {
        b.sphere(origin, bubble, Some(null)).exterior = Some(ember);
    } else {
        b.description.sensor.medium = Some(ember);
    }
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    // The mean over a block of the image, by 64 × 64 midpoints: off by less than 1e-3 of it.
    let truth = |x: u32, y: u32, c: usize| {
        const NODES: u32 = 64;
        let o = glam::DVec3::from(origin.map(f64::from));
        let at =
            |block: u32, i: u32| (f64::from(block) + (f64::from(i) + 0.5) / f64::from(NODES)) / 4.0;
        let mut sum = 0.0;
        for (i, j) in (0..NODES).flat_map(|j| (0..NODES).map(move |i| (i, j))) {
            let phi = std::f64::consts::TAU * (0.5 - at(x, i));
            let (sin, cos) = (std::f64::consts::PI * at(y, j)).sin_cos();
            let d = glam::DVec3::new(sin * phi.sin(), cos, sin * phi.cos());
            let along = o.dot(d);
            let s = -along + (along * along + 1.0 - o.dot(o)).sqrt() - f64::from(bubble);
            let (sigma, emission) = (f64::from(sigma[c]), f64::from(emission[c]));
            sum += emission / sigma * -(-sigma * s).exp_m1();
        }
        sum / f64::from(NODES * NODES)
    };
    for &estimator in estimators {
        let settings = Settings {
            estimator,
            ..Settings::default()
        };
        let passes = if estimator == Estimator::Light {
            240
        } else {
            60
        };
        let all = single::blocks::<32>(&scene, &settings, 4, passes, BATCHES);
        for (i, e) in (0..).zip(&all) {
            let (x, y) = (i / 3 % 4, i / 12);
            // As above: no variance at the poles.
            if estimator == Estimator::Light && !(1..3).contains(&y) {
                continue;
            }
            let truth = truth(x, y, i as usize % 3);
            let off = (e.mean - truth).abs();
            assert!(
                off < Z * e.error + 1e-3 * truth && e.error < 0.03 * truth,
                "{estimator:?}, bubble {bubble}, block {x}, {y}, channel {}: {e:?} for {truth}",
                i % 3
            );
        }
    }
}
