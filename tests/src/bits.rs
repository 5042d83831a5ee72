//! Scenes for the same bits everywhere: between them every surface, texture, light, sensor and filter that exists, small
//! enough for a microcontroller. Their blobs are checked in (`tests/data/bits`), so that no target depends on the compiler.

use crate::scenes::{Builder, room};
use etendue_host::description::{
    Color, ColorSource, Description, Distribution, EmitterKind, Facets, Filter, Grid, GridValues,
    Image, Index, Lobe, Masking, Medium, Model, Pattern, Phase, Projection, Texels, Texture,
    Tracking, Wrap,
};

/// Columns and rows of the images.
pub const SIZE: [u32; 2] = [16, 12];

fn constant(c: f32) -> ColorSource {
    ColorSource::Constant([c; 3])
}

fn texture(b: &mut Builder, pattern: Pattern) -> ColorSource {
    let textures = &mut b.description.textures;
    textures.push(Texture {
        name: format!("texture {}", textures.len()),
        pattern,
        to_uv: [[2.0, 0.5, 0.1], [-0.5, 2.0, 0.3]],
    });
    ColorSource::Texture(textures.len() - 1)
}

/// A gradient with some structure, of 5 × 3 texels.
fn image(texels: fn(Vec<[u8; 4]>) -> Texels) -> Image {
    let texel = |i: u8| [20 + 15 * i, 250 - 16 * i, 37 * (i % 7), 255 - 13 * i];
    Image {
        width: 5,
        height: 3,
        texels: texels((0..15).map(texel).collect()),
    }
}

fn bitmap(image: Image, nearest: bool, wrap: Wrap, alpha: bool) -> Pattern {
    Pattern::Bitmap {
        image,
        nearest,
        wrap,
        alpha,
    }
}

fn float(texels: Vec<[u8; 4]>) -> Texels {
    Texels::Float(
        texels
            .into_iter()
            .map(|[r, g, b, _]| [r, g, b].map(|c| f32::from(c) / 255.0))
            .collect(),
    )
}

fn sky(count: usize) -> Vec<Color> {
    (0..count)
        .map(|i| {
            let x = (i * 29 % 31) as f32 / 31.0;
            [0.2 + x, 0.5, if i % 5 == 0 { 3.0 } else { 0.1 }]
        })
        .collect()
}

