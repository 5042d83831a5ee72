//! What the estimators are compiled for: a scene pays only for what it needs (`transport.md` §9).

use crate::spectrum::Spectrum;
use core::marker::PhantomData;

/// An instance of the estimators. What it leaves out isn't in its code.
pub trait Instance: Copy {
    /// What a path carries.
    type S: Spectrum;
    /// Whether there are media: free flight, transmittance, vertices in volumes, a leading channel.
    const MEDIA: bool;
}

/// Surfaces in empty space.
#[derive(Clone, Copy, Debug)]
pub struct Surfaces<S>(PhantomData<S>);

impl<S: Spectrum> Instance for Surfaces<S> {
    type S = S;
    const MEDIA: bool = false;
}

/// Surfaces and scattering volumes.
#[cfg(feature = "media")]
#[derive(Clone, Copy, Debug)]
pub struct Volumes<S>(PhantomData<S>);

#[cfg(feature = "media")]
impl<S: Spectrum> Instance for Volumes<S> {
    type S = S;
    const MEDIA: bool = true;
}
