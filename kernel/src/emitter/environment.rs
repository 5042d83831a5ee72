//! Backgrounds as images over directions: lat-long, cube map; importance sampled by cell.
//!
//! A cell is what lies between four neighbouring texel centres (lat-long, bilinear) or one texel
//! (cube map, nearest). Within a lat-long cell directions are uniform per solid angle; within a cube
//! map's, uniform on the face.

use super::distant::Direction;
use super::pick_cell;
use crate::blob::format::{Cell, Emitter, emitter as kind};
use crate::blob::{Scene, View};
use crate::real::{INV_PI, PI, Real, Vec3, acos, atan2, safe_sqrt, sin_cos, sqrt, square, vec3};
use crate::spectrum::Spectrum;
use crate::warp::polar;

/// What comes from `direction`.
#[inline]
pub(super) fn radiance<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    direction: Vec3,
) -> Direction<S> {
    let scale = scene.light(e.radiance);
    let (texel, pdf): (S, Real) = match e.kind {
        kind::LATLONG => LatLong { scene, e }.look(to_local(e, direction)),
        _ => CubeMap { scene, e }.look(to_local(e, direction)),
    };
    Direction {
        direction,
        radiance: texel * scale,
        pdf,
    }
}

/// Draws a direction by importance.
#[inline]
pub(super) fn sample<S: Spectrum>(
    scene: View<'_, '_, S>,
    e: &Emitter,
    xi: [Real; 2],
    more: [Real; 2],
) -> Option<Direction<S>> {
    let (index, cell) = pick_cell(cells(&scene, e), more)?;
    let local = if e.kind == kind::LATLONG {
        LatLong { scene, e }.direction(index, xi)
    } else {
        CubeMap { scene, e }.direction(index, xi)
    };
    let rows = e.to_local.map(vec3);
    let direction = rows[0] * local.x + rows[1] * local.y + rows[2] * local.z;
    let drawn = radiance(scene, e, direction);
    // Looking it up again may land in the neighbour cell by rounding; then its density is the right one.
    (cell.probability > 0.0 && drawn.pdf > 0.0).then_some(drawn)
}

#[inline(always)]
fn cells<'a>(scene: &Scene<'a>, e: &Emitter) -> &'a [Cell] {
    let rows = if e.kind == kind::LATLONG {
        e.height.saturating_sub(1)
    } else {
        e.height
    };
    let count = (e.width as usize).saturating_mul(rows as usize);
    let first = e.cells as usize;
    scene
        .cells()
        .get(first..first.saturating_add(count))
        .unwrap_or(&[])
}

#[inline(always)]
fn to_local(e: &Emitter, direction: Vec3) -> Vec3 {
    let rows = e.to_local.map(vec3);
    Vec3::new(
        rows[0].dot(direction),
        rows[1].dot(direction),
        rows[2].dot(direction),
    )
}

#[inline(always)]
fn texel<S: Spectrum>(scene: View<'_, '_, S>, e: &Emitter, column: u32, row: u32) -> S {
    let at = e.texels as usize + 3 * (row as usize * e.width as usize + column as usize);
    match scene.texels().get(at..at + 3) {
        Some(&[r, g, b]) => scene.lift([f32::from_bits(r), f32::from_bits(g), f32::from_bits(b)]),
        _ => S::BLACK,
    }
}

/// Up is y; +x at u = 1/4, +z at u = 1/2, −z at u = 0.
struct LatLong<'s, 'a, S: Spectrum> {
    scene: View<'s, 'a, S>,
    e: &'s Emitter,
}

impl<S: Spectrum> LatLong<'_, '_, S> {
    /// Row height in θ.
    fn step(&self) -> Real {
        PI / (self.e.height - 1) as Real
    }

