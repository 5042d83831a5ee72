//! How to estimate.

use super::arguments::{Sized32, input};
use super::status::{ETD_E_ARGUMENT, ETD_E_MISALIGNED, ETD_E_NULL, EtdStatus, status_of};
#[cfg(feature = "metropolis")]
use crate::estimate::Mutations;
use crate::estimate::{Estimator, Rule, Settings, Tree};
use crate::path::Heuristic;
use crate::random::Sequence;

/// A walk from the sensor, with a light sampled at each vertex.
pub const ETD_PATH: u32 = 0;
/// A walk from a light, each vertex joined to the sensor. Reports splats.
pub const ETD_LIGHT: u32 = 1;
/// Both walks and all connections between them. Reports splats.
pub const ETD_BIDIRECTIONAL: u32 = 2;
/// Ray trees to a stated depth (`branching`); longer paths are left out.
pub const ETD_DISTRIBUTED: u32 = 3;
/// Direct light and single scattering by quadrature (`quadrature`, `steps`); all other light is left out. Scenes with
/// environments, constant backgrounds or glowing media: `ETD_E_UNSUPPORTED`.
pub const ETD_QUADRATURE: u32 = 4;
/// The same, and what it leaves out by path tracing.
pub const ETD_QUADRATURE_AND_PATH: u32 = 5;
/// Chains of paths over `ETD_BIDIRECTIONAL` (`etd_chain_advance`). Where samples of pixels, rays or points are asked for, they are those of
/// `ETD_BIDIRECTIONAL`.
pub const ETD_METROPOLIS: u32 = 6;

/// Weights in proportion to densities.
pub const ETD_BALANCE: u32 = 0;
/// Weights in proportion to squared densities.
pub const ETD_POWER: u32 = 1;
/// Balance, without strategies of less than a tenth of the best one's density.
pub const ETD_CUTOFF: u32 = 2;
/// The densest strategy alone.
pub const ETD_MAXIMUM: u32 = 3;

/// Independent numbers.
pub const ETD_INDEPENDENT: u32 = 0;
/// Owen-scrambled Sobol' points: the samples of a pixel spread evenly. Best for a power of two of samples.
pub const ETD_SOBOL: u32 = 1;

