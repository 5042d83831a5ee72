//! The caller's own functions: splats, cancelling, rays, random numbers.

use super::arguments::Sized32;
use super::status::{ETD_E_ARGUMENT, ETD_E_UNSUPPORTED, EtdStatus};
use crate::real::Vec3;
use core::ffi::c_void;

/// A ray: origin + t·direction with t_min < t < t_max. In world space, world units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdRay {
    /// sizeof(EtdRay); set by the library.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes; unit length.
    pub direction: [f32; 3],
    /// Nearest t, exclusive.
    pub t_min: f32,
    /// Farthest t, exclusive; may be infinite.
    pub t_max: f32,
}

/// Where a ray met a primitive. `struct_size` is set by the library before it asks.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdHit {
    /// sizeof(EtdHit).
    pub struct_size: u32,
    /// The primitive, as `etd_scene_triangles` and `etd_scene_spheres` number them.
    pub primitive: u32,
    /// Distance along the ray.
    pub t: f32,
    /// Barycentric weight of the triangle's second vertex; unused on spheres.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex; unused on spheres.
    pub v: f32,
}

/// Functions of the caller; each may be null. They get `user`, run on the calling thread with the library's
/// floating-point control word, and must return: no longjmp, no C++ exception may leave them.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdHooks {
    /// sizeof(EtdHooks).
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// Handed to every function.
    pub user: *mut c_void,
    /// What a sample adds to pixel (x, y) of the image, to be divided by the samples per pixel like the samples themselves.
    /// Needed for pixels and tiles by the estimators `light` and `bidirectional`.
    pub splat: Option<unsafe extern "C" fn(user: *mut c_void, x: u32, y: u32, rgb: *const f32)>,
    /// Asked between samples; anything but 0 stops the call with `ETD_E_CANCELLED`.
    pub cancelled: Option<unsafe extern "C" fn(user: *mut c_void) -> i32>,
    /// The caller's own ray tracer: the closest hit; 0 for none. Triangles are two-sided. Given together with `occluded`, or
    /// not at all. A hit outside (t_min, t_max) or on a primitive that doesn't exist counts as none.
    pub closest: Option<
        unsafe extern "C" fn(user: *mut c_void, ray: *const EtdRay, hit: *mut EtdHit) -> i32,
    >,
    /// Whether anything is hit at t_min < t < t_max; 0 for no.
    pub occluded: Option<unsafe extern "C" fn(user: *mut c_void, ray: *const EtdRay) -> i32>,
    /// The caller's own random numbers in [0, 1), uniform. `subpath` 0 is the walk from the sensor, 1 from a light, 2 any of those that the sensor's
    /// is split into; `vertex` counts along it; `purpose` says what for (0 filter, 1 lens, 2 choice of light, 3 point on it, 4 its direction,
    /// 5 lobe, 6 direction, 7 opacity, 8 roulette, 9 leading channel, 10 flight, 11 part of a blend). A value outside [0, 1) is taken to the nearer end.
    pub random: Option<
        unsafe extern "C" fn(user: *mut c_void, subpath: u32, vertex: u32, purpose: u32) -> f32,
    >,
}

// SAFETY: repr(C), the size first, numbers and nullable pointers only.
unsafe impl Sized32 for EtdHooks {}

impl EtdHooks {
    /// No functions.
    pub(super) const NONE: Self = Self {
        struct_size: size_of::<Self>() as u32,
        reserved: 0,
        user: core::ptr::null_mut(),
        splat: None,
        cancelled: None,
        closest: None,
        occluded: None,
        random: None,
    };

    /// Half a ray tracer is an error, and so is what the build leaves out.
    pub(super) fn check(self) -> Result<Self, EtdStatus> {
        if self.closest.is_some() != self.occluded.is_some() || self.reserved != 0 {
            return Err(ETD_E_ARGUMENT);
        }
        if cfg!(not(feature = "capi")) && (self.closest.is_some() || self.random.is_some()) {
            return Err(ETD_E_UNSUPPORTED);
        }
        Ok(self)
    }

    /// Whether to stop.
    pub(super) fn cancelled(&self) -> bool {
        // SAFETY: the caller's function, called as it is documented.
        self.cancelled.is_some_and(|f| unsafe { f(self.user) } != 0)
    }

    /// Reports a splat.
    pub(super) fn splat(&self, [x, y]: [u32; 2], rgb: [f32; 3]) {
        if let Some(f) = self.splat {
            // SAFETY: the caller's function, called as it is documented; `rgb` has three elements.
            unsafe { f(self.user, x, y, rgb.as_ptr()) };
        }
    }
}

/// A vector from C; `None` if it is not finite or absurdly large.
pub(super) fn position(v: &[f32]) -> Option<Vec3> {
    let &[x, y, z] = v else { return None };
    let limit = crate::blob::MAX_COORDINATE;
    [x, y, z]
        .iter()
        .all(|c| c.abs() <= limit)
        .then(|| Vec3::new(x, y, z))
}

/// A direction from C, normalised; `None` if it has none.
pub(super) fn direction(v: &[f32]) -> Option<Vec3> {
    let d = position(v)?;
    let length = crate::real::sqrt(d.dot(d));
    (length > 1e-12 && length.is_finite()).then(|| d * (1.0 / length))
}
