//! Media, their boundaries, and lights and sensors in them.

use super::Complete::{FromLight, FromSensor};
use super::Named;
use crate::scenes::{Builder, room};
use etendue_host::description::{
    ColorSource, Description, Distribution, EmitterKind, Facets, Geometry, Grid, GridValues, Lobe,
    Masking, Medium, Model, Phase, Projection, Tracking,
};

const HG: Phase = Phase::HenyeyGreenstein { g: 0.6 };

/// A grid that varies by place, and with `rgb` by channel.
fn clouds(rgb: bool) -> Grid {
    let n = 7u32;
    let value = |x: u32, y: u32, z: u32| {
        let wave = |i: u32, k: f32| (1.0 + (i as f32 * k).sin()) * 0.5;
        let v = wave(x, 1.3) * wave(y, 0.9) * wave(z, 1.7);
        // Some of it is empty.
        if v < 0.1 { 0.0 } else { v }
    };
    let mut gray = Vec::new();
    for z in 0..n {
        for y in 0..n {
            for x in 0..n {
                gray.push(value(x, y, z));
            }
        }
    }
    let values = if rgb {
        let tinted = |(i, &v): (usize, &f32)| [v, v * (i % 5) as f32 * 0.25, 0.2 * v];
        GridValues::Rgb(gray.iter().enumerate().map(tinted).collect())
    } else {
        GridValues::Gray(gray)
    };
    Grid {
        size: [n; 3],
        values,
        nearest: false,
    }
}

/// The room, filled with fog up to the opening through which the camera looks in.
fn fog_room(phase: Phase, furnish: impl FnOnce(&mut Builder, usize)) -> Description {
    room(|b| {
        let fog = b.medium([0.5, 0.4, 0.3], [0.9, 0.8, 0.7], phase);
        // Beyond the walls: no two boundaries coincide.
        b.fog([-1.1, -1.2, -0.1], [1.1, 1.1, 2.1], fog);
        furnish(b, fog);
    })
    .description
}

fn boxes(b: &mut Builder, _: usize) {
    let white = Some(b.diffuse([0.8; 3]));
    b.cuboid([-0.6, 0.0, 0.0], [-0.1, 0.5, 0.9], false, white);
    b.sphere([0.45, -0.1, 0.3], 0.3, white);
}

/// What fills the room.
pub fn fogs() -> Vec<Named> {
    let mut all: Vec<Named> = vec![
        ("fog", fog_room(Phase::Isotropic, boxes), FromLight),
        ("fog that scatters forwards", fog_room(HG, boxes), FromLight),
    ];
    let mut inside = fog_room(HG, boxes);
    inside.shapes.iter_mut().for_each(|s| {
        if s.interior.is_some()
            && let etendue_host::description::Geometry::Mesh(m) = &mut s.geometry
        {
            m.positions.iter_mut().for_each(|p| p[1] *= 4.0);
        }
    });
    inside.sensor.medium = Some(0);
    all.push(("the camera in the fog", inside, FromLight));
    let d = room(|b| {
        boxes(b, 0);
        let phase = vec![
            Lobe {
                phase: Phase::Rayleigh,
                weight: 1.0,
            },
            Lobe {
                phase: HG,
                weight: 2.0,
            },
            Lobe {
                phase: Phase::HenyeyGreenstein { g: -0.4 },
                weight: 1.0,
            },
            Lobe {
                phase: Phase::Forward,
                weight: 1.0,
            },
        ];
        let fog = b.matter(Medium {
            sigma_t: [2.0, 0.02, 0.0],
            albedo: [0.6, 0.9, 0.5],
            phase,
            ..Medium::default()
        });
        b.fog([-0.9, -0.9, 0.05], [0.9, 0.9, 1.6], fog);
    });
    all.push((
        // What goes straight on is a Dirac, through which no light walk sees the sensor.
        "a blend of phase functions, very chromatic",
        d.description,
        FromSensor,
    ));
    all
}

