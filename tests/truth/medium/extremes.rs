//! Numbers at the ends of their ranges: nothing but finite ones comes back.

use super::kernel::Scene;
use super::kernel::medium::Flight;
use super::kernel::real::ONE_MINUS;
use super::kernel::spectrum::{Rgb, Spectrum};
use super::ways::{FRESH, Fixed, channels, holding, ray, way};
use etendue::blob::format::{Medium, medium};
use etendue_tests::media::{Matter, homogeneous};

/// Every kind of medium with every extinction.
fn zoo() -> Matter {
    let mut zoo = Matter::default();
    let values = zoo.grid([3, 2, 2], false, |[x, y, z]| {
        [[0.0, 1.0, 0.25][((x + y + z) % 3) as usize]]
    });
    let colors = zoo.grid([2, 2, 2], true, |[x, y, _]| [x as f32, 0.5, y as f32]);
    for sigma in [
        [0.0, 1.0, 1000.0],
        [1e-6, 1e-12, 0.0],
        [1e4, 1e12, 1.0],
        [0.0, 0.0, 0.0],
        [1e3, 1e3, 1e3],
    ] {
        let emission = sigma.map(|s: f32| if s > 0.0 { 1e20 } else { 0.0 });
        let flags = [0, medium::RESIDUAL, medium::REGULAR];
        zoo.media.push(Medium {
            emission,
            ..homogeneous(sigma, [0.5; 3])
        });
        for grid in [values, colors] {
            for flags in flags {
                let index = zoo.gridded(grid, sigma, [0.5; 3], [2, 2, 1]);
                let one = grid == values && sigma.iter().all(|s| *s == sigma[0]);
                let known = if one { !0 } else { !medium::RESIDUAL };
                zoo.media[index].flags = flags & known;
                zoo.media[index].emission = emission;
                for word in zoo.words.iter_mut().rev().take(4).filter(|w| **w > 0.0) {
                    *word = word.max(1e-12);
                }
            }
        }
    }
    zoo
}

fn finite(what: Rgb, context: &str) {
    for x in channels(what) {
        assert!(x >= 0.0 && x.is_finite(), "{context}: {what:?}");
    }
}

#[test]
fn nothing_but_finite_numbers() {
    let zoo = zoo();
    let blob = holding(&zoo);
    let scene = Scene::open(blob.bytes()).unwrap();
    for index in 0..zoo.media.len() {
        for (origin, direction) in [
            ([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]),
            ([0.2, 0.3, 0.4], [1.0, 2.0, 3.0]),
            ([1.0, 1.0, 1.0], [-1.0, -1.0, -1.0]),
            ([0.5, 0.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.5, 5.0, 5.0], [0.0, 0.0, 1.0]),
            ([1e12, 0.5, 0.5], [-1.0, 0.0, 0.0]),
        ] {
            for length in [0.0, 1e-30, 1e-3, 1.0, 1e12, f64::INFINITY] {
                let way = way(&scene, index, ray(origin, direction, length));
                for xi in [0.0, 1e-7, 0.5, ONE_MINUS] {
                    let medium = way.medium;
                    let context = format!(
                        "{:?} of {:?}: {:?}, ξ {xi}",
                        medium.kind, medium.sigma_t, way.ray
                    );
                    for leading in 0..3 {
                        let (mut carried, mut glow) = (FRESH, Rgb::BLACK);
                        let flight =
                            way.fly(leading, &mut carried, &mut glow, &mut 2000, &mut Fixed(xi));
                        finite(carried.throughput, &context);
                        finite(carried.ratio, &context);
                        finite(glow, &context);
                        if let Flight::Collided(c) = flight {
                            assert!(c.t >= 0.0 && c.t <= way.ray.t_max, "{context}: {c:?}");
                            finite(c.scattering, &context);
                            finite(c.emission, &context);
                            finite(carried.throughput * c.scattering, &context);
                            finite(carried.throughput * c.emission, &context);
                        }
                        let expected = way.expected(leading);
                        assert!((0.0..=1.0).contains(&expected), "{context}: {expected}");
                    }
                    let tau: Rgb = way.transmittance(&mut 2000, &mut Fixed(xi));
                    finite(tau, &context);
                }
            }
        }
    }
}

/// Without steps left nothing is claimed.
#[test]
fn steps_run_out() {
    let mut matter = Matter::default();
    let grid = matter.grid([1, 1, 1], false, |_| [1.0]);
    matter.gridded(grid, [100.0; 3], [1.0; 3], [1, 1, 1]);
    let blob = holding(&matter);
    let scene = Scene::open(blob.bytes()).unwrap();
    let way = way(&scene, 0, ray([0.0, 0.5, 0.5], [1.0, 0.0, 0.0], 1.0));
    let (mut carried, mut glow, mut steps) = (FRESH, Rgb::BLACK, 0);
    let flight = way.fly(0, &mut carried, &mut glow, &mut steps, &mut Fixed(0.5));
    assert!(matches!(flight, Flight::Cut));
    let tau: Rgb = way.transmittance(&mut steps, &mut Fixed(0.5));
    assert!(tau.is_black());
}
