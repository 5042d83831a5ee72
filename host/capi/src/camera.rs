//! The camera.

use crate::arguments::{Sized32, input};
use crate::boundary::{Trouble, fill};
use crate::builder::{EtdBuilder, edit};
use etendue::capi::status::{ETD_E_ARGUMENT, EtdStatus};
use etendue_host::description::{Filter, Projection, Sensor};
use glam::DVec3;

/// A pinhole, or a thin lens where `aperture` is not 0.
pub const ETD_PERSPECTIVE: u32 = 0;
/// Parallel rays.
pub const ETD_ORTHOGRAPHIC: u32 = 1;
/// All directions around a point, lat-long: `direction` in the middle, `up` at the top.
pub const ETD_PANORAMA: u32 = 2;

/// Constant within the radius.
pub const ETD_FILTER_BOX: u32 = 0;
/// Falls linearly to 0 at the radius.
pub const ETD_FILTER_TENT: u32 = 1;
/// A Gaussian, shifted to be 0 at the radius.
pub const ETD_FILTER_GAUSSIAN: u32 = 2;

/// A camera and its image. `etd_camera_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdCamera {
    /// sizeof(EtdCamera).
    pub struct_size: u32,
    /// `ETD_PERSPECTIVE`, `ETD_ORTHOGRAPHIC` or `ETD_PANORAMA`.
    pub projection: u32,
    /// Where it is, world units.
    pub origin: [f32; 3],
    /// Where it looks; any length but 0.
    pub direction: [f32; 3],
    /// What is up in the image; any length but 0, not along `direction`.
    pub up: [f32; 3],
    /// `ETD_PERSPECTIVE`: the angle that the image's width spans, radians, in (0, π). `ETD_ORTHOGRAPHIC`: the image's width, world units.
    /// Pixels are square. `ETD_PANORAMA`: not read; the image spans everything.
    pub field: f32,
    /// Radius of the lens, world units; 0: a pinhole.
    pub aperture: f32,
    /// Distance to the plane in focus, along the axis, world units.
    pub focus: f32,
    /// Nearest and farthest depth that is seen, along the axis (`ETD_PANORAMA`: distance), world units.
    pub clip: [f32; 2],
    /// Offset of the principal point, in widths and heights of the image.
    pub principal: [f32; 2],
    /// Columns of the whole image, 1 to 65536.
    pub width: u32,
    /// Its rows, 1 to 65536.
    pub height: u32,
    /// The part of it that is rendered: first column, first row, columns, rows. All 0: everything.
    pub crop: [u32; 4],
    /// `ETD_FILTER_…`.
    pub filter: u32,
    /// Its half-width in pixels, 0.001 to 8.
    pub filter_radius: f32,
    /// σ in pixels; of `ETD_FILTER_GAUSSIAN` alone.
    pub filter_sigma: f32,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdCamera {}

/// At the origin, looking along +z, y up; a pinhole with an angle of 90°, 768 by 576 pixels, a box filter of one pixel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_camera_default(camera: *mut EtdCamera) -> EtdStatus {
    fill(camera, || EtdCamera {
        struct_size: size_of::<EtdCamera>() as u32,
        projection: ETD_PERSPECTIVE,
        origin: [0.0; 3],
        direction: [0.0, 0.0, 1.0],
        up: [0.0, 1.0, 0.0],
        field: std::f32::consts::FRAC_PI_2,
        aperture: 0.0,
        focus: 1.0,
        clip: [1e-2, 1e4],
        principal: [0.0; 2],
        width: 768,
        height: 576,
        crop: [0; 4],
        filter: ETD_FILTER_BOX,
        filter_radius: 0.5,
        filter_sigma: 0.0,
    })
}

/// Sets the camera; the last one counts. Without one, the scene has that of `etd_camera_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_camera(
    builder: *mut EtdBuilder,
    camera: *const EtdCamera,
) -> EtdStatus {
    edit(builder, |scene| {
        scene.sensor = sensor(&input(camera)?)?;
        Ok(())
    })
}

