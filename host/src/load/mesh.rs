//! Triangles from files and built-in shapes to the world: transform, orientation, normals.

use super::error::{LoadError, file_place};
use crate::description::Mesh;
use glam::{DMat3, DMat4, DVec3, Vec3};
use std::path::Path;

/// Triangles as a file has them, before its transform.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// Positions.
    pub positions: Vec<[f32; 3]>,
    /// Normals of the file, one per position.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Texture coordinates, one per position.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// The file itself asks for flat shading.
    pub face_normals: bool,
}

/// How a shape wants its triangles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Finish {
    /// Flat shading: normals of the file are discarded, none are computed.
    pub face_normals: bool,
    /// Front and back change places.
    pub flip_normals: bool,
    /// The shape is flat-faced: its normals say what is outside and are then dropped.
    pub flat: bool,
}

impl RawMesh {
    /// Refuses what no mesh may hold: no triangles, indices out of range, numbers that aren't finite.
    pub fn check(&self, path: &Path) -> Result<(), LoadError> {
        let bad = |text: String| Err(LoadError::malformed(path, 0, text));
        if self.triangles.is_empty() {
            return bad("mesh has 0 triangles, expected at least 1".into());
        }
        let count = self.positions.len();
        if count > u32::MAX as usize || self.triangles.len() > (u32::MAX / 4) as usize {
            return bad(format!("mesh of {count} vertices, expected less than 2^32"));
        }
        if let Some(i) = not_finite(&self.positions) {
            return bad(format!(
                "vertex {i} is {:?}, expected finite numbers",
                self.positions[i]
            ));
        }
        if let Some(normals) = &self.normals
            && let Some(i) = not_finite(normals)
        {
            return bad(format!(
                "normal of vertex {i} is {:?}, expected finite numbers",
                normals[i]
            ));
        }
        if let Some(uvs) = &self.uvs
            && let Some(i) = not_finite(uvs)
        {
            return bad(format!(
                "texture coordinate of vertex {i} is {:?}, expected finite numbers",
                uvs[i]
            ));
        }
        let wrong = self
            .triangles
            .iter()
            .position(|t| t.iter().any(|&i| i as usize >= count));
        match wrong {
            Some(t) => bad(format!(
                "triangle {t} has vertices {:?}, expected indices below {count}",
                self.triangles[t]
            )),
            None => Ok(()),
        }
    }

    /// Into the world. Normals of the file say what is outside: a triangle that runs the other way
    /// (a mirror does that) is turned. Computed normals follow the triangles.
    pub fn finish(
        mut self,
        to_world: &DMat4,
        finish: Finish,
        path: &Path,
        warnings: &mut Vec<String>,
    ) -> Result<Mesh, LoadError> {
        self.check(path)?;
        if *to_world != DMat4::IDENTITY {
            for p in &mut self.positions {
                let q = to_world
                    .transform_point3(Vec3::from(*p).as_dvec3())
                    .as_vec3();
                *p = q.to_array();
            }
            if let Some(i) = not_finite(&self.positions) {
                return Err(LoadError::malformed(
                    path,
                    0,
                    format!(
                        "vertex {i} transformed is {:?}, expected finite numbers",
                        self.positions[i]
                    ),
                ));
            }
        }
        let discard = (finish.face_normals || self.face_normals) && !finish.flat;
        let mut normals = if discard {
            None
        } else if let Some(mut normals) = self.normals.take() {
            let zeros = transform_normals(&mut normals, to_world);
            self.turn_towards(&normals);
            if zeros > 0 && !finish.flat {
                warnings.push(format!(
                    "{}: {zeros} vertex normals are zero and were computed instead",
                    file_place(path, 0).file.display()
                ));
                let computed = smooth_normals(&self.positions, &self.triangles);
                for (n, c) in normals.iter_mut().zip(computed) {
                    if *n == [0.0; 3] {
                        *n = c;
                    }
                }
            }
            Some(normals)
        } else {
            Some(smooth_normals(&self.positions, &self.triangles))
        };
        if finish.flip_normals {
            for t in &mut self.triangles {
                t.swap(1, 2);
            }
            for n in normals.iter_mut().flatten() {
                *n = n.map(|x| -x);
            }
        }
        if finish.flat {
            normals = None;
        }
        Ok(Mesh {
            positions: self.positions,
            normals,
            uvs: self.uvs,
            triangles: self.triangles,
        })
    }

    fn turn_towards(&mut self, normals: &[[f32; 3]]) {
        let positions = &self.positions;
        for t in &mut self.triangles {
            let sum: Vec3 = t.iter().map(|&i| Vec3::from(normals[i as usize])).sum();
            if geometric(positions, t).dot(sum.as_dvec3()) < 0.0 {
                t.swap(1, 2);
            }
        }
    }
}

fn not_finite<const N: usize>(values: &[[f32; N]]) -> Option<usize> {
    values.iter().position(|v| !v.iter().all(|x| x.is_finite()))
}

fn geometric(positions: &[[f32; 3]], t: &[u32; 3]) -> DVec3 {
    let [a, b, c] = t.map(|i| Vec3::from(positions[i as usize]).as_dvec3());
    (b - a).cross(c - a)
}

/// By the inverse transpose, to unit length; how many were zero (and stay so).
fn transform_normals(normals: &mut [[f32; 3]], to_world: &DMat4) -> usize {
    let matrix = DMat3::from_mat4(*to_world).inverse().transpose();
    let mut zeros = 0;
    for n in normals {
        let v = matrix * Vec3::from(*n).as_dvec3();
        let length = v.length();
        *n = if length > 0.0 && length.is_finite() {
            (v / length).as_vec3().to_array()
        } else {
            zeros += 1;
            [0.0; 3]
        };
    }
    zeros
}

/// Vertex normals weighted by the angle of each triangle at the vertex (Thürmer & Wüthrich 1998).
fn smooth_normals(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    let mut any = vec![Vec3::ZERO; positions.len()];
    for t in triangles {
        let n = geometric(positions, t);
        let length = n.length();
        if length == 0.0 {
            continue;
        }
        let n = n / length;
        let v = t.map(|i| Vec3::from(positions[i as usize]).as_dvec3());
        for k in 0..3 {
            let a = (v[(k + 1) % 3] - v[k]).normalize_or_zero();
            let b = (v[(k + 2) % 3] - v[k]).normalize_or_zero();
            // Kahan's form keeps small and wide angles.
            let angle = 2.0 * (a - b).length().atan2((a + b).length());
            sums[t[k] as usize] += n * angle;
            any[t[k] as usize] = n.as_vec3();
        }
    }
    let fall_back = |n: Vec3| if n == Vec3::ZERO { Vec3::X } else { n };
    sums.iter()
        .zip(&any)
        .map(|(s, a)| {
            let length = s.length();
            if length > 1e-9 {
                (*s / length).as_vec3()
            } else {
                fall_back(*a)
            }
            .to_array()
        })
        .collect()
}
