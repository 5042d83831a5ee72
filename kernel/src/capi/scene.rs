//! Scenes: open, inspect, list what rays can meet.

use super::arguments::{Sized32, optional_out, output, place, slice, slice_mut};
use super::control::Control;
use super::status::{
    ETD_ABI_VERSION, ETD_E_ABI, ETD_E_HANDLE, ETD_E_MISALIGNED, ETD_E_NULL, ETD_E_SIZE, EtdStatus,
    of_blob, status_of,
};
use crate::blob::{BlobError, Scene};
use crate::shape::Instructions;

/// Bytes of memory that a scene's handle needs, on every target.
pub const ETD_SCENE_SIZE: usize = 384;
/// What that memory must be aligned to.
pub const ETD_SCENE_ALIGN: usize = 16;
/// What a blob's first byte must be aligned to.
pub const ETD_BLOB_ALIGN: usize = 16;

/// A scene that has been opened: lives in the caller's memory, needs no closing. It doesn't change: any number of
/// threads may use one at once. It refers to its blob, which must stay where it is, unchanged, as long as the scene is used.
pub struct EtdScene {
    magic: u64,
    scene: Scene<'static>,
}

const MAGIC: u64 = 0x656e_6563_5364_7445; // "EtdScene"

const _: () = assert!(size_of::<EtdScene>() <= ETD_SCENE_SIZE);
const _: () = assert!(align_of::<EtdScene>() <= ETD_SCENE_ALIGN);

/// Where a blob is damaged.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdBlobError {
    /// sizeof(EtdBlobError), set by the caller.
    pub struct_size: u32,
    /// The section (0: header or table of contents), numbered as in the blob's format.
    pub section: u32,
    /// The record in it.
    pub index: u32,
    /// The rule of the format that it breaks (`etd_rule_string`).
    pub rule: u32,
}

/// What a scene is and holds.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdSceneInfo {
    /// sizeof(EtdSceneInfo), set by the caller.
    pub struct_size: u32,
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// What the scene holds: bits as the blob's format numbers them.
    pub needs: u32,
    /// Triangles.
    pub triangles: u32,
    /// Spheres.
    pub spheres: u32,
    /// Objects.
    pub shapes: u32,
    /// Local models.
    pub materials: u32,
    /// Textures.
    pub textures: u32,
    /// Lights.
    pub emitters: u32,
    /// Levels of the tree below its root.
    pub depth: u32,
    /// The instructions that rays are traced with: 0 scalar, 1 SSE2, 2 AVX2. All give the same bits.
    pub instructions: u32,
    /// Centre of a sphere around the scene, world units.
    pub center: [f32; 3],
    /// Its radius.
    pub radius: f32,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdBlobError {}
// SAFETY: as above.
unsafe impl Sized32 for EtdSceneInfo {}

/// The scene of a handle.
pub(super) fn scene<'a>(handle: *const EtdScene) -> Result<&'a Scene<'static>, EtdStatus> {
    if handle.is_null() {
        return Err(ETD_E_NULL);
    }
    if !handle.is_aligned() {
        return Err(ETD_E_MISALIGNED);
    }
    // SAFETY: not null and aligned; a handle is `ETD_SCENE_SIZE` bytes of live memory by the caller's word.
    let magic = unsafe { (&raw const (*handle).magic).read() };
    if magic != MAGIC {
        return Err(ETD_E_HANDLE);
    }
    // SAFETY: only `etd_scene_open` writes that number, after the scene behind it, and whoever moves or frees the
    // memory or the blob no longer uses the handle, by the caller's word.
    Ok(unsafe { &(*handle).scene })
}

impl EtdScene {
    /// The scene of a handle, for libraries that add functions of their own.
    ///
    /// # Errors
    /// `ETD_E_NULL`, `ETD_E_MISALIGNED`, `ETD_E_HANDLE`.
    ///
    /// # Safety
    /// What every function asks that takes a handle: if it is neither null nor misaligned, it points to
    /// `ETD_SCENE_SIZE` bytes of live memory, and neither they nor the blob change during `'a`.
    pub unsafe fn get<'a>(handle: *const Self) -> Result<&'a Scene<'static>, EtdStatus> {
        scene(handle)
    }
}

