//! Shapes: meshes from files, spheres exactly, boxes, rectangles and discs as triangles.

use super::Loader;
use super::plugin::Plugin;
use super::transform::similarity;
use crate::description::{Color, ColorSource, Geometry, Mesh, Model, Shape, Spectrum};
use crate::load::error::{LoadError, Problem};
use crate::load::mesh::Finish;
use crate::load::{RawMesh, obj, ply, serialized};
use glam::{DMat3, DVec3, Vec3};
use std::f32::consts::TAU;

const KNOWN: &str = "obj, ply, serialized, sphere, cube, rectangle or disk";
/// Triangles of a disc.
const FAN: u32 = 256;

impl Loader<'_> {
    /// Adds the shape at an element.
    pub fn shape(&mut self, index: usize) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        if ![
            "obj",
            "ply",
            "serialized",
            "sphere",
            "cube",
            "rectangle",
            "disk",
        ]
        .contains(&plugin.kind)
        {
            let later = [
                "cylinder",
                "instance",
                "shapegroup",
                "merge",
                "sdfgrid",
                "bsplinecurve",
                "linearcurve",
            ];
            return Err(if later.contains(&plugin.kind) {
                plugin.unsupported(format!("shape {}", plugin.kind), &format!("choose {KNOWN}"))
            } else {
                plugin.unknown(KNOWN)
            });
        }
        let [interior, exterior] = self.sides(&plugin)?;
        let surface = match plugin.object("bsdf")? {
            Some(bsdf) => self.surface(bsdf)?,
            None => self.default_surface(),
        };
        let emitted = match plugin.object("emitter")? {
            Some(emitter) => self.area(emitter)?,
            None => None,
        };
        let (emission, spectrum) = match emitted {
            Some((color, spectrum)) => (Some(color), spectrum),
            None => (None, None),
        };
        let geometry = match plugin.kind {
            "sphere" => {
                let textured = [surface.front, surface.back]
                    .iter()
                    .flatten()
                    .any(|&m| self.textured(m))
                    || matches!(surface.opacity, Some(ColorSource::Texture(_)));
                self.sphere(&plugin, textured)?
            }
            _ => Geometry::Mesh(self.mesh(&plugin)?),
        };
        plugin.ignore(&["silhouette_sampling_weight"])?;
        plugin.finish()?;
        if emission.is_some()
            && let Geometry::Mesh(mesh) = &geometry
            && !has_area(mesh)
        {
            let text = "emits from triangles of no area, expected a surface";
            return Err(plugin.error(Problem::Malformed(text.into())));
        }
        let name = self.name(plugin.node);
        self.out.shapes.push(Shape {
            name,
            place: plugin.node.place.clone(),
            geometry,
            front: surface.front,
            back: surface.back,
            emission,
            spectrum,
            opacity: surface.opacity,
            interior,
            exterior,
        });
        Ok(())
    }

    fn area(&mut self, index: usize) -> Result<Option<(Color, Option<Spectrum>)>, LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        if plugin.kind != "area" {
            return Err(plugin.unknown("area (others stand outside of shapes)"));
        }
        let (radiance, spectrum) = plugin.light("radiance")?;
        plugin.ignore(&["sampling_weight"])?;
        plugin.finish()?;
        Ok((radiance != [0.0; 3]).then_some((radiance, spectrum)))
    }

    fn textured(&self, material: usize) -> bool {
        let model = &self.out.materials[material].model;
        let parts = match model {
            Model::Blend { parts, .. } => parts.as_slice(),
            _ => &[],
        };
        let is = |s: &ColorSource| matches!(s, ColorSource::Texture(_));
        model.colors().iter().any(is) || parts.iter().any(|&part| self.textured(part))
    }

    fn sphere(&mut self, plugin: &Plugin, textured: bool) -> Result<Geometry, LoadError> {
        let center = plugin.vector("center")?.unwrap_or([0.0; 3]);
        let radius = plugin.positive("radius")?.unwrap_or(1.0);
        let flip = plugin.boolean("flip_normals")?.unwrap_or(false);
        let to_world = plugin.transform("to_world")?;
        let linear = DMat3::from_mat4(to_world);
        let Some(scale) = similarity(&linear) else {
            let found = format!(
                "scale {:.4} {:.4} {:.4} or shear",
                linear.x_axis.length(),
                linear.y_axis.length(),
                linear.z_axis.length()
            );
            return Err(plugin.invalid(
                "to_world",
                "of one scale in all directions (a sphere stays one)",
                found,
            ));
        };
        if textured
            && (linear / scale - DMat3::IDENTITY)
                .to_cols_array()
                .iter()
                .any(|x| x.abs() > 1e-4)
        {
            self.warn(plugin.node, "sphere: its texture isn't turned by to_world");
        }
        let radius = (f64::from(radius) * scale) as f32;
        let center = to_world.transform_point3(DVec3::from(center)).as_vec3();
        if !(radius > 0.0 && radius.is_finite() && center.is_finite()) {
            return Err(plugin.invalid("radius", "> 0 and finite in the world", radius));
        }
        Ok(Geometry::Sphere {
            center: center.to_array(),
            radius,
            flipped: flip != (linear.determinant() < 0.0),
        })
    }

    fn mesh(&mut self, plugin: &Plugin) -> Result<Mesh, LoadError> {
        let flag = |name| Ok(plugin.boolean(name)?.unwrap_or(false));
        let to_world = plugin.transform("to_world")?;
        let file = match plugin.kind {
            "obj" | "ply" | "serialized" => plugin.file("filename")?,
            _ => plugin.node.place.file.clone(),
        };
        let raw = match plugin.kind {
            "obj" => {
                let flip = plugin.boolean("flip_tex_coords")?.unwrap_or(true);
                obj::load(&file, flip, &mut self.warnings)?
            }
            "ply" => {
                let mut raw = ply::load(&file)?;
                if flag("flip_tex_coords")? {
                    raw.uvs
                        .iter_mut()
                        .flatten()
                        .for_each(|uv| uv[1] = 1.0 - uv[1]);
                }
                raw
            }
            "serialized" => {
                let index = plugin
                    .integer_in("shape_index", 0, i64::from(i32::MAX))?
                    .unwrap_or(0);
                serialized::load(&file, index as usize)?
            }
            "cube" => cube(),
            "rectangle" => rectangle(),
            _ => {
                let text = format!("disk: drawn as {FAN} triangles of the disc's area");
                self.warn(plugin.node, text);
                disc()
            }
        };
        let flat = matches!(plugin.kind, "cube" | "rectangle" | "disk");
        let finish = Finish {
            face_normals: flag("face_normals")?,
            flip_normals: flag("flip_normals")?,
            flat,
        };
        let mut mesh = raw.finish(&to_world, finish, &file, &mut self.warnings)?;
        mesh.triangles.shrink_to_fit();
        Ok(mesh)
    }
}