/// What is in a volume of grids, by every way of tracking.
pub fn grids() -> Vec<Named> {
    let with = |rgb: bool, tracking: Tracking| {
        room(|b| {
            boxes(b, 0);
            let smoke = Medium {
                sigma_t: [6.0, 5.0, 4.0].map(|s| if rgb { s } else { 6.0 }),
                albedo: [0.9, 0.7, 0.5],
                phase: vec![Phase::HenyeyGreenstein { g: 0.3 }.into()],
                ..Medium::default()
            };
            let (low, high) = ([-0.9, -0.8, 0.6], [0.8, 0.9, 1.7]);
            let smoke = b.smoke(low, high, clouds(rgb), smoke);
            b.description.media[smoke].grids.as_mut().unwrap().tracking = tracking;
            b.fog(low, high, smoke);
        })
        .description
    };
    vec![
        (
            "smoke, Woodcock",
            with(false, Tracking::Woodcock),
            FromLight,
        ),
        (
            "smoke, residual",
            with(false, Tracking::Residual),
            FromLight,
        ),
        ("smoke, regular", with(false, Tracking::Regular), FromLight),
        (
            "coloured smoke, Woodcock",
            with(true, Tracking::Woodcock),
            FromLight,
        ),
        (
            "coloured smoke, regular",
            with(true, Tracking::Regular),
            FromLight,
        ),
    ]
}

/// Boundaries: glass, ground glass, nested, masked, two-sided.
pub fn boundaries() -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    // Large lamps: a path tracer has to find them through glass.
    let lamp = |b: &mut Builder| {
        let white = Some(b.diffuse([0.8; 3]));
        b.quad([-0.9, -0.9, 1.9], [0.0, 1.8, 0.0], [1.8, 0.0, 0.0], white)
            .emission = Some([1.0; 3]);
    };
    let d = room(|b| {
        lamp(b);
        let glass = b.glass(1.33);
        let wax = b.medium(
            [4.0, 5.0, 6.0],
            [0.95, 0.9, 0.7],
            Phase::HenyeyGreenstein { g: 0.3 },
        );
        b.ball([0.3, 0.0, 0.5], 0.4, glass, wax);
    });
    all.push(("wax", d.description, FromSensor));
    let d = room(|b| {
        let ground = b.material(Model::RoughDielectric {
            ior: 1.4,
            reflectance: ColorSource::Constant([1.0; 3]),
            transmittance: ColorSource::Constant([1.0; 3]),
            facets: Facets {
                alpha: [0.4; 2],
                distribution: Distribution::Ggx,
                masking: Masking::Correlated,
                compensated: false,
            },
        });
        let dull = b.material(Model::Phong {
            diffuse_reflectance: ColorSource::Constant([0.1; 3]),
            reflectance: ColorSource::Constant([0.9; 3]),
            transmittance: ColorSource::Constant([0.8; 3]),
            diffuse_transmittance: ColorSource::Constant([0.1; 3]),
            exponent: 20.0,
            modified: false,
            ior: 1.3,
            fresnel: true,
        });
        let jade = b.medium([2.0, 1.0, 3.0], [0.8, 0.95, 0.7], HG);
        let wax = b.medium([1.0, 2.0, 4.0], [0.9; 3], Phase::Rayleigh);
        b.ball([0.4, -0.1, 0.45], 0.4, ground, jade);
        b.ball([-0.45, 0.1, 0.45], 0.4, dull, wax);
    });
    all.push(("jade in ground glass, Phong wax", d.description, FromLight));
    let d = room(|b| {
        lamp(b);
        let part = |phase, weight| Lobe { phase, weight };
        let phases = [
            vec![Phase::Isotropic.into()],
            vec![
                part(Phase::Rayleigh, 1.0),
                part(HG, 1.0),
                part(Phase::HenyeyGreenstein { g: -0.3 }, 1.0),
                part(Phase::Forward, 0.5),
            ],
        ];
        for (x, phase) in [0.42, -0.45].into_iter().zip(phases) {
            let ground = b.material(Model::RoughDielectric {
                ior: 1.3,
                reflectance: ColorSource::Constant([1.0; 3]),
                transmittance: ColorSource::Constant([1.0; 3]),
                facets: Facets {
                    alpha: [0.5; 2],
                    distribution: Distribution::Beckmann,
                    masking: Masking::Separable,
                    compensated: false,
                },
            });
            let wax = b.matter(Medium {
                sigma_t: [0.5, 2.0, 5.0],
                albedo: [0.95, 0.9, 0.8],
                phase,
                ..Medium::default()
            });
            b.ball([x, 0.0, 0.5], 0.4, ground, wax);
        }
    });
    // What goes straight on is a Dirac, but light that it takes to the camera's side of a ball is scattered by the ball's surface.
    all.push((
        "every phase function in ground glass",
        d.description,
        FromLight,
    ));
    let mut d = fog_room(Phase::Isotropic, |b, fog| {
        lamp(b);
        let null = b.null();
        let glass = b.glass(1.4);
        let juice = b.medium([1.0, 3.0, 5.0], [0.5; 3], HG);
        // Glass in fog, filled with juice in which hangs a bubble of fog.
        b.ball([-0.3, 0.1, 0.6], 0.45, glass, juice).exterior = Some(fog);
        b.ball([-0.3, 0.1, 0.6], 0.2, null, fog).exterior = Some(juice);
    });
    all.push(("a bubble in juice in glass in fog", d.clone(), FromSensor));
    d = fog_room(HG, |b, fog| {
        let white = Some(b.diffuse([0.8; 3]));
        let half = ColorSource::Constant([0.5; 3]);
        b.quad([-0.8, -0.3, 1.2], [1.6, 0.0, 0.0], [0.0, 0.6, 0.0], white)
            .opacity = Some(half);
        let thin = b.material(Model::Diffuse {
            reflectance: ColorSource::Constant([0.3; 3]),
            transmittance: ColorSource::Constant([0.6; 3]),
        });
        // A lampshade around denser fog.
        let dense = b.medium([2.0; 3], [0.9; 3], Phase::Isotropic);
        b.ball([0.3, 0.0, 0.5], 0.35, thin, dense).exterior = Some(fog);
    });
    all.push(("masks and a translucent ball in fog", d, FromLight));
    all
}

