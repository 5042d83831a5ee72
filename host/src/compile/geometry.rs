//! All geometry in flat lists, and what can be said of it at once.

use crate::description::{Geometry, Mesh};
use etendue::blob::MAX_COORDINATE;
use etendue::blob::format::{Shape, Sphere, Triangle};

/// All geometry in flat lists.
#[derive(Default)]
pub(super) struct Flat {
    pub corners: Vec<[[f32; 3]; 3]>,
    pub triangles: Vec<Triangle>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub spheres: Vec<([f32; 3], f32)>,
    pub sphere_records: Vec<Sphere>,
    low: Option<[f32; 3]>,
    high: [f32; 3],
}

impl Flat {
    /// Adds a mesh; returns its area.
    pub fn mesh(&mut self, id: u32, mesh: &Mesh, shape: &mut Shape) -> Result<f64, String> {
        let too_many = || "more vertices than the format can count (2³²)".to_string();
        shape.vertices = u32::try_from(mesh.positions.len()).map_err(|_| too_many())?;
        for p in &mesh.positions {
            self.grow(*p, 0.0)?;
        }
        if let Some(normals) = &mesh.normals {
            shape.normals = u32::try_from(self.normals.len()).map_err(|_| too_many())?;
            self.normals.extend(normals.iter().map(|n| unit(*n)));
        }
        if let Some(uvs) = &mesh.uvs {
            shape.uvs = u32::try_from(self.uvs.len()).map_err(|_| too_many())?;
            self.uvs.extend_from_slice(uvs);
        }
        let mut area = 0.0;
        for index in &mesh.triangles {
            let corner = |i: u32| {
                let p = mesh.positions.get(i as usize).copied();
                p.ok_or_else(|| format!("vertex {i} of {}", mesh.positions.len()))
            };
            let corners = [corner(index[0])?, corner(index[1])?, corner(index[2])?];
            area += triangle_area(&corners);
            self.corners.push(corners);
            self.triangles.push(Triangle {
                index: *index,
                shape: id,
            });
        }
        Ok(area)
    }

    /// Adds a sphere; returns its area.
    pub fn sphere(
        &mut self,
        shape: u32,
        center: [f32; 3],
        radius: f32,
        flipped: bool,
    ) -> Result<f64, String> {
        if !(radius > 0.0 && radius <= MAX_COORDINATE) {
            return Err(format!(
                "a sphere's radius must be in (0, 1e12], found {radius}"
            ));
        }
        self.grow(center, radius)?;
        self.spheres.push((center, radius));
        self.sphere_records.push(Sphere {
            center,
            radius,
            shape,
            flipped: u32::from(flipped),
            reserved: [0; 2],
        });
        Ok(sphere_area(radius))
    }

    /// Makes the bounds hold a ball around `p`.
    fn grow(&mut self, p: [f32; 3], radius: f32) -> Result<(), String> {
        if !p.iter().all(|x| x.abs() <= MAX_COORDINATE) {
            return Err(format!(
                "coordinates must be finite and within ±1e12, found {p:?}"
            ));
        }
        let low = self.low.get_or_insert([f32::INFINITY; 3]);
        if low[0] == f32::INFINITY {
            self.high = [f32::NEG_INFINITY; 3];
        }
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis] - radius);
            self.high[axis] = self.high[axis].max(p[axis] + radius);
        }
        Ok(())
    }

    /// A sphere around everything, a little larger than need be.
    pub fn bounds(&self) -> ([f32; 3], f32) {
        let Some(low) = self.low else {
            return ([0.0; 3], 1.0);
        };
        let center: [f32; 3] = std::array::from_fn(|i| 0.5 * (low[i] + self.high[i]));
        let square: f64 = (0..3)
            .map(|i| f64::from(self.high[i]) - f64::from(center[i]))
            .map(|x| x * x)
            .sum();
        let size = center.iter().fold(0.0f32, |m, x| m.max(x.abs()));
        let radius = square.sqrt() as f32 * 1.0001 + size * 1e-6;
        (center, radius.max(f32::MIN_POSITIVE * 16.0))
    }
}

/// `n` at unit length, in double precision; +z if it has none.
fn unit(n: [f32; 3]) -> [f32; 3] {
    let v = glam::DVec3::from(n.map(f64::from)).normalize_or(glam::DVec3::Z);
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Half the diagonal of an object's bounding box.
pub(super) fn size(g: &Geometry) -> f64 {
    match g {
        Geometry::Sphere { radius, .. } => f64::from(*radius),
        Geometry::Mesh(mesh) => {
            let corners = mesh.positions.iter().map(|p| glam::Vec3::from(*p));
            let low = corners.clone().fold(glam::Vec3::INFINITY, glam::Vec3::min);
            let high = corners.fold(glam::Vec3::NEG_INFINITY, glam::Vec3::max);
            0.5 * f64::from((high - low).length())
        }
    }
}

pub(super) fn triangle_area(t: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = t.map(|p| glam::DVec3::from(p.map(f64::from)));
    0.5 * (b - a).cross(c - a).length()
}

pub(super) fn sphere_area(radius: f32) -> f64 {
    4.0 * std::f64::consts::PI * f64::from(radius) * f64::from(radius)
}

/// A position as a key: −0 and 0 are the same place.
pub fn key(position: [f32; 3]) -> [u32; 3] {
    position.map(|x| (x + 0.0).to_bits())
}
