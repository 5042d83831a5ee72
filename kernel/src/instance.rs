//! What the estimators are compiled for: a scene pays only for what it needs (`transport.md` §9).
//!
//! [`crate::estimate_with`] takes the first of these that has all that the scene says it needs ([`crate::blob::format::needs`]).

use crate::spectrum::Spectrum;
use core::marker::PhantomData;

/// An instance of the estimators. What it leaves out isn't in its code.
pub trait Instance: Copy {
    /// What a path carries.
    type S: Spectrum;
    /// Whether there are glossy models among the surfaces.
    const GLOSSY: bool;
    /// Whether there are surfaces that treat channels differently: densities by channel.
    const DISPERSIVE: bool;
    /// Whether there are media: free flight, transmittance, vertices in volumes, a leading channel.
    const MEDIA: bool;
}

/// Surfaces in empty space.
#[derive(Clone, Copy, Debug)]
pub struct Surfaces<S>(PhantomData<S>);

impl<S: Spectrum> Instance for Surfaces<S> {
    type S = S;
    const GLOSSY: bool = false;
    const DISPERSIVE: bool = false;
    const MEDIA: bool = false;
}

/// Surfaces in empty space, glossy ones among them.
#[cfg(feature = "glossy")]
#[derive(Clone, Copy, Debug)]
pub struct GlossySurfaces<S>(PhantomData<S>);

#[cfg(feature = "glossy")]
impl<S: Spectrum> Instance for GlossySurfaces<S> {
    type S = S;
    const GLOSSY: bool = true;
    const DISPERSIVE: bool = false;
    const MEDIA: bool = false;
}

/// Scattering volumes, and surfaces of which none is glossy.
#[cfg(feature = "media")]
#[derive(Clone, Copy, Debug)]
pub struct Volumes<S>(PhantomData<S>);

#[cfg(feature = "media")]
impl<S: Spectrum> Instance for Volumes<S> {
    type S = S;
    const GLOSSY: bool = false;
    const DISPERSIVE: bool = false;
    const MEDIA: bool = true;
}

#[cfg(feature = "media")]
impl<S> Volumes<S> {
    /// Whether they have code of their own. Not without glossy models, where [`Complete`] is the same; nor where the size of code counts more than the 1 to 3 % that walks
    /// through volumes take longer by `Complete`: in a browser's module, in flash, in what a GPU's driver compiles, and in double precision, which is for comparisons.
    pub const APART: bool = cfg!(all(
        feature = "glossy",
        not(any(
            feature = "f64",
            target_family = "wasm",
            target_arch = "arm",
            target_arch = "nvptx64"
        ))
    ));
}

/// All there is: surfaces, dispersing ones among them, and scattering volumes.
#[cfg(feature = "media")]
#[derive(Clone, Copy, Debug)]
pub struct Complete<S>(PhantomData<S>);

#[cfg(feature = "media")]
impl<S: Spectrum> Instance for Complete<S> {
    type S = S;
    const GLOSSY: bool = cfg!(feature = "glossy");
    const DISPERSIVE: bool = cfg!(feature = "spectral");
    const MEDIA: bool = true;
}