/// Checks a blob and makes a scene of it in `memory`, in time linear in `blob_size`. Any bytes are safe to open.
///
/// `abi_version` is `ETD_ABI_VERSION`. `blob` is `blob_size` bytes, aligned to `ETD_BLOB_ALIGN`, and stays the caller's; it must
/// not change or move while the scene is used. `memory` is `memory_size` ≥ `ETD_SCENE_SIZE` bytes, aligned to `ETD_SCENE_ALIGN`; `*out` will
/// point into it. `error`, if not null, is filled in where the blob is refused (`ETD_E_BLOB_…`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_open(
    abi_version: u32,
    blob: *const u8,
    blob_size: usize,
    memory: *mut core::ffi::c_void,
    memory_size: usize,
    out: *mut *const EtdScene,
    error: *mut EtdBlobError,
) -> EtdStatus {
    status_of((|| {
        if abi_version != ETD_ABI_VERSION {
            return Err(ETD_E_ABI);
        }
        let error = optional_out(error)?;
        if out.is_null() || memory.is_null() || blob.is_null() {
            return Err(ETD_E_NULL);
        }
        if !out.is_aligned() || memory.align_offset(ETD_SCENE_ALIGN) != 0 {
            return Err(ETD_E_MISALIGNED);
        }
        if memory_size < ETD_SCENE_SIZE {
            return Err(ETD_E_SIZE);
        }
        let bytes: &'static [u8] = slice(blob, blob_size)?;
        let _control = Control::set();
        match Scene::open(bytes) {
            Ok(scene) => {
                let handle = memory.cast::<EtdScene>();
                // SAFETY: `memory` is large and aligned enough, and the caller's to give.
                unsafe {
                    handle.write(EtdScene {
                        magic: MAGIC,
                        scene,
                    });
                    out.write(handle.cast_const());
                }
                Ok(())
            }
            Err(e) => {
                let BlobError {
                    section,
                    index,
                    rule,
                } = e;
                if let Some(report) = error {
                    (report.section, report.index) = (section, index);
                    report.rule = rule as u32;
                }
                Err(of_blob(&e))
            }
        }
    })())
}

/// What a scene is and holds. Set `info->struct_size` before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_inspect(
    handle: *const EtdScene,
    info: *mut EtdSceneInfo,
) -> EtdStatus {
    status_of((|| {
        let scene = scene(handle)?;
        let info = output(info)?;
        let [width, height] = scene.size();
        let world = scene.world();
        *info = EtdSceneInfo {
            struct_size: info.struct_size,
            width,
            height,
            needs: scene.needs(),
            triangles: scene.triangles().count() as u32,
            spheres: scene.sphere_records().len() as u32,
            shapes: scene.shapes().len() as u32,
            materials: scene.materials().len() as u32,
            textures: scene.textures().len() as u32,
            emitters: scene.emitters().len() as u32,
            depth: world.depth,
            instructions: match scene.isa() {
                Instructions::Scalar(_) => 0,
                #[cfg(target_arch = "x86_64")]
                Instructions::Sse2(_) => 1,
                #[cfg(target_arch = "x86_64")]
                Instructions::Avx2(_) => 2,
            },
            center: world.center,
            radius: world.radius,
        };
        Ok(())
    })())
}

/// Lists triangles, for a ray tracer of the caller's own: 9 floats each (x, y, z of three vertices, world units; counter-clockwise seen
/// from the front) into `positions`, and the number by which `EtdHit` names it into `primitives`. Writes at most `capacity` of them and
/// the number there are into `*count`; both arrays may be null if `capacity` is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_triangles(
    handle: *const EtdScene,
    positions: *mut f32,
    primitives: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> EtdStatus {
    status_of((|| {
        let scene = scene(handle)?;
        let floats = capacity.checked_mul(9).ok_or(ETD_E_SIZE)?;
        let positions = slice_mut(positions, floats)?;
        let primitives = slice_mut(primitives, capacity)?;
        let places = positions.chunks_exact_mut(9).zip(primitives);
        for ((position, primitive), (id, corners)) in places.zip(scene.triangles()) {
            for (p, c) in position.iter_mut().zip(corners.as_flattened()) {
                *p = *c;
            }
            *primitive = id;
        }
        *place(count)? = scene.triangles().count();
        Ok(())
    })())
}

/// Lists spheres: 4 floats each (centre, radius) and the number by which `EtdHit` names it; otherwise like `etd_scene_triangles`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_spheres(
    handle: *const EtdScene,
    spheres: *mut f32,
    primitives: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> EtdStatus {
    status_of((|| {
        let scene = scene(handle)?;
        let floats = capacity.checked_mul(4).ok_or(ETD_E_SIZE)?;
        let spheres = slice_mut(spheres, floats)?;
        let primitives = slice_mut(primitives, capacity)?;
        let places = spheres.chunks_exact_mut(4).zip(primitives);
        for ((record, primitive), (id, [x, y, z], radius)) in places.zip(scene.spheres()) {
            for (to, from) in record.iter_mut().zip([x, y, z, radius]) {
                *to = from;
            }
            *primitive = id;
        }
        *place(count)? = scene.sphere_records().len();
        Ok(())
    })())
}
