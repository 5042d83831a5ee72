//! What fills objects.

use crate::arguments::{Sized32, input, place, slice};
use crate::boundary::{Trouble, copied, fill};
use crate::builder::{EtdBuilder, edit};
use crate::surface::{finite, optional_id};
use etendue::capi::status::{ETD_E_ARGUMENT, ETD_E_SIZE, EtdStatus};
use etendue_host::description::{Grid, GridValues, Grids, Lobe, Medium, Phase, Place, Tracking};

/// Scatters alike in all directions.
pub const ETD_PHASE_ISOTROPIC: u32 = 0;
/// Henyey and Greenstein's, with the asymmetry `g`.
pub const ETD_PHASE_HG: u32 = 1;
/// Rayleigh's, of particles much smaller than wavelengths.
pub const ETD_PHASE_RAYLEIGH: u32 = 2;
/// Straight on.
pub const ETD_PHASE_FORWARD: u32 = 3;

/// Grids are tracked by Woodcock's method, transmittance by ratio tracking.
pub const ETD_TRACK_WOODCOCK: u32 = 0;
/// Transmittance by residual ratio tracking; `extinction` has one channel, and those of `sigma_t` are the same.
pub const ETD_TRACK_RESIDUAL: u32 = 1;
/// Cell by cell, exactly.
pub const ETD_TRACK_REGULAR: u32 = 2;

/// A part of a phase function.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdLobe {
    /// `ETD_PHASE_…`.
    pub kind: u32,
    /// `ETD_PHASE_HG`: mean cosine between the directions in which light travels, in (−1, 1); > 0 is forwards.
    pub g: f32,
    /// Its share relative to the others', ≥ 0.
    pub weight: f32,
}

/// Numbers over a box, each of them for the middle of its texel.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdGrid {
    /// Texels in x, y and z, each 1 to 4096.
    pub size: [u32; 3],
    /// Numbers to a texel: 1, or 3 for RGB.
    pub channels: u32,
    /// 1: those of the nearest texel; 0: trilinear between them.
    pub nearest: u32,
    /// Zero.
    pub reserved: u32,
    /// The numbers, ≥ 0: channels fastest, then x, y, z. Null: no grid, 1 everywhere.
    pub values: *const f32,
    /// How many they are.
    pub floats: usize,
}

/// A medium. `etd_medium_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdMedium {
    /// sizeof(EtdMedium).
    pub struct_size: u32,
    /// `ETD_TRACK_…`, of a medium with grids.
    pub tracking: u32,
    /// Extinction, 1 over world units, 0 or 1e-12 to 1e12; times `extinction` if that is a grid.
    pub sigma_t: [f32; 3],
    /// Scattering as a part of extinction, 0 to 1; times `albedos` if that is a grid.
    pub albedo: [f32; 3],
    /// What it emits, W/(m³ sr), 0 to 1e20, times `emissions` if that is a grid; 0 where it doesn't absorb.
    pub emission: [f32; 3],
    /// The phase function: its parts.
    pub phase: [EtdLobe; 4],
    /// World space to the grids' box, the unit cube: 12 numbers, three rows of four. Outside of the cube there is nothing.
    pub to_grid: [[f32; 4]; 3],
    /// Zero.
    pub reserved: u32,
    /// Without it the medium is the same everywhere.
    pub extinction: EtdGrid,
    /// Only beside `extinction`.
    pub albedos: EtdGrid,
    /// Only beside `extinction`.
    pub emissions: EtdGrid,
}

// SAFETY: repr(C), the size first, numbers and pointers only.
unsafe impl Sized32 for EtdMedium {}

fn bad(reason: impl Into<String>) -> Trouble {
    Trouble::new(ETD_E_ARGUMENT, reason)
}

/// The same everywhere, with an extinction of 1 and an albedo of 0.75; scatters alike in all directions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_medium_default(medium: *mut EtdMedium) -> EtdStatus {
    fill(medium, || {
        let grid = EtdGrid {
            size: [1; 3],
            channels: 1,
            nearest: 0,
            reserved: 0,
            values: std::ptr::null(),
            floats: 0,
        };
        let lobe = |weight| EtdLobe {
            kind: ETD_PHASE_ISOTROPIC,
            g: 0.0,
            weight,
        };
        EtdMedium {
            struct_size: size_of::<EtdMedium>() as u32,
            tracking: ETD_TRACK_WOODCOCK,
            sigma_t: [1.0; 3],
            albedo: [0.75; 3],
            emission: [0.0; 3],
            phase: [lobe(1.0), lobe(0.0), lobe(0.0), lobe(0.0)],
            to_grid: [
                [1.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0],
            ],
            reserved: 0,
            extinction: grid,
            albedos: grid,
            emissions: grid,
        }
    })
}

/// Adds a medium and writes its id, counted from 0. Its numbers are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_medium(
    builder: *mut EtdBuilder,
    medium: *const EtdMedium,
    id: *mut u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let (m, id) = (input(medium)?, place(id)?);
        let new = scene.media.len();
        let medium = described(&m, format!("medium {new}"))?;
        scene.media.push(medium);
        *id = new as u32;
        Ok(())
    })
}

