//! Splats: a point of the image goes to each pixel whose filter covers it, once, with the filter's density there.

use super::kernel::Scene;
use super::kernel::real::Real;
use super::kernel::sensor::each_pixel;
use super::zoo::Random;
use etendue_host::description::Filter;
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;
use std::collections::BTreeMap;

/// Image, and the part of it that is rendered: left, top, columns, rows.
const RESOLUTION: [u32; 2] = [40, 30];
const CROP: [u32; 4] = [3, 5, 29, 20];

/// Density in one dimension, up to its integral.
fn shape(filter: Filter, x: f64) -> (f64, f64) {
    match filter {
        Filter::Box { radius } => (1.0, radius.into()),
        Filter::Tent { radius } => (f64::from(radius) - x.abs(), radius.into()),
        Filter::Gaussian { sigma, radius } => {
            let bell = |x: f64| (-0.5 * (x / f64::from(sigma)).powi(2)).exp();
            (bell(x) - bell(radius.into()), radius.into())
        }
    }
}

/// Its integral, by the midpoint rule.
fn integral(filter: Filter) -> f64 {
    const STEPS: u32 = 20_000;
    let (_, radius) = shape(filter, 0.0);
    let h = 2.0 * radius / f64::from(STEPS);
    let at = |i: u32| shape(filter, (f64::from(i) + 0.5) * h - radius).0;
    (0..STEPS).map(at).sum::<f64>() * h
}

#[test]
fn a_point_goes_to_each_pixel_that_sees_it() {
    let filters = [
        Filter::Box { radius: 0.5 },
        Filter::Box { radius: 4.3 },
        Filter::Tent { radius: 1.0 },
        Filter::Tent { radius: 7.9 },
        Filter::Gaussian {
            sigma: 0.5,
            radius: 2.0,
        },
        // Wider than what is done at a time.
        Filter::Gaussian {
            sigma: 3.0,
            radius: 8.0,
        },
    ];
    let mut random = Random::new(7);
    for filter in filters {
        let mut b = Builder::new();
        b.sphere([0.0; 3], 1.0, None).emission = Some([1.0; 3]);
        let sensor = &mut b.description.sensor;
        (sensor.filter, sensor.resolution, sensor.crop) = (filter, RESOLUTION, Some(CROP));
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let whole = integral(filter);
        for _ in 0..200 {
            let [x, y] = random.two();
            let raster = [x * RESOLUTION[0] as Real, y * RESOLUTION[1] as Real];
            let mut found = BTreeMap::new();
            each_pixel(&scene, raster, |pixel, density| {
                assert!(
                    found.insert(pixel, density as f64).is_none(),
                    "{pixel:?} twice"
                );
            });
            for (x, y) in (0..CROP[2]).flat_map(|x| (0..CROP[3]).map(move |y| (x, y))) {
                let away = [0, 1].map(|axis| {
                    let center = f64::from(CROP[axis] + [x, y][axis]) + 0.5;
                    raster[axis] as f64 - center
                });
                let [(fx, radius), (fy, _)] = away.map(|d| shape(filter, d));
                let expected = if away.iter().all(|d| d.abs() < radius) {
                    fx * fy / (whole * whole)
                } else {
                    0.0
                };
                let density = found.remove(&[x, y]).unwrap_or(0.0);
                // On the edge of the filter rounding decides.
                let edge = away.iter().any(|d| (d.abs() - radius).abs() < 1e-5);
                let near = (density - expected).abs() <= 1e-4 * expected + 1e-7;
                assert!(
                    near || edge,
                    "{filter:?} {raster:?} {x} {y}: {density}, expected {expected}"
                );
            }
            assert!(found.is_empty(), "beyond the image: {found:?}");
        }
    }
}
