//! What the explicit weights remember of a walk: a few numbers per vertex, not the vertices.

use crate::real::Real;
use heapless::deque::DequeInner;
use heapless::vec::{OwnedVecStorage, VecStorage, ViewVecStorage};

/// A vertex of a walk, as the ratio walk sees it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Link {
    /// Density per area by the walk itself.
    pub forward: Real,
    /// Density per area by a walk from the other end.
    pub reverse: Real,
    /// [`super::Terms::a`].
    pub a: Real,
    /// Whether the walk went on from here by a Dirac lobe.
    pub dirac: bool,
}

/// The last links of a walk, latest last, in storage of any capacity: [`History`] owns it, [`HistoryView`] doesn't know how much.
#[allow(missing_debug_implementations)] // storage is generic
pub struct HistoryInner<V: VecStorage<Link> + ?Sized> {
    links: DequeInner<Link, V>,
}

/// The last `N` links.
pub type History<const N: usize> = HistoryInner<OwnedVecStorage<Link, N>>;
/// The last links, however many are kept.
pub type HistoryView = HistoryInner<ViewVecStorage<Link>>;

impl<const N: usize> Clone for History<N> {
    fn clone(&self) -> Self {
        Self {
            links: self.links.clone(),
        }
    }
}

impl<const N: usize> Default for History<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> History<N> {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            links: heapless::Deque::new(),
        }
    }
}

impl HistoryView {
    /// Forgets everything.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.links.clear();
    }

    /// Adds the next vertex; the oldest makes room.
    #[inline(always)]
    pub fn push(&mut self, link: Link) {
        if self.links.is_full() {
            self.links.pop_front();
        }
        // Can't fail: there is room now (and with no capacity there is nothing to remember).
        let _ = self.links.push_back(link);
    }

    /// The link of the vertex `back` before the latest (0 is the latest).
    #[inline(always)]
    pub fn recent(&mut self, back: usize) -> Option<&mut Link> {
        let index = self.links.iter().len().checked_sub(back + 1)?;
        self.links.get_mut(index)
    }

    /// From the latest to the oldest.
    #[inline(always)]
    pub fn backwards(&self) -> impl Iterator<Item = &Link> {
        self.links.iter().rev()
    }
}
