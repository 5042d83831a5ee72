//! What light paths a scene may have at all, by proof from its contents: what no path needs, estimators leave out. All that they would add there is 0, so that no
//! image changes but by the numbers that are no longer drawn from a stream.

use super::format::{NONE, material, needs};
use super::scene::Scene;

/// What walks through a scene may come to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Possible {
    /// A vertex that may be joined to another: a surface with a lobe that isn't Dirac, or a medium. Without one, light walks are of no use
    /// beyond the light itself.
    pub joins: bool,
    /// Light that a walk may run into: on a surface, in a medium, or behind all. Without it, a walk's last ray is of no use.
    pub meets: bool,
}

impl Possible {
    /// In one pass over materials and shapes.
    pub(super) fn of(scene: &Scene<'_>) -> Self {
        use material::{CONDUCTOR, DIELECTRIC, DISPERSIVE, MIRROR, NULL};
        let smooth = |kind| !matches!(kind, MIRROR | CONDUCTOR | DIELECTRIC | DISPERSIVE | NULL);
        Self {
            joins: !scene.media.is_empty() || scene.materials.iter().any(|m| smooth(m.kind)),
            meets: scene.has(needs::GLOWING)
                || scene.world.background != NONE
                || scene.shapes.iter().any(|s| s.emitter != NONE),
        }
    }

    /// Whether a walk of so many edges ends here: it may have `limit`, and the last has nothing to find but light.
    #[inline(always)]
    pub fn ends(self, edges: u32, limit: u32) -> bool {
        edges + 1 >= limit && !self.meets
    }
}
