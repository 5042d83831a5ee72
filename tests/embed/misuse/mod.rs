//! What C can get wrong: each mistake has its status, and leaves things as they were.

mod calls;
mod numbers;

use etendue::capi::status::*;
use etendue_host_capi::blob::EtdBlob;
use etendue_host_capi::builder::*;
use etendue_host_capi::camera::*;
use etendue_host_capi::hooks::EtdHost;
use etendue_host_capi::light::*;
use etendue_host_capi::medium::*;
use etendue_host_capi::object::*;
use etendue_host_capi::surface::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};

/// A struct as its default function makes it.
pub fn made<T>(default: unsafe extern "C" fn(*mut T) -> EtdStatus) -> T {
    let mut value = std::mem::MaybeUninit::<T>::uninit();
    // SAFETY: memory for a T, which the function fills in.
    unsafe {
        assert_eq!(default(value.as_mut_ptr()), ETD_OK);
        assert_eq!(default(null_mut()), ETD_E_NULL);
        assert_eq!(default(off(value.as_mut_ptr())), ETD_E_MISALIGNED);
        value.assume_init()
    }
}

/// One byte further.
pub fn off<T>(pointer: *mut T) -> *mut T {
    pointer.cast::<u8>().wrapping_add(1).cast()
}

/// A struct to be filled in, or one whose zeros are fine.
pub fn sized<T>() -> T {
    // SAFETY: structs of the header: numbers and nullable pointers, a `u32` first.
    unsafe {
        let mut value: T = std::mem::zeroed();
        (&raw mut value).cast::<u32>().write(size_of::<T>() as u32);
        value
    }
}

/// Tries a call with a good struct, and with all that is wrong with pointers to structs.
pub fn pointers<T: Copy>(good: T, call: impl Fn(*mut T) -> EtdStatus) {
    let mut value = good;
    assert_eq!(call(null_mut()), ETD_E_NULL);
    assert_eq!(call(off(&raw mut value)), ETD_E_MISALIGNED);
    for size in [0, size_of::<T>() as u32 - 1, size_of::<T>() as u32 + 1] {
        value = good;
        // SAFETY: a struct's first member is its size.
        unsafe { (&raw mut value).cast::<u32>().write(size) };
        assert_eq!(call(&raw mut value), ETD_E_SIZE, "{size}");
    }
    value = good;
    assert_eq!(call(&raw mut value), ETD_OK);
}

pub struct Builder(pub *mut EtdBuilder);

impl Builder {
    pub fn new(host: *const EtdHost) -> Self {
        let mut builder = null_mut();
        // SAFETY: good pointers.
        let status = unsafe { etd_builder_create(ETD_ABI_VERSION, host, &raw mut builder) };
        assert_eq!(status, ETD_OK);
        Self(builder)
    }

    /// With one triangle that shines, seen by a camera of 8 × 8 pixels.
    pub fn small(host: *const EtdHost) -> Self {
        let builder = Self::new(host);
        let mut camera = made(etd_camera_default);
        (camera.width, camera.height) = (8, 8);
        // SAFETY: good pointers.
        unsafe {
            assert_eq!(etd_builder_set_camera(builder.0, &raw const camera), ETD_OK);
            let mut id = 9;
            assert_eq!(
                etd_builder_add_mesh(builder.0, &triangle(), &raw mut id),
                ETD_OK
            );
            assert_eq!(id, 0);
        }
        builder
    }

    pub fn message(&self) -> String {
        let mut buffer = [0 as c_char; 256];
        // SAFETY: good pointers; the text ends with a 0.
        unsafe {
            assert_eq!(
                etd_builder_message(self.0, buffer.as_mut_ptr(), 256),
                ETD_OK
            );
            CStr::from_ptr(buffer.as_ptr()).to_str().unwrap().into()
        }
    }

    pub fn build(&self) -> EtdBlob {
        let mut blob = sized();
        // SAFETY: good pointers.
        let status = unsafe { etd_builder_build(self.0, &raw mut blob, null_mut()) };
        assert_eq!(status, ETD_OK, "{}", self.message());
        blob
    }
}

impl Drop for Builder {
    fn drop(&mut self) {
        // SAFETY: made by `new`, used no more.
        assert_eq!(unsafe { etd_builder_free(self.0) }, ETD_OK);
    }
}

static POSITIONS: [f32; 9] = [-1., -1., 2., 1., -1., 2., 0., 1., 2.];
static INDICES: [u32; 3] = [0, 2, 1];

