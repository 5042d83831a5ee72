//! The scene of `kernel/examples/c/build_scene.c`, described in Rust: the same bits must come out.

use etendue::{Estimator, Scene, Settings};
use etendue_host::compile::{compile, recompile};
use etendue_host::description::{
    ColorSource, Description, Filter, Geometry, Material, Mesh, Model, Place, Projection, Sensor,
    Shape,
};
use etendue_host::render::{Budget, Device, Options, render};
use std::sync::atomic::AtomicBool;

type Points = Vec<[f32; 3]>;

fn points<const N: usize>(numbers: [f32; N]) -> Points {
    numbers.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
}

fn shape(
    positions: Points,
    triangles: &[u32],
    material: usize,
    emission: Option<[f32; 3]>,
) -> Shape {
    Shape {
        spectrum: None,
        name: String::new(),
        place: Place::default(),
        geometry: Geometry::Mesh(Mesh {
            positions,
            normals: None,
            uvs: None,
            triangles: triangles.chunks(3).map(|t| [t[0], t[1], t[2]]).collect(),
        }),
        front: Some(material),
        back: Some(material),
        emission,
        opacity: None,
        interior: None,
        exterior: None,
    }
}

fn quad(corners: [f32; 12], material: usize, emission: Option<[f32; 3]>) -> Shape {
    shape(points(corners), &[0, 1, 2, 0, 2, 3], material, emission)
}

/// As `put` in C: width, height, x, z, cosine, sine.
fn cube([width, height, x, z, c, s]: [f32; 6]) -> Shape {
    let corners = points([
        0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0., 0., 1., 1., 0., 1., 1., 1., 1., 0., 1.,
        1.,
    ]);
    let triangles = [
        0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 3, 7, 6, 3, 6, 2, 0, 4, 7, 0, 7, 3,
        1, 2, 6, 1, 6, 5,
    ];
    let rows = [
        [width * c, 0.0, width * s, x],
        [0.0, height, 0.0, 0.0],
        [-width * s, 0.0, width * c, z],
    ];
    let columns = [0, 1, 2, 3].map(|i| glam::DVec3::from(rows.map(|row| f64::from(row[i]))));
    let place = |p: [f32; 3]| {
        let [x, y, z] = p.map(f64::from);
        let q = columns[0] * x + columns[1] * y + columns[2] * z + columns[3];
        q.to_array().map(|x| x as f32)
    };
    shape(
        corners.into_iter().map(place).collect(),
        &triangles,
        0,
        None,
    )
}

fn description(small: [f32; 6]) -> Description {
    let diffuse = |color| Material {
        name: String::new(),
        model: Model::Diffuse {
            reflectance: ColorSource::Constant(color),
            transmittance: ColorSource::Constant([0.0; 3]),
        },
    };
    #[rustfmt::skip]
    let shapes = vec![
        quad([0., 0., 0., 0., 0., 560., 560., 0., 560., 560., 0., 0.], 0, None),
        quad([0., 550., 0., 560., 550., 0., 560., 550., 560., 0., 550., 560.], 0, None),
        quad([0., 0., 560., 0., 550., 560., 560., 550., 560., 560., 0., 560.], 0, None),
        quad([0., 0., 0., 0., 550., 0., 0., 550., 560., 0., 0., 560.], 2, None),
        quad([560., 0., 0., 560., 0., 560., 560., 550., 560., 560., 550., 0.], 1, None),
        quad([213., 549., 227., 343., 549., 227., 343., 549., 332., 213., 549., 332.], 0, Some([17., 12., 4.])),
        cube(small),
        cube([165., 330., 314., 245., 0.96, -0.28]),
    ];
    let tangent = (0.5 * f64::from(0.686_f32)).tan() as f32;
    Description {
        sensor: Sensor {
            projection: Projection::Perspective {
                half_tangent: [tangent; 2],
                aperture: 0.0,
                focus: 1.0,
            },
            origin: [278., 273., -800.],
            resolution: [128; 2],
            filter: Filter::Box { radius: 0.5 },
            medium: None,
            ..Sensor::default()
        },
        shapes,
        materials: vec![
            diffuse([0.725, 0.71, 0.68]),
            diffuse([0.63, 0.065, 0.05]),
            diffuse([0.14, 0.45, 0.091]),
        ],
        ..Description::default()
    }
}

/// What the program prints when it is asked for so many samples.
pub fn printed(samples: u64) -> String {
    let first = compile(&description([165., 165., 82., 225., 0.96, 0.28])).unwrap();
    let moved = description([165., 165., 150., 100., 0.8, 0.6]);
    let moved = recompile(&moved, &first.tree).unwrap();
    let jobs = [
        (&first, Estimator::Path),
        (&first, Estimator::Light),
        (&first, Estimator::Bidirectional),
        (&moved, Estimator::Bidirectional),
    ];
    jobs.map(|(compiled, estimator)| {
        let scene = Scene::open(compiled.blob.bytes()).unwrap();
        let options = Options {
            settings: Settings {
                estimator,
                ..Settings::default()
            },
            budget: Budget::Passes(samples),
            threads: 1,
            device: Device::Cpu,
        };
        let image = render(&scene, &options, &AtomicBool::new(false), &|_| ()).unwrap();
        let bytes = image.image.as_flattened().iter();
        // FNV-1a.
        let hash = bytes
            .flat_map(|x| x.to_bits().to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325_u64, |h, byte| {
                (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        format!("{hash:016x}\n")
    })
    .concat()
}
