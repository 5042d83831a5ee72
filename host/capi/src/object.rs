//! Objects: meshes and spheres.

use crate::arguments::{Sized32, input, place, slice};
use crate::boundary::{Trouble, copied, fill};
use crate::builder::{ETD_NONE, EtdBuilder, edit};
use crate::described::{Described, Object};
use crate::surface::{finite, optional_id};
use etendue::capi::status::{ETD_E_ARGUMENT, EtdStatus};
use etendue_host::description::{Color, ColorSource, Geometry, Mesh, Place, Shape};
use glam::DMat4;

/// Triangles over shared vertices. `etd_mesh_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdMesh {
    /// sizeof(EtdMesh).
    pub struct_size: u32,
    /// Vertices, at least 1.
    pub vertices: u32,
    /// Triangles, at least 1.
    pub triangles: u32,
    /// Material on the front, where the vertices run counter-clockwise; `ETD_NONE` is black.
    pub front: u32,
    /// Material on the back; `ETD_NONE` is black.
    pub back: u32,
    /// Texture whose first channel is the opacity; `ETD_NONE`: opaque.
    pub opacity: u32,
    /// Radiance that the front emits, W/(m² sr).
    pub emission: [f32; 3],
    /// Zero.
    pub reserved: u32,
    /// 3 · `vertices` numbers, in the object's own space.
    pub positions: *const f32,
    /// 3 · `vertices` numbers, of any length but 0; null: flat triangles.
    pub normals: *const f32,
    /// 2 · `vertices` numbers, texture coordinates; null: none.
    pub uvs: *const f32,
    /// 3 · `triangles` numbers below `vertices`.
    pub indices: *const u32,
}

/// An exact sphere. `etd_sphere_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdSphere {
    /// sizeof(EtdSphere).
    pub struct_size: u32,
    /// Material outside; `ETD_NONE` is black.
    pub front: u32,
    /// Material inside; `ETD_NONE` is black.
    pub back: u32,
    /// Texture whose first channel is the opacity; `ETD_NONE`: opaque.
    pub opacity: u32,
    /// Its centre, in the object's own space.
    pub center: [f32; 3],
    /// Its radius, > 0.
    pub radius: f32,
    /// Radiance that the front emits, W/(m² sr).
    pub emission: [f32; 3],
    /// 1: the front is inside; else 0.
    pub flipped: u32,
}

// SAFETY: repr(C), the size first, numbers and pointers only.
unsafe impl Sized32 for EtdMesh {}
// SAFETY: as above.
unsafe impl Sized32 for EtdSphere {}

fn bad(reason: impl Into<String>) -> Trouble {
    Trouble::new(ETD_E_ARGUMENT, reason)
}

/// No vertices yet; black, opaque, no light.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_mesh_default(mesh: *mut EtdMesh) -> EtdStatus {
    fill(mesh, || EtdMesh {
        struct_size: size_of::<EtdMesh>() as u32,
        vertices: 0,
        triangles: 0,
        front: ETD_NONE,
        back: ETD_NONE,
        opacity: ETD_NONE,
        emission: [0.0; 3],
        reserved: 0,
        positions: std::ptr::null(),
        normals: std::ptr::null(),
        uvs: std::ptr::null(),
        indices: std::ptr::null(),
    })
}

/// The unit sphere around the origin; black, opaque, no light.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_sphere_default(sphere: *mut EtdSphere) -> EtdStatus {
    fill(sphere, || EtdSphere {
        struct_size: size_of::<EtdSphere>() as u32,
        front: ETD_NONE,
        back: ETD_NONE,
        opacity: ETD_NONE,
        center: [0.0; 3],
        radius: 1.0,
        emission: [0.0; 3],
        flipped: 0,
    })
}

