//! Surfaces, lights, sensors and places.

use super::Complete::{FromLight, FromSensor};
use super::Named;
use crate::scenes::{Builder, V, room, round};
use etendue_host::description::{
    ColorSource, Description, Distribution, EmitterKind, Facets, Filter, Geometry, Masking, Mesh,
    Model, Projection,
};

/// The room with a white box and a white ball.
pub fn plain() -> Description {
    transformed(1.0, [0.0; 3])
}

/// The same elsewhere.
pub fn transformed(k: f32, by: V) -> Description {
    let b = room(|b| {
        let white = Some(b.diffuse([0.8; 3]));
        b.cuboid([-0.6, 0.0, 0.0], [-0.1, 0.5, 0.9], false, white);
        b.sphere([0.45, -0.1, 0.3], 0.3, white);
    });
    b.transformed(k, by).description
}

/// A mesh of a sphere with smooth normals.
pub(super) fn ball(center: V, radius: f32, rings: u32) -> Mesh {
    let sectors = 2 * rings;
    round(rings, sectors, |i, j| {
        let theta = std::f32::consts::PI * i as f32 / rings as f32;
        let phi = 2.0 * std::f32::consts::PI * j as f32 / sectors as f32;
        let n = [
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        ];
        (std::array::from_fn(|a| center[a] + radius * n[a]), n)
    })
}

/// An exact diffuse ball, and one of 20,000 triangles.
pub fn sphere_and_mesh() -> (Description, Description) {
    let with = |geometry: fn() -> Geometry| {
        room(|b| {
            let white = Some(b.diffuse([0.8; 3]));
            b.shape(geometry(), white);
        })
        .description
    };
    (
        with(|| Geometry::Sphere {
            center: [0.0, 0.0, 0.6],
            radius: 0.5,
            flipped: false,
        }),
        with(|| Geometry::Mesh(ball([0.0, 0.0, 0.6], 0.5, 72))),
    )
}

