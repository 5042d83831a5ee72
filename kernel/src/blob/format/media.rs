//! The records of scattering volumes.

use bytemuck::{Pod, Zeroable};

/// Kinds of media and of phase functions, flags.
pub mod medium {
    /// The same everywhere.
    pub const HOMOGENEOUS: u32 = 0;
    /// Given by grids.
    pub const GRID: u32 = 1;
    /// Flag on a grid: free flight and transmittance by regular tracking (through the cells one by one, exact) in place of
    /// Woodcock's and ratio tracking.
    pub const REGULAR: u32 = 1;
    /// Flag on a grid whose extinction has one channel: transmittance by residual ratio tracking.
    pub const RESIDUAL: u32 = 2;
    /// Phase function: 1/4π.
    pub const ISOTROPIC: u32 = 0;
    /// Phase function of Henyey and Greenstein with asymmetry `g`.
    pub const HENYEY_GREENSTEIN: u32 = 1;
    /// Phase function 3/16π·(1 + cos²).
    pub const RAYLEIGH: u32 = 2;
    /// Straight on: a Dirac.
    pub const FORWARD: u32 = 3;
}

/// One part of a phase function.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Lobe {
    /// Which phase function ([`medium`]).
    pub kind: u32,
    /// Henyey-Greenstein: mean cosine between the directions of propagation, in (−1, 1); > 0 is forwards.
    pub g: f32,
    /// Its share, ≥ 0; the four shares of a medium add up to 1.
    pub weight: f32,
    /// Zero.
    pub reserved: u32,
}

/// What fills a scattering volume.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Medium {
    /// Which kind ([`medium`]).
    pub kind: u32,
    /// Its flags.
    pub flags: u32,
    /// grid: [`Grid`] of the extinction, in units of `sigma_t`.
    pub extinctions: u32,
    /// grid: [`Grid`] of the albedo, in units of `albedo`, or [`NONE`][super::NONE]: 1 everywhere.
    pub albedos: u32,
    /// grid: [`Grid`] of the emission, in units of `emission`, or [`NONE`][super::NONE]: 1 wherever the grid is.
    pub emissions: u32,
    /// grid: first word in [`TEXELS`][super::section::TEXELS] of the majorants: `f32`, x fastest, one for each of `cells` boxes into which the
    /// unit cube is cut: at least σ_t of every channel anywhere in the box.
    pub majorants: u32,
    /// grid: boxes of the majorants by axis.
    pub cells: [u32; 3],
    /// Its [`VOLUME`][super::emitter::VOLUME] emitter, or [`NONE`][super::NONE].
    pub emitter: u32,
    /// homogeneous: `sigma_t` by wavelength: first word in [`TEXELS`][super::section::TEXELS] of rows of two `f32`, nm and value, by rising wavelength,
    /// and their number; none: what `sigma_t` stands for.
    pub sigma_t_spectrum: [u32; 2],
    /// Extinction σ_t per channel, in 1 over scene units, ≥ 0.
    pub sigma_t: [f32; 3],
    /// Albedo σ_s/σ_t per channel, in [0, 1].
    pub albedo: [f32; 3],
    /// Emission E per channel, W m⁻³ sr⁻¹, ≥ 0; where it is > 0 so is absorption.
    pub emission: [f32; 3],
    /// Extinction that the weights of multiple importance sampling assume, per channel: `sigma_t` where it is the same
    /// everywhere, else its mean; > 0 where `sigma_t` is. Any value keeps estimates unbiased.
    pub mean: [f32; 3],
    /// The phase function: parts and their shares.
    pub phase: [Lobe; 4],
    /// grid: (x, y, z, 1) times these rows gives coordinates in the grids' unit cube. Outside of the cube there is nothing.
    pub to_grid: [[f32; 4]; 3],
    /// homogeneous: `albedo` by wavelength, like `sigma_t_spectrum`.
    pub albedo_spectrum: [u32; 2],
    /// homogeneous: `emission` by wavelength, like `sigma_t_spectrum`.
    pub emission_spectrum: [u32; 2],
}

/// Values over the unit cube, ≥ 0: texel-centred, x fastest, then y, then z.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Grid {
    /// 1: the nearest texel rather than trilinear. Beyond the outermost centres values stay as they are there.
    pub nearest: u32,
    /// 1 or 3 values a texel.
    pub channels: u32,
    /// Texels by axis, each in [1, 4096].
    pub size: [u32; 3],
    /// First word in [`TEXELS`][super::section::TEXELS]: `f32`.
    pub texels: u32,
    /// Zero.
    pub reserved: [u32; 2],
}
