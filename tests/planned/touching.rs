//! Media that share faces with each other and with walls: a ray goes through every boundary, in whatever order the objects were said.

use etendue::spectrum::Spectrum;
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::compile::compile;
use etendue_host::description::{EmitterKind, Phase};
use etendue_tests::scenes::{Builder, V};

/// Corners of a box, its extinction, and which of the boxes it stands in.
type Fog = (V, V, f32, Option<usize>);

/// Radiance of a floor of reflectance 1 at z = −3 under a lamp of intensity 1 at a height of 8 above it, seen from under the boxes.
fn lit(fogs: &[Fog], order: &[usize]) -> f64 {
    let mut b = Builder::new().camera(
        [2.0, 2.0, -2.5],
        [0.13, 0.07, -3.0],
        [0.0, 0.0, 1.0],
        0.001,
        [1, 1],
    );
    let white = b.diffuse([1.0; 3]);
    b.quad(
        [-5.0, -5.0, -3.0],
        [10.0, 0.0, 0.0],
        [0.0, 10.0, 0.0],
        Some(white),
    );
    b.light(EmitterKind::Point {
        position: [0.13, 0.07, 5.0],
        intensity: [1.0; 3],
    });
    for &(_, _, sigma_t, _) in fogs {
        b.medium([sigma_t; 3], [0.0; 3], Phase::Isotropic);
    }
    for &i in order {
        let (low, high, _, around) = fogs[i];
        b.fog(low, high, i).exterior = around;
    }
    let compiled = compile(&b.description).unwrap_or_else(|e| panic!("{e}"));
    assert!(compiled.warnings.is_empty(), "{:?}", compiled.warnings);
    let scene = Scene::open(compiled.blob.bytes()).unwrap();
    let settings = Settings {
        estimator: Estimator::Path,
        max_edges: Some(2),
        ..Settings::default()
    };
    let mut scratch = Scratch::<8>::new();
    let rgb = scene.estimate(&settings, [0, 0], 0, &mut scratch, &mut |_, _| ());
    f64::from(rgb.to_array()[0])
}

/// All orders of `n` things.
fn orders(n: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![vec![]];
    }
    let insert = |order: Vec<usize>| {
        (0..n).map(move |at| {
            let mut order = order.clone();
            order.insert(at, n - 1);
            order
        })
    };
    orders(n - 1).into_iter().flat_map(insert).collect()
}

#[test]
fn light_goes_through_all_that_touches() {
    let cases: &[(&str, &[Fog], f64)] = &[
        (
            "layers",
            &[
                ([-1.0, -1.0, 0.0], [1.0, 1.0, 0.5], 1.0, None),
                ([-1.0, -1.0, 0.5], [1.0, 1.0, 1.0], 2.0, None),
                ([-1.0, -1.0, 1.0], [1.0, 1.0, 1.5], 0.5, None),
            ],
            0.5 + 1.0 + 0.25,
        ),
        // No corner of one lies in the other.
        (
            "a cross",
            &[
                ([-3.0, -0.5, 0.0], [3.0, 0.5, 1.0], 1.0, None),
                ([-0.5, -3.0, 1.0], [0.5, 3.0, 1.5], 2.0, None),
            ],
            2.0,
        ),
        (
            "a small one on a large one",
            &[
                ([-3.0, -3.0, 0.0], [3.0, 3.0, 1.0], 1.0, None),
                ([-0.3, -0.3, 1.0], [0.3, 0.3, 1.5], 2.0, None),
            ],
            2.0,
        ),
        (
            "all on one plane, one in another",
            &[
                ([-3.0, -3.0, 0.0], [3.0, 3.0, 2.0], 1.0, None),
                ([-2.0, -2.0, 0.0], [2.0, 2.0, 1.0], 2.0, Some(0)),
                ([-1.0, -1.0, 0.0], [1.0, 1.0, 0.5], 4.0, Some(1)),
            ],
            1.0 + 1.0 + 2.0,
        ),
        (
            "side by side on a third",
            &[
                ([-3.0, -3.0, 0.0], [3.0, 3.0, 1.0], 1.0, None),
                ([-3.0, -3.0, 1.0], [-0.1, 3.0, 2.0], 8.0, None),
                ([-0.1, -3.0, 1.0], [3.0, 3.0, 2.0], 0.5, None),
            ],
            1.5,
        ),
    ];
    for (name, fogs, depth) in cases {
        let expected = (-depth).exp() / (64.0 * std::f64::consts::PI);
        for order in orders(fogs.len()) {
            let found = lit(fogs, &order) / expected - 1.0;
            // Boundaries are set apart by 9e-6, or twice that, where the optical depth of a unit is 4 at most; and single precision.
            assert!(found.abs() < 1e-4, "{name}, {order:?}: off by {found:e}");
        }
    }
}

/// Fog up to the walls of a closed room under a bright sky: no ray gets past both at once.
#[test]
fn a_room_filled_to_its_walls_is_tight() {
    let mut b = Builder::new().camera(
        [0.1, 0.2, 0.3],
        [1.0, 0.9, -0.8],
        [0.0, 0.0, 1.0],
        90.0,
        [24, 24],
    );
    let gray = b.diffuse([0.5; 3]);
    let fog = b.medium([0.5; 3], [0.9; 3], Phase::Isotropic);
    b.cuboid([-1.0; 3], [1.0; 3], true, Some(gray));
    b.fog([-1.0; 3], [1.0; 3], fog);
    b.light(EmitterKind::Constant {
        radiance: [100.0; 3],
    });
    let compiled = compile(&b.description).unwrap_or_else(|e| panic!("{e}"));
    let scene = Scene::open(compiled.blob.bytes()).unwrap();
    for estimator in [Estimator::Path, Estimator::Light, Estimator::Bidirectional] {
        let settings = Settings {
            estimator,
            ..Settings::default()
        };
        let mut scratch = Scratch::<8>::new();
        let mut lit = 0;
        for i in 0..24 * 24 {
            for index in 0..16 {
                let mut see = |rgb: etendue::Rgb| lit += u32::from(rgb != etendue::Rgb::BLACK);
                let mut splats = Vec::new();
                let own = scene.estimate(
                    &settings,
                    [i % 24, i / 24],
                    index,
                    &mut scratch,
                    &mut |_, rgb| splats.push(rgb),
                );
                splats.into_iter().chain([own]).for_each(&mut see);
            }
        }
        assert_eq!(lit, 0, "{estimator:?}: samples that see the sky");
        assert!(scratch.counters.closest_rays > 0);
    }
}
