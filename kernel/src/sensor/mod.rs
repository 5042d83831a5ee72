//! What measures: elements j of a sensor and their responsivity W_e^(j) (`transport.md` §3).
//!
//! An [`Element`] starts sensor walks and says how a point of the scene projects onto it. One number
//! serves both: a walk from the sensor has density `density`·|cos θ_y| per area at the first point y it
//! meets, and a point x seen from the sensor contributes f·`density`·|cos θ_x|·filter — the 1/density of one and the
//! W_e of the other are the same factor, because the walk's directions are drawn in proportion to W_e.

mod filter;
mod orthographic;
mod panorama;
mod perspective;
mod probe;

pub use filter::{Filter, each_pixel};

use crate::blob::Scene;
use crate::blob::format::sensor as kind;
use crate::random::{Purpose, Sampler, Subpath};
use crate::real::{Real, Vec3, gamma};
use crate::shape::Ray;

/// Whether there are panoramas: the checker refuses blobs with one otherwise.
const PANORAMA: bool = cfg!(feature = "panorama");

/// An element of a sensor: what one estimate is for.
#[derive(Clone, Copy, Debug)]
pub enum Element {
    /// A pixel of the scene's camera, counted within the crop window; its value is a radiance.
    Pixel([u32; 2]),
    /// A single ray; its value is the radiance that arrives along it. No walk from a light can meet it.
    Ray(Ray),
    /// A point with a normal; its value is irradiance on the side of the normal.
    Irradiance {
        /// Where.
        position: Vec3,
        /// Which way it faces, unit.
        normal: Vec3,
    },
}

/// How a sensor walk begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The first ray.
    pub ray: Ray,
    /// Density of its direction per solid angle (of its origin per perpendicular area, if `parallel`).
    pub density: Real,
    /// Whether all rays of the sensor are parallel: then no inverse square.
    pub parallel: bool,
    /// Value of the element per unit of radiance along the ray.
    pub scale: Real,
}

/// How a point of the scene appears to the sensor.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// From the point towards the sensor, unit.
    pub direction: Vec3,
    /// Distance over which nothing may be in between.
    pub distance: Real,
    /// The density of sensor walks at the point is this times |cos θ|; the inverse square is in it.
    pub density: Real,
    /// Value of the element per unit of radiance: [`Start::scale`].
    pub scale: Real,
    /// Continuous pixel coordinates in the full image.
    pub raster: [Real; 2],
}

impl Element {
    /// The radiance that arrives at `origin` from `direction` (unit).
    #[inline(always)]
    pub fn ray(origin: Vec3, direction: Vec3) -> Self {
        Element::Ray(Ray {
            origin,
            direction,
            t_min: 0.0,
            t_max: Real::INFINITY,
        })
    }

    /// The irradiance at `position` on the side of `normal` (unit). The position may lie on the scene's geometry: it is
    /// lifted off it. Which triangle that is isn't known, so its extent is bounded by the scene's (see
    /// [`crate::shape::triangle_offset`]).
    #[inline(always)]
    pub fn irradiance(scene: &Scene<'_>, position: Vec3, normal: Vec3) -> Self {
        let extent = Real::from(scene.world().radius) + position.abs().max_element();
        Element::Irradiance {
            position: position + normal * (gamma(8) * extent),
            normal,
        }
    }

    /// Draws the first ray.
    #[inline(always)]
    pub fn start(&self, scene: &Scene<'_>, sampler: &mut impl Sampler) -> Start {
        sampler.at(Subpath::Sensor, 0);
        match *self {
            Element::Pixel(pixel) => {
                let sensor = scene.sensor();
                let raster = filter::sample(scene, pixel, sampler.two(Purpose::Filter));
                match sensor.kind {
                    kind::PERSPECTIVE => {
                        perspective::start(sensor, raster, sampler.two(Purpose::Lens))
                    }
                    kind::PANORAMA if PANORAMA => panorama::start(sensor, raster),
                    _ => orthographic::start(sensor, raster),
                }
            }
            Element::Ray(ray) => probe::ray_start(ray),
            Element::Irradiance { position, normal } => {
                probe::irradiance_start(position, normal, sampler.two(Purpose::Direction))
            }
        }
    }

    /// How `x` appears to the sensor; `None` where it can't be seen. `lens` draws the point on the lens.
    #[inline(always)]
    pub fn project(&self, scene: &Scene<'_>, x: Vec3, lens: [Real; 2]) -> Option<Projection> {
        match *self {
            Element::Pixel(_) => {
                let sensor = scene.sensor();
                match sensor.kind {
                    kind::PERSPECTIVE => perspective::project(sensor, x, lens),
                    kind::PANORAMA if PANORAMA => panorama::project(sensor, x),
                    _ => orthographic::project(sensor, x),
                }
            }
            Element::Ray(_) => None,
            Element::Irradiance { position, normal } => {
                probe::irradiance_project(position, normal, x)
            }
        }
    }

    /// How a direction at infinity, `towards` it from the scene, appears; like [`Self::project`] with
    /// the density per solid angle.
    #[inline(always)]
    pub fn project_distant(
        &self,
        scene: &Scene<'_>,
        towards: Vec3,
        lens: [Real; 2],
    ) -> Option<(Projection, Vec3)> {
        match *self {
            Element::Pixel(_) => {
                let sensor = scene.sensor();
                match sensor.kind {
                    kind::PERSPECTIVE => perspective::project_distant(sensor, towards, lens),
                    kind::PANORAMA if PANORAMA => Some(panorama::project_distant(sensor, towards)),
                    _ => None,
                }
            }
            Element::Irradiance { position, normal } => {
                probe::irradiance_project_distant(position, normal, towards)
            }
            Element::Ray(_) => None,
        }
    }

    /// n of the strategies in which a light walk meets the sensor (t = 1), relative to one sensor
    /// walk: every light walk may meet any pixel of the image.
    #[inline(always)]
    pub fn light_paths(&self, scene: &Scene<'_>) -> Real {
        match self {
            Element::Pixel(_) => {
                let [w, h] = scene.size();
                w as Real * h as Real
            }
            Element::Ray(_) => 0.0,
            Element::Irradiance { .. } => 1.0,
        }
    }
}