pub fn triangle() -> EtdMesh {
    let mut mesh = made(etd_mesh_default);
    (mesh.vertices, mesh.triangles) = (3, 1);
    (mesh.positions, mesh.indices) = (POSITIONS.as_ptr(), INDICES.as_ptr());
    mesh.emission = [1.0; 3];
    mesh
}

/// Every function that takes a builder refuses what isn't one.
#[test]
fn builders() {
    let (mut id, mut out) = (0, null_mut());
    let id = &raw mut id;
    let mut text = [0 as c_char; 8];
    let text = text.as_mut_ptr();
    let identity = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.];
    let (m, n, t) = (
        made(etd_material_default),
        triangle(),
        made(etd_texture_default),
    );
    let (s, l, c) = (
        made(etd_sphere_default),
        made(etd_light_default),
        made(etd_camera_default),
    );
    let u = made(etd_medium_default);
    let mut blob: EtdBlob = sized();
    let blob = &raw mut blob;
    // SAFETY: the pointers are good or, on purpose, such as the functions find out.
    unsafe {
        let calls = |b: *mut EtdBuilder| {
            [
                etd_builder_message(b, text, 8),
                etd_builder_set_camera(b, &c),
                etd_builder_add_material(b, &m, id),
                etd_builder_set_material(b, 0, &m),
                etd_builder_add_texture(b, &t, id),
                etd_builder_add_mesh(b, &n, id),
                etd_builder_add_sphere(b, &s, id),
                etd_builder_add_light(b, &l, id),
                etd_builder_set_light(b, 0, &l),
                etd_builder_set_transform(b, 0, identity.as_ptr()),
                etd_builder_add_instance(b, 0, identity.as_ptr(), id),
                etd_builder_add_medium(b, &u, id),
                etd_builder_set_media(b, 0, ETD_NONE, ETD_NONE),
                etd_builder_set_exterior(b, ETD_NONE),
                etd_builder_set_color(b, ETD_COLOR_AUTO),
                etd_builder_build(b, blob, null_mut()),
                etd_builder_refit(b, blob, null_mut()),
            ]
        };
        let mut foreign = [0_u64; 64];
        let foreign: *mut EtdBuilder = foreign.as_mut_ptr().cast();
        assert_eq!(calls(null_mut()), [ETD_E_NULL; 17]);
        assert_eq!(calls(off(foreign)), [ETD_E_MISALIGNED; 17]);
        assert_eq!(calls(foreign), [ETD_E_HANDLE; 17]);
        assert_eq!(etd_builder_free(null_mut()), ETD_OK);
        assert_eq!(etd_builder_free(off(foreign)), ETD_E_MISALIGNED);
        assert_eq!(etd_builder_free(foreign), ETD_E_HANDLE);
        let create = etd_builder_create;
        assert_eq!(create(ETD_ABI_VERSION + 1, null(), &raw mut out), ETD_E_ABI);
        assert_eq!(create(ETD_ABI_VERSION, null(), null_mut()), ETD_E_NULL);
        assert_eq!(
            create(ETD_ABI_VERSION, null(), off(&raw mut out)),
            ETD_E_MISALIGNED
        );
        let mut host: EtdHost = sized();
        assert_eq!(
            create(ETD_ABI_VERSION, off(&raw mut host), &raw mut out),
            ETD_E_MISALIGNED
        );
        host.struct_size -= 1;
        assert_eq!(create(ETD_ABI_VERSION, &host, &raw mut out), ETD_E_SIZE);
        host.struct_size += 1;
        host.allocate = Some(no_memory);
        assert_eq!(create(ETD_ABI_VERSION, &host, &raw mut out), ETD_E_ARGUMENT);
        assert!(out.is_null());

        let good = Builder::small(null());
        assert_eq!(
            etd_builder_add_instance(good.0, 0, identity.as_ptr(), id),
            ETD_E_UNSUPPORTED
        );
        assert_eq!(
            etd_builder_set_media(good.0, 0, 0, ETD_NONE),
            ETD_E_ARGUMENT
        );
        assert_eq!(
            etd_builder_set_media(good.0, 0, ETD_NONE, 0),
            ETD_E_ARGUMENT
        );
        assert_eq!(etd_builder_set_exterior(good.0, 0), ETD_E_ARGUMENT);
        assert_eq!(etd_builder_set_color(good.0, 3), ETD_E_ARGUMENT);
        assert_eq!(etd_builder_add_medium(good.0, &u, id), ETD_OK);
        assert_eq!((*id, etd_builder_set_exterior(good.0, 0)), (0, ETD_OK));
        assert_eq!(etd_builder_set_media(good.0, 1, 0, 0), ETD_E_ARGUMENT);
        assert_eq!(etd_builder_set_media(good.0, 0, 0, 0), ETD_OK);
        assert_eq!(
            etd_builder_add_instance(good.0, 0, identity.as_ptr(), id),
            ETD_E_UNSUPPORTED
        );
        assert_eq!(etd_builder_message(good.0, null_mut(), 8), ETD_E_NULL);
        assert_eq!(etd_builder_message(good.0, text, 2), ETD_OK);
        assert_eq!([*text, *text.add(1)], [b't' as c_char, 0]);
        let at = identity.as_ptr().cast_mut();
        assert_eq!(etd_builder_set_transform(good.0, 0, null()), ETD_E_NULL);
        assert_eq!(
            etd_builder_set_transform(good.0, 0, off(at)),
            ETD_E_MISALIGNED
        );
        assert_eq!(etd_builder_set_transform(good.0, 1, at), ETD_E_ARGUMENT);
        assert!(good.message().contains("object 1"), "{}", good.message());
        let flat = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 0., 0.];
        assert_eq!(
            etd_builder_set_transform(good.0, 0, flat.as_ptr()),
            ETD_E_ARGUMENT
        );
        assert_eq!(etd_builder_set_transform(good.0, 0, at), ETD_OK);
        assert_eq!(good.message(), "");
    }
}