/// Mirrors, glass, sheets, masks, null boundaries, smooth normals, two-sided things.
pub fn objects() -> Vec<Named> {
    let constant = |c: f32| ColorSource::Constant([c; 3]);
    let mut all: Vec<Named> = Vec::new();
    all.push(("plain", plain(), FromLight));
    let b = room(|b| {
        let white = Some(b.diffuse([0.8; 3]));
        b.shape(Geometry::Mesh(ball([-0.4, 0.1, 0.45], 0.4, 5)), white);
        b.shape(Geometry::Mesh(ball([0.5, -0.2, 0.3], 0.25, 4)), white);
    });
    all.push(("coarse balls with smooth normals", b.description, FromLight));
    // The adjoint's factor doesn't cancel over these: all lean the same way, by 37°.
    let b = room(|b| {
        let white = Some(b.diffuse([0.8; 3]));
        for (corner, normal) in [
            ([-0.9, -0.8, 0.3], [0.6, 0.0, 0.8]),
            ([-0.9, 0.1, 0.5], [0.0, -0.6, 0.8]),
        ] {
            let card = b.quad(corner, [1.8, 0.0, 0.0], [0.0, 0.7, 0.0], white);
            if let Geometry::Mesh(mesh) = &mut card.geometry {
                mesh.normals = Some(vec![normal; 4]);
            }
        }
    });
    all.push(("cards with leaning normals", b.description, FromLight));
    let b = room(|b| {
        let thin = b.material(Model::Diffuse {
            reflectance: constant(0.3),
            transmittance: constant(0.6),
        });
        b.quad(
            [-0.9, 0.0, 0.9],
            [1.0, 0.0, 0.0],
            [0.0, 0.4, 0.5],
            Some(thin),
        );
        let (red, blue) = (b.diffuse([0.8, 0.2, 0.2]), b.diffuse([0.2, 0.2, 0.8]));
        let card = b.quad(
            [0.2, -0.2, 0.4],
            [0.6, 0.3, 0.0],
            [0.0, 0.0, 0.8],
            Some(red),
        );
        card.back = Some(blue);
        let one_sided = b.quad(
            [-0.5, -0.5, 0.1],
            [0.4, 0.0, 0.3],
            [0.0, 0.4, 0.0],
            Some(red),
        );
        one_sided.back = None;
    });
    all.push((
        "translucent, two-sided and one-sided cards",
        b.description,
        FromLight,
    ));
    let b = room(|b| {
        let white = Some(b.diffuse([0.8; 3]));
        b.quad([-0.8, -0.3, 1.2], [1.6, 0.0, 0.0], [0.0, 0.6, 0.0], white)
            .opacity = Some(constant(0.4));
        b.sphere([0.3, 0.0, 0.4], 0.3, white).opacity = Some(constant(0.7));
        let null = b.material(Model::Null);
        b.cuboid([-0.9, -0.9, 0.05], [0.9, 0.9, 1.5], false, Some(null));
    });
    all.push(("masks within a null boundary", b.description, FromLight));
    let b = room(|b| {
        let glass = Some(b.glass(1.5));
        let mirror = Some(b.mirror(0.9));
        let white = Some(b.diffuse([0.8; 3]));
        b.sphere([0.45, 0.1, 0.35], 0.3, glass);
        b.quad([-0.95, 0.2, 0.1], [0.7, 0.6, 0.0], [0.0, 0.0, 1.2], mirror);
        b.cuboid([-0.5, -0.5, 0.0], [-0.2, -0.2, 0.3], false, white);
        // A lamp large enough for a path tracer's caustics.
        b.quad([-0.9, -0.9, 1.9], [0.0, 1.8, 0.0], [1.8, 0.0, 0.0], white)
            .emission = Some([1.0; 3]);
    });
    all.push(("glass ball and mirror", b.description, FromSensor));
    let b = room(|b| {
        let sheet = b.material(Model::Sheet {
            specular_reflectance: ColorSource::Constant([0.1, 0.1, 0.2]),
            specular_transmittance: ColorSource::Constant([0.5, 0.3, 0.1]),
            diffuse_reflectance: constant(0.2),
            diffuse_transmittance: ColorSource::Constant([0.1, 0.2, 0.3]),
        });
        let gold = b.material(Model::Conductor {
            spectra: None,
            eta: [0.14, 0.37, 1.44],
            k: [3.98, 2.39, 1.6],
            reflectance: constant(1.0),
        });
        b.quad(
            [-0.9, -0.4, 1.0],
            [1.8, 0.0, 0.0],
            [0.0, 1.0, 0.2],
            Some(sheet),
        );
        b.cuboid([0.2, 0.1, 0.0], [0.7, 0.6, 0.5], false, Some(gold));
        b.quad([-0.9, -0.9, 1.9], [0.0, 1.8, 0.0], [1.8, 0.0, 0.0], None)
            .emission = Some([1.0; 3]);
    });
    all.push(("coloured sheet and gold", b.description, FromSensor));
    all
}

