//! What C's structs mean: the same blobs, byte for byte, as from a description in Rust.

use crate::misuse::{Builder, made, sized, triangle};
use etendue::capi::status::{ETD_E_ARGUMENT, ETD_OK};
use etendue_host::compile::compile;
use etendue_host::description::{
    Color, ColorSource, Description, Emitter, EmitterKind, Filter, Geometry, Grid, GridValues,
    Grids, Image, Index, Lobe, Material, Medium, Mesh, Model, Pattern, Phase, Place, Projection,
    Sensor, Shape, Texels, Texture, Tracking, Wrap,
};
use etendue_host_capi::blob::{EtdBlob, etd_blob_free};
use etendue_host_capi::builder::*;
use etendue_host_capi::camera::*;
use etendue_host_capi::light::*;
use etendue_host_capi::medium::*;
use etendue_host_capi::object::*;
use etendue_host_capi::surface::*;
use std::ptr::null;

fn bytes(builder: &Builder) -> Vec<u8> {
    let mut blob: EtdBlob = builder.build();
    // SAFETY: a blob that was just built, freed once.
    unsafe {
        let bytes = std::slice::from_raw_parts(blob.data, blob.size).to_vec();
        assert_eq!(etd_blob_free(&raw mut blob), ETD_OK);
        bytes
    }
}

/// Builds both and compares.
fn same(builder: &Builder, description: &Description) {
    let made = compile(description).unwrap();
    assert!(bytes(builder) == made.blob.bytes());
}

fn mesh(positions: &[f32], triangles: &[[u32; 3]]) -> Mesh {
    Mesh {
        positions: positions.chunks(3).map(|p| [p[0], p[1], p[2]]).collect(),
        triangles: triangles.to_vec(),
        ..Mesh::default()
    }
}

fn shape(geometry: Geometry) -> Shape {
    Shape {
        spectrum: None,
        name: String::new(),
        place: Place::default(),
        geometry,
        front: None,
        back: None,
        emission: None,
        opacity: None,
        interior: None,
        exterior: None,
    }
}

/// The triangle that `Builder::small` holds.
fn shining() -> Shape {
    let positions = [-1., -1., 2., 1., -1., 2., 0., 1., 2.];
    Shape {
        emission: Some([1.0; 3]),
        ..shape(Geometry::Mesh(mesh(&positions, &[[0, 2, 1]])))
    }
}

fn described() -> Description {
    Description {
        sensor: Sensor {
            resolution: [8, 8],
            ..Sensor::default()
        },
        shapes: vec![shining()],
        ..Description::default()
    }
}

