//! Just enough of Embree 3's C interface to trace single rays in robust mode.

use core::ffi::{c_char, c_int, c_uint, c_void};
use core::ptr;

use etendue::shape::Ray;

const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const GEOMETRY_TRIANGLE: c_int = 0;
const SCENE_ROBUST: c_int = 1 << 2;
const INVALID: u32 = u32::MAX;

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RtcRay {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RtcRayHit {
    ray: RtcRay,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
}

#[repr(C)]
struct RtcContext {
    flags: c_int,
    filter: *mut c_void,
    instance: u32,
}

impl RtcContext {
    fn incoherent() -> Self {
        Self {
            flags: 0,
            filter: ptr::null_mut(),
            instance: INVALID,
        }
    }
}

// SAFETY: as declared in Embree 3.13's rtcore_*.h; handles are pointers, enums C ints.
unsafe extern "C" {
    fn rtcNewDevice(config: *const c_char) -> *mut c_void;
    fn rtcNewScene(device: *mut c_void) -> *mut c_void;
    fn rtcSetSceneFlags(scene: *mut c_void, flags: c_int);
    fn rtcNewGeometry(device: *mut c_void, kind: c_int) -> *mut c_void;
    fn rtcSetNewGeometryBuffer(
        geometry: *mut c_void,
        kind: c_int,
        slot: c_uint,
        format: c_int,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    fn rtcCommitGeometry(geometry: *mut c_void);
    fn rtcAttachGeometry(scene: *mut c_void, geometry: *mut c_void) -> c_uint;
    fn rtcReleaseGeometry(geometry: *mut c_void);
    fn rtcCommitScene(scene: *mut c_void);
    fn rtcReleaseScene(scene: *mut c_void);
    fn rtcReleaseDevice(device: *mut c_void);
    fn rtcIntersect1(scene: *mut c_void, context: *mut RtcContext, hit: *mut RtcRayHit);
    fn rtcOccluded1(scene: *mut c_void, context: *mut RtcContext, ray: *mut RtcRay);
}

/// A scene in Embree.
pub struct Embree {
    device: *mut c_void,
    scene: *mut c_void,
}

impl Embree {
    /// Builds with default quality, robust.
    pub fn new(triangles: &[[[f32; 3]; 3]]) -> Self {
        // SAFETY: calls in the documented order; each buffer is filled with the `count` records of
        // `stride` bytes that it was made for, and vertex buffers are padded by Embree itself.
        unsafe {
            let device = rtcNewDevice(ptr::null());
            assert!(!device.is_null());
            let scene = rtcNewScene(device);
            rtcSetSceneFlags(scene, SCENE_ROBUST);
            let geometry = rtcNewGeometry(device, GEOMETRY_TRIANGLE);
            let (n, v) = (triangles.len(), triangles.len() * 3);
            let vertices =
                rtcSetNewGeometryBuffer(geometry, BUFFER_VERTEX, 0, FORMAT_FLOAT3, 12, v);
            ptr::copy_nonoverlapping(triangles.as_ptr().cast(), vertices.cast::<u8>(), v * 12);
            let indices = rtcSetNewGeometryBuffer(geometry, BUFFER_INDEX, 0, FORMAT_UINT3, 12, n);
            for i in 0..v {
                indices.cast::<u32>().add(i).write(i as u32);
            }
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(scene);
            Self { device, scene }
        }
    }

    fn ray(ray: &Ray) -> RtcRay {
        RtcRay {
            origin: ray.origin.to_array(),
            t_near: ray.t_min,
            direction: ray.direction.to_array(),
            time: 0.0,
            t_far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
        }
    }

    /// Distance to the closest hit.
    pub fn closest(&self, ray: &Ray) -> Option<f32> {
        let mut hit = RtcRayHit {
            ray: Self::ray(ray),
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: INVALID,
            geometry: INVALID,
            instance: INVALID,
        };
        // SAFETY: the scene is committed; context and hit are initialised and aligned.
        unsafe { rtcIntersect1(self.scene, &mut RtcContext::incoherent(), &mut hit) };
        (hit.geometry != INVALID).then_some(hit.ray.t_far)
    }

    /// Whether there is any hit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut ray = Self::ray(ray);
        // SAFETY: the scene is committed; context and ray are initialised and aligned.
        unsafe { rtcOccluded1(self.scene, &mut RtcContext::incoherent(), &mut ray) };
        ray.t_far < 0.0
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: both are held and released once.
        unsafe {
            rtcReleaseScene(self.scene);
            rtcReleaseDevice(self.device);
        }
    }
}
