//! Distances along a way by the angle under which a light sees them (Kulla & Fajardo 2012, §4.1): density ∝ 1/|x₀ − y|², so
//! that what is near a small light isn't left to chance.

use crate::real::{Real, Vec3, atan2, sqrt, tan};
use crate::shape::Ray;

/// A way, as it is seen from a point x₀.
#[derive(Clone, Copy, Debug)]
pub struct Equiangular {
    /// Where on the way x₀ is nearest.
    nearest: Real,
    /// How near that is.
    distance: Real,
    /// The angles of the way's two ends, from the perpendicular.
    from: Real,
    to: Real,
    end: Real,
}

impl Equiangular {
    /// Of `way` from its origin to its `t_max`, which may be infinite.
    #[inline]
    pub fn new(way: &Ray, x0: Vec3) -> Self {
        let towards = x0 - way.origin;
        let nearest = towards.dot(way.direction);
        let off = towards - way.direction * nearest;
        // Any distance makes a density; one that isn't 0 a finite one, also for lights on the way.
        let least = 1e-6 * sqrt(towards.length_squared()) + Real::MIN_POSITIVE;
        let distance = sqrt(off.length_squared()).max(least);
        Self {
            nearest,
            distance,
            from: atan2(-nearest, distance),
            to: atan2(way.t_max - nearest, distance),
            end: way.t_max,
        }
    }

    /// Draws a distance; `None` where rounding has left no room.
    #[inline]
    pub fn sample(&self, xi: Real) -> Option<Real> {
        let angle = self.from + (self.to - self.from) * xi;
        let t = self.nearest + self.distance * tan(angle);
        (t > 0.0 && t < self.end && t < Real::INFINITY).then_some(t)
    }

    /// Density per length of drawing `t` (eq. 5).
    #[inline]
    pub fn pdf(&self, t: Real) -> Real {
        let along = t - self.nearest;
        let squared = self.distance * self.distance + along * along;
        let pdf = self.distance / ((self.to - self.from) * squared);
        if pdf.is_finite() { pdf } else { 0.0 }
    }
}