#[test]
fn textures_and_materials() {
    let builder = Builder::small(null());
    let mut d = described();
    let mut id = 99;
    static SMALL: [[u8; 4]; 4] = [[0, 1, 2, 3], [50, 60, 70, 80], [9, 8, 7, 6], [255; 4]];
    static LARGE: [Color; 4] = [[0.0, 0.5, 1.0], [0.25; 3], [0.75; 3], [1.0; 3]];
    let mut texture = |kind, flags, pattern: Pattern| {
        let mut t = made(etd_texture_default);
        (t.kind, t.flags, t.color) = (kind, flags, [[0.25; 3], [0.5, 0.0, 1.0]]);
        t.to_uv = [[2.0, 0.5, 0.25], [-0.5, 3.0, 0.125]];
        if kind != ETD_CHECKERBOARD {
            (t.width, t.height) = (2, 2);
        }
        (t.texels, t.bytes) = match kind {
            ETD_FLOAT => (LARGE.as_ptr().cast(), 48),
            _ => (SMALL.as_ptr().cast(), 16),
        };
        // SAFETY: good pointers.
        assert_eq!(
            // SAFETY: good pointers.
            unsafe { etd_builder_add_texture(builder.0, &t, &raw mut id) },
            ETD_OK
        );
        assert_eq!(id as usize, d.textures.len());
        d.textures.push(Texture {
            name: String::new(),
            pattern,
            to_uv: t.to_uv,
        });
    };
    let bitmap = |texels, nearest, wrap, alpha| Pattern::Bitmap {
        image: Image {
            width: 2,
            height: 2,
            texels,
        },
        nearest,
        wrap,
        alpha,
    };
    let small = || SMALL.to_vec();
    let colors = [[0.25; 3], [0.5, 0.0, 1.0]];
    texture(ETD_CHECKERBOARD, 0, Pattern::Checkerboard { colors });
    texture(
        ETD_SRGB8,
        ETD_NEAREST,
        bitmap(Texels::Srgb8(small()), true, Wrap::Repeat, false),
    );
    texture(
        ETD_LINEAR8,
        ETD_CLAMP | ETD_ALPHA,
        bitmap(Texels::Linear8(small()), false, Wrap::Clamp, true),
    );
    texture(
        ETD_FLOAT,
        ETD_MIRRORED,
        bitmap(Texels::Float(LARGE.to_vec()), false, Wrap::Mirror, false),
    );

    let [a, b, c, e] = [[0.25_f32; 3], [0.125; 3], [0.0625, 0.5, 0.25], [0.0; 3]];
    let constant = ColorSource::Constant;
    let mut material = |kind, texture: [u32; 4], model: Model| {
        let mut m = made(etd_material_default);
        (m.kind, m.texture, m.color) = (kind, texture, [a, b, c, e]);
        (m.eta, m.k, m.ior) = ([0.5, 1.0, 1.5], [2.0, 3.0, 0.0], 1.25);
        m.flags = u32::from(kind == ETD_DIELECTRIC) * ETD_SCHLICK;
        // SAFETY: good pointers.
        assert_eq!(
            // SAFETY: good pointers.
            unsafe { etd_builder_add_material(builder.0, &m, &raw mut id) },
            ETD_OK
        );
        assert_eq!(id as usize, d.materials.len());
        d.materials.push(Material {
            name: String::new(),
            model,
        });
    };
    let none = [ETD_NONE; 4];
    material(
        ETD_DIFFUSE,
        [ETD_NONE, 1, ETD_NONE, ETD_NONE],
        Model::Diffuse {
            reflectance: constant(a),
            transmittance: ColorSource::Texture(1),
        },
    );
    let reflectance = ColorSource::Texture(3);
    material(
        ETD_MIRROR,
        [3, ETD_NONE, ETD_NONE, ETD_NONE],
        Model::Mirror { reflectance },
    );
    material(
        ETD_CONDUCTOR,
        none,
        Model::Conductor {
            spectra: None,
            eta: [0.5, 1.0, 1.5],
            k: [2.0, 3.0, 0.0],
            reflectance: constant(a),
        },
    );
    material(
        ETD_DIELECTRIC,
        none,
        Model::Dielectric {
            ior: 1.25,
            reflectance: constant(a),
            transmittance: constant(b),
            schlick: true,
        },
    );
    material(ETD_BOUNDARY, none, Model::Null);
    material(
        ETD_SHEET,
        none,
        Model::Sheet {
            specular_reflectance: constant(a),
            specular_transmittance: constant(b),
            diffuse_reflectance: constant(c),
            diffuse_transmittance: constant(e),
        },
    );
    material(
        ETD_DISPERSIVE,
        none,
        Model::Dispersive {
            index: Index::Sellmeier {
                b: [0.5, 1.0, 1.5],
                c: [2.0, 3.0, 0.0],
            },
            outside: 1.25,
            reflectance: constant(a),
            transmittance: constant(b),
            schlick: false,
        },
    );
    // Objects that use them.
    let mut object = triangle();
    let normals = [0., 0., -2., 0., 1., -1., 1., 0., -1.];
    let uvs = [0., 0., 1., 0., 0., 1.];
    (object.front, object.back, object.opacity, object.emission) = (5, 4, 2, [0.0; 3]);
    (object.normals, object.uvs) = (normals.as_ptr(), uvs.as_ptr());
    let mut ball = made(etd_sphere_default);
    (ball.front, ball.back, ball.flipped) = (3, 3, 1);
    (ball.center, ball.radius, ball.emission) = ([1.0, 2.0, 3.0], 0.5, [0.0, 2.0, 0.0]);
    // SAFETY: good pointers.
    unsafe {
        assert_eq!(
            etd_builder_add_mesh(builder.0, &object, &raw mut id),
            ETD_OK
        );
        assert_eq!(
            etd_builder_add_sphere(builder.0, &ball, &raw mut id),
            ETD_OK
        );
    }
    assert_eq!(id, 2);
    let mut smooth = mesh(&[-1., -1., 2., 1., -1., 2., 0., 1., 2.], &[[0, 2, 1]]);
    smooth.normals = Some(mesh(&normals, &[]).positions);
    smooth.uvs = Some(uvs.chunks(2).map(|uv| [uv[0], uv[1]]).collect());
    d.shapes.push(Shape {
        front: Some(5),
        back: Some(4),
        opacity: Some(ColorSource::Texture(2)),
        ..shape(Geometry::Mesh(smooth))
    });
    d.shapes.push(Shape {
        front: Some(3),
        back: Some(3),
        emission: Some([0.0, 2.0, 0.0]),
        ..shape(Geometry::Sphere {
            center: [1.0, 2.0, 3.0],
            radius: 0.5,
            flipped: true,
        })
    });
    same(&builder, &d);
    // Another in the place of one.
    let mut m = made(etd_material_default);
    m.color[0] = c;
    // SAFETY: good pointers.
    assert_eq!(
        // SAFETY: good pointers.
        unsafe { etd_builder_set_material(builder.0, 2, &m) },
        ETD_OK
    );
    d.materials[2].model = Model::Diffuse {
        reflectance: constant(c),
        transmittance: constant([0.0; 3]),
    };
    same(&builder, &d);
}

