//! What a scene proves useless isn't tried, and images are the same without: bit by bit where a walk's numbers don't depend on how many another has drawn.

use etendue::random::Sequence;
use etendue::{Counters, Estimator, Scene, Scratch, Settings};
use etendue_host::description::{EmitterKind, Phase, Projection};
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;

/// The image's bits, splats included, and what the kernel counted, of 8 samples per pixel.
fn render(b: &Builder, estimator: Estimator, max_edges: Option<u32>) -> (Vec<u64>, Counters) {
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let settings = Settings {
        estimator,
        max_edges,
        sequence: Sequence::Sobol,
        ..Settings::default()
    };
    let [width, height] = scene.size();
    let mut scratch = Scratch::<8>::new();
    let mut bits = Vec::new();
    for i in 0..width * height {
        for index in 0..8 {
            let mut splats = Vec::new();
            let own = scene.estimate(
                &settings,
                [i % width, i / width],
                index,
                &mut scratch,
                &mut |[x, y], rgb| splats.push(([x, y], rgb)),
            );
            splats.push(([0, 0], own));
            for ([x, y], rgb) in splats {
                bits.extend(rgb.to_array().map(|v| u64::from(v.to_bits())));
                bits.push(u64::from(x) << 32 | u64::from(y));
            }
        }
    }
    (bits, scratch.counters)
}

/// Nothing but glass and mirrors: no vertex can be joined to another, so that a light walk ends where it begins. A diffuse material that nothing wears takes the proof away,
/// and changes nothing but the work.
#[test]
fn light_walks_need_vertices_that_can_be_joined() {
    let mut b = Builder::new().camera([0.0, -3.0, 1.0], [0.0; 3], [0.0, 0.0, 1.0], 50.0, [12, 12]);
    let (mirror, glass) = (Some(b.mirror(0.9)), Some(b.glass(1.5)));
    b.quad([-2.0, -2.0, -0.5], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], mirror);
    b.sphere([0.4, 0.0, 0.0], 0.4, glass);
    b.sphere([-0.5, 0.2, 0.0], 0.3, mirror).emission = Some([3.0, 2.0, 1.0]);
    b.light(EmitterKind::Constant { radiance: [0.2; 3] });
    let mut unproved = b.clone();
    unproved.diffuse([0.5; 3]);
    for estimator in [Estimator::Light, Estimator::Bidirectional] {
        let (bits, proved) = render(&b, estimator, None);
        let (same, tried) = render(&unproved, estimator, None);
        assert!(bits == same, "{estimator:?}: images differ");
        println!("{estimator:?}: {proved:?}, without proof {tried:?}");
        assert_eq!(proved.light_walks, tried.light_walks);
        assert!(proved.closest_rays < tried.closest_rays, "{estimator:?}");
        if estimator == Estimator::Light {
            assert_eq!(proved.closest_rays, 0);
        }
    }
}

/// A point lamp over a floor: no walk runs into it, so that with paths of two edges a walk from the sensor has one ray.
#[test]
fn last_rays_need_light_to_meet() {
    let lit = |meets: bool| {
        let mut b =
            Builder::new().camera([0.0, -2.0, 1.0], [0.0; 3], [0.0, 0.0, 1.0], 20.0, [12, 12]);
        let white = Some(b.diffuse([0.8; 3]));
        b.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], white);
        b.light(EmitterKind::Point {
            position: [0.3, 0.2, 1.0],
            intensity: [1.0; 3],
        });
        if meets {
            b.light(EmitterKind::Constant { radiance: [0.1; 3] });
        }
        b
    };
    let samples = 12 * 12 * 8;
    for estimator in [Estimator::Path, Estimator::Bidirectional] {
        let (_, proved) = render(&lit(false), estimator, Some(2));
        let (_, tried) = render(&lit(true), estimator, Some(2));
        // A light walk of two edges has one ray that meets something, and is joined to the sensor there.
        let light = if estimator == Estimator::Path {
            0
        } else {
            samples
        };
        assert_eq!(proved.closest_rays, samples + light, "{estimator:?}");
        assert!(tried.closest_rays > samples + light, "{estimator:?}");
        // Longer paths have all rays but the last.
        let (_, longer) = render(&lit(false), estimator, Some(3));
        assert!(longer.closest_rays > proved.closest_rays, "{estimator:?}");
    }
}

/// A background seen by parallel rays, through nothing and through what absorbs: of all strategies s = 0 alone makes such paths, whose weight is 1 exactly.
#[test]
fn parallel_rays_meet_a_background_by_one_strategy() {
    let mut b = Builder::new().camera([0.0, -3.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], 50.0, [12, 12]);
    b.description.sensor.projection = Projection::Orthographic {
        half_extent: [1.0, 1.0],
    };
    let absorber = b.medium([2.0; 3], [0.0; 3], Phase::Isotropic);
    b.fog([-0.5; 3], [0.5; 3], absorber);
    b.light(EmitterKind::Constant { radiance: [2.0; 3] });
    let (bits, _) = render(&b, Estimator::Bidirectional, None);
    let values: Vec<f32> = bits
        .chunks(4)
        .map(|rgb| f32::from_bits(rgb[0] as u32))
        .collect();
    let seen = values.iter().filter(|v| **v != 0.0);
    assert!(seen.clone().count() > 500);
    for v in seen {
        assert!((v / 2.0 - 1.0).abs() < 1e-5, "{v} in place of 2");
    }
}
