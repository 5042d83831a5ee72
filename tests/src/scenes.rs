//! Scenes in code: descriptions that tests build, piece by piece.

use etendue_host::description::{
    Color, ColorSource, Description, Emitter, EmitterKind, Geometry, Grid, GridValues, Grids,
    Material, Medium, Mesh, Model, Phase, Place, Projection, Sensor, Shape,
};

/// A point or direction.
pub type V = [f32; 3];

/// A scene under construction.
#[derive(Clone, Default)]
pub struct Builder {
    /// What has been built so far.
    pub description: Description,
}

impl Builder {
    /// Nothing yet, and a 16×16 image.
    pub fn new() -> Self {
        let mut b = Self::default();
        b.description.sensor.resolution = [16, 16];
        b
    }

    /// A camera at `eye` that looks at `target`; `fov` across the image in degrees.
    pub fn camera(mut self, eye: V, target: V, up: V, fov: f32, resolution: [u32; 2]) -> Self {
        let v = |a: V| glam::Vec3::from(a);
        let forward = (v(target) - v(eye)).normalize();
        let right = forward.cross(v(up)).normalize();
        let down = forward.cross(right);
        let tangent = (0.5 * fov.to_radians()).tan();
        self.description.sensor = Sensor {
            projection: Projection::Perspective {
                half_tangent: [
                    tangent,
                    tangent * resolution[1] as f32 / resolution[0] as f32,
                ],
                aperture: 0.0,
                focus: 1.0,
            },
            origin: eye,
            right: right.into(),
            down: down.into(),
            forward: forward.into(),
            clip: [1e-4, 1e6],
            resolution,
            ..Sensor::default()
        };
        self
    }

    /// Adds a local model.
    pub fn material(&mut self, model: Model) -> usize {
        let name = format!("material {}", self.description.materials.len());
        self.description.materials.push(Material { name, model });
        self.description.materials.len() - 1
    }

    /// Adds a diffuse reflector.
    pub fn diffuse(&mut self, reflectance: Color) -> usize {
        self.material(Model::Diffuse {
            reflectance: ColorSource::Constant(reflectance),
            transmittance: ColorSource::Constant([0.0; 3]),
        })
    }

    /// Adds a smooth dielectric.
    pub fn glass(&mut self, ior: f32) -> usize {
        self.material(Model::Dielectric {
            ior,
            reflectance: ColorSource::Constant([1.0; 3]),
            transmittance: ColorSource::Constant([1.0; 3]),
            schlick: false,
        })
    }

    /// Adds a mirror.
    pub fn mirror(&mut self, reflectance: f32) -> usize {
        self.material(Model::Mirror {
            reflectance: ColorSource::Constant([reflectance; 3]),
        })
    }

    /// Adds a local model that lets light pass: the boundary of a medium.
    pub fn null(&mut self) -> usize {
        self.material(Model::Null)
    }

    /// Adds a medium that is the same everywhere, with one phase function and without emission.
    pub fn medium(&mut self, sigma_t: Color, albedo: Color, phase: Phase) -> usize {
        self.matter(Medium {
            sigma_t,
            albedo,
            phase: vec![phase.into()],
            ..Medium::default()
        })
    }

    /// Adds a medium whose extinction is `sigma_t` times a grid over the box from `low` to `high`.
    pub fn smoke(&mut self, low: V, high: V, extinction: Grid, medium: Medium) -> usize {
        let to_grid = std::array::from_fn(|i| {
            let mut row = [0.0; 4];
            row[i] = 1.0 / (high[i] - low[i]);
            row[3] = -low[i] * row[i];
            row
        });
        self.matter(Medium {
            grids: Some(Grids {
                extinction,
                albedo: None,
                emission: None,
                to_grid,
                tracking: Default::default(),
            }),
            ..medium
        })
    }

    /// Adds a medium.
    pub fn matter(&mut self, mut medium: Medium) -> usize {
        medium.name = format!("medium {}", self.description.media.len());
        self.description.media.push(medium);
        self.description.media.len() - 1
    }

    /// Adds an object; both sides have `material`.
    pub fn shape(&mut self, geometry: Geometry, material: Option<usize>) -> &mut Shape {
        let name = format!("shape {}", self.description.shapes.len());
        self.description.shapes.push(Shape {
            name,
            place: Place::default(),
            geometry,
            front: material,
            back: material,
            emission: None,
            spectrum: None,
            opacity: None,
            interior: None,
            exterior: None,
        });
        self.description.shapes.last_mut().unwrap()
    }

