//! Which medium lies on which side of a surface.

use crate::blob::Scene;
use crate::blob::format::NONE;
use crate::real::Vec3;
use crate::shape::Point;

/// No medium's index, and not [`NONE`], which is the vacuum.
pub(super) const PARTS_NOTHING: u32 = NONE - 1;

/// The media in front of the surface at `point` and behind it, given the one on this side.
#[inline(always)]
pub(super) fn sides(scene: &Scene<'_>, point: &Point, here: u32) -> [u32; 2] {
    match scene.shape(point.shape) {
        Some(s) if s.interior != NONE || s.exterior != NONE => [s.exterior, s.interior],
        _ => [here; 2],
    }
}

/// Which of the two media at `point` lies towards `direction`.
#[inline(always)]
pub(super) fn side(media: &[u32; 2], point: &Point, direction: Vec3) -> u32 {
    let [front, back] = *media;
    if direction.dot(point.normal) < 0.0 {
        back
    } else {
        front
    }
}