/// Glossy things of every kind; all but a blend's mirror and plastic's coat are smooth enough for light tracing.
pub fn glossy() -> Vec<Named> {
    let constant = |c: f32| ColorSource::Constant([c; 3]);
    let facets = |alpha: f32, distribution, masking, compensated| Facets {
        alpha: [alpha; 2],
        distribution,
        masking,
        compensated,
    };
    let mut all: Vec<Named> = Vec::new();
    let b = room(|b| {
        let gold = b.material(Model::RoughConductor {
            spectra: None,
            eta: [0.14, 0.37, 1.44],
            k: [3.98, 2.39, 1.6],
            reflectance: constant(1.0),
            facets: facets(0.4, Distribution::Ggx, Masking::Correlated, true),
        });
        let steel = b.material(Model::RoughConductor {
            spectra: None,
            eta: [0.0; 3],
            k: [1.0; 3],
            reflectance: constant(0.7),
            facets: facets(0.3, Distribution::Beckmann, Masking::Separable, false),
        });
        let plastic = b.material(Model::Plastic {
            ior: 1.5,
            diffuse_reflectance: ColorSource::Constant([0.2, 0.3, 0.8]),
            reflectance: constant(1.0),
            nonlinear: true,
            facets: Some(facets(0.3, Distribution::Ggx, Masking::Separable, false)),
        });
        let phong = b.material(Model::Phong {
            diffuse_reflectance: ColorSource::Constant([0.4, 0.2, 0.1]),
            reflectance: constant(0.5),
            transmittance: constant(0.0),
            diffuse_transmittance: constant(0.0),
            exponent: 20.0,
            modified: true,
            ior: 1.0,
            fresnel: false,
        });
        b.quad(
            [-1.0, -1.0, 0.01],
            [2.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            Some(steel),
        );
        b.sphere([-0.5, 0.1, 0.35], 0.3, Some(gold));
        b.sphere([0.45, -0.1, 0.3], 0.3, Some(plastic));
        b.cuboid([-0.2, 0.3, 0.0], [0.2, 0.6, 0.9], false, Some(phong));
    });
    all.push(("metals, plastic and Phong", b.description, FromLight));
    let b = room(|b| {
        let ground = b.material(Model::RoughDielectric {
            ior: 1.5,
            reflectance: constant(1.0),
            transmittance: constant(1.0),
            facets: facets(0.4, Distribution::Ggx, Masking::Separable, true),
        });
        let dull = b.material(Model::Phong {
            diffuse_reflectance: constant(0.0),
            reflectance: constant(1.0),
            transmittance: ColorSource::Constant([0.9, 0.8, 0.6]),
            diffuse_transmittance: constant(0.0),
            exponent: 20.0,
            modified: true,
            ior: 1.4,
            fresnel: true,
        });
        let sheet = b.material(Model::Phong {
            diffuse_reflectance: constant(0.2),
            reflectance: constant(0.2),
            transmittance: constant(0.4),
            diffuse_transmittance: constant(0.1),
            exponent: 30.0,
            modified: true,
            ior: 1.0,
            fresnel: false,
        });
        b.sphere([-0.45, 0.1, 0.4], 0.35, Some(ground));
        b.cuboid([0.2, -0.2, 0.05], [0.7, 0.3, 0.6], false, Some(dull));
        b.quad(
            [-0.9, -0.4, 1.1],
            [1.8, 0.0, 0.0],
            [0.0, 1.0, 0.2],
            Some(sheet),
        );
    });
    all.push((
        "ground glass, Phong glass and sheet",
        b.description,
        FromLight,
    ));
    let b = room(|b| {
        let varnish = b.material(Model::Plastic {
            ior: 1.5,
            diffuse_reflectance: constant(0.6),
            reflectance: constant(1.0),
            nonlinear: false,
            facets: None,
        });
        let mirror = b.mirror(0.9);
        let red = b.diffuse([0.8, 0.2, 0.2]);
        let half = b.material(Model::Blend {
            parts: [red, mirror],
            weight: constant(0.4),
        });
        let nested = b.material(Model::Blend {
            parts: [half, varnish],
            weight: constant(0.5),
        });
        b.cuboid([-0.6, 0.0, 0.0], [-0.1, 0.5, 0.9], false, Some(half));
        b.sphere([0.45, -0.1, 0.3], 0.3, Some(nested));
        // A lamp large enough for a path tracer's caustics.
        b.quad([-0.9, -0.9, 1.9], [0.0, 1.8, 0.0], [1.8, 0.0, 0.0], None)
            .emission = Some([1.0; 3]);
    });
    all.push(("blends and varnish", b.description, FromSensor));
    all
}

/// Every kind of light.
pub fn lights() -> Vec<Named> {
    let open = |light: &dyn Fn(&mut Builder)| {
        let mut b = Builder::new().camera(
            [0.0, -3.0, 1.6],
            [0.0, 0.0, 0.3],
            [0.0, 0.0, 1.0],
            40.0,
            [16, 16],
        );
        let grey = Some(b.diffuse([0.5, 0.6, 0.7]));
        b.quad([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], grey);
        b.cuboid([-0.5, -0.2, 0.0], [0.0, 0.3, 0.6], false, grey);
        b.sphere([0.4, 0.0, 0.3], 0.25, grey);
        light(&mut b);
        b.description
    };
    let sky = |i: u32| {
        let (x, y) = (i % 16, i / 16);
        let sun = if (x, y) == (5, 2) { 40.0 } else { 0.0 };
        [
            0.4 + 0.02 * x as f32 + sun,
            0.5 + sun,
            0.9 - 0.05 * y as f32 + sun,
        ]
    };
    // Up is z: the image's y is the world's z.
    let to_local = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
    let lit = |kind: EmitterKind| open(&move |b| b.light(kind.clone()));
    vec![
        (
            "point",
            lit(EmitterKind::Point {
                position: [0.7, -0.8, 1.5],
                intensity: [2.0, 1.0, 0.5],
            }),
            FromLight,
        ),
        (
            "spot",
            lit(EmitterKind::Spot {
                position: [0.5, -1.0, 1.8],
                direction: [-0.243, 0.485, -0.84],
                intensity: [4.0; 3],
                cutoff: 0.7,
                beam_width: 0.4,
            }),
            FromLight,
        ),
        (
            "directional",
            lit(EmitterKind::Directional {
                direction: [0.48, 0.36, -0.8],
                irradiance: [2.0, 1.5, 1.0],
            }),
            FromLight,
        ),
        (
            "constant",
            lit(EmitterKind::Constant {
                radiance: [0.5, 0.7, 1.0],
            }),
            FromLight,
        ),
        (
            "lat-long",
            lit(EmitterKind::LatLong {
                width: 16,
                height: 9,
                texels: (0..144).map(sky).collect(),
                scale: 0.7,
                to_local,
            }),
            FromLight,
        ),
        (
            "cube map",
            lit(EmitterKind::CubeMap {
                width: 4,
                texels: (0..96).map(sky).collect(),
                scale: 0.7,
                to_local,
            }),
            FromLight,
        ),
        (
            "sun, spot and sky, chosen among",
            open(&|b| {
                b.light(EmitterKind::Directional {
                    direction: [-0.6, 0.0, -0.8],
                    irradiance: [1.0, 0.9, 0.8],
                });
                b.light(EmitterKind::Spot {
                    position: [0.0, -1.0, 1.5],
                    direction: [0.0, 0.55, -0.835_164_6],
                    intensity: [2.0; 3],
                    cutoff: 0.6,
                    beam_width: 0.4,
                });
                b.light(EmitterKind::Constant {
                    radiance: [0.1, 0.2, 0.3],
                });
            }),
            FromLight,
        ),
        (
            "spheres and triangles, many",
            open(&|b| {
                for i in 0..12 {
                    let x = -0.9 + 0.16 * i as f32;
                    b.sphere(
                        [x, 0.7, 0.2 + 0.1 * i as f32],
                        0.02 + 0.005 * i as f32,
                        None,
                    )
                    .emission = Some([20.0 / (1.0 + i as f32), 3.0, 2.0]);
                }
                b.quad([-0.5, -0.5, 1.4], [0.0, 0.7, 0.0], [0.7, 0.0, 0.0], None)
                    .emission = Some([1.0, 2.0, 3.0]);
            }),
            FromLight,
        ),
        (
            "a lamp that is a shell, seen from inside and outside",
            open(&|b| {
                b.shape(
                    Geometry::Sphere {
                        center: [0.0, 0.0, 0.0],
                        radius: 6.0,
                        flipped: true,
                    },
                    None,
                )
                .emission = Some([0.5, 0.4, 0.3]);
            }),
            FromLight,
        ),
    ]
}

/// Makes the camera a panorama amid the room, its seam at a wall.
fn panorama(d: &mut Description, filter: Filter) {
    let s = &mut d.sensor;
    (s.projection, s.filter) = (Projection::Panorama, filter);
    (s.origin, s.resolution) = ([0.1, -0.5, 1.1], [16, 8]);
    (s.right, s.down, s.forward) = ([0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]);
}

/// Crop, lens, filters, projections, mirrored cameras.
pub fn sensors() -> Vec<Named> {
    let with = |name: &'static str, change: &dyn Fn(&mut Description)| {
        let mut d = plain();
        change(&mut d);
        (name, d, FromLight)
    };
    let lens = |d: &mut Description| {
        if let Projection::Perspective {
            aperture, focus, ..
        } = &mut d.sensor.projection
        {
            (*aperture, *focus) = (0.15, 3.2);
        }
    };
    vec![
        with("crop", &|d| {
            d.sensor.resolution = [40, 40];
            d.sensor.crop = Some([9, 14, 20, 16]);
        }),
        with("thin lens", &lens),
        // Blurred over several blocks of the image: where on the lens a light walk is seen from matters.
        with("thin lens, wide open and close", &|d| {
            if let Projection::Perspective {
                aperture, focus, ..
            } = &mut d.sensor.projection
            {
                (*aperture, *focus) = (0.5, 1.2);
            }
        }),
        with("tent filter", &|d| {
            d.sensor.filter = Filter::Tent { radius: 1.5 }
        }),
        with("gaussian filter, thin lens and crop", &|d| {
            lens(d);
            d.sensor.filter = Filter::Gaussian {
                sigma: 0.7,
                radius: 2.0,
            };
            d.sensor.resolution = [40, 40];
            d.sensor.crop = Some([9, 14, 20, 16]);
        }),
        with("wide box filter", &|d| {
            d.sensor.filter = Filter::Box { radius: 1.0 }
        }),
        with("mirrored", &|d| d.sensor.right = d.sensor.right.map(|x| -x)),
        with("shifted film", &|d| d.sensor.principal = [0.1, -0.05]),
        with("orthographic", &|d| {
            d.sensor.projection = Projection::Orthographic {
                half_extent: [0.9, 0.9],
            }
        }),
        with("orthographic, tent filter, crop", &|d| {
            d.sensor.projection = Projection::Orthographic {
                half_extent: [0.9, 0.9],
            };
            d.sensor.filter = Filter::Tent { radius: 1.2 };
            d.sensor.resolution = [32, 32];
            d.sensor.crop = Some([4, 8, 24, 20]);
        }),
        with("panorama", &|d| panorama(d, Filter::Box { radius: 0.5 })),
        with("panorama, wide filter across seam and poles", &|d| {
            panorama(d, Filter::Tent { radius: 3.0 })
        }),
        with("panorama, gaussian filter and crop at the seam", &|d| {
            panorama(
                d,
                Filter::Gaussian {
                    sigma: 1.0,
                    radius: 3.0,
                },
            );
            d.sensor.resolution = [40, 20];
            d.sensor.crop = Some([0, 0, 12, 20]);
        }),
        with("near and far planes", &|d| d.sensor.clip = [2.9, 4.1]),
    ]
}