/// Lights around and within fog.
pub fn lights() -> Vec<Named> {
    let alone = |furnish: &dyn Fn(&mut Builder)| {
        let mut b = Builder::new().camera(
            [0.0, -3.4, 1.0],
            [0.0, 0.0, 0.7],
            [0.0, 0.0, 1.0],
            40.0,
            [16, 16],
        );
        let grey = Some(b.diffuse([0.5; 3]));
        b.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], grey);
        b.sphere([0.4, 0.0, 0.35], 0.3, grey);
        furnish(&mut b);
        b.description
    };
    let fog = |b: &mut Builder| {
        let fog = b.medium([0.6, 0.5, 0.3], [0.9; 3], HG);
        b.fog([-1.5, -1.5, -0.2], [1.5, 1.5, 1.6], fog);
    };
    let named = |name, light: &dyn Fn(&mut Builder)| {
        let d = alone(&|b| {
            fog(b);
            light(b);
        });
        (name, d, FromLight)
    };
    vec![
        named("a point in fog", &|b| {
            b.light(EmitterKind::Point {
                position: [-0.5, 0.2, 1.1],
                intensity: [2.0, 3.0, 4.0],
            });
            let fog = Some(0);
            b.description.emitters[0].medium = fog;
        }),
        named("a point in a bubble in fog", &|b| {
            // Which keeps away from the light what would scatter as 1/d².
            let (null, fog) = (b.null(), Some(0));
            b.sphere([-0.4, 0.0, 0.9], 0.3, Some(null)).exterior = fog;
            b.light(EmitterKind::Point {
                position: [-0.5, 0.05, 0.95],
                intensity: [2.0, 3.0, 4.0],
            });
        }),
        named("a spot into fog", &|b| {
            b.light(EmitterKind::Spot {
                position: [-1.0, 0.2, 2.2],
                direction: [0.6, 0.0, -0.8],
                intensity: [9.0; 3],
                cutoff: 0.5,
                beam_width: 0.3,
            });
        }),
        named("the sun over fog", &|b| {
            b.light(EmitterKind::Directional {
                direction: [0.48, 0.36, -0.8],
                irradiance: [3.0, 2.5, 2.0],
            });
        }),
        named("a sky over fog", &|b| {
            b.light(EmitterKind::Constant {
                radiance: [0.4, 0.5, 0.6],
            });
        }),
        named("a small lamp in fog", &|b| {
            // Beside the image: seen directly it would be all of the noise.
            let black = Some(b.diffuse([0.1; 3]));
            b.sphere([-1.42, 0.2, 0.5], 0.02, black).emission = Some([700.0, 600.0, 500.0]);
        }),
        named("a lamp half in fog", &|b| {
            let black = Some(b.diffuse([0.1; 3]));
            b.sphere([-0.4, 0.3, 1.6], 0.3, black).emission = Some([4.0; 3]);
        }),
    ]
}

