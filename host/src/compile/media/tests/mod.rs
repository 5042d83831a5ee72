//! Media in the blob.

mod space;

use super::grids::{majorants, texels_of};
use crate::compile::{CompileError, compile};
use crate::description::{
    Description, Emitter, EmitterKind, Geometry, Grid, GridValues, Grids, Lobe, Material, Medium,
    Model, Phase, Place, Shape, Tracking,
};
use etendue::Scene;
use etendue::blob::format::{NONE, emitter, medium, needs};

/// A ball of `medium`, of radius 1.
fn ball(medium: Medium) -> Description {
    Description {
        shapes: vec![Shape {
            name: "ball".into(),
            place: Place::default(),
            geometry: Geometry::Sphere {
                center: [1.0, 2.0, 3.0],
                radius: 1.0,
                flipped: false,
            },
            front: Some(0),
            back: Some(0),
            emission: None,
            spectrum: None,
            opacity: None,
            interior: Some(0),
            exterior: None,
        }],
        materials: vec![Material {
            name: "null".into(),
            model: Model::Null,
        }],
        media: vec![Medium {
            name: "wax".into(),
            ..medium
        }],
        ..Description::default()
    }
}

fn flame() -> Medium {
    Medium {
        sigma_t: [1.0, 2.0, 4.0],
        albedo: [0.5; 3],
        emission: [3.0, 2.0, 1.0],
        ..Medium::default()
    }
}

fn grids(extinction: Grid) -> Grids {
    Grids {
        extinction,
        albedo: None,
        emission: None,
        // The unit cube is [0, 2] × [1, 3] × [2, 4]: the box around the ball.
        to_grid: [
            [0.5, 0.0, 0.0, 0.0],
            [0.0, 0.5, 0.0, -0.5],
            [0.0, 0.0, 0.5, -1.0],
        ],
        tracking: Tracking::Woodcock,
    }
}

fn gray(size: [u32; 3], value: impl Fn(usize) -> f32) -> Grid {
    let count = size.iter().map(|&n| n as usize).product();
    Grid {
        size,
        values: GridValues::Gray((0..count).map(value).collect()),
        nearest: false,
    }
}

#[test]
fn a_medium_stands_in_the_blob_as_it_was_described() {
    let mut m = flame();
    m.phase = vec![
        Lobe {
            phase: Phase::HenyeyGreenstein { g: -0.5 },
            weight: 3.0,
        },
        Lobe {
            phase: Phase::Rayleigh,
            weight: 1.0,
        },
    ];
    let compiled = compile(&ball(m)).unwrap();
    let scene = Scene::open(compiled.blob.bytes()).unwrap();
    let [m] = scene.media() else { panic!() };
    assert_eq!((m.kind, m.flags), (medium::HOMOGENEOUS, 0));
    assert_eq!((m.sigma_t, m.mean), ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0]));
    assert_eq!((m.albedo, m.emission), ([0.5; 3], [3.0, 2.0, 1.0]));
    let lobes = m.phase.map(|l| (l.kind, l.g, l.weight));
    let nothing = (medium::ISOTROPIC, 0.0, 0.0);
    let expected = [
        (medium::HENYEY_GREENSTEIN, -0.5, 0.75),
        (medium::RAYLEIGH, 0.0, 0.25),
        nothing,
        nothing,
    ];
    assert_eq!(lobes, expected);
    let shape = &scene.shapes()[0];
    assert_eq!((shape.interior, shape.exterior), (0, NONE));
    assert!(scene.has(needs::MEDIA) && scene.has(needs::GLOWING) && !scene.has(needs::GRIDS));
}

#[test]
fn what_emits_is_a_light_in_a_box() {
    let mut d = ball(flame());
    let power = |watts: f32| EmitterKind::Point {
        position: [0.0; 3],
        intensity: [watts; 3],
    };
    // As much power as the box of side 2 with a mean emission of 2.
    d.emitters.push(Emitter {
        spectrum: None,
        name: "lamp".into(),
        place: Place::default(),
        kind: power(16.0),
        medium: None,
    });
    let compiled = compile(&d).unwrap();
    let scene = Scene::open(compiled.blob.bytes()).unwrap();
    let [flame, lamp] = scene.emitters() else {
        panic!()
    };
    assert_eq!(
        (flame.kind, flame.medium, flame.shape),
        (emitter::VOLUME, 0, NONE)
    );
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a} isn't {b}");
    for (axis, corner) in [0.0, 1.0, 2.0].into_iter().enumerate() {
        near(flame.position[axis], corner);
        for edge in 0..3 {
            near(
                flame.to_local[edge][axis],
                if edge == axis { 2.0 } else { 0.0 },
            );
        }
    }
    near(flame.density, 0.5 / 8.0);
    near(lamp.density, 0.5);
    assert_eq!(scene.choices().len(), 2);
}

