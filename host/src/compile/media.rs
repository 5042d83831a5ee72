//! Media: their records, grids with majorants, and the boxes from which those that emit are sampled as lights.

pub(super) mod contact;
mod grids;
pub(super) mod lines;
mod objects;
pub(super) mod space;

use super::bvh::Bounds;
use crate::description::{
    Color, Description, Geometry, Grid, Grids, Medium, Phase, Spectrum, Tracking, is_spectrum,
};
use crate::spectra::append;
use bytemuck::Zeroable;
use etendue::blob::MAX_COORDINATE;
use etendue::blob::format::{self, Lobe, NONE, medium, needs};
use glam::{DMat3, DVec3};
use grids::{absorbs, grid_mean, majorants};

/// Extinctions are 0 or within this, as the kernel asks.
const EXTINCTION: [f32; 2] = [1e-12, 1e12];
/// Emission is at most this.
const MOST_EMISSION: f32 = 1e20;
/// Closer to 1 the asymmetry of a phase function can't be told from 1.
const MOST_G: f32 = 0.999_999_9;
/// Texels by axis.
const MOST_TEXELS: u32 = 4096;

/// Records of media, and what they make the scene need.
#[derive(Default)]
pub(super) struct Media {
    pub media: Vec<format::Medium>,
    pub grids: Vec<format::Grid>,
    pub needs: u32,
    /// Media that emit and stand somewhere.
    pub glowing: Vec<Glowing>,
}

/// A medium that emits.
pub(super) struct Glowing {
    pub medium: u32,
    /// A corner of the box that holds it, and the box's edges.
    pub corner: [f32; 3],
    pub edges: [[f32; 3]; 3],
    /// Mean of the channels' and places' emission within the box.
    pub mean: f64,
    pub volume: f64,
    /// Radiance of light that has been through it all, about.
    pub radiance: f64,
}

impl Media {
    /// Compiles the media of `d`; words of grids go to `texels`.
    ///
    /// # Errors
    /// Which medium, and what is wrong.
    pub fn compile(d: &Description, texels: &mut Vec<u32>) -> Result<Self, (usize, String)> {
        let mut out = Self::default();
        for (id, m) in d.media.iter().enumerate() {
            out.medium(d, id, m, texels).map_err(|e| (id, e))?;
        }
        Ok(out)
    }

    fn medium(
        &mut self,
        d: &Description,
        id: usize,
        m: &Medium,
        texels: &mut Vec<u32>,
    ) -> Result<(), String> {
        check(m)?;
        let mut rows = |s: &Option<Spectrum>| s.as_ref().map_or([0; 2], |s| append(texels, s));
        let [sigma_t, albedo, emission] = &m.spectra;
        let mut record = format::Medium {
            sigma_t: m.sigma_t,
            albedo: m.albedo,
            emission: m.emission,
            mean: m.sigma_t,
            phase: phase(m)?,
            extinctions: NONE,
            albedos: NONE,
            emissions: NONE,
            emitter: NONE,
            sigma_t_spectrum: rows(sigma_t),
            albedo_spectrum: rows(albedo),
            emission_spectrum: rows(emission),
            ..format::Medium::zeroed()
        };
        let mut emitted = mean(m.emission);
        if let Some(grids) = &m.grids {
            // At one wavelength an extinction is between its channels' least and largest: any two of them may meet.
            let bound = match d.spectral() {
                true => [m.sigma_t.iter().copied().fold(0.0, f32::max); 3],
                false => m.sigma_t,
            };
            emitted *= self.grids(m, grids, bound, &mut record, texels)?;
        }
        let emits = m.emission.iter().any(|&e| e > 0.0);
        let bounds = bounds(d, id);
        if bounds.is_some() || is_used(d, id) {
            self.needs |= needs::MEDIA;
            if m.grids.is_some() {
                self.needs |= needs::GRIDS;
            }
            if emits {
                self.needs |= needs::GLOWING;
            }
        }
        self.media.push(record);
        if !emits {
            return Ok(());
        }
        let Some(bounds) = bounds else { return Ok(()) };
        self.glowing
            .push(glowing(id, m, &record, &bounds, emitted)?);
        Ok(())
    }