#[test]
fn lights() {
    static TEXELS: [Color; 12] = [[0.5, 1.0, 2.0]; 12];
    let builder = Builder::small(null());
    let mut d = described();
    let mut l = made(etd_light_default);
    (l.color, l.position, l.direction) = ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [0.0, -2.0, 0.0]);
    (l.cutoff, l.beam_width, l.scale) = (0.5, 0.25, 2.0);
    l.axes = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let mut id = 99;
    let mut add = |l: &EtdLight, kind: EmitterKind| {
        // SAFETY: good pointers.
        let status = unsafe { etd_builder_add_light(builder.0, l, &raw mut id) };
        assert_eq!(status, ETD_OK);
        assert_eq!(id as usize, d.emitters.len());
        let name = String::new();
        d.emitters.push(Emitter {
            spectrum: None,
            name,
            place: Place::default(),
            kind,
            medium: None,
        });
    };
    let (position, direction, color) = ([4.0, 5.0, 6.0], [0.0, -1.0, 0.0], [1.0, 2.0, 3.0]);
    l.kind = ETD_LIGHT_POINT;
    add(
        &l,
        EmitterKind::Point {
            position,
            intensity: color,
        },
    );
    l.kind = ETD_LIGHT_SPOT;
    let spot = EmitterKind::Spot {
        position,
        direction,
        intensity: color,
        cutoff: 0.5,
        beam_width: 0.25,
    };
    add(&l, spot);
    l.kind = ETD_LIGHT_DIRECTIONAL;
    add(
        &l,
        EmitterKind::Directional {
            direction,
            irradiance: color,
        },
    );
    l.kind = ETD_LIGHT_CONSTANT;
    add(&l, EmitterKind::Constant { radiance: color });
    same(&builder, &d);
    // Three backgrounds, one in the place of the other.
    (l.texels, l.scale) = (TEXELS.as_flattened().as_ptr(), 2.0);
    let to_local = l.axes;
    for (kind, width, height) in [(ETD_LIGHT_LATLONG, 4, 3), (ETD_LIGHT_CUBEMAP, 1, 6)] {
        (l.kind, l.width, l.height) = (kind, width, height);
        l.floats = 3 * width as usize * height as usize;
        let texels = TEXELS[..l.floats / 3].to_vec();
        // SAFETY: good pointers.
        assert_eq!(unsafe { etd_builder_set_light(builder.0, 3, &l) }, ETD_OK);
        d.emitters[3].kind = match kind {
            ETD_LIGHT_CUBEMAP => EmitterKind::CubeMap {
                width,
                texels,
                scale: 2.0,
                to_local,
            },
            _ => EmitterKind::LatLong {
                width,
                height,
                texels,
                scale: 2.0,
                to_local,
            },
        };
        same(&builder, &d);
    }
}

#[test]
fn cameras() {
    let builder = Builder::small(null());
    let mut d = described();
    let mut c = made(etd_camera_default);
    (c.origin, c.direction, c.up) = ([1.0, 2.0, 3.0], [3.0, 0.0, 0.0], [5.0, 0.0, 0.5]);
    (c.width, c.height, c.crop, c.clip) = (40, 20, [4, 3, 9, 7], [0.5, 64.0]);
    (c.aperture, c.focus, c.principal) = (0.25, 3.0, [0.125, -0.25]);
    (c.filter, c.filter_radius, c.filter_sigma) = (ETD_FILTER_GAUSSIAN, 2.0, 0.5);
    let tangent = (0.5 * f64::from(c.field)).tan();
    d.sensor = Sensor {
        projection: Projection::Perspective {
            half_tangent: [tangent as f32, (0.5 * tangent) as f32],
            aperture: 0.25,
            focus: 3.0,
        },
        origin: [1.0, 2.0, 3.0],
        // Up is z: to the right of someone who looks along x is −y.
        right: [0.0, -1.0, 0.0],
        down: [0.0, 0.0, -1.0],
        forward: [1.0, 0.0, 0.0],
        clip: [0.5, 64.0],
        principal: [0.125, -0.25],
        resolution: [40, 20],
        crop: Some([4, 3, 9, 7]),
        filter: Filter::Gaussian {
            sigma: 0.5,
            radius: 2.0,
        },
        medium: None,
    };
    let set = |c: &EtdCamera| {
        // SAFETY: good pointers.
        assert_eq!(unsafe { etd_builder_set_camera(builder.0, c) }, ETD_OK);
    };
    set(&c);
    same(&builder, &d);
    (c.projection, c.field, c.crop) = (ETD_ORTHOGRAPHIC, 8.0, [0; 4]);
    (c.filter, c.filter_radius) = (ETD_FILTER_TENT, 1.0);
    set(&c);
    d.sensor.projection = Projection::Orthographic {
        half_extent: [4.0, 2.0],
    };
    (d.sensor.crop, d.sensor.filter) = (None, Filter::Tent { radius: 1.0 });
    same(&builder, &d);
}