/// Says what is behind the front of an object, `interior`, and before it, `exterior`; `ETD_NONE` is vacuum. Where both are, as at first, the
/// object doesn't part media: it stands in whichever is there. Objects touch, nest or stand apart: those that overlap are refused
/// by the build. The media at the camera and at lights are found from the objects around them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_media(
    builder: *mut EtdBuilder,
    object: u32,
    interior: u32,
    exterior: u32,
) -> EtdStatus {
    edit(builder, |scene| {
        let media = scene.media.len();
        let interior = optional_id("medium", interior, media)?;
        let exterior = optional_id("medium", exterior, media)?;
        let object = scene.objects.get_mut(object as usize);
        let object = object.ok_or_else(|| bad("there is no such object"))?;
        (object.shape.interior, object.shape.exterior) = (interior, exterior);
        Ok(())
    })
}

/// Says what fills the space outside all objects; `ETD_NONE`, as at first: what they are met from. Through a medium that fills all space
/// no light comes from infinity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_exterior(
    builder: *mut EtdBuilder,
    medium: u32,
) -> EtdStatus {
    edit(builder, |scene| {
        scene.exterior = optional_id("medium", medium, scene.media.len())?;
        Ok(())
    })
}

fn described(m: &EtdMedium, name: String) -> Result<Medium, Trouble> {
    let within = |values: &[f32], most: f32| values.iter().all(|x| (0.0..=most).contains(x));
    let thin = |s: &f32| *s == 0.0 || (1e-12..=1e12).contains(s);
    let ranges = m.sigma_t.iter().all(thin) && within(&m.albedo, 1.0) && within(&m.emission, 1e20);
    if !ranges || m.reserved != 0 {
        return Err(bad(
            "medium: sigma_t must be 0 or 1e-12 to 1e12, albedo 0 to 1, emission 0 to 1e20, reserved 0",
        ));
    }
    let tracking = match m.tracking {
        ETD_TRACK_WOODCOCK => Tracking::Woodcock,
        ETD_TRACK_RESIDUAL => Tracking::Residual,
        ETD_TRACK_REGULAR => Tracking::Regular,
        _ => return Err(bad("medium: unknown tracking")),
    };
    let mut phase = Vec::new();
    for l in &m.phase {
        phase.push(lobe(l)?);
    }
    phase.retain(|l: &Lobe| l.weight > 0.0);
    if phase.is_empty() {
        return Err(bad("medium: no part of the phase function has a weight"));
    }
    if !finite(m.to_grid.as_flattened()) {
        return Err(bad("medium: to_grid is not finite"));
    }
    let (albedo, emission) = (grid(&m.albedos)?, grid(&m.emissions)?);
    let grids = match grid(&m.extinction)? {
        Some(extinction) => Some(Grids {
            extinction,
            albedo,
            emission,
            to_grid: m.to_grid,
            tracking,
        }),
        None if albedo.is_some() || emission.is_some() => {
            return Err(bad(
                "medium: grids of albedo and emission need one of extinction",
            ));
        }
        None => None,
    };
    Ok(Medium {
        name,
        place: Place::default(),
        sigma_t: m.sigma_t,
        albedo: m.albedo,
        emission: m.emission,
        phase,
        spectra: [const { None }; 3],
        grids,
    })
}

fn lobe(l: &EtdLobe) -> Result<Lobe, Trouble> {
    if !(l.weight >= 0.0 && l.weight <= 1e30) {
        return Err(bad("medium: weights of phase functions must be 0 to 1e30"));
    }
    let phase = match l.kind {
        ETD_PHASE_ISOTROPIC => Phase::Isotropic,
        ETD_PHASE_HG if l.g > -1.0 && l.g < 1.0 => Phase::HenyeyGreenstein { g: l.g },
        ETD_PHASE_HG => return Err(bad("medium: g must be between -1 and 1")),
        ETD_PHASE_RAYLEIGH => Phase::Rayleigh,
        ETD_PHASE_FORWARD => Phase::Forward,
        _ => return Err(bad("medium: unknown phase function")),
    };
    Ok(Lobe {
        phase,
        weight: l.weight,
    })
}

fn grid(g: &EtdGrid) -> Result<Option<Grid>, Trouble> {
    if g.values.is_null() && g.floats == 0 {
        return Ok(None);
    }
    let sizes = g.size.iter().all(|n| (1..=4096).contains(n));
    if !sizes || ![1, 3].contains(&g.channels) || g.nearest > 1 || g.reserved != 0 {
        return Err(bad(
            "grid: size must be 1 to 4096, channels 1 or 3, nearest 0 or 1, reserved 0",
        ));
    }
    // At most 2³⁶ · 3.
    let [x, y, z] = g.size.map(u64::from);
    let count = x * y * z * u64::from(g.channels);
    if g.floats as u64 != count {
        let reason = format!("grid: {} floats, expected {count}", g.floats);
        return Err(Trouble::new(ETD_E_SIZE, reason));
    }
    let values = slice(g.values, g.floats)?;
    if !values.iter().all(|v| *v >= 0.0 && v.is_finite()) {
        return Err(bad("grid: values must be finite and >= 0"));
    }
    let values = match g.channels {
        1 => GridValues::Gray(copied(values)?),
        _ => GridValues::Rgb(copied(values.as_chunks::<3>().0)?),
    };
    Ok(Some(Grid {
        size: g.size,
        values,
        nearest: g.nearest == 1,
    }))
}
