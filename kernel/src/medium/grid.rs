//! The medium given by grids: its values at a point, and the part of a way that is within their cube.

use super::lattice::{Cell, Line};
use crate::blob::View;
use crate::blob::format::{Grid, Medium};
use crate::real::{Real, Vec3, vec3};
use crate::shape::Ray;
use crate::spectrum::Spectrum;
use core::ops::{Add, Mul};

/// Extinction below this is none: quotients stay finite. (With a coordinate of at most 1e12, τ is above e⁻¹ there.)
pub(super) const THINNEST: Real = 1e-12;

/// A way through grids.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage<'a, S: Spectrum> {
    waves: S::Waves,
    texels: &'a [u32],
    medium: &'a Medium,
    pub extinction: &'a Grid,
    albedo: Option<&'a Grid>,
    emission: Option<&'a Grid>,
    pub line: Line,
}

impl<'a, S: Spectrum> Passage<'a, S> {
    /// What of `ray` is within the cube, if anything.
    #[inline]
    pub fn new(scene: View<'_, 'a, S>, m: &'a Medium, ray: &Ray) -> Option<Self> {
        let rows = Rows::new(m);
        let origin = rows.point(ray.origin);
        let line = Line::clip(origin, rows.direction(ray.direction), ray.t_max)?;
        Self::within(scene, m, line)
    }

    #[inline(always)]
    fn within(scene: View<'_, 'a, S>, m: &'a Medium, line: Line) -> Option<Self> {
        Some(Self {
            waves: scene.waves,
            texels: scene.texels(),
            medium: m,
            extinction: scene.grid(m.extinctions)?,
            albedo: scene.grid(m.albedos),
            emission: scene.grid(m.emissions),
            line,
        })
    }

    /// Its length in the world.
    #[inline(always)]
    pub fn length(&self) -> Real {
        self.line.end - self.line.start
    }

    /// σ_t at t.
    #[inline]
    pub fn sigma(&self, t: Real) -> S {
        let unit: S = self.look(self.extinction, t);
        (unit * S::lift(self.medium.sigma_t, &self.waves))
            .map(|x| if x < THINNEST { 0.0 } else { x })
    }

    /// σ_s at t, where σ_t is `sigma`.
    #[inline]
    pub fn scattering(&self, t: Real, sigma: S) -> S {
        let albedo = sigma * S::lift(self.medium.albedo, &self.waves);
        match self.albedo {
            Some(grid) => albedo * self.look(grid, t),
            None => albedo,
        }
    }

    /// E at t, where σ_t is `sigma`: none in a vacuum.
    #[inline]
    pub fn emission(&self, t: Real, sigma: S) -> S {
        if !self.glows() {
            return S::BLACK;
        }
        let constant = S::light(self.medium.emission, &self.waves);
        let e = match self.emission {
            Some(grid) => constant * self.look(grid, t),
            None => constant,
        };
        e.zip(sigma, |e, sigma| if sigma > 0.0 { e } else { 0.0 })
    }

    /// Whether it emits anywhere.
    #[inline(always)]
    pub fn glows(&self) -> bool {
        self.medium.emission.iter().any(|&e| e > 0.0)
    }

    #[inline(always)]
    fn look(&self, grid: &Grid, t: Real) -> S {
        look(self.texels, grid, self.line.at(t), &self.waves)
    }

    /// Boxes of the majorants by axis.
    #[inline(always)]
    pub fn boxes(&self) -> [u32; 3] {
        self.medium.cells
    }

    /// At least σ_t of every channel anywhere in the box.
    #[inline(always)]
    pub fn majorant(&self, cell: &Cell) -> Real {
        let index = place(self.medium.majorants, self.medium.cells, cell.index);
        word(self.texels, index)
    }
}

/// σ_t and E at a point in the world.
pub(super) fn matter_at<S: Spectrum>(scene: View<'_, '_, S>, m: &Medium, x: Vec3) -> (S, S) {
    let u = Rows::new(m).point(x);
    if u.min_element() < 0.0 || u.max_element() > 1.0 {
        return (S::BLACK, S::BLACK);
    }
    let line = Line {
        origin: u,
        direction: Vec3::ZERO,
        start: 0.0,
        end: 0.0,
    };
    match Passage::within(scene, m, line) {
        Some(p) => {
            let sigma = p.sigma(0.0);
            (sigma, p.emission(0.0, sigma))
        }
        None => (S::BLACK, S::BLACK),
    }
}

