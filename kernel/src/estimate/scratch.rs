//! The memory that an estimate works in.

use crate::blob::Scene;
#[cfg(feature = "spectral")]
use crate::blob::format::needs;
use crate::path::{Counters, History, HistoryView, Link, Vertex};
#[cfg(feature = "spectral")]
use crate::spectrum::Hero;
use crate::spectrum::{Rgb, Spectrum};
use heapless::{Vec, VecView};

/// Memory that an estimate works in, owned by the caller: `N` bounds the light walk's vertices (strategies
/// with more don't exist), not the length of paths. It bounds the depth of [`super::Estimator::Distributed`]'s trees, too, and how many Dirac
/// lobes [`super::Estimator::Quadrature`] follows one after the other.
#[derive(Clone)]
pub struct Scratch<const N: usize = 32> {
    light: Stored<N>,
    links: Vec<Link, N>,
    sensor: History<N>,
    /// What happened since the caller last set this to its default.
    pub counters: Counters,
}

/// The light walk, of channels or of wavelengths.
#[derive(Clone)]
enum Stored<const N: usize> {
    Rgb(Vec<Vertex<Rgb>, N>),
    #[cfg(feature = "spectral")]
    Spectral(Vec<Vertex<Hero>, N>),
}

impl<const N: usize> Scratch<N> {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            light: Stored::Rgb(Vec::new()),
            links: Vec::new(),
            sensor: History::new(),
            counters: Counters::ZERO,
        }
    }

    /// What estimators take, for what paths of `scene` carry.
    #[inline(always)]
    pub fn view(&mut self, scene: &Scene<'_>) -> ScratchView<'_> {
        #[cfg(feature = "spectral")]
        match (&self.light, scene.has(needs::SPECTRAL)) {
            (Stored::Rgb(_), true) => self.light = Stored::Spectral(Vec::new()),
            (Stored::Spectral(_), false) => self.light = Stored::Rgb(Vec::new()),
            _ => {}
        }
        let _ = scene;
        ScratchView {
            light: match &mut self.light {
                Stored::Rgb(light) => Light::Rgb(light),
                #[cfg(feature = "spectral")]
                Stored::Spectral(light) => Light::Spectral(light),
            },
            links: &mut self.links,
            sensor: &mut self.sensor,
            counters: &mut self.counters,
        }
    }
}

impl<const N: usize> Default for Scratch<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A [`Scratch`] of any capacity: estimators are compiled once for all of them.
#[allow(missing_debug_implementations)] // thousands of numbers
pub struct ScratchView<'s> {
    pub(super) light: Light<'s>,
    pub(super) links: &'s mut VecView<Link>,
    pub(super) sensor: &'s mut HistoryView,
    pub(super) counters: &'s mut Counters,
}

/// [`Stored`], of any capacity.
pub(super) enum Light<'s> {
    Rgb(&'s mut VecView<Vertex<Rgb>>),
    #[cfg(feature = "spectral")]
    Spectral(&'s mut VecView<Vertex<Hero>>),
}

impl ScratchView<'_> {
    /// The most vertices that a light walk keeps.
    #[inline(always)]
    pub fn capacity(&self) -> usize {
        self.links.capacity()
    }

    /// [`Scratch::counters`].
    #[inline(always)]
    pub fn counters(&mut self) -> &mut Counters {
        self.counters
    }
}

/// What one instance of the estimators works in.
#[cfg_attr(not(feature = "bidirectional"), allow(dead_code))]
pub(super) struct Workspace<'w, S: Spectrum> {
    pub light: &'w mut VecView<Vertex<S>>,
    pub links: &'w mut VecView<Link>,
    pub sensor: &'w mut HistoryView,
    pub counters: &'w mut Counters,
}
