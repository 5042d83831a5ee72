//! Lights that aren't objects.

use crate::arguments::{Sized32, input, place, slice};
use crate::boundary::{Trouble, copied, fill};
use crate::builder::{EtdBuilder, edit};
use etendue::capi::status::{ETD_E_ARGUMENT, ETD_E_SIZE, EtdStatus};
use etendue_host::description::{Color, Emitter, EmitterKind, Place};
use glam::DVec3;

/// A point: `color` is its radiant intensity, W/sr.
pub const ETD_LIGHT_POINT: u32 = 0;
/// A point with a cone around `direction`: `color` is the intensity inside `beam_width`, W/sr; it falls to 0 at `cutoff`.
pub const ETD_LIGHT_SPOT: u32 = 1;
/// From infinity along `direction`: `color` is the irradiance on a plane across it, W/m².
pub const ETD_LIGHT_DIRECTIONAL: u32 = 2;
/// The radiance `color`, W/(m² sr), from all directions. One such, or one image, to a scene.
pub const ETD_LIGHT_CONSTANT: u32 = 3;
/// A lat-long image around the scene: its top row is the image's +y, column 0 its −z, the middle its +z; radiance is texel · `scale`.
pub const ETD_LIGHT_LATLONG: u32 = 4;
/// Six square images around the scene, below each other: +x −x +y −y +z −z; `height` is 6 · `width`.
pub const ETD_LIGHT_CUBEMAP: u32 = 5;

/// A light. `etd_light_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdLight {
    /// sizeof(EtdLight).
    pub struct_size: u32,
    /// `ETD_LIGHT_…`.
    pub kind: u32,
    /// What it emits, in the kind's unit.
    pub color: [f32; 3],
    /// Where a point or spot is, world units.
    pub position: [f32; 3],
    /// Where light goes: a spot's axis, or along which directional light travels; any length but 0.
    pub direction: [f32; 3],
    /// A spot's: angle to the axis beyond which there is no light, radians, in (0, π).
    pub cutoff: f32,
    /// A spot's: angle up to which there is all of it, radians, 0 to `cutoff`.
    pub beam_width: f32,
    /// Factor of an image, ≥ 0.
    pub scale: f32,
    /// The x, y and z axis of an image in world space, unit and at right angles: its rows.
    pub axes: [[f32; 3]; 3],
    /// Columns of an image, 1 to 65536.
    pub width: u32,
    /// Rows of an image: at least 2 of a lat-long one, 6 · `width` of a cube.
    pub height: u32,
    /// Zero.
    pub reserved: u32,
    /// An image's texels: `width` · `height` times linear RGB, ≥ 0.
    pub texels: *const f32,
    /// How many numbers they are: 3 · `width` · `height`.
    pub floats: usize,
}

// SAFETY: repr(C), the size first, numbers and a pointer only.
unsafe impl Sized32 for EtdLight {}

/// A constant background of radiance 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_light_default(light: *mut EtdLight) -> EtdStatus {
    fill(light, || EtdLight {
        struct_size: size_of::<EtdLight>() as u32,
        kind: ETD_LIGHT_CONSTANT,
        color: [1.0; 3],
        position: [0.0; 3],
        direction: [0.0, 0.0, 1.0],
        cutoff: std::f32::consts::FRAC_PI_6,
        beam_width: std::f32::consts::FRAC_PI_8,
        scale: 1.0,
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        width: 0,
        height: 0,
        reserved: 0,
        texels: std::ptr::null(),
        floats: 0,
    })
}

/// Adds a light and writes its id, counted from 0. Its texels are copied. (Objects with an emission are lights too, without an id here.)
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_light(
    builder: *mut EtdBuilder,
    light: *const EtdLight,
    id: *mut u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let (light, id) = (input(light)?, place(id)?);
        let kind = kind(&light)?;
        let new = scene.emitters.len();
        let name = format!("light {new}");
        scene.emitters.push(Emitter {
            spectrum: None,
            name,
            place: Place::default(),
            kind,
            medium: None,
        });
        *id = new as u32;
        Ok(())
    })
}