    /// The grids of a medium; returns the mean over the unit cube of what emission is multiplied by.
    fn grids(
        &mut self,
        m: &Medium,
        grids: &Grids,
        bound: Color,
        record: &mut format::Medium,
        texels: &mut Vec<u32>,
    ) -> Result<f64, String> {
        record.kind = medium::GRID;
        record.flags = match grids.tracking {
            Tracking::Woodcock => 0,
            Tracking::Residual => medium::RESIDUAL,
            Tracking::Regular => medium::REGULAR,
        };
        let [red, green, blue] = m.sigma_t;
        let one = grids.extinction.values.flat().1 == 1 && red == green && green == blue;
        if grids.tracking == Tracking::Residual && !one {
            return Err(
                "residual tracking asks for extinction of one channel, the same in all of sigma_t"
                    .into(),
            );
        }
        record.to_grid = grids.to_grid;
        if !invertible(&grids.to_grid) {
            return Err("the transform of its grids must be one that can be undone, and no rows of it beyond 1e12".into());
        }
        record.extinctions = self.grid(&grids.extinction, EXTINCTION[1], "extinction", texels)?;
        if let Some(albedo) = &grids.albedo {
            record.albedos = self.grid(albedo, 1.0, "albedo", texels)?;
        }
        absorbs(m, grids)?;
        let mut emission = 1.0;
        if let Some(grid) = &grids.emission {
            let most = m.emission.iter().fold(f32::MIN_POSITIVE, |m, &e| m.max(e));
            record.emissions = self.grid(grid, MOST_EMISSION / most, "emission", texels)?;
            emission = grid_mean(grid).iter().sum::<f64>() / 3.0;
        }
        // Weights may assume anything that isn't 0 where extinction isn't.
        let mean = grid_mean(&grids.extinction);
        let [least, most] = EXTINCTION;
        for ((mean, of), sigma_t) in record.mean.iter_mut().zip(mean).zip(record.sigma_t) {
            *mean = match sigma_t > 0.0 {
                true => ((f64::from(sigma_t) * of) as f32)
                    .max(sigma_t * 1e-6)
                    .clamp(least, most),
                false => 0.0,
            };
        }
        let majorants = majorants(&grids.extinction, bound);
        record.cells = majorants.cells;
        record.majorants = texels.len() as u32;
        if majorants.values.iter().any(|m| *m > EXTINCTION[1]) {
            return Err(format!(
                "sigma_t must be at most {:e} everywhere",
                EXTINCTION[1]
            ));
        }
        texels.extend(majorants.values.iter().map(|m| m.to_bits()));
        Ok(emission)
    }

    fn grid(
        &mut self,
        grid: &Grid,
        limit: f32,
        what: &str,
        texels: &mut Vec<u32>,
    ) -> Result<u32, String> {
        let (values, channels) = grid.values.flat();
        if grid.size.iter().any(|n| !(1..=MOST_TEXELS).contains(n)) {
            return Err(format!(
                "grids must have 1 to {MOST_TEXELS} texels by axis, found {:?} in that of {what}",
                grid.size
            ));
        }
        let count = grid.size.iter().map(|&n| n as usize).product::<usize>() * channels;
        if values.len() != count {
            let size = grid.size;
            return Err(format!(
                "a grid of {size:?} texels must have {count} numbers, found {} in that of {what}",
                values.len()
            ));
        }
        if let Some(v) = values.iter().find(|v| !(0.0..=limit).contains(*v)) {
            return Err(format!(
                "{what} must be in [0, {limit}], found {v} in its grid"
            ));
        }
        let first = u32::try_from(texels.len() + count);
        if first.is_err() {
            return Err("more texels than the format can count (2³²)".into());
        }
        self.grids.push(format::Grid {
            nearest: u32::from(grid.nearest),
            channels: channels as u32,
            size: grid.size,
            texels: texels.len() as u32,
            reserved: [0; 2],
        });
        texels.extend(values.iter().map(|v| v.to_bits()));
        Ok(self.grids.len() as u32 - 1)
    }
}