/// A room with one of every local model, a pinhole camera, area, point and spot lights.
fn matter() -> Description {
    room(|b| {
        let board = texture(
            b,
            Pattern::Checkerboard {
                colors: [[0.8, 0.7, 0.2], [0.1, 0.2, 0.4]],
            },
        );
        let srgb = texture(b, bitmap(image(Texels::Srgb8), false, Wrap::Repeat, false));
        let linear = texture(b, bitmap(image(Texels::Linear8), true, Wrap::Mirror, false));
        let floats = texture(b, bitmap(image(float), false, Wrap::Clamp, false));
        let mask = texture(b, bitmap(image(Texels::Linear8), false, Wrap::Repeat, true));
        let floor = b.material(Model::Diffuse {
            reflectance: board,
            transmittance: constant(0.0),
        });
        b.quad(
            [-1.0, -1.0, 0.01],
            [2.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            Some(floor),
        );
        let leaf = b.material(Model::Diffuse {
            reflectance: srgb,
            transmittance: linear,
        });
        b.quad(
            [-0.9, -0.4, 0.9],
            [0.8, 0.0, 0.1],
            [0.0, 0.5, 0.3],
            Some(leaf),
        )
        .opacity = Some(mask);
        let glass = Some(b.glass(1.5));
        b.sphere([0.5, 0.0, 0.35], 0.3, glass);
        let water = b.material(Model::Dielectric {
            ior: 1.33,
            reflectance: constant(1.0),
            transmittance: ColorSource::Constant([0.8, 0.9, 1.0]),
            schlick: true,
        });
        b.cuboid([-0.9, -0.2, 0.05], [-0.5, 0.2, 0.5], false, Some(water));
        let mirror = Some(b.mirror(0.9));
        b.quad([-0.3, 0.9, 0.2], [0.6, 0.05, 0.0], [0.0, 0.0, 0.9], mirror);
        let gold = b.material(Model::Conductor {
            spectra: None,
            eta: [0.14, 0.37, 1.44],
            k: [3.98, 2.39, 1.6],
            reflectance: constant(1.0),
        });
        b.sphere([0.0, 0.3, 0.25], 0.2, Some(gold));
        let sheet = b.material(Model::Sheet {
            specular_reflectance: constant(0.1),
            specular_transmittance: floats,
            diffuse_reflectance: constant(0.2),
            diffuse_transmittance: constant(0.3),
        });
        b.quad(
            [0.1, -0.5, 1.0],
            [0.7, 0.2, 0.0],
            [0.0, 0.3, 0.5],
            Some(sheet),
        );
        let null = Some(b.material(Model::Null));
        b.cuboid([-0.5, -0.9, 0.02], [0.2, -0.4, 0.6], false, null);
        let white = Some(b.diffuse([0.8; 3]));
        b.sphere([-0.2, -0.5, 1.5], 0.12, white).emission = Some([4.0, 2.0, 1.0]);
        b.light(EmitterKind::Point {
            position: [0.7, -0.7, 1.7],
            intensity: [0.3, 0.4, 0.6],
        });
        b.light(EmitterKind::Spot {
            position: [-0.7, -0.7, 1.8],
            direction: [0.6, 0.48, -0.64],
            intensity: [2.0, 1.0, 1.0],
            cutoff: 0.6,
            beam_width: 0.4,
        });
        b.light(EmitterKind::Constant { radiance: [0.1; 3] });
        b.description.sensor.resolution = SIZE;
    })
    .description
}

/// A room with one of every glossy model.
fn gloss() -> Description {
    let facets = |alpha: f32, distribution, masking, compensated| Facets {
        alpha: [alpha; 2],
        distribution,
        masking,
        compensated,
    };
    let scene = room(|b| {
        let board = texture(
            b,
            Pattern::Checkerboard {
                colors: [[0.8; 3], [0.1; 3]],
            },
        );
        let phong = |exponent: f32, ior: f32| Model::Phong {
            diffuse_reflectance: constant(0.2),
            reflectance: constant(0.3),
            transmittance: constant(0.4),
            diffuse_transmittance: constant(0.1),
            exponent,
            modified: exponent > 50.0,
            ior,
            fresnel: ior > 1.0,
        };
        let models = [
            Model::RoughConductor {
                spectra: None,
                eta: [0.14, 0.37, 1.44],
                k: [3.98, 2.39, 1.6],
                reflectance: constant(1.0),
                facets: facets(0.2, Distribution::Ggx, Masking::Correlated, true),
            },
            Model::RoughConductor {
                spectra: None,
                eta: [0.0; 3],
                k: [1.0; 3],
                reflectance: board,
                facets: facets(0.4, Distribution::Beckmann, Masking::Cavities, false),
            },
            Model::RoughDielectric {
                ior: 1.5,
                reflectance: constant(1.0),
                transmittance: ColorSource::Constant([0.8, 0.9, 1.0]),
                facets: facets(0.3, Distribution::Beckmann, Masking::Separable, true),
            },
            Model::RoughDielectric {
                ior: 1.33,
                reflectance: constant(1.0),
                transmittance: constant(1.0),
                facets: facets(0.1, Distribution::Ggx, Masking::Correlated, false),
            },
            Model::Plastic {
                ior: 1.5,
                diffuse_reflectance: board,
                reflectance: constant(1.0),
                nonlinear: true,
                facets: Some(facets(0.1, Distribution::Ggx, Masking::Separable, false)),
            },
            Model::Plastic {
                ior: 1.4,
                diffuse_reflectance: constant(0.5),
                reflectance: constant(1.0),
                nonlinear: false,
                facets: None,
            },
            phong(20.0, 1.5),
            phong(100.0, 1.0),
        ];
        for (i, model) in models.into_iter().enumerate() {
            let material = Some(b.material(model));
            let [x, z] = [i % 4, i / 4].map(|n| n as f32);
            b.sphere(
                [0.45 * x - 0.68, 0.2 - 0.3 * z, 0.3 + 0.6 * z],
                0.22,
                material,
            );
        }
        let mirror = b.mirror(0.9);
        let red = b.diffuse([0.8, 0.2, 0.2]);
        let blend = b.material(Model::Blend {
            parts: [red, mirror],
            weight: board,
        });
        b.quad(
            [-1.0, -1.0, 0.01],
            [2.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            Some(blend),
        );
        b.light(EmitterKind::Constant { radiance: [0.1; 3] });
        b.description.sensor.resolution = SIZE;
    });
    scene.description
}

/// A room with every phase function, kind of medium and way of tracking; a point light within, and what glows.
fn fog() -> Description {
    let part = |phase, weight| Lobe { phase, weight };
    let grid = |rgb: bool| {
        let value = |i: usize| (i * 7 % 12) as f32 / 12.0;
        let values = if rgb {
            GridValues::Rgb((0..12).map(|i| [value(i), 0.5, value(i + 5)]).collect())
        } else {
            GridValues::Gray((0..12).map(value).collect())
        };
        Grid {
            size: [2, 3, 2],
            values,
            nearest: rgb,
        }
    };
    let scene = room(|b| {
        let mist = b.matter(Medium {
            sigma_t: [0.2, 0.3, 0.5],
            albedo: [0.9, 0.8, 0.7],
            phase: vec![
                part(Phase::Isotropic, 1.0),
                part(Phase::HenyeyGreenstein { g: 0.7 }, 2.0),
                part(Phase::Rayleigh, 1.0),
                part(Phase::Forward, 0.5),
            ],
            ..Medium::default()
        });
        b.fog([-1.1, -1.2, -0.1], [1.1, 1.1, 2.1], mist);
        let glass = b.glass(1.3);
        let ember = b.matter(Medium {
            sigma_t: [3.0, 2.0, 1.0],
            albedo: [0.5; 3],
            emission: [4.0, 2.0, 0.5],
            ..Medium::default()
        });
        b.ball([-0.6, 0.0, 0.4], 0.3, glass, ember).exterior = Some(mist);
        for (x, rgb, tracking) in [
            (-0.4, true, Tracking::Woodcock),
            (0.1, false, Tracking::Residual),
            (0.6, true, Tracking::Regular),
        ] {
            let (low, high) = ([x - 0.2, -0.2, 1.0], [x + 0.2, 0.3, 1.5]);
            let smoke = Medium {
                sigma_t: [8.0; 3],
                albedo: [0.8; 3],
                emission: [0.5, 0.2, 0.1],
                phase: vec![part(Phase::HenyeyGreenstein { g: -0.3 }, 1.0)],
                ..Medium::default()
            };
            let smoke = b.smoke(low, high, grid(rgb), smoke);
            let grids = b.description.media[smoke].grids.as_mut().unwrap();
            grids.tracking = tracking;
            grids.emission = Some(grid(rgb));
            b.fog(low, high, smoke).exterior = Some(mist);
        }
        b.light(EmitterKind::Point {
            position: [0.5, -0.4, 0.6],
            intensity: [0.5; 3],
        });
        b.description.emitters[0].medium = Some(mist);
        b.description.sensor.resolution = SIZE;
    });
    scene.description
}

/// A room of all that disperses and gives spectra, and coloured fog.
fn prism() -> Description {
    let scene = room(|b| {
        let glass = |index, schlick| Model::Dispersive {
            index,
            outside: 1.000_277,
            reflectance: constant(1.0),
            transmittance: ColorSource::Constant([1.0, 0.9, 0.8]),
            schlick,
        };
        let indices = [
            Index::Cauchy([1.5, 0.004, 0.0001]),
            Index::Sellmeier {
                b: [1.737_597, 0.313_747_35, 1.898_781],
                c: [0.013_188_707, 0.062_306_814, 155.236_3],
            },
            Index::Table(vec![[400.0, 1.6], [550.0, 1.5], [700.0, 1.45]]),
        ];
        for (i, index) in indices.into_iter().enumerate() {
            let glass = b.material(glass(index, i == 2));
            b.sphere([-0.55 + 0.5 * i as f32, -0.2, 0.5], 0.22, Some(glass));
        }
        let rows = vec![[380.0, 0.1], [500.0, 0.9], [520.0, 0.2], [700.0, 0.7]];
        let reflectance = texture(b, Pattern::Spectrum(rows));
        let paper = b.material(Model::Diffuse {
            reflectance,
            transmittance: constant(0.0),
        });
        b.cuboid([-0.7, 0.2, 0.0], [-0.2, 0.7, 1.2], false, Some(paper));
        let fog = b.medium([0.5, 0.3, 0.1], [0.9, 0.5, 0.8], Phase::Isotropic);
        b.fog([0.0, 0.1, 0.1], [0.8, 0.8, 1.4], fog);
        b.sphere([0.6, -0.3, 1.6], 0.1, None).emission = Some([4.0, 2.0, 1.0]);
        let lamp = b.description.shapes.last_mut().unwrap();
        lamp.spectrum = Some(vec![[450.0, 1.0], [580.0, 6.0], [600.0, 3.0]]);
        b.light(EmitterKind::Point {
            position: [-0.4, -0.5, 1.6],
            intensity: [0.5; 3],
        });
        b.description.emitters[0].spectrum = Some(vec![[540.0, 1.0]]);
        b.description.sensor.resolution = SIZE;
    });
    scene.description
}

/// Seen all round from within a mist, across the seam and the poles; it has no light that quadrature makes nothing of.
fn round() -> Description {
    let scene = room(|b| {
        let phase = Phase::HenyeyGreenstein { g: 0.5 };
        let mist = b.medium([0.3, 0.2, 0.4], [0.9, 0.8, 0.7], phase);
        b.fog([-0.9, -0.9, 0.1], [0.9, 0.9, 1.9], mist);
        let glass = b.glass(1.5);
        let water = b.medium([0.5, 0.2, 0.1], [0.2; 3], Phase::Rayleigh);
        b.ball([-0.4, 0.3, 0.5], 0.3, glass, water).exterior = Some(mist);
        b.light(EmitterKind::Point {
            position: [0.5, -0.4, 1.4],
            intensity: [0.5, 0.4, 0.6],
        });
        b.description.emitters[0].medium = Some(mist);
        let sensor = &mut b.description.sensor;
        sensor.projection = Projection::Panorama;
        sensor.origin = [0.2, -0.1, 0.9];
        sensor.medium = Some(mist);
        sensor.filter = Filter::Tent { radius: 1.5 };
        sensor.resolution = SIZE;
    });
    scene.description
}

/// A few things in the open: lat-long sky, sun, thin lens, Gaussian filter, coarse smooth normals.
fn open_air() -> Description {
    let mut b = Builder::new().camera(
        [0.0, -3.0, 1.2],
        [0.0, 0.0, 0.4],
        [0.0, 0.0, 1.0],
        45.0,
        SIZE,
    );
    furnish(&mut b);
    b.light(EmitterKind::LatLong {
        width: 8,
        height: 5,
        texels: sky(40),
        scale: 0.7,
        to_local: [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
    });
    b.light(EmitterKind::Directional {
        direction: [0.6, 0.0, -0.8],
        irradiance: [2.0, 1.8, 1.5],
    });
    let sensor = &mut b.description.sensor;
    if let Projection::Perspective {
        aperture, focus, ..
    } = &mut sensor.projection
    {
        (*aperture, *focus) = (0.1, 2.8);
    }
    sensor.filter = Filter::Gaussian {
        sigma: 0.6,
        radius: 2.0,
    };
    b.description
}

/// The same from parallel rays through a crop window and a tent, under a cube map.
fn plan() -> Description {
    let mut b = Builder::new().camera(
        [0.0, -3.0, 3.0],
        [0.0, 0.0, 0.2],
        [0.0, 0.0, 1.0],
        45.0,
        SIZE,
    );
    furnish(&mut b);
    b.light(EmitterKind::CubeMap {
        width: 2,
        texels: sky(24),
        scale: 1.0,
        to_local: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    });
    let sensor = &mut b.description.sensor;
    sensor.projection = Projection::Orthographic {
        half_extent: [1.6, 1.2],
    };
    sensor.resolution = [24, 18];
    sensor.crop = Some([5, 4, SIZE[0], SIZE[1]]);
    sensor.filter = Filter::Tent { radius: 1.0 };
    b.description
}

fn furnish(b: &mut Builder) {
    let white = Some(b.diffuse([0.7, 0.6, 0.5]));
    b.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], white);
    let glass = Some(b.glass(1.5));
    b.sphere([0.6, 0.0, 0.4], 0.4, glass);
    // An octahedron that passes for a ball.
    let v = |i: usize| -> [f32; 3] {
        std::array::from_fn(|a| if a == i / 2 { [1.0, -1.0][i % 2] } else { 0.0 })
    };
    let normals: Vec<_> = (0..6).map(v).collect();
    let positions = normals
        .iter()
        .map(|n| [n[0] * 0.5 - 0.6, n[1] * 0.5, n[2] * 0.5 + 0.5])
        .collect();
    let triangles = (0..8)
        .map(|i: u32| {
            let (x, y, z) = (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2));
            if i.count_ones().is_multiple_of(2) {
                [x, y, z]
            } else {
                [x, z, y]
            }
        })
        .collect();
    let mesh = etendue_host::description::Mesh {
        positions,
        normals: Some(normals),
        uvs: None,
        triangles,
    };
    b.shape(etendue_host::description::Geometry::Mesh(mesh), white);
}

/// All of them, by name.
pub fn scenes() -> [(&'static str, Description); 7] {
    [
        ("matter", matter()),
        ("gloss", gloss()),
        ("fog", fog()),
        ("prism", prism()),
        ("round", round()),
        ("open_air", open_air()),
        ("plan", plan()),
    ]
}

/// FNV-1a over the bits of single-precision numbers, lowest byte first: the hash that every target prints.
pub fn hash(values: &[f32]) -> u64 {
    let bytes = values.iter().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, b| {
        (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3)
    })
}
