//! Light maps: the irradiance under a lamp, averaged over texels, by every estimator and on any number of threads.

use etendue::{Estimator, Scene, Settings};
use etendue_host::description::{Description, Geometry, Mesh};
use etendue_host::render::{Bake, Baked, bake};
use etendue_tests::render::{Estimate, blob};
use etendue_tests::scenes::Builder;

/// A floor of 2 × 2 under a lamp of 1 × 1 at height 1, its texture coordinates mirrored in u.
fn scene() -> (Description, Mesh) {
    let mut b = Builder::new();
    b.quad([-0.5, -0.5, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], None)
        .emission = Some([1.0, 2.0, 3.0]);
    let floor = b.quad([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], None);
    let Geometry::Mesh(mesh) = &mut floor.geometry else {
        unreachable!()
    };
    mesh.uvs = Some(vec![[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    let mesh = mesh.clone();
    (b.description, mesh)
}

/// Irradiance at (x, y) under the lamp: four corners' configuration factors (Howell B-4), times π.
fn closed_form(x: f64, y: f64) -> f64 {
    // Of a rectangle from over the point to (a, b), with signs.
    let corner = |a: f64, b: f64| {
        let (p, q) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        0.5 * (a / p * (b / p).atan() + b / q * (a / q).atan())
    };
    let (l, r, n, f) = (-0.5 - x, 0.5 - x, -0.5 - y, 0.5 - y);
    corner(r, f) - corner(l, f) - corner(r, n) + corner(l, n)
}

fn options(estimator: Estimator, samples: u64, threads: usize) -> Bake {
    Bake {
        settings: Settings {
            estimator,
            seed: 3,
            ..Settings::default()
        },
        size: [8, 4],
        samples,
        dilate: 0,
        threads,
    }
}

/// Independent maps: they give the spread.
fn maps(scene: &Scene<'_>, mesh: &Mesh, estimator: Estimator) -> Vec<Baked> {
    let map = |seed| {
        let mut how = options(estimator, 1000, 0);
        how.settings.seed = seed;
        bake(scene, mesh, &how, &|_| ()).unwrap()
    };
    (0..24).map(map).collect()
}

/// A channel of a texel.
fn texel(maps: &[Baked], at: usize, channel: usize) -> Estimate {
    let value = |map: &Baked| f64::from(map.texels[at][channel]);
    Estimate::of(&maps.iter().map(value).collect::<Vec<f64>>())
}

/// 480 means of 24 maps: with 23 degrees of freedom P(|t| > 7.5) = 1.3e-7, one false alarm in 16,000 runs.
#[test]
fn a_texel_is_the_mean_irradiance_of_its_patch() {
    let (d, mesh) = scene();
    let bytes = blob(&d);
    let scene = Scene::open(bytes.bytes()).unwrap();
    for estimator in [
        Estimator::Path,
        Estimator::Light,
        Estimator::Bidirectional,
        Estimator::Distributed,
        Estimator::Quadrature,
    ] {
        let maps = maps(&scene, &mesh, estimator);
        for (x, y) in (0..4).flat_map(|y| (0..8).map(move |x| (x, y))) {
            let at = y * 8 + x;
            // Texel (x, y) covers u from x/8 and v from y/4: mirrored in x. Its mean by 16 × 16 points: error below 1e-4.
            let mut truth = 0.0;
            for (i, j) in (0..16).flat_map(|j| (0..16).map(move |i| (i, j))) {
                let u = (x as f64 + (f64::from(i) + 0.5) / 16.0) / 8.0;
                let v = (y as f64 + (f64::from(j) + 0.5) / 16.0) / 4.0;
                truth += closed_form(1.0 - 2.0 * u, 2.0 * v - 1.0) / 256.0;
            }
            for (c, radiance) in [1.0, 2.0, 3.0].into_iter().enumerate() {
                let e = texel(&maps, at, c);
                let truth = truth * radiance;
                assert!(
                    (e.mean - truth).abs() < 7.5 * e.error + 3e-4 * truth && e.error < 0.06 * truth,
                    "{estimator:?}, texel {x}, {y}, channel {c}: {e:?} for {truth}"
                );
            }
        }
    }
}

#[test]
fn the_bits_are_the_same_on_any_number_of_threads() {
    let (d, mesh) = scene();
    let bytes = blob(&d);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let map = |threads| {
        let how = options(Estimator::Bidirectional, 5, threads);
        bake(&scene, &mesh, &how, &|_| ()).unwrap().texels
    };
    assert_eq!(map(1), map(3));
}

/// Half of the map has no triangle: it stays 0, but for what is spread into it.
#[test]
fn what_nothing_covers_stays_black_unless_dilated() {
    let (d, mut mesh) = scene();
    let bytes = blob(&d);
    let scene = Scene::open(bytes.bytes()).unwrap();
    for uv in mesh.uvs.iter_mut().flatten() {
        uv[0] *= 0.5;
    }
    let mut how = options(Estimator::Path, 4, 0);
    let map = bake(&scene, &mesh, &how, &|_| ()).unwrap();
    assert_eq!(map.covered, 16);
    let black = |map: &[[f32; 3]], x: usize| (0..4).all(|y| map[y * 8 + x] == [0.0; 3]);
    assert!((0..8).all(|x| black(&map.texels, x) == (x >= 4)));
    how.dilate = 2;
    let map = bake(&scene, &mesh, &how, &|_| ()).unwrap();
    assert!((0..8).all(|x| black(&map.texels, x) == (x >= 6)));
}

/// Lights that no walk meets: a point at height 2 over the place, a spot that looks down on it, a sun.
#[test]
fn points_spots_and_suns_shine_on_irradiance_sensors() {
    use etendue::Scratch;
    use etendue::real::Vec3;
    use etendue_host::description::EmitterKind;
    let lights = [
        (
            EmitterKind::Point {
                position: [0.0, 1.5, 2.0],
                intensity: [5.0; 3],
            },
            // I·cos/d² with d² = 1.5² + 2², cos = 2/2.5.
            5.0 * 0.8 / 6.25,
        ),
        (
            EmitterKind::Spot {
                position: [0.0, 0.0, 2.0],
                direction: [0.0, 0.0, -1.0],
                intensity: [3.0; 3],
                cutoff: 0.5,
                beam_width: 0.4,
            },
            0.75,
        ),
        (
            EmitterKind::Directional {
                direction: [0.6, 0.0, -0.8],
                irradiance: [2.0; 3],
            },
            1.6,
        ),
    ];
    for (kind, truth) in lights {
        let mut b = Builder::new();
        b.sphere([0.0, 0.0, -5.0], 1.0, None);
        b.light(kind.clone());
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        for estimator in [
            Estimator::Path,
            Estimator::Light,
            Estimator::Bidirectional,
            Estimator::Distributed,
            Estimator::Quadrature,
            Estimator::QuadratureAndPath,
        ] {
            let settings = Settings {
                estimator,
                ..Settings::default()
            };
            let mut scratch = Scratch::<8>::new();
            let e = scene
                .irradiance(&settings, Vec3::ZERO, Vec3::Z, 0, 0, &mut scratch)
                .g;
            assert!(
                (e / truth - 1.0).abs() < 1e-4,
                "{kind:?} {estimator:?}: {e}, expected {truth}"
            );
            let behind = scene
                .irradiance(&settings, Vec3::ZERO, -Vec3::Z, 0, 0, &mut scratch)
                .g;
            assert_eq!(behind, 0.0, "{kind:?} {estimator:?}");
        }
    }
}

/// The same lamp and floor in ink: each point of the lamp by its own way, cos²/d² e^(−σd). Of each texel 4 × 4 points, of the lamp 32 × 32: off by less than
/// 3e-4. 480 comparisons as above, with the same odds.
#[test]
fn a_light_map_in_what_absorbs() {
    const SIGMA: [f32; 3] = [0.2, 0.7, 1.5];
    let (d, mesh) = scene();
    let mut b = Builder { description: d };
    let ink = b.medium(SIGMA, [0.0; 3], etendue_host::description::Phase::Isotropic);
    b.fog([-3.0, -3.0, -0.5], [3.0, 3.0, 1.5], ink);
    let bytes = blob(&b.description);
    let scene = Scene::open(bytes.bytes()).unwrap();
    let middle = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
    let closed_form = |x: f64, y: f64, sigma: f64| {
        const LAMP: u32 = 32;
        let mut sum = 0.0;
        for (i, j) in (0..LAMP).flat_map(|j| (0..LAMP).map(move |i| (i, j))) {
            let [dx, dy] = [middle(i, LAMP) - 0.5 - x, middle(j, LAMP) - 0.5 - y];
            let square = 1.0 + dx * dx + dy * dy;
            sum += (-sigma * square.sqrt()).exp() / (square * square);
        }
        sum / f64::from(LAMP * LAMP)
    };
    for estimator in [
        Estimator::Path,
        Estimator::Light,
        Estimator::Bidirectional,
        Estimator::Distributed,
        Estimator::Quadrature,
    ] {
        let maps = maps(&scene, &mesh, estimator);
        for (x, y) in (0..4u32).flat_map(|y| (0..8u32).map(move |x| (x, y))) {
            for (c, sigma) in SIGMA.into_iter().enumerate() {
                let mut truth = 0.0;
                for (i, j) in (0..4).flat_map(|j| (0..4).map(move |i| (i, j))) {
                    let u = (f64::from(x) + middle(i, 4)) / 8.0;
                    let v = (f64::from(y) + middle(j, 4)) / 4.0;
                    truth += closed_form(1.0 - 2.0 * u, 2.0 * v - 1.0, sigma.into()) / 16.0;
                }
                let truth = truth * (c + 1) as f64;
                let e = texel(&maps, (y * 8 + x) as usize, c);
                assert!(
                    (e.mean - truth).abs() < 7.5 * e.error + 1e-3 * truth && e.error < 0.06 * truth,
                    "{estimator:?}, texel {x}, {y}, channel {c}: {e:?} for {truth}"
                );
            }
        }
    }
}