/// Whether rows of a transform are of usable lengths and no small part of a volume, as the kernel asks.
fn invertible(rows: &[[f32; 4]; 3]) -> bool {
    let [a, b, c] = rows.map(|[x, y, z, _]| DVec3::from([x, y, z].map(f64::from)));
    let product = a.length_squared() * b.length_squared() * c.length_squared();
    let volume = a.dot(b.cross(c));
    let usable = |r: &DVec3| (1e-12..=1e12).contains(&r.length());
    let offsets = rows.iter().all(|r| r[3].abs() <= 1e24);
    offsets && [a, b, c].iter().all(usable) && volume * volume >= 1e-8 * product
}

/// Ranges, in the words of scene files.
fn check(m: &Medium) -> Result<(), String> {
    let [least, most] = EXTINCTION;
    let thin = |s: &&f32| **s != 0.0 && !(least..=most).contains(*s);
    let rows = m.spectra[0].iter().flatten().map(|[_, sigma]| sigma);
    if let Some(s) = m.sigma_t.iter().chain(rows).find(thin) {
        return Err(format!(
            "sigma_t must be 0 or in [{least:e}, {most:e}], found {s}"
        ));
    }
    let ranges = [
        ("albedo", m.albedo, 1.0),
        ("emission", m.emission, MOST_EMISSION),
    ];
    for (name, values, most) in ranges {
        if let Some(v) = values.iter().find(|v| !(0.0..=most).contains(*v)) {
            return Err(format!("{name} must be in [0, {most:e}], found {v}"));
        }
    }
    for c in 0..3 {
        let absorbs = m.sigma_t[c] > 0.0 && m.albedo[c] < 1.0;
        let varies = m.grids.as_ref().is_some_and(|g| g.albedo.is_some());
        if m.emission[c] > 0.0 && !absorbs && (!varies || m.sigma_t[c] == 0.0) {
            return Err("emits where it doesn't absorb, expected sigma_t > 0 and albedo < 1 in each channel that emits".into());
        }
    }
    check_spectra(m)
}

/// The same of spectra.
fn check_spectra(m: &Medium) -> Result<(), String> {
    if m.spectra.iter().all(Option::is_none) {
        return Ok(());
    }
    if m.grids.is_some() {
        return Err("spectra and grids, expected one or the other".into());
    }
    let ranges = [
        ("sigma_t", EXTINCTION[1]),
        ("albedo", 1.0),
        ("emission", MOST_EMISSION),
    ];
    for (rows, (name, most)) in m.spectra.iter().zip(ranges) {
        if rows.as_ref().is_some_and(|rows| !is_spectrum(rows, most)) {
            return Err(format!(
                "the spectrum of {name} must have rows by rising wavelength, values in [0, {most:e}]"
            ));
        }
    }
    let values = |i: usize, colors: Color| {
        let rows = m.spectra[i].iter().flatten().map(|[_, value]| *value);
        rows.chain(colors).collect::<Vec<f32>>()
    };
    let (sigma_t, albedo, emission) = (
        values(0, m.sigma_t),
        values(1, m.albedo),
        values(2, m.emission),
    );
    let absorbs = sigma_t.iter().all(|s| *s > 0.0) && albedo.iter().all(|a| *a < 1.0);
    let emits = emission.iter().any(|e| *e > 0.0);
    if emits && !absorbs {
        return Err("emits where it doesn't absorb, expected sigma_t > 0 and albedo < 1 at every wavelength".into());
    }
    if emits && m.emission == [0.0; 3] {
        return Err("emits what can't be seen, expected emission between 380 and 780 nm".into());
    }
    Ok(())
}

