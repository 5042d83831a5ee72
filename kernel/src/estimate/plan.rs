//! What estimators that plan their work ahead are told: how a ray tree branches, how fine a quadrature is.

/// The most levels of a [`Tree`], and the most Dirac lobes that [`Rule`] follows one after the other.
pub const LEVELS: usize = 8;

/// How ray trees branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree {
    /// Rays that go on from a vertex, by level: the vertices that rays from the sensor meet are level 0. Up to the first 0: so
    /// many levels there are, and paths have at most an edge more.
    pub branching: [u8; LEVELS],
    /// Samples of lights at each vertex; 0 counts as 1.
    pub lights: u8,
}

impl Default for Tree {
    fn default() -> Self {
        Self {
            branching: [8, 4, 2, 1, 0, 0, 0, 0],
            lights: 4,
        }
    }
}

impl Tree {
    /// How many levels there are.
    pub fn levels(&self) -> u32 {
        self.branching.iter().take_while(|&&n| n > 0).count() as u32
    }

    /// Rays from a vertex of `level`.
    #[cfg_attr(not(feature = "distributed"), allow(dead_code))]
    #[inline(always)]
    pub(super) fn rays(&self, level: u32) -> u32 {
        self.branching
            .get(level as usize)
            .map_or(0, |&n| u32::from(n))
    }
}

/// How fine quadrature is. Its error shrinks with `order` and `steps`; what it leaves out stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rule {
    /// Nodes of the Gauss–Legendre rule in each of the two directions across an emitting triangle or sphere, 1 to
    /// [`Rule::MAX_ORDER`]; others count as the nearest of these.
    pub order: u8,
    /// Steps of the trapezoid rule along a way through a medium; 0 counts as 1.
    pub steps: u16,
    /// Dirac lobes that are followed one after the other, at most [`LEVELS`] and the scratch's capacity.
    pub depth: u8,
    /// Instead of these rules as many equal steps, shifted at random: without bias (Cranley & Patterson 1976).
    pub shift: bool,
}

impl Rule {
    /// The most nodes in one direction.
    pub const MAX_ORDER: u8 = 8;
}

impl Default for Rule {
    fn default() -> Self {
        Self {
            order: 4,
            steps: 64,
            depth: 8,
            shift: false,
        }
    }
}
