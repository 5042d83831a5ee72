//! How to estimate.

use super::arguments::{Sized32, input};
use super::status::{ETD_E_ARGUMENT, ETD_E_MISALIGNED, ETD_E_NULL, EtdStatus, status_of};
use crate::estimate::{Estimator, Settings};
use crate::path::Heuristic;

/// A walk from the sensor, with a light sampled at each vertex.
pub const ETD_PATH: u32 = 0;
/// A walk from a light, each vertex joined to the sensor. Reports splats.
pub const ETD_LIGHT: u32 = 1;
/// Both walks and all connections between them. Reports splats.
pub const ETD_BIDIRECTIONAL: u32 = 2;

/// Weights in proportion to densities.
pub const ETD_BALANCE: u32 = 0;
/// Weights in proportion to squared densities.
pub const ETD_POWER: u32 = 1;
/// Balance, without strategies of less than a tenth of the best one's density.
pub const ETD_CUTOFF: u32 = 2;
/// The densest strategy alone.
pub const ETD_MAXIMUM: u32 = 3;

/// How to estimate. `etd_settings_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdSettings {
    /// sizeof(EtdSettings).
    pub struct_size: u32,
    /// `ETD_PATH`, `ETD_LIGHT` or `ETD_BIDIRECTIONAL`.
    pub estimator: u32,
    /// `ETD_BALANCE`, `ETD_POWER`, `ETD_CUTOFF` or `ETD_MAXIMUM`.
    pub heuristic: u32,
    /// The most edges of a path (1: emitters seen directly, 2: direct light, …); −1: no limit.
    pub max_edges: i32,
    /// Selects the random numbers.
    pub seed: u64,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdSettings {}

/// Path tracing with the power heuristic, paths of any length, seed 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_settings_default(settings: *mut EtdSettings) -> EtdStatus {
    status_of((|| {
        if settings.is_null() {
            return Err(ETD_E_NULL);
        }
        if !settings.is_aligned() {
            return Err(ETD_E_MISALIGNED);
        }
        // SAFETY: not null and aligned; the caller's to give.
        unsafe {
            settings.write(EtdSettings {
                struct_size: size_of::<EtdSettings>() as u32,
                estimator: ETD_PATH,
                heuristic: ETD_POWER,
                max_edges: -1,
                seed: 0,
            });
        }
        Ok(())
    })())
}

pub(super) fn settings(pointer: *const EtdSettings) -> Result<Settings, EtdStatus> {
    let s = input(pointer)?;
    Ok(Settings {
        estimator: match s.estimator {
            ETD_PATH => Estimator::Path,
            #[cfg(feature = "light")]
            ETD_LIGHT => Estimator::Light,
            #[cfg(not(feature = "light"))]
            ETD_LIGHT => return Err(super::status::ETD_E_UNSUPPORTED),
            #[cfg(feature = "bidirectional")]
            ETD_BIDIRECTIONAL => Estimator::Bidirectional,
            #[cfg(not(feature = "bidirectional"))]
            ETD_BIDIRECTIONAL => return Err(super::status::ETD_E_UNSUPPORTED),
            _ => return Err(ETD_E_ARGUMENT),
        },
        heuristic: match s.heuristic {
            ETD_BALANCE => Heuristic::Balance,
            ETD_POWER => Heuristic::Power,
            ETD_CUTOFF => Heuristic::Cutoff,
            ETD_MAXIMUM => Heuristic::Maximum,
            _ => return Err(ETD_E_ARGUMENT),
        },
        max_edges: match s.max_edges {
            -1 => None,
            n => Some(u32::try_from(n).map_err(|_| ETD_E_ARGUMENT)?),
        },
        seed: s.seed,
        explicit_weights: false,
    })
}

impl EtdSettings {
    /// What the caller's struct asks for, for libraries that add functions of their own.
    ///
    /// # Errors
    /// `ETD_E_NULL`, `ETD_E_MISALIGNED`, `ETD_E_SIZE`, `ETD_E_ARGUMENT`, `ETD_E_UNSUPPORTED`.
    ///
    /// # Safety
    /// If the pointer is neither null nor misaligned, it points to a live struct whose first member is its size.
    pub unsafe fn get(pointer: *const Self) -> Result<Settings, EtdStatus> {
        settings(pointer)
    }
}