/// How to estimate. `etd_settings_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdSettings {
    /// sizeof(EtdSettings).
    pub struct_size: u32,
    /// `ETD_PATH`, `ETD_LIGHT`, `ETD_BIDIRECTIONAL`, `ETD_DISTRIBUTED`, `ETD_QUADRATURE`, `ETD_QUADRATURE_AND_PATH` or
    /// `ETD_METROPOLIS`.
    pub estimator: u32,
    /// `ETD_BALANCE`, `ETD_POWER`, `ETD_CUTOFF` or `ETD_MAXIMUM`.
    pub heuristic: u32,
    /// The most edges of a path (1: emitters seen directly, 2: direct light, …); −1: no limit.
    pub max_edges: i32,
    /// Selects the random numbers.
    pub seed: u64,
    /// `ETD_DISTRIBUTED`: rays that go on from a vertex, by level, up to the first 0; paths have at most an edge more than there are
    /// levels. The scratch's capacity bounds the levels as well.
    pub branching: [u8; 8],
    /// `ETD_DISTRIBUTED`: samples of lights at each vertex, 1 to 255.
    pub light_samples: u32,
    /// Quadrature: nodes of the Gauss–Legendre rule in each direction across an emitting triangle or sphere, 1 to 8.
    pub quadrature: u32,
    /// Quadrature: steps of the trapezoid rule along a way through a medium, 1 to 65535.
    pub steps: u32,
    /// Quadrature: not 0: equal steps shifted at random in place of these rules, without bias.
    pub shift: u32,
    /// `ETD_INDEPENDENT` or `ETD_SOBOL`.
    pub sequence: u32,
    /// Walks that carry less than this share of what they began with go on by Russian roulette, 0 to 1. So are connections of
    /// `bidirectional` looked at that carry less than a tenth of this share of what their sample has so far. 0: no roulette.
    pub roulette: f32,
    /// `ETD_METROPOLIS`: how often a step of a chain is a path drawn anew, 0 to 1.
    pub large_steps: f32,
    /// `ETD_METROPOLIS`: the largest change of a random number in what steps are left, above 0, at most 0.5.
    pub step_size: f32,
    /// `ETD_METROPOLIS`: the share of the other steps that move the path's place in the image and nothing else, 0 to 1.
    pub view_steps: f32,
    /// `ETD_METROPOLIS`: what chains leave to the samples of the bootstrap: what a contribution carries up to so much, a radiance, at least 0. 0: nothing.
    pub above: f32,
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
        let (tree, rule) = (Tree::default(), Rule::default());
        // SAFETY: not null and aligned; the caller's to give.
        unsafe {
            settings.write(EtdSettings {
                struct_size: size_of::<EtdSettings>() as u32,
                estimator: ETD_PATH,
                heuristic: ETD_POWER,
                max_edges: -1,
                seed: 0,
                branching: tree.branching,
                light_samples: tree.lights.into(),
                quadrature: rule.order.into(),
                steps: rule.steps.into(),
                shift: rule.shift.into(),
                sequence: ETD_INDEPENDENT,
                roulette: Settings::default().roulette,
                #[cfg(feature = "metropolis")]
                large_steps: Settings::default().mutations.large,
                #[cfg(not(feature = "metropolis"))]
                large_steps: 0.0,
                #[cfg(feature = "metropolis")]
                step_size: Settings::default().mutations.size,
                #[cfg(not(feature = "metropolis"))]
                step_size: 0.0,
                #[cfg(feature = "metropolis")]
                view_steps: Settings::default().mutations.view,
                #[cfg(not(feature = "metropolis"))]
                view_steps: 0.0,
                above: 0.0,
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
            #[cfg(feature = "distributed")]
            ETD_DISTRIBUTED => Estimator::Distributed,
            #[cfg(not(feature = "distributed"))]
            ETD_DISTRIBUTED => return Err(super::status::ETD_E_UNSUPPORTED),
            #[cfg(feature = "quadrature")]
            ETD_QUADRATURE => Estimator::Quadrature,
            #[cfg(feature = "quadrature")]
            ETD_QUADRATURE_AND_PATH => Estimator::QuadratureAndPath,
            #[cfg(feature = "metropolis")]
            ETD_METROPOLIS => Estimator::Metropolis,
            #[cfg(not(feature = "metropolis"))]
            ETD_METROPOLIS => return Err(super::status::ETD_E_UNSUPPORTED),
            #[cfg(not(feature = "quadrature"))]
            ETD_QUADRATURE | ETD_QUADRATURE_AND_PATH => {
                return Err(super::status::ETD_E_UNSUPPORTED);
            }
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
        sequence: match s.sequence {
            ETD_INDEPENDENT => Sequence::Independent,
            #[cfg(feature = "sobol")]
            ETD_SOBOL => Sequence::Sobol,
            #[cfg(not(feature = "sobol"))]
            ETD_SOBOL => return Err(super::status::ETD_E_UNSUPPORTED),
            _ => return Err(ETD_E_ARGUMENT),
        },
        seed: s.seed,
        roulette: share(s.roulette)?,
        tree: Tree {
            branching: s.branching,
            lights: within(s.light_samples, 1, u8::MAX.into())? as u8,
        },
        rule: Rule {
            order: within(s.quadrature, 1, Rule::MAX_ORDER.into())? as u8,
            steps: within(s.steps, 1, u16::MAX.into())? as u16,
            shift: s.shift != 0,
            ..Rule::default()
        },
        #[cfg(feature = "metropolis")]
        mutations: Mutations {
            large: share(s.large_steps)?,
            view: share(s.view_steps)?,
            size: match s.step_size {
                size if size > 0.0 && size <= 0.5 => size,
                _ => return Err(ETD_E_ARGUMENT),
            },
            above: match s.above {
                above if above >= 0.0 && above.is_finite() => above,
                _ => return Err(ETD_E_ARGUMENT),
            },
        },
        explicit_weights: false,
    })
}

/// A share of something.
fn share(x: f32) -> Result<f32, EtdStatus> {
    if (0.0..=1.0).contains(&x) {
        Ok(x)
    } else {
        Err(ETD_E_ARGUMENT)
    }
}

/// A number in its range.
fn within(x: u32, least: u32, most: u32) -> Result<u32, EtdStatus> {
    if (least..=most).contains(&x) {
        Ok(x)
    } else {
        Err(ETD_E_ARGUMENT)
    }
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