#[test]
fn grids_narrow_the_box_of_what_emits() {
    let mut m = flame();
    m.grids = Some(Grids {
        // [0, 0.5] × [1, 1.5] × [2, 2.5].
        to_grid: [
            [2.0, 0.0, 0.0, 0.0],
            [0.0, 2.0, 0.0, -2.0],
            [0.0, 0.0, 2.0, -4.0],
        ],
        ..grids(gray([3, 3, 3], |_| 1.0))
    });
    let compiled = compile(&ball(m)).unwrap();
    let scene = Scene::open(compiled.blob.bytes()).unwrap();
    let [flame] = scene.emitters() else { panic!() };
    assert_eq!(flame.position, [0.0, 1.0, 2.0]);
    assert_eq!(flame.to_local[1], [0.0, 0.5, 0.0]);
    assert!((flame.density - 8.0).abs() < 1e-4, "{}", flame.density);
    assert!(scene.has(needs::GRIDS));
}

/// What the format says of grids, in double precision.
fn value(grid: &Grid, at: [f64; 3], channel: usize) -> f64 {
    let (values, channels) = grid.values.flat();
    let texel = |i: [f64; 3]| {
        let [x, y, z] =
            std::array::from_fn(|a| i[a].clamp(0.0, f64::from(grid.size[a]) - 1.0) as usize);
        let [w, h, _] = grid.size.map(|n| n as usize);
        f64::from(values[((z * h + y) * w + x) * channels + channel % channels])
    };
    let scaled: [f64; 3] = std::array::from_fn(|a| at[a] * f64::from(grid.size[a]));
    if grid.nearest {
        return texel(scaled.map(f64::floor));
    }
    let low = scaled.map(|x| (x - 0.5).floor());
    (0..8)
        .map(|corner| {
            let step: [f64; 3] = std::array::from_fn(|a| f64::from(corner >> a & 1));
            let weight: f64 = (0..3)
                .map(|a| {
                    let t = scaled[a] - 0.5 - low[a];
                    if step[a] == 1.0 { t } else { 1.0 - t }
                })
                .product();
            weight * texel(std::array::from_fn(|a| low[a] + step[a]))
        })
        .sum()
}

#[test]
fn majorants_are_above_every_value_in_their_box_and_not_far_above() {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    for size in [[1, 1, 1], [2, 5, 3], [9, 4, 17], [300, 2, 1]] {
        for (nearest, rgb) in [(false, false), (true, false), (false, true), (true, true)] {
            let count: usize = size.iter().map(|&n| n as usize).product();
            let mut spiky = || if random() < 0.9 { 0.0 } else { random() as f32 };
            let values = if rgb {
                GridValues::Rgb((0..count).map(|_| [spiky(), spiky(), spiky()]).collect())
            } else {
                GridValues::Gray((0..count).map(|_| spiky()).collect())
            };
            let grid = Grid {
                size,
                values,
                nearest,
            };
            let sigma_t = [2.0, 3.0, 0.5];
            let m = majorants(&grid, sigma_t);
            for _ in 0..2000 {
                let at = [random(), random(), random()];
                let cell: [usize; 3] =
                    std::array::from_fn(|a| (at[a] * f64::from(m.cells[a])) as usize);
                let [w, h, _] = m.cells.map(|n| n as usize);
                let bound = f64::from(m.values[(cell[2] * h + cell[1]) * w + cell[0]]);
                for (c, s) in sigma_t.into_iter().enumerate() {
                    let here = f64::from(s) * value(&grid, at, c);
                    assert!(here <= bound, "{here} above {bound} at {at:?} of {size:?}");
                }
            }
            let most = m.values.iter().fold(0.0f32, |a, b| a.max(*b));
            assert!(most <= 3.0 * 1.001);
            // A box speaks for its own texels and a few beyond.
            let wide = texels_of(&grid, 0, 1.min(m.cells[0] - 1), m.cells[0]);
            assert!(wide.count() <= size[0].div_ceil(m.cells[0]) as usize + 3);
        }
    }
}

fn refusal(m: Medium) -> String {
    let error: CompileError = compile(&ball(m)).unwrap_err();
    assert_eq!(error.name, "wax");
    error.reason
}

