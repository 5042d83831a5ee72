//! Numbers that make no sense.

use super::{Builder, made, triangle};
use etendue::capi::status::*;
use etendue_host_capi::camera::*;
use etendue_host_capi::light::*;
use etendue_host_capi::medium::*;
use etendue_host_capi::object::*;
use etendue_host_capi::surface::*;
use std::ptr::null;

#[test]
fn numbers_of_a_scene() {
    fn refused<T>(good: fn() -> T, changes: &[fn(&mut T)], call: impl Fn(&T) -> EtdStatus) {
        for (i, change) in changes.iter().enumerate() {
            let mut bad = good();
            change(&mut bad);
            let status = call(&bad);
            assert!(
                [ETD_E_ARGUMENT, ETD_E_NULL, ETD_E_SIZE].contains(&status),
                "{i}: {status}"
            );
        }
        assert_eq!(call(&good()), ETD_OK);
    }
    fn default_sphere() -> EtdSphere {
        made(etd_sphere_default)
    }
    fn default_material() -> EtdMaterial {
        made(etd_material_default)
    }
    fn default_camera() -> EtdCamera {
        made(etd_camera_default)
    }
    static FAR: [f32; 12] = [0., 0., f32::NAN, 0., 0., 0., 0., 1., 0., 0., 0., 0.];
    let b = Builder::new(null());
    let mut id = 0;
    let id = &raw mut id;
    refused(
        triangle,
        &[
            |m| m.vertices = 0,
            |m| m.triangles = 0,
            |m| m.vertices = 2,
            |m| m.positions = null(),
            |m| m.indices = null(),
            |m| m.positions = FAR.as_ptr(),
            |m| m.normals = FAR.as_ptr(),
            |m| m.uvs = FAR.as_ptr(),
            |m| m.front = 0,
            |m| m.back = 7,
            |m| m.opacity = 0,
            |m| m.emission[1] = -1.0,
            |m| m.emission[2] = f32::NAN,
            |m| m.reserved = 1,
        ],
        // SAFETY: good pointers, and null ones.
        |m| unsafe { etd_builder_add_mesh(b.0, m, id) },
    );
    refused(
        default_sphere,
        &[
            |s| s.radius = 0.0,
            |s| s.radius = f32::NAN,
            |s| s.center[0] = f32::INFINITY,
            |s| s.flipped = 2,
            |s| s.front = 0,
        ],
        // SAFETY: good pointers.
        |s| unsafe { etd_builder_add_sphere(b.0, s, id) },
    );
    refused(
        default_material,
        &[
            |m| m.kind = 13,
            |m| m.flags = 1,
            |m| m.color[0][0] = 1.5,
            |m| m.color[1][2] = 0.5,
            |m| m.texture[3] = 0,
            |m| (m.kind, m.eta[0]) = (ETD_CONDUCTOR, 0.0),
            |m| (m.kind, m.ior) = (ETD_DIELECTRIC, f32::NAN),
        ],
        // SAFETY: good pointers.
        |m| unsafe { etd_builder_add_material(b.0, m, id) },
    );
    static TEXELS: [f32; 12] = [2.0; 12];
    fn image() -> EtdTexture {
        let mut t = made(etd_texture_default);
        (t.kind, t.width, t.height, t.bytes) = (ETD_SRGB8, 2, 2, 16);
        t.texels = TEXELS.as_ptr().cast();
        t
    }
    refused(
        image,
        &[
            |t| t.kind = 5,
            |t| t.flags = 6,
            |t| t.flags = 16,
            |t| t.bytes = 15,
            |t| t.width = 0,
            |t| t.texels = null(),
            |t| t.to_uv[0][0] = f32::NAN,
            |t| (t.kind, t.bytes) = (ETD_FLOAT, 48),
        ],
        // SAFETY: good pointers, and null ones.
        |t| unsafe { etd_builder_add_texture(b.0, t, id) },
    );
    fn sky() -> EtdLight {
        let mut l = made(etd_light_default);
        (l.kind, l.width, l.height, l.floats) = (ETD_LIGHT_LATLONG, 2, 2, 12);
        l.texels = TEXELS.as_ptr();
        l
    }
    refused(
        sky,
        &[
            |l| l.kind = 6,
            |l| l.kind = ETD_LIGHT_CUBEMAP,
            |l| l.floats = 11,
            |l| (l.height, l.floats) = (1, 6),
            |l| l.texels = null(),
            |l| l.scale = -1.0,
            |l| l.axes[1] = [1.0, 0.0, 0.0],
            |l| l.color[0] = f32::INFINITY,
            |l| (l.kind, l.direction) = (ETD_LIGHT_DIRECTIONAL, [0.0; 3]),
            |l| (l.kind, l.cutoff) = (ETD_LIGHT_SPOT, 0.0),
            |l| (l.kind, l.beam_width) = (ETD_LIGHT_SPOT, 3.0),
        ],
        // SAFETY: good pointers, and null ones.
        |l| unsafe { etd_builder_add_light(b.0, l, id) },
    );
    fn smoke() -> EtdMedium {
        let mut m = made(etd_medium_default);
        (m.extinction.size, m.extinction.floats) = ([2, 2, 3], 12);
        m.extinction.values = TEXELS.as_ptr();
        m
    }
    refused(
        smoke,
        &[
            |m| m.sigma_t[1] = -1.0,
            |m| m.sigma_t[1] = f32::NAN,
            |m| m.albedo[0] = 1.5,
            |m| m.emission[2] = f32::INFINITY,
            |m| m.reserved = 1,
            |m| m.tracking = 3,
            |m| m.phase[0].weight = 0.0,
            |m| m.phase[1].weight = -1.0,
            |m| m.phase[3].kind = 4,
            |m| (m.phase[2].kind, m.phase[2].g) = (ETD_PHASE_HG, 1.0),
            |m| m.to_grid[2][3] = f32::NAN,
            |m| m.extinction.size[0] = 0,
            |m| m.extinction.size[2] = 4097,
            |m| m.extinction.channels = 2,
            |m| m.extinction.nearest = 2,
            |m| m.extinction.reserved = 1,
            |m| m.extinction.floats = 11,
            |m| m.extinction.values = null(),
            |m| m.extinction.values = FAR.as_ptr(),
            |m| (m.albedos, m.extinction) = (m.extinction, m.albedos),
        ],
        // SAFETY: good pointers, and null ones.
        |m| unsafe { etd_builder_add_medium(b.0, m, id) },
    );
    refused(
        default_camera,
        &[
            |c| c.projection = 3,
            |c| c.direction = [0.0; 3],
            |c| c.up = [0.0, 0.0, 2.0],
            |c| c.field = 3.2,
            |c| c.focus = 0.0,
            |c| c.aperture = -1.0,
            |c| c.clip = [1.0, 1.0],
            |c| c.width = 0,
            |c| c.height = 1 << 17,
            |c| c.crop = [700, 0, 100, 100],
            |c| c.crop = [u32::MAX, 0, 2, 1],
            |c| c.filter = 3,
            |c| c.filter_radius = 9.0,
            |c| c.filter = ETD_FILTER_GAUSSIAN,
            |c| c.origin[2] = f32::NAN,
            |c| c.principal[0] = f32::NAN,
        ],
        // SAFETY: good pointers.
        |c| unsafe { etd_builder_set_camera(b.0, c) },
    );
}
