//! Pixel filters: part of W_e. Sensor walks draw from the filter; splats are weighted by its density,
//! without renormalising (`transport.md` §7, Film).

use super::{PANORAMA, panorama};
use crate::blob::Scene;
use crate::blob::format::{Sensor, sensor as kind};
use crate::real::Real;
use crate::warp::{self, Gaussian};

/// A sensor's filter, ready to be asked: what all samples have in common is found once.
#[derive(Clone, Copy, Debug)]
pub struct Filter {
    radius: Real,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Box,
    Tent,
    Gaussian(Gaussian),
}

impl Filter {
    /// A pixel's own square.
    pub const PIXEL: Self = Self {
        radius: 0.5,
        shape: Shape::Box,
    };

    /// That of a sensor that has been checked.
    pub fn of(s: &Sensor) -> Self {
        let radius = Real::from(s.filter_radius);
        let shape = match s.filter {
            kind::BOX => Shape::Box,
            kind::TENT => Shape::Tent,
            _ => Shape::Gaussian(Gaussian::new(radius, Real::from(s.filter_sigma))),
        };
        Self { radius, shape }
    }

    /// An offset from the pixel's centre, in one dimension.
    #[inline(always)]
    fn offset(&self, xi: Real) -> Real {
        match &self.shape {
            Shape::Box => (2.0 * xi - 1.0) * self.radius,
            Shape::Tent => warp::tent(self.radius, xi),
            Shape::Gaussian(g) => g.sample(xi),
        }
    }

    /// Density at distance `x` from the pixel's centre, in one dimension.
    #[inline(always)]
    fn density(&self, x: Real) -> Real {
        match &self.shape {
            Shape::Box => 0.5 / self.radius,
            Shape::Tent => warp::tent_pdf(self.radius, x),
            Shape::Gaussian(g) => g.pdf(x),
        }
    }
}

/// A continuous position in the full image, drawn from the filter of `pixel` (of the crop window).
#[inline(always)]
pub(super) fn sample(scene: &Scene<'_>, [x, y]: [u32; 2], [a, b]: [Real; 2]) -> [Real; 2] {
    let (filter, [left, top]) = (scene.filter(), scene.sensor().crop_offset);
    [
        (left + x) as Real + 0.5 + filter.offset(a),
        (top + y) as Real + 0.5 + filter.offset(b),
    ]
}

/// Calls `f` with every pixel of the image that sees the point `raster` of it, in pixels of the full image, and with its filter's density there.
/// A panorama, which starts over beyond its edges, may see it in several places, and calls for each.
#[inline(always)]
pub fn each_pixel(scene: &Scene<'_>, raster: [Real; 2], mut f: impl FnMut([u32; 2], Real)) {
    let (s, filter) = (scene.sensor(), scene.filter());
    if PANORAMA && s.kind == kind::PANORAMA {
        panorama::repeats(s, raster, filter.radius, |again| {
            Footprint::around(s, filter, again).for_each(s, filter, &mut f);
        });
    } else {
        Footprint::around(s, filter, raster).for_each(s, filter, f);
    }
}

/// How many columns a [`Footprint`] takes at a time.
const COLUMNS: usize = 8;

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
    fn around(s: &Sensor, &Filter { radius, .. }: &Filter, raster: [Real; 2]) -> Self {
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
    fn for_each(&self, s: &Sensor, filter: &Filter, mut f: impl FnMut([u32; 2], Real)) {
        let density = |axis: usize, i: u32| {
            let center = (s.crop_offset[axis] + i) as Real + 0.5;
            filter.density(self.raster[axis] - center)
        };
        let [right, bottom] = [0, 1].map(|axis| self.end[axis].min(s.crop_size[axis]));
        // Some columns at a time: their densities serve all rows.
        let mut left = self.first[0];
        while left < right {
            let mut across = [0.0; COLUMNS];
            let columns = left..right.min(left + COLUMNS as u32);
            for (fx, x) in across.iter_mut().zip(columns.clone()) {
                *fx = density(0, x);
            }
            for y in self.first[1]..bottom {
                let fy = density(1, y);
                for (fx, x) in across.iter().zip(columns.clone()) {
                    let weight = fy * fx;
                    if weight > 0.0 {
                        f([x, y], weight);
                    }
                }
            }
            left += COLUMNS as u32;
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
