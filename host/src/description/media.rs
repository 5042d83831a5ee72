//! What fills scattering volumes.

use super::{Color, Place, Spectrum};

/// A medium: absorbs, scatters, emits.
#[derive(Clone, Debug)]
pub struct Medium {
    /// What messages call it.
    pub name: String,
    /// Where it was said.
    pub place: Place,
    /// Extinction σ_t in 1 over scene units; with grids the factor of theirs. Each channel 0 or in [1e-12, 1e12].
    pub sigma_t: Color,
    /// Albedo σ_s/σ_t; with grids the factor of theirs. Each channel in [0, 1].
    pub albedo: Color,
    /// Emission E in W m⁻³ sr⁻¹; with grids the factor of theirs. Each channel in [0, 1e20]; where it is > 0 so must absorption be.
    pub emission: Color,
    /// Parts of the phase function, one to four; their weights are relative to each other.
    pub phase: Vec<Lobe>,
    /// σ_t, albedo and E by wavelength, where that is known; the colours are what they stand for in red, green and blue. Not with grids.
    pub spectra: [Option<Spectrum>; 3],
    /// How it varies; `None`: the same everywhere.
    pub grids: Option<Grids>,
}

impl Default for Medium {
    /// Nothing: vacuum with a name.
    fn default() -> Self {
        Self {
            name: String::new(),
            place: Place::default(),
            sigma_t: [0.0; 3],
            albedo: [0.0; 3],
            emission: [0.0; 3],
            phase: vec![Lobe::from(Phase::Isotropic)],
            spectra: [const { None }; 3],
            grids: None,
        }
    }
}

/// A part of a phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Which.
    pub phase: Phase,
    /// Its share relative to the others', ≥ 0.
    pub weight: f32,
}

impl From<Phase> for Lobe {
    fn from(phase: Phase) -> Self {
        Self { phase, weight: 1.0 }
    }
}

/// The phase functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// 1/4π.
    Isotropic,
    /// Henyey and Greenstein's.
    HenyeyGreenstein {
        /// Mean cosine between the directions of propagation, in (−1, 1); > 0 is forwards.
        g: f32,
    },
    /// 3/16π·(1 + cos²).
    Rayleigh,
    /// Straight on: a Dirac.
    Forward,
}

/// How a medium varies over the unit cube of its grids; outside of the cube there is nothing.
#[derive(Clone, Debug)]
pub struct Grids {
    /// Extinction in units of [`Medium::sigma_t`].
    pub extinction: Grid,
    /// Albedo in units of [`Medium::albedo`]; `None`: 1.
    pub albedo: Option<Grid>,
    /// Emission in units of [`Medium::emission`]; `None`: 1.
    pub emission: Option<Grid>,
    /// World to the unit cube: (x, y, z, 1) times these rows.
    pub to_grid: [[f32; 4]; 3],
    /// How distances and transmittance are found.
    pub tracking: Tracking,
}

/// How the kernel finds its way through grids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tracking {
    /// Woodcock's free flight, transmittance by ratio tracking.
    #[default]
    Woodcock,
    /// Woodcock's free flight, transmittance by residual ratio tracking. Asks for extinction of one channel, the same in all of `sigma_t`.
    Residual,
    /// Cell by cell, exactly.
    Regular,
}

/// Values over the unit cube, texel-centred; beyond the outermost centres they stay as they are there.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Texels by axis, each in [1, 4096].
    pub size: [u32; 3],
    /// x fastest, then y, then z; each value finite and ≥ 0.
    pub values: GridValues,
    /// Nearest texel instead of trilinear.
    pub nearest: bool,
}

/// How many numbers a texel has.
#[derive(Clone, Debug)]
pub enum GridValues {
    /// One for all channels.
    Gray(Vec<f32>),
    /// One for each channel.
    Rgb(Vec<Color>),
}

impl GridValues {
    /// All numbers, and how many make a texel.
    pub fn flat(&self) -> (&[f32], usize) {
        match self {
            Self::Gray(values) => (values, 1),
            Self::Rgb(values) => (values.as_flattened(), 3),
        }
    }
}
