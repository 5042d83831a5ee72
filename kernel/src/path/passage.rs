//! Through what fills the space between surfaces: free flight on a walk, transmittance on a connection.

use super::boundary::{PARTS_NOTHING, side, sides};
use super::trace::{Meeting, SHORTEN, Sight, Trace, past};
use crate::blob::format::needs;
use crate::instance::Instance;
use crate::medium::{Carried, Flight, Way};
use crate::random::{Purpose, Sampler};
use crate::real::{Real, Vec3};
use crate::shape::{Point, Ray, Tracer};
use crate::spectrum::Spectrum;

/// A way through one medium that a walk has begun.
#[derive(Clone, Copy, Debug)]
pub struct Leg<S> {
    /// The medium.
    pub medium: u32,
    /// The way: its origin is where the walk entered the medium, or the vertex it left; `t_max` is where the medium ends.
    pub ray: Ray,
    /// How far along the walk collided, if it did.
    pub t: Real,
    /// What it carried where it began, relative to the vertex it left.
    pub carried: Carried<S>,
}

/// A walk between two of its vertices.
#[derive(Clone, Copy, Debug)]
pub struct Passage<S> {
    /// The medium it is in.
    pub medium: u32,
    /// f/p̄ of the way, and the densities by channel.
    pub carried: Carried<S>,
    /// What the media on the way send back along it.
    pub glow: S,
    /// The probability of getting so far, as the weights assume it.
    pub expected: Real,
    /// The last way through a medium.
    pub leg: Option<Leg<S>>,
    /// One of them all, drawn uniformly, and how many there were.
    pub drawn: Option<(Leg<S>, u32)>,
}

impl<S: Spectrum> Passage<S> {
    /// Begins a way.
    #[inline(always)]
    fn enter(&mut self, way: &Way<'_, '_, S>, sampler: &mut impl Sampler) {
        let leg = Leg {
            medium: self.medium,
            ray: way.ray,
            t: 0.0,
            carried: self.carried,
        };
        self.leg = Some(leg);
        // A reservoir of one: the n-th takes the place of the one before with probability 1/n.
        let n = self.drawn.map_or(0, |(_, n)| n) + 1;
        let stay = n > 1 && sampler.one(Purpose::Flight) * n as Real >= 1.0;
        self.drawn = match self.drawn {
            Some((before, _)) if stay => Some((before, n)),
            _ => Some((leg, n)),
        };
    }
}

impl<'t, 'a, T: Tracer, K: Instance> Trace<'t, 'a, T, K> {
    /// [`Self::meet`] where there are media.
    #[inline(never)]
    pub(super) fn meet_in_media(
        &mut self,
        mut ray: Ray,
        passage: &mut Passage<K::S>,
        sampler: &mut impl Sampler,
    ) -> Meeting<K::S> {
        let mut distance = 0.0;
        loop {
            self.counters.closest_rays += 1;
            let hit = self.tracer.closest(&ray);
            let found = hit.and_then(|h| Some((Point::at(&self.scene, &ray, &h)?, h.t)));
            let end = found.map_or(ray.t_max, |(_, t)| t);
            if let Some(way) = self.way(&ray, end, passage.medium) {
                if self.scene.has(needs::SMALL_LIGHTS) {
                    passage.enter(&way, sampler);
                }
                let flight = way.fly(
                    self.lead,
                    &mut passage.carried,
                    &mut passage.glow,
                    &mut self.remaining,
                    sampler,
                );
                match flight {
                    Flight::Collided(c) => {
                        if let Some(leg) = &mut passage.leg {
                            leg.t = c.t;
                        }
                        let walked = Ray {
                            t_max: c.t,
                            ..way.ray
                        };
                        passage.expected *= Way { ray: walked, ..way }.expected(self.lead);
                        return Meeting::Collision(c, distance + ray.t_min + c.t);
                    }
                    Flight::Through => passage.expected *= way.expected(self.lead),
                    Flight::Cut => {
                        self.counters.cut_walks += 1;
                        return Meeting::Cut;
                    }
                }
            }
            let Some((point, t)) = found else {
                return Meeting::Escaped;
            };
            let opacity = self.opacity(&point, ray.direction);
            if opacity >= 1.0 || (opacity > 0.0 && sampler.one(Purpose::Opacity) < opacity) {
                return Meeting::Surface(point, distance + t);
            }
            if !self.pass() {
                return Meeting::Cut;
            }
            distance += t;
            passage.medium = self.behind(&point, ray.direction, passage.medium);
            ray = past(&ray, &point, t);
        }
    }