/// World to the grids' cube.
struct Rows([Vec3; 3], Vec3);

impl Rows {
    #[inline(always)]
    fn new(m: &Medium) -> Self {
        let [a, b, c] = m.to_grid;
        Self(
            [a, b, c].map(|[x, y, z, _]| vec3([x, y, z])),
            vec3([a[3], b[3], c[3]]),
        )
    }

    #[inline(always)]
    fn direction(&self, d: Vec3) -> Vec3 {
        Vec3::from_array(self.0.map(|row| row.dot(d)))
    }

    #[inline(always)]
    fn point(&self, x: Vec3) -> Vec3 {
        self.direction(x) + self.1
    }
}

/// The value of a grid at a point of the unit cube; one that rounding has put outside counts as on its border.
#[inline]
fn look<S: Spectrum>(texels: &[u32], g: &Grid, u: Vec3, waves: &S::Waves) -> S {
    let [x, y, z] = u.to_array();
    let [nx, ny, nz] = g.size;
    let axes = [
        axis(x, nx, g.nearest),
        axis(y, ny, g.nearest),
        axis(z, nz, g.nearest),
    ];
    let at = |x, y, z| place(0, g.size, [x, y, z]);
    let grey = |i: usize| word(texels, (g.texels as usize).wrapping_add(i));
    let rgb = |i: usize| {
        let first = (g.texels as usize).wrapping_add(i.wrapping_mul(3));
        match texels.get(first..).and_then(|t| t.first_chunk()) {
            Some(rgb) => S::lift(rgb.map(f32::from_bits), waves),
            None => S::BLACK,
        }
    };
    match (g.channels, g.nearest) {
        (1, 1) => S::grey(grey(at(axes[0].low, axes[1].low, axes[2].low))),
        (1, _) => S::grey(trilinear(axes, |x, y, z| grey(at(x, y, z)))),
        (_, 1) => rgb(at(axes[0].low, axes[1].low, axes[2].low)),
        _ => trilinear(axes, |x, y, z| rgb(at(x, y, z))),
    }
}

/// Two neighbouring texels, and how far the point is from the first to the second.
#[derive(Clone, Copy)]
struct Between {
    low: u32,
    high: u32,
    fraction: Real,
}

#[inline(always)]
fn axis(u: Real, size: u32, nearest: u32) -> Between {
    let last = size.saturating_sub(1);
    let x = u * size as Real - if nearest == 1 { 0.0 } else { 0.5 };
    let x = x.max(0.0).min(last as Real);
    let low = x as u32;
    Between {
        low,
        high: low.saturating_add(1).min(last),
        fraction: x - low as Real,
    }
}

#[inline(always)]
fn trilinear<T: Copy + Add<Output = T> + Mul<Real, Output = T>>(
    [x, y, z]: [Between; 3],
    value: impl Fn(u32, u32, u32) -> T,
) -> T {
    let mix = |a: T, b: T, f: Real| a * (1.0 - f) + b * f;
    let line = |j, k| mix(value(x.low, j, k), value(x.high, j, k), x.fraction);
    let face = |k| mix(line(y.low, k), line(y.high, k), y.fraction);
    mix(face(z.low), face(z.high), z.fraction)
}

/// Where cell `index` of `count` stands behind `first`. The gate has seen that it is within the texels, so nothing wraps.
#[inline(always)]
fn place(first: u32, count: [u32; 3], index: [u32; 3]) -> usize {
    let [nx, ny, _] = count.map(|n| n as usize);
    let [x, y, z] = index.map(|i| i as usize);
    let layer = z.wrapping_mul(ny).wrapping_add(y);
    (first as usize).wrapping_add(layer.wrapping_mul(nx).wrapping_add(x))
}

#[inline(always)]
fn word(texels: &[u32], index: usize) -> Real {
    let bits = texels.get(index).copied().unwrap_or(0);
    Real::from(f32::from_bits(bits))
}