/// A ball of a medium in a boundary of either kind, exact and as a mesh.
pub fn spheres_and_meshes() -> Vec<[Description; 2]> {
    let with = |glass: bool, mesh: bool| {
        let b = room(|b| {
            let boundary = if glass { b.glass(1.3) } else { b.null() };
            let wax = b.medium([1.0, 2.0, 3.0], [0.9, 0.8, 0.5], HG);
            let (center, radius) = ([0.1, 0.0, 0.7], 0.5);
            let shape = if mesh {
                let mesh = Geometry::Mesh(super::scenes::ball(center, radius, 72));
                b.shape(mesh, Some(boundary))
            } else {
                b.sphere(center, radius, Some(boundary))
            };
            shape.interior = Some(wax);
            let white = Some(b.diffuse([0.8; 3]));
            b.quad([-0.9, -0.9, 1.9], [0.0, 1.8, 0.0], [1.8, 0.0, 0.0], white)
                .emission = Some([1.0; 3]);
        });
        b.description
    };
    [false, true]
        .map(|glass| [with(glass, false), with(glass, true)])
        .into()
}

/// Media that emit.
pub fn flames() -> Vec<Named> {
    let glow = |medium: Medium| {
        room(move |b| {
            boxes(b, 0);
            b.description.shapes[5].emission = Some([0.5; 3]);
            let null = b.null();
            let flame = b.matter(medium);
            b.ball([-0.2, -0.3, 1.1], 0.4, null, flame);
        })
        .description
    };
    let flame = Medium {
        sigma_t: [2.0, 1.0, 0.5],
        albedo: [0.3, 0.5, 0.2],
        emission: [9.0, 5.0, 2.0],
        phase: vec![HG.into()],
        ..Medium::default()
    };
    let burning = |tracking| {
        room(|b| {
            boxes(b, 0);
            b.description.shapes[5].emission = Some([0.5; 3]);
            let (low, high) = ([-0.8, -0.7, 0.5], [0.7, 0.8, 1.6]);
            let smoke = Medium {
                sigma_t: [5.0; 3],
                ..flame.clone()
            };
            let smoke = b.smoke(low, high, clouds(false), smoke);
            let grids = b.description.media[smoke].grids.as_mut().unwrap();
            grids.tracking = tracking;
            grids.emission = Some(clouds(true));
            b.fog(low, high, smoke);
        })
        .description
    };
    vec![
        ("a ball that glows", glow(flame.clone()), FromLight),
        (
            "smoke that burns, Woodcock",
            burning(Tracking::Woodcock),
            FromLight,
        ),
        (
            "smoke that burns, regular",
            burning(Tracking::Regular),
            FromLight,
        ),
    ]
}

/// Sensors that look into fog.
pub fn sensors() -> Vec<Named> {
    let mut lens = fog_room(HG, boxes);
    if let Projection::Perspective {
        aperture, focus, ..
    } = &mut lens.sensor.projection
    {
        (*aperture, *focus) = (0.15, 3.0);
    }
    lens.sensor.crop = Some([2, 3, 12, 12]);
    let mut parallel = fog_room(HG, boxes);
    parallel.sensor.projection = Projection::Orthographic {
        half_extent: [0.9; 2],
    };
    let mut round = fog_room(HG, boxes);
    let s = &mut round.sensor;
    (s.projection, s.medium) = (Projection::Panorama, Some(0));
    (s.origin, s.resolution) = ([0.1, -0.5, 1.1], [16, 8]);
    vec![
        ("a lens, cropped, before fog", lens, FromLight),
        ("parallel rays into fog", parallel, FromLight),
        ("a panorama in fog", round, FromLight),
    ]
}