/// Puts another light in the place of `id`: how lights move.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_light(
    builder: *mut EtdBuilder,
    id: u32,
    light: *const EtdLight,
) -> EtdStatus {
    edit(builder, |scene| {
        let kind = kind(&input(light)?)?;
        let count = scene.emitters.len();
        match scene.emitters.get_mut(id as usize) {
            Some(place) => place.kind = kind,
            None => return Err(bad(&format!("there is no light {id}, but {count}"))),
        }
        Ok(())
    })
}

fn bad(what: &str) -> Trouble {
    Trouble::new(ETD_E_ARGUMENT, format!("light: {what}"))
}

fn ensure(holds: bool, what: &str) -> Result<(), Trouble> {
    if holds { Ok(()) } else { Err(bad(what)) }
}

fn kind(l: &EtdLight) -> Result<EmitterKind, Trouble> {
    let emitted = |values: &[f32]| values.iter().all(|x| (0.0..=1e30).contains(x));
    ensure(emitted(&l.color), "color must be 0 to 1e30")?;
    ensure(l.reserved == 0, "reserved must be 0")?;
    ensure(
        l.position.iter().all(|x| x.abs() <= 1e12),
        "position must be finite, within ±1e12",
    )?;
    let direction = || {
        let unit = DVec3::from(l.direction.map(f64::from)).try_normalize();
        let unit = unit.ok_or_else(|| bad("direction must be finite, not 0"))?;
        Ok::<Color, Trouble>(unit.to_array().map(|x| x as f32))
    };
    match l.kind {
        ETD_LIGHT_POINT => Ok(EmitterKind::Point {
            position: l.position,
            intensity: l.color,
        }),
        ETD_LIGHT_SPOT => {
            ensure(
                l.cutoff > 1e-3 && l.cutoff < std::f32::consts::PI,
                "cutoff must be an angle in (0.001, pi)",
            )?;
            ensure(
                (0.0..=l.cutoff).contains(&l.beam_width),
                "beam_width must be 0 to cutoff",
            )?;
            Ok(EmitterKind::Spot {
                position: l.position,
                direction: direction()?,
                intensity: l.color,
                cutoff: l.cutoff,
                beam_width: l.beam_width,
            })
        }
        ETD_LIGHT_DIRECTIONAL => Ok(EmitterKind::Directional {
            direction: direction()?,
            irradiance: l.color,
        }),
        ETD_LIGHT_CONSTANT => Ok(EmitterKind::Constant { radiance: l.color }),
        ETD_LIGHT_LATLONG | ETD_LIGHT_CUBEMAP => {
            let cube = l.kind == ETD_LIGHT_CUBEMAP;
            ensure((1..=1 << 16).contains(&l.width), "width must be 1 to 65536")?;
            ensure(
                if cube {
                    u64::from(l.height) == 6 * u64::from(l.width) && l.height <= 1 << 18
                } else {
                    (2..=1 << 16).contains(&l.height)
                },
                "height must be 2 to 65536, or 6 times width of a cube",
            )?;
            ensure((0.0..=1e30).contains(&l.scale), "scale must be 0 to 1e30")?;
            ensure(right_angles(l.axes), "axes must be unit, at right angles")?;
            let count = l.width as usize * l.height as usize;
            if count.checked_mul(3) != Some(l.floats) {
                let reason = format!("light: {} floats, expected {count} times 3", l.floats);
                return Err(Trouble::new(ETD_E_SIZE, reason));
            }
            let texels = slice(l.texels.cast::<Color>(), count)?;
            ensure(emitted(texels.as_flattened()), "texels must be 0 to 1e30")?;
            let (texels, to_local) = (copied(texels)?, l.axes);
            Ok(match cube {
                true => EmitterKind::CubeMap {
                    width: l.width,
                    texels,
                    scale: l.scale,
                    to_local,
                },
                false => EmitterKind::LatLong {
                    width: l.width,
                    height: l.height,
                    texels,
                    scale: l.scale,
                    to_local,
                },
            })
        }
        _ => Err(bad("unknown kind")),
    }
}

fn right_angles(axes: [[f32; 3]; 3]) -> bool {
    let axes = axes.map(|a| DVec3::from(a.map(f64::from)));
    (0..3).all(|i| {
        let next = axes[(i + 1) % 3];
        (axes[i].length() - 1.0).abs() <= 1e-4 && axes[i].dot(next).abs() <= 1e-4
    })
}