    /// Adds a parallelogram `corner` + s·`a` + t·`b`; its normal is a × b.
    pub fn quad(&mut self, corner: V, a: V, b: V, material: Option<usize>) -> &mut Shape {
        let add = |p: V, q: V| std::array::from_fn(|i| p[i] + q[i]);
        let positions = vec![
            corner,
            add(corner, a),
            add(add(corner, a), b),
            add(corner, b),
        ];
        let mesh = Mesh {
            positions,
            normals: None,
            uvs: Some(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        self.shape(Geometry::Mesh(mesh), material)
    }

    /// Adds an axis-aligned box; normals point outwards, or inwards if `inside`.
    pub fn cuboid(&mut self, low: V, high: V, inside: bool, material: Option<usize>) -> &mut Shape {
        let corner = |i: usize| -> V {
            std::array::from_fn(|a| if i >> a & 1 == 0 { low[a] } else { high[a] })
        };
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let mut mesh = Mesh::default();
        for face in faces {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(face.map(corner));
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                mesh.triangles.push(if inside {
                    [first + a, first + c, first + b]
                } else {
                    [first + a, first + b, first + c]
                });
            }
        }
        self.shape(Geometry::Mesh(mesh), material)
    }

    /// Adds an exact sphere.
    pub fn sphere(&mut self, center: V, radius: f32, material: Option<usize>) -> &mut Shape {
        self.shape(
            Geometry::Sphere {
                center,
                radius,
                flipped: false,
            },
            material,
        )
    }

    /// Adds a box of `medium` that light enters freely.
    pub fn fog(&mut self, low: V, high: V, medium: usize) -> &mut Shape {
        let null = self.null();
        let shape = self.cuboid(low, high, false, Some(null));
        shape.interior = Some(medium);
        shape
    }

    /// Adds a sphere of `medium` behind `material`.
    pub fn ball(&mut self, center: V, radius: f32, material: usize, medium: usize) -> &mut Shape {
        let shape = self.sphere(center, radius, Some(material));
        shape.interior = Some(medium);
        shape
    }

    /// Adds a light that isn't a shape.
    pub fn light(&mut self, kind: EmitterKind) {
        self.description.emitters.push(Emitter {
            spectrum: None,
            name: "light".into(),
            place: Place::default(),
            kind,
            medium: None,
        });
    }

    /// Everything scaled by `k` and then moved by `by`: what radiance shouldn't notice (point lights aside).
    pub fn transformed(mut self, k: f32, by: V) -> Self {
        let place = |p: &mut V| *p = std::array::from_fn(|i| p[i] * k + by[i]);
        for s in &mut self.description.shapes {
            match &mut s.geometry {
                Geometry::Mesh(m) => m.positions.iter_mut().for_each(place),
                Geometry::Sphere { center, radius, .. } => {
                    place(center);
                    *radius *= k;
                }
            }
        }
        let sensor = &mut self.description.sensor;
        place(&mut sensor.origin);
        sensor.clip = sensor.clip.map(|c| c * k);
        match &mut sensor.projection {
            Projection::Perspective {
                aperture, focus, ..
            } => {
                *aperture *= k;
                *focus *= k;
            }
            Projection::Orthographic { half_extent } => *half_extent = half_extent.map(|h| h * k),
            Projection::Panorama => (),
        }
        self
    }
}

/// Henyey and Greenstein's phase function, or the isotropic one that it is for g = 0.
pub fn phase(g: f32) -> Phase {
    if g == 0.0 {
        Phase::Isotropic
    } else {
        Phase::HenyeyGreenstein { g }
    }
}

/// A trilinear grid of one channel: `value` of each texel's place in the unit cube.
pub fn grid(size: [u32; 3], value: impl Fn(V) -> f32) -> Grid {
    let place = |i: u32, n: u32| (i as f32 + 0.5) / n as f32;
    let [w, h, d] = size;
    let mut values = Vec::new();
    for z in 0..d {
        for y in 0..h {
            values.extend((0..w).map(|x| value([place(x, w), place(y, h), place(z, d)])));
        }
    }
    Grid {
        size,
        values: GridValues::Gray(values),
        nearest: false,
    }
}

/// A mesh around an axis: `rings` + 1 rings of `sectors` vertices, of which `vertex(ring, sector)` gives position and normal.
pub fn round(rings: u32, sectors: u32, vertex: impl Fn(u32, u32) -> (V, V)) -> Mesh {
    let mut mesh = Mesh::default();
    let mut normals = Vec::new();
    for i in 0..=rings {
        for j in 0..sectors {
            let (position, normal) = vertex(i, j);
            mesh.positions.push(position);
            normals.push(normal);
        }
    }
    for i in 0..rings {
        for j in 0..sectors {
            let at = |i: u32, j: u32| i * sectors + j % sectors;
            mesh.triangles
                .push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.triangles
                .push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    mesh.normals = Some(normals);
    mesh
}

/// A small room: diffuse walls, a lamp under the ceiling, and what `furnish` puts into it.
pub fn room(furnish: impl FnOnce(&mut Builder)) -> Builder {
    let mut b = Builder::new().camera(
        [0.0, -3.4, 1.0],
        [0.0, 0.0, 0.9],
        [0.0, 0.0, 1.0],
        40.0,
        [16, 16],
    );
    let white = Some(b.diffuse([0.7, 0.7, 0.7]));
    let red = Some(b.diffuse([0.6, 0.1, 0.1]));
    let green = Some(b.diffuse([0.1, 0.6, 0.1]));
    b.quad([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], white);
    b.quad([-1.0, -1.0, 2.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], white);
    b.quad([-1.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], white);
    b.quad([-1.0, -1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], red);
    b.quad([1.0, -1.0, 0.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0], green);
    b.quad([-0.3, -0.3, 1.98], [0.0, 0.6, 0.0], [0.6, 0.0, 0.0], white)
        .emission = Some([9.0, 8.0, 6.0]);
    furnish(&mut b);
    b
}