#[test]
fn transforms() {
    let builder = Builder::small(null());
    let mut d = described();
    let mut ball = made(etd_sphere_default);
    (ball.center, ball.radius) = ([1.0, 0.0, 0.0], 0.5);
    let mut object = triangle();
    let normals = [1., 1., 0., 0., 0., -1., 0., 1., 0.];
    object.normals = normals.as_ptr();
    let mut id = 0;
    let place = |id, matrix: [f32; 12]| {
        // SAFETY: good pointers.
        unsafe { etd_builder_set_transform(builder.0, id, matrix.as_ptr()) }
    };
    // SAFETY: good pointers.
    unsafe {
        assert_eq!(
            etd_builder_add_sphere(builder.0, &ball, &raw mut id),
            ETD_OK
        );
        assert_eq!(
            etd_builder_add_mesh(builder.0, &object, &raw mut id),
            ETD_OK
        );
    }
    // A quarter turn around z, twice as large, elsewhere.
    let turned = [0., -2., 0., 8., 2., 0., 0., 16., 0., 0., 2., 32.];
    assert_eq!(place(1, turned), ETD_OK);
    d.shapes.push(shape(Geometry::Sphere {
        center: [8.0, 18.0, 32.0],
        radius: 1.0,
        flipped: false,
    }));
    // Mirrored in x and stretched: normals stay at right angles to their tangents, the front stays outside.
    assert_eq!(
        place(2, [-4., 0., 0., 1., 0., 1., 0., 0., 0., 0., 1., 0.]),
        ETD_OK
    );
    let mut mirrored = mesh(&[5., -1., 2., -3., -1., 2., 1., 1., 2.], &[[0, 1, 2]]);
    let slope = glam::DVec3::new(-0.25, 1.0, 0.0).normalize();
    let slope = slope.to_array().map(|x| x as f32);
    mirrored.normals = Some(vec![slope, [0., 0., -1.], [-0., 1., 0.]]);
    d.shapes.push(Shape {
        emission: Some([1.0; 3]),
        ..shape(Geometry::Mesh(mirrored))
    });
    same(&builder, &d);
    // A transform takes the place of the one before, and spheres stay spheres.
    let stretched = [1., 0., 0., 0., 0., 2., 0., 0., 0., 0., 1., 0.];
    assert_eq!(place(1, stretched), ETD_E_ARGUMENT);
    same(&builder, &d);
    assert_eq!(
        place(1, [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.]),
        ETD_OK
    );
    d.shapes[1].geometry = Geometry::Sphere {
        center: [1.0, 0.0, 0.0],
        radius: 0.5,
        flipped: false,
    };
    same(&builder, &d);
    // Moved and back again: the refitted tree is the first one.
    let whole = bytes(&builder);
    let mut moved = sized();
    let mut built: EtdBuilt = sized();
    // SAFETY: good pointers.
    unsafe {
        for matrix in [turned, stretched] {
            let _ = place(0, matrix);
            let refit = etd_builder_refit(builder.0, &raw mut moved, &raw mut built);
            assert_eq!((refit, built.refitted), (ETD_OK, 1));
            let bytes = std::slice::from_raw_parts(moved.data, moved.size);
            assert!(bytes != whole);
            assert_eq!(etd_blob_free(&raw mut moved), ETD_OK);
        }
        let _ = place(0, [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.]);
        assert_eq!(
            etd_builder_refit(builder.0, &raw mut moved, &raw mut built),
            ETD_OK
        );
        let bytes = std::slice::from_raw_parts(moved.data, moved.size);
        assert!(bytes == whole && built.refitted == 1);
        assert_eq!(etd_blob_free(&raw mut moved), ETD_OK);
    }
}

