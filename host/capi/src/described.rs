//! What C has described so far.

use etendue_host::description::{Description, Geometry, Shape};
use glam::{DMat3, DMat4, DVec3};

/// What has been said so far: a description whose shapes wait, unmoved, in `objects`.
#[derive(Default)]
pub(crate) struct Described {
    pub rest: Description,
    pub objects: Vec<Object>,
}

impl std::ops::Deref for Described {
    type Target = Description;
    fn deref(&self) -> &Description {
        &self.rest
    }
}

impl std::ops::DerefMut for Described {
    fn deref_mut(&mut self) -> &mut Description {
        &mut self.rest
    }
}

/// An object where it was given, and where it is.
pub(crate) struct Object {
    pub shape: Shape,
    pub to_world: DMat4,
}

impl Object {
    /// Puts it somewhere else.
    pub fn place(&mut self, to_world: DMat4) -> Result<(), String> {
        if matches!(self.shape.geometry, Geometry::Sphere { .. }) {
            let square = DMat3::from_mat4(to_world);
            let square = square.transpose() * square;
            let scale = square.col(0).x;
            let off = (square * (1.0 / scale) - DMat3::IDENTITY).to_cols_array();
            if !off.iter().all(|x| x.abs() <= 1e-4) {
                return Err(
                    "matrix: a sphere may be moved, turned and scaled, not stretched".into(),
                );
            }
        }
        self.to_world = to_world;
        Ok(())
    }

    /// A copy in world space.
    pub fn in_world(&self) -> Shape {
        let mut shape = self.shape.clone();
        // Bit for bit what was given.
        if self.to_world == DMat4::IDENTITY {
            return shape;
        }
        let linear = DMat3::from_mat4(self.to_world);
        let point = |p: [f32; 3]| {
            let p = self
                .to_world
                .transform_point3(DVec3::from(p.map(f64::from)));
            p.to_array().map(|x| x as f32)
        };
        match &mut shape.geometry {
            Geometry::Mesh(mesh) => {
                for p in &mut mesh.positions {
                    *p = point(*p);
                }
                let to_normal = linear.inverse().transpose();
                for n in mesh.normals.iter_mut().flatten() {
                    let turned = to_normal * DVec3::from(n.map(f64::from));
                    *n = turned.normalize_or_zero().to_array().map(|x| x as f32);
                }
                if linear.determinant() < 0.0 {
                    for t in &mut mesh.triangles {
                        t.swap(1, 2);
                    }
                }
            }
            Geometry::Sphere { center, radius, .. } => {
                *center = point(*center);
                *radius = (f64::from(*radius) * linear.determinant().abs().cbrt()) as f32;
            }
        }
        shape
    }
}