fn has_area(mesh: &Mesh) -> bool {
    mesh.triangles.iter().any(|t| {
        let [a, b, c] = t.map(|i| Vec3::from(mesh.positions[i as usize]).as_dvec3());
        (b - a).cross(c - a).length() > 0.0
    })
}

/// [−1, 1]² in z = 0, facing +z.
fn rectangle() -> RawMesh {
    RawMesh {
        positions: vec![
            [-1.0, -1.0, 0.0],
            [1.0, -1.0, 0.0],
            [-1.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
        ],
        normals: Some(vec![[0.0, 0.0, 1.0]; 4]),
        uvs: Some(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]),
        triangles: vec![[1, 2, 0], [1, 3, 2]],
        face_normals: false,
    }
}

/// [−1, 1]³; every face spans the unit square of (u, v).
fn cube() -> RawMesh {
    // Normal and corners of each face, counter-clockwise from outside.
    const FACES: [([f32; 3], [[f32; 3]; 4]); 6] = [
        (
            [0., -1., 0.],
            [
                [1., -1., -1.],
                [1., -1., 1.],
                [-1., -1., 1.],
                [-1., -1., -1.],
            ],
        ),
        (
            [0., 1., 0.],
            [[1., 1., -1.], [-1., 1., -1.], [-1., 1., 1.], [1., 1., 1.]],
        ),
        (
            [1., 0., 0.],
            [[1., -1., -1.], [1., 1., -1.], [1., 1., 1.], [1., -1., 1.]],
        ),
        (
            [0., 0., 1.],
            [[1., -1., 1.], [1., 1., 1.], [-1., 1., 1.], [-1., -1., 1.]],
        ),
        (
            [-1., 0., 0.],
            [
                [-1., -1., 1.],
                [-1., 1., 1.],
                [-1., 1., -1.],
                [-1., -1., -1.],
            ],
        ),
        (
            [0., 0., -1.],
            [
                [1., 1., -1.],
                [1., -1., -1.],
                [-1., -1., -1.],
                [-1., 1., -1.],
            ],
        ),
    ];
    let mut mesh = RawMesh {
        normals: Some(Vec::new()),
        uvs: Some(Vec::new()),
        ..RawMesh::default()
    };
    for (i, (normal, corners)) in FACES.iter().enumerate() {
        let base = 4 * i as u32;
        mesh.positions.extend(corners);
        mesh.normals.iter_mut().for_each(|n| n.extend([*normal; 4]));
        mesh.uvs
            .iter_mut()
            .for_each(|u| u.extend([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]));
        mesh.triangles
            .extend([[base, base + 1, base + 2], [base + 3, base, base + 2]]);
    }
    mesh
}

/// The unit disc in z = 0, facing +z, u = radius and v = angle; as a fan that has the disc's area.
fn disc() -> RawMesh {
    let mut mesh = RawMesh {
        uvs: Some(Vec::new()),
        ..RawMesh::default()
    };
    let step = TAU / FAN as f32;
    let radius = (step / step.sin()).sqrt();
    let rim = |i: u32| {
        let angle = (i % FAN) as f32 * step;
        [radius * angle.cos(), radius * angle.sin(), 0.0]
    };
    for i in 0..FAN {
        let base = 3 * i;
        let turn = |k: f32| (i as f32 + k) / FAN as f32;
        mesh.positions.extend([[0.0; 3], rim(i), rim(i + 1)]);
        mesh.uvs
            .iter_mut()
            .for_each(|u| u.extend([[0.0, turn(0.5)], [1.0, turn(0.0)], [1.0, turn(1.0)]]));
        mesh.triangles.push([base, base + 1, base + 2]);
    }
    mesh.normals = Some(vec![[0.0, 0.0, 1.0]; mesh.positions.len()]);
    mesh
}