#[test]
fn numbers_out_of_range_are_refused() {
    let cases: [(Medium, &str); 9] = [
        (
            Medium {
                sigma_t: [-1.0, 0.0, 0.0],
                ..flame()
            },
            "sigma_t must be 0 or in [1e-12, 1e12], found -1",
        ),
        (
            Medium {
                sigma_t: [f32::NAN; 3],
                ..flame()
            },
            "sigma_t must be",
        ),
        (
            Medium {
                albedo: [0.5, 1.5, 0.5],
                ..flame()
            },
            "albedo must be in [0, 1e0], found 1.5",
        ),
        (
            Medium {
                emission: [f32::INFINITY; 3],
                ..flame()
            },
            "emission must be",
        ),
        (
            Medium {
                sigma_t: [0.0; 3],
                ..flame()
            },
            "emits where it doesn't absorb",
        ),
        (
            Medium {
                albedo: [1.0; 3],
                ..flame()
            },
            "emits where it doesn't absorb",
        ),
        (
            Medium {
                phase: vec![],
                ..flame()
            },
            "1 to 4 parts",
        ),
        (
            Medium {
                phase: vec![Phase::HenyeyGreenstein { g: 1.0 }.into()],
                ..flame()
            },
            "g must be in (-1, 1), found 1",
        ),
        (
            Medium {
                phase: vec![Lobe {
                    phase: Phase::Rayleigh,
                    weight: -1.0,
                }],
                ..flame()
            },
            "weights",
        ),
    ];
    for (m, expected) in cases {
        let found = refusal(m);
        assert!(found.contains(expected), "{found}, expected {expected}");
    }
    let with = |g: Grids| Medium {
        grids: Some(g),
        ..flame()
    };
    let short = Grid {
        values: GridValues::Gray(vec![1.0; 7]),
        ..gray([2, 2, 2], |_| 1.0)
    };
    let cases = [
        (grids(short.clone()), "must have 8 numbers, found 7"),
        (grids(gray([2, 0, 2], |_| 1.0)), "1 to 4096 texels"),
        (
            grids(gray([2, 2, 2], |i| i as f32 - 3.5)),
            "extinction must be in [0, 1000000000000], found -3.5",
        ),
        (
            Grids {
                albedo: Some(gray([1, 1, 1], |_| 1.5)),
                ..grids(gray([1, 1, 1], |_| 1.0))
            },
            "albedo must be in [0, 1], found 1.5",
        ),
        (
            Grids {
                tracking: Tracking::Residual,
                ..grids(Grid {
                    values: GridValues::Rgb(vec![[1.0; 3]]),
                    ..gray([1, 1, 1], |_| 0.0)
                })
            },
            "one channel",
        ),
    ];
    for (g, expected) in cases {
        let found = refusal(with(g));
        assert!(found.contains(expected), "{found}, expected {expected}");
    }
    // A grey grid times what isn't grey.
    let found = refusal(Medium {
        sigma_t: [1.0, 2.0, 1.0],
        grids: Some(Grids {
            tracking: Tracking::Residual,
            ..grids(gray([1, 1, 1], |_| 1.0))
        }),
        ..flame()
    });
    assert!(found.contains("the same in all of sigma_t"), "{found}");
}

#[test]
fn what_fills_all_space_does_not_emit() {
    let mut d = ball(flame());
    d.exterior = Some(0);
    let error = compile(&d).unwrap_err();
    assert!(error.reason.contains("outside all objects"), "{error}");
}

#[test]
fn emission_without_absorption_is_found_texel_by_texel() {
    let dense = gray([2, 1, 2], |i| if i == 2 { 0.0 } else { 1.0 });
    let with = |emission: Option<Grid>, albedo: Option<Grid>, factor: f32| Medium {
        albedo: [factor; 3],
        grids: Some(Grids {
            emission,
            albedo,
            ..grids(dense.clone())
        }),
        ..flame()
    };
    let flames = gray([2, 1, 2], |i| if i == 1 { 3.0 } else { 0.0 });
    compile(&ball(with(Some(flames.clone()), None, 0.5))).unwrap();
    let white = gray([2, 1, 2], |i| if i == 1 { 0.5 } else { 1.0 });
    compile(&ball(with(Some(flames.clone()), Some(white.clone()), 1.0))).unwrap();
    compile(&ball(with(
        Some(flames.clone()),
        Some(gray([1, 1, 1], |_| 0.5)),
        1.0,
    )))
    .unwrap();
    let cases = [
        (with(None, None, 0.5), "at texel (0, 0, 1)"),
        (
            with(Some(gray([2, 1, 2], |_| 1.0)), None, 0.5),
            "at texel (0, 0, 1)",
        ),
        (
            with(Some(gray([1, 1, 1], |_| 1.0)), None, 0.5),
            "the size and filter",
        ),
        (
            with(Some(flames.clone()), Some(gray([2, 1, 2], |_| 1.0)), 1.0),
            "at texel (1, 0, 0)",
        ),
        (
            with(Some(flames), Some(gray([1, 1, 1], |_| 1.0)), 1.0),
            "an albedo that reaches 1",
        ),
    ];
    for (m, expected) in cases {
        let found = refusal(m);
        assert!(found.contains(expected), "{found}, expected {expected}");
    }
}