    /// The first surface that stops `ray`, whatever fills the space before it: `on_way` is told of every way through a medium and of how far before
    /// its end a point is certainly still inside, and `medium` becomes the one in front of that surface.
    #[cfg_attr(not(feature = "quadrature"), allow(dead_code))]
    #[inline(always)]
    pub fn straight(
        &mut self,
        mut ray: Ray,
        medium: &mut u32,
        sampler: &mut impl Sampler,
        mut on_way: impl FnMut(&mut Self, &Way<'t, 'a, K::S>, u32, Real),
    ) -> Meeting<K::S> {
        let mut distance = 0.0;
        loop {
            self.counters.closest_rays += 1;
            let hit = self.tracer.closest(&ray);
            let found = hit.and_then(|h| Some((Point::at(&self.scene, &ray, &h)?, h.t)));
            let end = found.map_or(ray.t_max, |(_, t)| t);
            if K::MEDIA
                && let Some(way) = self.way(&ray, end, *medium)
            {
                let margin = found.map_or(0.0, |(point, _)| {
                    point.offset / ray.direction.dot(point.normal).abs()
                });
                on_way(self, &way, *medium, margin);
            }
            let Some((point, t)) = found else {
                return Meeting::Escaped;
            };
            let opacity = self.opacity(&point, ray.direction);
            if opacity >= 1.0 || (opacity > 0.0 && sampler.one(Purpose::Opacity) < opacity) {
                return Meeting::Surface(point, distance + t);
            }
            if !self.pass() {
                return Meeting::Cut;
            }
            distance += t;
            if K::MEDIA {
                *medium = self.behind(&point, ray.direction, *medium);
            }
            ray = past(&ray, &point, t);
        }
    }

    /// A way through a medium that begins like `leg` and goes on for `length`.
    #[inline(always)]
    pub fn along(&self, leg: &Leg<K::S>, length: Real) -> Option<Way<'t, 'a, K::S>> {
        let ray = Ray {
            t_max: length,
            ..leg.ray
        };
        Some(Way {
            scene: self.scene,
            medium: self.scene.medium(leg.medium)?,
            ray,
        })
    }

    /// τ over `way`.
    #[inline(always)]
    pub fn transmittance(&mut self, way: &Way<'_, '_, K::S>, sampler: &mut impl Sampler) -> K::S {
        way.transmittance(&mut self.remaining, sampler)
    }

    /// The way through `medium` from where `ray` begins to `end`; `None` through a vacuum.
    #[inline(always)]
    fn way(&self, ray: &Ray, end: Real, medium: u32) -> Option<Way<'t, 'a, K::S>> {
        let medium = self.scene.medium(medium)?;
        let ray = Ray {
            origin: ray.origin + ray.direction * ray.t_min,
            direction: ray.direction,
            t_min: 0.0,
            t_max: end - ray.t_min,
        };
        Some(Way {
            scene: self.scene,
            medium,
            ray,
        })
    }

    /// The medium that a ray is in after it has passed the surface at `point` out of `medium`.
    #[inline(always)]
    fn behind(&self, point: &Point, direction: Vec3, medium: u32) -> u32 {
        side(&sides(&self.scene, point, medium), point, direction)
    }

    /// The medium around `position`, which lies on no surface: what the first surface that parts media says, looking along
    /// `direction`.
    #[inline(never)]
    pub fn medium_at(&mut self, position: Vec3, direction: Vec3) -> u32 {
        let mut ray = Ray {
            origin: position,
            direction,
            t_min: 0.0,
            t_max: Real::INFINITY,
        };
        loop {
            self.counters.closest_rays += 1;
            let hit = self.tracer.closest(&ray);
            let Some((point, t)) = hit.and_then(|h| Some((Point::at(&self.scene, &ray, &h)?, h.t)))
            else {
                return self.scene.world().exterior;
            };
            let media = sides(&self.scene, &point, PARTS_NOTHING);
            if media != [PARTS_NOTHING; 2] {
                return side(&media, &point, -direction);
            }
            if !self.pass() {
                return self.scene.world().exterior;
            }
            ray = past(&ray, &point, t);
        }
    }

    #[inline(never)]
    pub(super) fn visibility_in_media(
        &mut self,
        mut ray: Ray,
        mut medium: u32,
        sampler: &mut impl Sampler,
    ) -> Sight<K::S> {
        let mut sight = Sight::<K::S>::free(1.0);
        // Surfaces aren't asked about that far; media fill it all.
        let rounding = if ray.t_max < Real::INFINITY {
            ray.t_max * (1.0 - SHORTEN)
        } else {
            0.0
        };
        loop {
            let hit = self.tracer.closest(&Ray {
                t_max: ray.t_max - rounding,
                ..ray
            });
            let found = hit.and_then(|h| Some((Point::at(&self.scene, &ray, &h)?, h.t)));
            let opacity = found.map_or(0.0, |(point, _)| self.opacity(&point, ray.direction));
            if opacity >= 1.0 {
                return Sight::free(0.0);
            }
            let end = found.map_or(ray.t_max, |(_, t)| t);
            if let Some(way) = self.way(&ray, end, medium) {
                sight.value *= if self.exact {
                    way.exact()
                } else {
                    way.transmittance(&mut self.remaining, sampler)
                };
                sight.expected *= way.expected(self.lead);
            }
            sight.medium = medium;
            let Some((point, t)) = found else {
                return sight;
            };
            sight.value *= 1.0 - opacity;
            if sight.value.is_black() || !self.pass() {
                return Sight::free(0.0);
            }
            medium = self.behind(&point, ray.direction, medium);
            ray = past(&ray, &point, t);
        }
    }
}