/// Adds a mesh and writes its id: objects are numbered from 0, meshes and spheres together. Its arrays are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_mesh(
    builder: *mut EtdBuilder,
    mesh: *const EtdMesh,
    id: *mut u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let (m, id) = (input(mesh)?, place(id)?);
        if m.vertices == 0 || m.triangles == 0 || m.reserved != 0 {
            return Err(bad(
                "mesh: vertices and triangles must be at least 1, reserved 0",
            ));
        }
        if m.triangles > u32::MAX / 4 {
            return Err(bad("mesh: more triangles than a scene can hold"));
        }
        let count = m.vertices as usize;
        let positions = slice(m.positions.cast::<[f32; 3]>(), count)?;
        let optional = |pointer: *const f32| if pointer.is_null() { 0 } else { count };
        let normals = slice(m.normals.cast::<[f32; 3]>(), optional(m.normals))?;
        let uvs = slice(m.uvs.cast::<[f32; 2]>(), optional(m.uvs))?;
        let triangles = slice(m.indices.cast::<[u32; 3]>(), m.triangles as usize)?;
        let find = |what: &str, wrong: Option<usize>| match wrong {
            Some(i) => Err(bad(format!("mesh: {what} of vertex {i} is out of range"))),
            None => Ok(()),
        };
        let far = |p: &[f32; 3]| !p.iter().all(|x| x.abs() <= 1e12);
        find("position", positions.iter().position(far))?;
        let no_normal = |n: &[f32; 3]| *n == [0.0; 3] || !finite(n);
        find("normal", normals.iter().position(no_normal))?;
        find("texture coordinate", uvs.iter().position(|uv| !finite(uv)))?;
        let wrong = |t: &[u32; 3]| t.iter().any(|&i| i >= m.vertices);
        if let Some(i) = triangles.iter().position(wrong) {
            return Err(bad(format!(
                "mesh: triangle {i} has vertices {:?}, expected indices below {count}",
                triangles[i]
            )));
        }
        let geometry = Geometry::Mesh(Mesh {
            positions: copied(positions)?,
            normals: Some(copied(normals)?).filter(|n| !n.is_empty()),
            uvs: Some(copied(uvs)?).filter(|uv| !uv.is_empty()),
            triangles: copied(triangles)?,
        });
        *id = add(scene, geometry, [m.front, m.back, m.opacity], m.emission)?;
        Ok(())
    })
}

/// Adds a sphere and writes its id: objects are numbered from 0, meshes and spheres together.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_sphere(
    builder: *mut EtdBuilder,
    sphere: *const EtdSphere,
    id: *mut u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let (s, id) = (input(sphere)?, place(id)?);
        let sound = s.radius > 0.0 && s.radius <= 1e12 && s.flipped <= 1;
        if !sound || !s.center.iter().all(|x| x.abs() <= 1e12) {
            return Err(bad(
                "sphere: centre and radius must be within 1e12, radius > 0, flipped 0 or 1",
            ));
        }
        let geometry = Geometry::Sphere {
            center: s.center,
            radius: s.radius,
            flipped: s.flipped == 1,
        };
        *id = add(scene, geometry, [s.front, s.back, s.opacity], s.emission)?;
        Ok(())
    })
}

/// What meshes and spheres have in common.
fn add(
    scene: &mut Described,
    geometry: Geometry,
    [front, back, opacity]: [u32; 3],
    emission: Color,
) -> Result<u32, Trouble> {
    if !emission.iter().all(|x| (0.0..=1e30).contains(x)) {
        return Err(bad("emission: must be 0 to 1e30"));
    }
    let id = scene.objects.len();
    let shape = Shape {
        name: format!("object {id}"),
        place: Place::default(),
        geometry,
        front: optional_id("material", front, scene.materials.len())?,
        back: optional_id("material", back, scene.materials.len())?,
        emission: (emission != [0.0; 3]).then_some(emission),
        spectrum: None,
        opacity: optional_id("texture", opacity, scene.textures.len())?.map(ColorSource::Texture),
        interior: None,
        exterior: None,
    };
    scene.objects.push(Object {
        shape,
        to_world: DMat4::IDENTITY,
    });
    Ok(id as u32)
}