    /// Colour and density towards the unit vector `d`.
    #[inline]
    fn look(&self, d: Vec3) -> (S, Real) {
        let (w, h) = (self.e.width, self.e.height);
        let phi = atan2(d.x, -d.z) * (0.5 * INV_PI);
        let u = (if phi < 0.0 { phi + 1.0 } else { phi }) * w as Real - 0.5;
        let theta = acos(d.y.clamp(-1.0, 1.0)) / self.step();
        // Columns wrap: column −1 is the last one.
        let u = if u < 0.0 { u + w as Real } else { u };
        let (column, row) = ((u as u32).min(w - 1), (theta as u32).min(h - 2));
        let (fx, fy) = (
            (u - column as Real).clamp(0.0, 1.0),
            (theta - row as Real).clamp(0.0, 1.0),
        );
        let right = if column + 1 == w { 0 } else { column + 1 };
        let t = |c, r| texel(self.scene, self.e, c, r);
        let color = (t(column, row) * (1.0 - fx) + t(right, row) * fx) * (1.0 - fy)
            + (t(column, row + 1) * (1.0 - fx) + t(right, row + 1) * fx) * fy;
        let index = row as usize * w as usize + column as usize;
        let probability = cells(&self.scene, self.e)
            .get(index)
            .map_or(0.0, |c| Real::from(c.probability));
        (color, probability / self.solid_angle(row))
    }

    /// Of a cell in `row`: (2π/width)·(cos θ₀ − cos θ₁), the difference as a product.
    fn solid_angle(&self, row: u32) -> Real {
        let middle = (row as Real + 0.5) * self.step();
        let sine = |x: Real| sin_cos(x).0;
        2.0 * PI / self.e.width as Real * 2.0 * sine(middle) * sine(0.5 * self.step())
    }

    /// A direction of cell `index`, uniform per solid angle.
    #[inline]
    fn direction(&self, index: usize, xi: [Real; 2]) -> Vec3 {
        let (w, step) = (self.e.width, self.step());
        let (row, column) = (
            (index / w.max(1) as usize) as Real,
            (index % w.max(1) as usize) as Real,
        );
        let phi = (column + 0.5 + xi[0]) * (2.0 * PI / w as Real);
        let cosine = |x: Real| sin_cos(x).1;
        let (top, bottom) = (cosine(row * step), cosine((row + 1.0) * step));
        let y = top + (bottom - top) * xi[1];
        let r = safe_sqrt((1.0 - y) * (1.0 + y));
        let [ahead, right] = polar(r, phi);
        Vec3::new(right, y, -ahead)
    }
}

/// Faces +x −x +y −y +z −z, stacked.
struct CubeMap<'s, 'a, S: Spectrum> {
    scene: View<'s, 'a, S>,
    e: &'s Emitter,
}

impl<S: Spectrum> CubeMap<'_, '_, S> {
    #[inline]
    fn look(&self, d: Vec3) -> (S, Real) {
        let a = d.abs();
        let (face, major, s, t) = if a.x >= a.y && a.x >= a.z {
            (if d.x < 0.0 { 1 } else { 0 }, a.x, d.y, d.z)
        } else if a.y >= a.z {
            (if d.y < 0.0 { 3 } else { 2 }, a.y, d.z, d.x)
        } else {
            (if d.z < 0.0 { 5 } else { 4 }, a.z, d.x, d.y)
        };
        let w = self.e.width;
        let place = |x: Real| ((((x / major + 1.0) * 0.5 * w as Real).max(0.0)) as u32).min(w - 1);
        let (column, row) = (place(s), face * w + place(t));
        let index = row as usize * w as usize + column as usize;
        let probability = cells(&self.scene, self.e)
            .get(index)
            .map_or(0.0, |c| Real::from(c.probability));
        // dω = dA/(1 + s² + t²)^{3/2}; a texel has area (2/w)² on the face at distance 1.
        let r_squared = square(s / major) + square(t / major) + 1.0;
        let pdf = probability * square(0.5 * w as Real) * r_squared * sqrt(r_squared);
        (texel(self.scene, self.e, column, row), pdf)
    }

    #[inline]
    fn direction(&self, index: usize, xi: [Real; 2]) -> Vec3 {
        let w = self.e.width.max(1) as usize;
        let (row, column) = (index / w, index % w);
        let (face, row) = (row / w, row % w);
        let place = |i: usize, x: Real| (i as Real + x) * (2.0 / w as Real) - 1.0;
        let (s, t) = (place(column, xi[0]), place(row, xi[1]));
        let sign = if face % 2 == 0 { 1.0 } else { -1.0 };
        let d = match face / 2 {
            0 => Vec3::new(sign, s, t),
            1 => Vec3::new(t, sign, s),
            _ => Vec3::new(s, t, sign),
        };
        d * (1.0 / sqrt(1.0 + s * s + t * t))
    }
}