/// An octahedron that is larger on one side than on the other, with a normal at each vertex.
pub const GEM: &str = "v 1 0 0\nv -0.5 0 0\nv 0 1 0\nv 0 -0.6 0\nv 0 0 1\nv 0 0 -0.8\n\
    vn 1 0 0\nvn -1 0 0\nvn 0 1 0\nvn 0 -1 0\nvn 0 0 1\nvn 0 0 -1\n\
    f 1//1 3//3 5//5\nf 3//3 2//2 5//5\nf 2//2 4//4 5//5\nf 4//4 1//1 5//5\n\
    f 3//3 1//1 6//6\nf 2//2 3//3 6//6\nf 4//4 2//2 6//6\nf 1//1 4//4 6//6\n";

/// Nothing in it is symmetric but the camera. Meshes with smooth and with flat normals, an exact sphere, glass, a lamp; all of them
/// are transformed by what is put in the place of `<mirror/>`. As in Mitsuba, a mirror turns spheres and meshes without normals
/// inside out: these are two-sided.
pub const MIRRORED: &str = r#"<scene version="3.0.0">
  <sensor type="perspective">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, -4, 1.5" target="0, 0, 0.6" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/></film>
  </sensor>
  <bsdf type="twosided" id="red"><bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.2"/></bsdf></bsdf>
  <bsdf type="diffuse" id="white"><rgb name="reflectance" value="0.7"/></bsdf>
  <bsdf type="dielectric" id="glass"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>
  <shape type="rectangle"><ref id="white"/>
    <transform name="to_world"><scale value="3"/><rotate y="1" angle="4"/><mirror/></transform></shape>
  <shape type="obj"><string name="filename" value="gem.obj"/><ref id="white"/>
    <transform name="to_world"><scale value="0.7"/><rotate z="1" angle="20"/><translate x="-0.7" z="0.7"/><mirror/></transform></shape>
  <shape type="obj"><string name="filename" value="gem.obj"/><boolean name="face_normals" value="true"/><ref id="red"/>
    <transform name="to_world"><scale value="0.4"/><rotate x="1" angle="20"/><translate x="0.2" y="0.6" z="0.4"/><mirror/></transform></shape>
  <shape type="cube"><ref id="glass"/>
    <transform name="to_world"><scale value="0.3"/><rotate z="1" angle="30"/><translate x="0.6" y="-0.4" z="0.4"/><mirror/></transform></shape>
  <shape type="sphere"><ref id="red"/>
    <transform name="to_world"><scale value="0.25"/><translate x="-0.2" y="-0.9" z="0.3"/><mirror/></transform></shape>
  <shape type="rectangle"><emitter type="area"><rgb name="radiance" value="2, 1.5, 1"/></emitter>
    <transform name="to_world"><scale x="1.2" y="0.8"/><rotate x="1" angle="180"/><rotate y="1" angle="20"/><translate x="-0.6" z="2.5"/><mirror/></transform></shape>
  <emitter type="constant"><rgb name="radiance" value="0.2"/></emitter>
</scene>
"#;