fn bad(what: &str) -> Trouble {
    Trouble::new(ETD_E_ARGUMENT, format!("camera: {what}"))
}

fn ensure(holds: bool, what: &str) -> Result<(), Trouble> {
    if holds { Ok(()) } else { Err(bad(what)) }
}

fn direction(v: [f32; 3]) -> Option<DVec3> {
    DVec3::from(v.map(f64::from)).try_normalize()
}

fn sensor(c: &EtdCamera) -> Result<Sensor, Trouble> {
    let forward = direction(c.direction).ok_or_else(|| bad("direction must be finite, not 0"))?;
    let up = direction(c.up).ok_or_else(|| bad("up must be finite, not 0"))?;
    let right = forward.cross(up).try_normalize();
    let right = right.ok_or_else(|| bad("up must not be along direction"))?;
    let down = forward.cross(right);
    ensure(
        [c.width, c.height]
            .iter()
            .all(|n| (1..=1 << 16).contains(n)),
        "width and height must be 1 to 65536",
    )?;
    let [x, y, w, h] = c.crop;
    let within = |first: u32, count: u32, all: u32| {
        count >= 1 && first.checked_add(count).is_some_and(|end| end <= all)
    };
    ensure(
        c.crop == [0; 4] || (within(x, w, c.width) && within(y, h, c.height)),
        "crop must lie within the image",
    )?;
    ensure(
        c.origin.iter().all(|x| x.abs() <= 1e12),
        "origin must be finite, within ±1e12",
    )?;
    ensure(
        c.principal.iter().all(|x| x.is_finite()),
        "principal must be finite",
    )?;
    let [near, far] = c.clip;
    ensure(
        near >= 0.0 && near < far && far.is_finite(),
        "clip must be 0 <= nearest < farthest",
    )?;
    let aspect = f64::from(c.height) / f64::from(c.width);
    let half = |x: f64| [x as f32, (x * aspect) as f32];
    let projection = match c.projection {
        ETD_PERSPECTIVE => {
            let angle = f64::from(c.field);
            ensure(
                angle > 0.0 && angle < std::f64::consts::PI,
                "field must be an angle in (0, pi)",
            )?;
            ensure((0.0..=1e12).contains(&c.aperture), "aperture must be >= 0")?;
            ensure((1e-9..=1e12).contains(&c.focus), "focus must be > 0")?;
            Projection::Perspective {
                half_tangent: half((0.5 * angle).tan()),
                aperture: c.aperture,
                focus: c.focus,
            }
        }
        ETD_ORTHOGRAPHIC => {
            ensure(
                (1e-8..=1e12).contains(&c.field),
                "field must be a width > 0",
            )?;
            Projection::Orthographic {
                half_extent: half(0.5 * f64::from(c.field)),
            }
        }
        ETD_PANORAMA => Projection::Panorama,
        _ => return Err(bad("unknown projection")),
    };
    let radius = c.filter_radius;
    ensure(
        (1e-3..=8.0).contains(&radius),
        "filter_radius must be 0.001 to 8",
    )?;
    let filter = match c.filter {
        ETD_FILTER_BOX => Filter::Box { radius },
        ETD_FILTER_TENT => Filter::Tent { radius },
        ETD_FILTER_GAUSSIAN => {
            let sigma = c.filter_sigma;
            ensure(
                (1e-3..=8.0).contains(&sigma),
                "filter_sigma must be 0.001 to 8",
            )?;
            Filter::Gaussian { sigma, radius }
        }
        _ => return Err(bad("unknown filter")),
    };
    let single = |v: DVec3| v.to_array().map(|x| x as f32);
    Ok(Sensor {
        projection,
        origin: c.origin,
        right: single(right),
        down: single(down),
        forward: single(forward),
        clip: c.clip,
        principal: c.principal,
        resolution: [c.width, c.height],
        crop: (c.crop != [0; 4]).then_some(c.crop),
        filter,
        medium: None,
    })
}