#[test]
fn structs_of_a_scene() {
    let b = Builder::new(null());
    let mut id = 0;
    let id = &raw mut id;
    // SAFETY: as above.
    unsafe {
        pointers(made(etd_camera_default), |c| etd_builder_set_camera(b.0, c));
        pointers(made(etd_material_default), |m| {
            etd_builder_add_material(b.0, m, id)
        });
        pointers(made(etd_material_default), |m| {
            etd_builder_set_material(b.0, 0, m)
        });
        pointers(made(etd_texture_default), |t| {
            etd_builder_add_texture(b.0, t, id)
        });
        pointers(triangle(), |m| etd_builder_add_mesh(b.0, m, id));
        pointers(made(etd_sphere_default), |s| {
            etd_builder_add_sphere(b.0, s, id)
        });
        pointers(made(etd_light_default), |l| {
            etd_builder_add_light(b.0, l, id)
        });
        pointers(made(etd_light_default), |l| {
            etd_builder_set_light(b.0, 0, l)
        });
        pointers(made(etd_medium_default), |m| {
            etd_builder_add_medium(b.0, m, id)
        });
        let (m, t, l) = (
            made(etd_material_default),
            made(etd_texture_default),
            made(etd_light_default),
        );
        let (n, s) = (triangle(), made(etd_sphere_default));
        for (wrong, status) in [(null_mut(), ETD_E_NULL), (off(id), ETD_E_MISALIGNED)] {
            assert_eq!(etd_builder_add_material(b.0, &m, wrong), status);
            assert_eq!(etd_builder_add_texture(b.0, &t, wrong), status);
            assert_eq!(etd_builder_add_mesh(b.0, &n, wrong), status);
            assert_eq!(etd_builder_add_sphere(b.0, &s, wrong), status);
            assert_eq!(etd_builder_add_light(b.0, &l, wrong), status);
        }
        assert_eq!(etd_builder_set_material(b.0, 1, &m), ETD_E_ARGUMENT);
        assert_eq!(etd_builder_set_light(b.0, 1, &l), ETD_E_ARGUMENT);
        // None of what was refused is there.
        assert_eq!(etd_builder_add_sphere(b.0, &s, id), ETD_OK);
        assert_eq!(*id, 2);
    }
}

unsafe extern "C" fn no_memory(_: *mut c_void, _: usize, _: usize) -> *mut c_void {
    null_mut()
}

#[test]
fn every_status_has_words() {
    let known = (0..=9).chain(100..=111).chain(200..=206);
    let words = |status| {
        // SAFETY: texts that live forever.
        unsafe { CStr::from_ptr(etd_error_string(status)) }
    };
    let all: std::collections::BTreeSet<_> = known.clone().map(words).collect();
    assert_eq!(all.len(), known.count());
    assert!(!all.contains(words(207)) && words(-1) == words(99));
}
