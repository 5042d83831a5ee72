//! Pixel filters: part of W_e. Sensor walks draw from the filter; splats are weighted by its density,
//! without renormalising (`transport.md` §7, Film).

use super::{PANORAMA, panorama};
use crate::blob::format::{Sensor, sensor as kind};
use crate::real::Real;
use crate::warp::{self, Gaussian};

/// A continuous position in the full image, drawn from the filter of `pixel` (of the crop window).
#[inline(always)]
pub(super) fn sample(s: &Sensor, pixel: [u32; 2], xi: [Real; 2]) -> [Real; 2] {
    let radius = Real::from(s.filter_radius);
    let offset = xi.map(|x| match s.filter {
        kind::BOX => (2.0 * x - 1.0) * radius,
        kind::TENT => warp::tent(radius, x),
        _ => Gaussian::new(radius, Real::from(s.filter_sigma)).sample(x),
    });
    let center = |axis: usize| (s.crop_offset[axis] + pixel[axis]) as Real + 0.5;
    [center(0) + offset[0], center(1) + offset[1]]
}

/// Density of the filter at distance `x` from the pixel's centre, in one dimension.
#[inline(always)]
fn density(s: &Sensor, x: Real) -> Real {
    let radius = Real::from(s.filter_radius);
    match s.filter {
        kind::BOX => 0.5 / radius,
        kind::TENT => warp::tent_pdf(radius, x),
        _ => Gaussian::new(radius, Real::from(s.filter_sigma)).pdf(x),
    }
}

/// Calls `f` with every pixel of the image that sees the point `raster` of it, in pixels of the full image, and with its filter's density there.
/// A panorama, which starts over beyond its edges, may see it in several places, and calls for each.
#[inline(always)]
pub fn each_pixel(s: &Sensor, raster: [Real; 2], mut f: impl FnMut([u32; 2], Real)) {
    if PANORAMA && s.kind == kind::PANORAMA {
        let radius = Real::from(s.filter_radius);
        panorama::repeats(s, raster, radius, |again| {
            Footprint::around(s, again).for_each(s, &mut f);
        });
    } else {
        Footprint::around(s, raster).for_each(s, f);
    }
}

/// The pixels of the image whose filter covers a point of the raster.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    first: [u32; 2],
    end: [u32; 2],
    raster: [Real; 2],
}

impl Footprint {
    /// Around `raster`, in pixels of the full image.
    #[inline(always)]
    fn around(s: &Sensor, raster: [Real; 2]) -> Self {
        let radius = Real::from(s.filter_radius);
        // Pixel i is covered if its centre lies in (x − r, x + r], x being measured from the crop window.
        let bounds = |axis: usize| {
            let size = s.crop_size[axis];
            let x = raster[axis] - s.crop_offset[axis] as Real - 0.5;
            (after(x - radius, size), after(x + radius, size))
        };
        let (x, y) = (bounds(0), bounds(1));
        Self {
            first: [x.0, y.0],
            end: [x.1, y.1],
            raster,
        }
    }

    /// Calls `f` with every covered pixel and its filter's density at the point.
    #[inline(always)]
    fn for_each(&self, s: &Sensor, mut f: impl FnMut([u32; 2], Real)) {
        let distance =
            |axis: usize, i: u32| self.raster[axis] - ((s.crop_offset[axis] + i) as Real + 0.5);
        for y in self.first[1]..self.end[1].min(s.crop_size[1]) {
            let fy = density(s, distance(1, y));
            for x in self.first[0]..self.end[0].min(s.crop_size[0]) {
                let weight = fy * density(s, distance(0, x));
                if weight > 0.0 {
                    f([x, y], weight);
                }
            }
        }
    }
}

/// The first integer in 0..=size above `x`; casts truncate and saturate.
#[inline(always)]
fn after(x: Real, size: u32) -> u32 {
    if x < 0.0 {
        0
    } else {
        (x as u32).saturating_add(1).min(size)
    }
}