#[test]
fn media() {
    static NUMBERS: [f32; 12] = [0.5; 12];
    let builder = Builder::small(null());
    let mut d = described();
    // A box of fog, and a ball in it.
    for (radius, id) in [(9.0, 1), (0.5, 2)] {
        let mut s = made(etd_sphere_default);
        s.radius = radius;
        let mut new = 0;
        // SAFETY: good pointers.
        let status = unsafe { etd_builder_add_sphere(builder.0, &s, &raw mut new) };
        assert_eq!((status, new), (ETD_OK, id));
        d.shapes.push(shape(Geometry::Sphere {
            center: [0.0; 3],
            radius,
            flipped: false,
        }));
    }
    let mut m = made(etd_medium_default);
    (m.sigma_t, m.albedo) = ([1.0, 2.0, 3.0], [0.25, 0.5, 0.75]);
    m.phase[0].weight = 0.0;
    m.phase[2] = EtdLobe {
        kind: ETD_PHASE_HG,
        g: -0.5,
        weight: 2.0,
    };
    m.phase[3] = EtdLobe {
        kind: ETD_PHASE_RAYLEIGH,
        weight: 6.0,
        ..m.phase[2]
    };
    let mut add = |m: &EtdMedium, medium: Medium| {
        let mut id = 99;
        // SAFETY: good pointers.
        let status = unsafe { etd_builder_add_medium(builder.0, m, &raw mut id) };
        assert_eq!((status, id as usize), (ETD_OK, d.media.len()));
        d.media.push(medium);
    };
    let lobe = |phase, weight| Lobe { phase, weight };
    let fog = Medium {
        sigma_t: m.sigma_t,
        albedo: m.albedo,
        phase: vec![
            lobe(Phase::HenyeyGreenstein { g: -0.5 }, 2.0),
            lobe(Phase::Rayleigh, 6.0),
        ],
        ..Medium::default()
    };
    add(&m, fog.clone());
    m.tracking = ETD_TRACK_REGULAR;
    m.emission = [4.0, 5.0, 6.0];
    m.to_grid = [
        [0.5, 0.0, 0.0, 0.5],
        [0.0, 0.5, 0.0, 0.5],
        [0.0, 0.0, 0.5, 0.5],
    ];
    let grid = |size, channels, nearest| EtdGrid {
        size,
        channels,
        nearest,
        reserved: 0,
        values: NUMBERS.as_ptr(),
        floats: 12,
    };
    (m.extinction, m.albedos) = (grid([1, 3, 4], 1, 1), grid([2, 1, 2], 3, 0));
    let gray = |size, nearest| Grid {
        size,
        values: GridValues::Gray(NUMBERS.to_vec()),
        nearest,
    };
    m.emissions = grid([1, 3, 4], 1, 1);
    let smoke = Medium {
        emission: m.emission,
        grids: Some(Grids {
            extinction: gray([1, 3, 4], true),
            albedo: Some(Grid {
                size: [2, 1, 2],
                values: GridValues::Rgb(vec![[0.5; 3]; 4]),
                nearest: false,
            }),
            emission: Some(gray([1, 3, 4], true)),
            to_grid: m.to_grid,
            tracking: Tracking::Regular,
        }),
        ..fog
    };
    add(&m, smoke);
    same(&builder, &d);
    for (object, [interior, exterior]) in [(1, [0, ETD_NONE]), (2, [1, 0])] {
        // SAFETY: a good builder.
        let status = unsafe { etd_builder_set_media(builder.0, object, interior, exterior) };
        assert_eq!(status, ETD_OK);
    }
    d.shapes[1].interior = Some(0);
    (d.shapes[2].interior, d.shapes[2].exterior) = (Some(1), Some(0));
    same(&builder, &d);
    let blob = compile(&d).unwrap().blob;
    let scene = etendue::Scene::open(blob.bytes()).unwrap();
    assert_eq!(scene.sensor().medium, 1, "the camera stands in the ball");
    // SAFETY: a good builder.
    let status = unsafe { etd_builder_set_media(builder.0, 2, 1, ETD_NONE) };
    assert_eq!(status, ETD_OK);
    let mut blob: EtdBlob = sized();
    // SAFETY: good pointers.
    let status = unsafe { etd_builder_build(builder.0, &raw mut blob, std::ptr::null_mut()) };
    assert_eq!(status, etendue::capi::status::ETD_E_SCENE);
    assert!(
        builder.message().contains("overlaps with"),
        "{}",
        builder.message()
    );
}