fn phase(m: &Medium) -> Result<[Lobe; 4], String> {
    if m.phase.is_empty() || m.phase.len() > 4 {
        return Err(format!(
            "a phase function has 1 to 4 parts, found {}",
            m.phase.len()
        ));
    }
    let total: f64 = m.phase.iter().map(|l| f64::from(l.weight)).sum();
    let good = m
        .phase
        .iter()
        .all(|l| l.weight >= 0.0 && l.weight.is_finite());
    if !good || total <= 0.0 {
        return Err("the weights of phase functions must be finite, >= 0, and not all 0".into());
    }
    let mut lobes = [Lobe::zeroed(); 4];
    for (out, l) in lobes.iter_mut().zip(&m.phase) {
        let (kind, g) = match l.phase {
            Phase::Isotropic => (medium::ISOTROPIC, 0.0),
            Phase::HenyeyGreenstein { g } if g.abs() <= MOST_G => (medium::HENYEY_GREENSTEIN, g),
            Phase::HenyeyGreenstein { g } => {
                return Err(format!("g must be in (-1, 1), found {g}"));
            }
            Phase::Rayleigh => (medium::RAYLEIGH, 0.0),
            Phase::Forward => (medium::FORWARD, 0.0),
        };
        *out = Lobe {
            kind,
            g,
            weight: (f64::from(l.weight) / total) as f32,
            reserved: 0,
        };
    }
    Ok(lobes)
}

/// Whether anything stands in it.
fn is_used(d: &Description, id: usize) -> bool {
    let is = |m: Option<usize>| m == Some(id);
    is(d.exterior) || is(d.sensor.medium) || d.emitters.iter().any(|e| is(e.medium))
}

/// A box around all objects that part it from others.
fn bounds(d: &Description, id: usize) -> Option<Bounds> {
    let mut bounds = Bounds::EMPTY;
    for s in &d.shapes {
        if s.interior != Some(id) && s.exterior != Some(id) {
            continue;
        }
        match &s.geometry {
            Geometry::Mesh(mesh) => {
                for p in &mesh.positions {
                    bounds = bounds.union(&Bounds { low: *p, high: *p });
                }
            }
            Geometry::Sphere { center, radius, .. } => {
                bounds = bounds.union(&Bounds::of_sphere(*center, *radius));
            }
        }
    }
    (bounds.low[0] <= bounds.high[0]).then_some(bounds)
}

/// The box in which a medium's emission is sampled: that of its objects or, if it is smaller, its grids' own.
fn glowing(
    id: usize,
    m: &Medium,
    record: &format::Medium,
    bounds: &Bounds,
    mean: f64,
) -> Result<Glowing, String> {
    let [low, high] = [bounds.low, bounds.high].map(|c| DVec3::from(c.map(f64::from)));
    let mut corner = low;
    let mut edges = DMat3::from_diagonal(high - low);
    let mut emission = mean;
    if m.grids.is_some() {
        let [x, y, z] = record.to_grid.map(|row| row.map(f64::from));
        let [rx, ry, rz] = [x, y, z].map(|r| DVec3::new(r[0], r[1], r[2]));
        let inverse = DMat3::from_cols(rx, ry, rz).transpose().inverse();
        let volume = inverse.determinant().abs();
        if !volume.is_finite() || volume == 0.0 {
            return Err("the transform of its grids can't be undone".into());
        }
        if volume < edges.determinant() {
            corner = -(inverse * DVec3::new(x[3], y[3], z[3]));
            edges = inverse;
        } else {
            emission *= volume / edges.determinant();
        }
    }
    let mut numbers = corner.to_array().into_iter().chain(edges.to_cols_array());
    if numbers.any(|x| x.abs() > f64::from(MAX_COORDINATE)) {
        return Err(
            "a medium that emits must lie within 1e12, and no edge of its box be longer".into(),
        );
    }
    let volume = edges.determinant().abs();
    if volume < 1e-37 {
        return Err(format!(
            "emits from a volume of at least 1e-37, found {volume:e}"
        ));
    }
    let absorption: f64 = (0..3)
        .map(|c| f64::from(record.mean[c]) * f64::from(1.0 - m.albedo[c]))
        .sum::<f64>()
        / 3.0;
    let size = edges
        .x_axis
        .length()
        .max(edges.y_axis.length())
        .max(edges.z_axis.length());
    let single = |v: DVec3| v.as_vec3().to_array();
    Ok(Glowing {
        medium: id as u32,
        corner: single(corner),
        edges: [edges.x_axis, edges.y_axis, edges.z_axis].map(single),
        mean: emission,
        volume,
        radiance: mean * size.min(1.0 / absorption.max(f64::MIN_POSITIVE)),
    })
}

fn mean(c: [f32; 3]) -> f64 {
    c.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests;
