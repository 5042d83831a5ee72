//! Media, their phase functions and their grids.

use super::rules::{Checked, ensure, finite, optional, span, within, zeros};
use super::surface::spectrum;
use crate::blob::format::{Grid, Lobe, Medium, NONE, emitter, medium, table};
use crate::blob::rule::Rule;
use crate::blob::scene::Scene;

/// Extinctions are 0 or within this, so that their quotients are finite.
const EXTINCTION: [f32; 2] = [1e-12, 1e12];
/// E over the thinnest extinction is finite.
const MOST_EMISSION: f32 = 1e20;
/// How often all texels may be read through media: grids may be shared, but checking takes linear time.
pub(super) const SHARING: u64 = 16;

pub(super) fn grid(scene: &Scene<'_>, g: &Grid, texels: &mut u64) -> Checked {
    ensure(cfg!(feature = "media"), Rule::MediumLeftOut)?;
    ensure(g.nearest <= 1, Rule::GridNearest)?;
    ensure(matches!(g.channels, 1 | 3), Rule::GridChannels)?;
    let fits = g.size.iter().all(|n| (1..=4096).contains(n));
    ensure(fits, Rule::GridSize)?;
    let values = values(scene, g)?;
    let left = texels.checked_sub(values.len() as u64);
    *texels = left.ok_or(Rule::GridBudget)?;
    ensure(at_most(values, EXTINCTION[1]), Rule::GridValue)?;
    zeros(&g.reserved, Rule::GridReserved)
}

pub(super) fn medium(scene: &Scene<'_>, index: usize, m: &Medium, reads: &mut u64) -> Checked {
    ensure(cfg!(feature = "media"), Rule::MediumLeftOut)?;
    ensure(m.kind <= medium::GRID, Rule::MediumKind)?;
    let known = match m.kind {
        medium::GRID => medium::REGULAR | medium::RESIDUAL,
        _ => 0,
    };
    ensure(m.flags & !known == 0, Rule::MediumFlags)?;
    ensure(m.sigma_t.iter().all(extinction), Rule::MediumSigma)?;
    within(&m.albedo, 0.0, 1.0, Rule::MediumAlbedo)?;
    within(&m.emission, 0.0, MOST_EMISSION, Rule::MediumEmission)?;
    ensure(m.mean.iter().all(extinction), Rule::MediumMean)?;
    let mut by_channel = m.sigma_t.iter().zip(&m.mean);
    let seen = by_channel.all(|(&sigma, &mean)| sigma == 0.0 || mean > 0.0);
    ensure(seen, Rule::MediumMean)?;
    let gridded = m.kind == medium::GRID && m.albedos != NONE;
    let mut by_channel = m.emission.iter().zip(&m.sigma_t).zip(&m.albedo);
    let absorbs = by_channel.all(|((&emission, &sigma), &albedo)| {
        emission == 0.0 || (sigma > 0.0 && (albedo < 1.0 || gridded))
    });
    ensure(absorbs, Rule::MediumAbsorption)?;
    optional(m.emitter, scene.emitters.len(), Rule::MediumEmitter)?;
    if let Some(e) = scene.emitter(m.emitter) {
        let own = e.kind == emitter::VOLUME && e.medium as usize == index;
        ensure(own, Rule::MediumEmitter)?;
    }
    m.phase.iter().try_for_each(lobe)?;
    let sum: f32 = m.phase.iter().map(|l| l.weight).sum();
    within(&[sum], 0.9999, 1.0001, Rule::LobeSum)?;
    spectra(scene, m, reads)?;
    if m.kind == medium::GRID {
        gridded_medium(scene, m, reads)
    } else {
        Ok(())
    }
}

/// Those of a homogeneous medium.
fn spectra(scene: &Scene<'_>, m: &Medium, reads: &mut u64) -> Checked {
    let all = [
        (m.sigma_t_spectrum, EXTINCTION[1]),
        (m.albedo_spectrum, 1.0),
        (m.emission_spectrum, MOST_EMISSION),
    ];
    let mut any = false;
    for ([first, rows], most) in all {
        if rows == 0 {
            zeros(&[first], Rule::MediumRows)?;
            continue;
        }
        ensure(cfg!(feature = "spectral"), Rule::SpectraLeftOut)?;
        ensure(m.kind == medium::HOMOGENEOUS, Rule::MediumRows)?;
        let left = reads.checked_sub(2 * u64::from(rows));
        *reads = left.ok_or(Rule::MediumBudget)?;
        spectrum(scene, first, rows, most, Rule::MediumRows)?;
        any = true;
    }
    let values = |[first, rows]: [u32; 2]| {
        let rows = table(scene.texels, first, rows).iter();
        rows.map(|&[_, value]| f32::from_bits(value))
    };
    let mut sigma_t = values(m.sigma_t_spectrum).chain(m.sigma_t);
    let mut albedo = values(m.albedo_spectrum).chain(m.albedo);
    let thick = sigma_t.clone().all(|sigma| extinction(&sigma));
    ensure(thick, Rule::MediumSigma)?;
    // Whether it emits is asked of its channels.
    let emits = m.emission.iter().any(|&e| e > 0.0);
    let seen = emits || values(m.emission_spectrum).all(|e| e <= 0.0);
    ensure(seen, Rule::MediumEmission)?;
    // At a wavelength any two rows, or channels, may meet.
    let absorbs = sigma_t.all(|sigma| sigma > 0.0) && albedo.all(|albedo| albedo < 1.0);
    ensure(!any || !emits || absorbs, Rule::MediumAbsorption)
}

fn lobe(l: &Lobe) -> Checked {
    ensure(l.kind <= medium::FORWARD, Rule::LobeKind)?;
    ensure(l.g.abs() < 1.0, Rule::LobeG)?;
    within(&[l.weight], 0.0, 1.0, Rule::LobeWeight)?;
    zeros(&[l.reserved], Rule::LobeReserved)
}

fn gridded_medium(scene: &Scene<'_>, m: &Medium, reads: &mut u64) -> Checked {
    let extinctions = scene.grid(m.extinctions).ok_or(Rule::MediumExtinctions)?;
    optional(m.albedos, scene.grids.len(), Rule::MediumAlbedos)?;
    optional(m.emissions, scene.grids.len(), Rule::MediumEmissions)?;
    let [r, g, b] = m.sigma_t;
    let one = extinctions.channels == 1 && r == g && g == b;
    let residual = m.flags & medium::RESIDUAL != 0;
    ensure(one || !residual, Rule::MediumResidual)?;
    ensure(invertible(&m.to_grid), Rule::MediumToGrid)?;
    let mut sides = m.cells.iter().zip(&extinctions.size);
    let fits = sides.all(|(cells, size)| (1..=*size).contains(cells));
    ensure(fits, Rule::MediumCells)?;
    let count = m.cells.iter().fold(1, |n, &c| n * u64::from(c));
    let majorants = span(scene.texels, m.majorants, count, Rule::MediumMajorants)?;
    let mut read = |words: &[u32]| {
        *reads = reads.checked_sub(words.len() as u64)?;
        Some(())
    };
    read(majorants).ok_or(Rule::MediumBudget)?;
    if let Some(grid) = scene.grid(m.albedos) {
        let values = values(scene, grid)?;
        read(values).ok_or(Rule::MediumBudget)?;
        let most = 1.0 / largest(&m.albedo);
        ensure(at_most(values, most), Rule::MediumAlbedoGrid)?;
    }
    if let Some(grid) = scene.grid(m.emissions) {
        let values = values(scene, grid)?;
        read(values).ok_or(Rule::MediumBudget)?;
        let most = MOST_EMISSION / largest(&m.emission);
        ensure(at_most(values, most), Rule::MediumEmissionGrid)?;
    }
    let values = values(scene, extinctions)?;
    read(values).ok_or(Rule::MediumBudget)?;
    let bounded = Boxes {
        medium: m,
        grid: extinctions,
        values,
    };
    let mut each = (0u32..).zip(majorants);
    ensure(
        each.all(|(i, &word)| bounded.by(i, f32::from_bits(word))),
        Rule::MediumMajorant,
    )
}

/// 0, or in range.
fn extinction(sigma: &f32) -> bool {
    *sigma == 0.0 || (EXTINCTION[0]..=EXTINCTION[1]).contains(sigma)
}

fn largest(by_channel: &[f32; 3]) -> f32 {
    by_channel.iter().fold(0.0, |a, &b| a.max(b))
}

/// All of them in [0, `most`].
#[inline(never)]
fn at_most(words: &[u32], most: f32) -> bool {
    words
        .iter()
        .all(|&w| (0.0..=most).contains(&f32::from_bits(w)))
}

/// A grid's words: at most 2³⁸.
#[inline(never)]
fn values<'a>(scene: &Scene<'a>, g: &Grid) -> Result<&'a [u32], Rule> {
    let words = g.size.iter().fold(1, |n, &s| n * u64::from(s)) * u64::from(g.channels);
    span(scene.texels, g.texels, words, Rule::GridTexels)
}

/// Rows of lengths within 1e±12 whose volume is no small part of what it would be were they orthogonal: no direction is
/// mapped to nothing, even in single precision.
fn invertible(rows: &[[f32; 4]; 3]) -> bool {
    if finite(rows.as_flattened(), Rule::MediumToGrid).is_err() {
        return false;
    }
    let [a, b, c] = rows.map(|[x, y, z, _]| [x, y, z].map(f64::from));
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let cross = [
        b[1] * c[2] - b[2] * c[1],
        b[2] * c[0] - b[0] * c[2],
        b[0] * c[1] - b[1] * c[0],
    ];
    let squares = [a, b, c].map(|r| dot(r, r));
    let volume = dot(a, cross);
    let product = squares[0] * squares[1] * squares[2];
    let offsets = rows.iter().all(|row| row[3].abs() <= 1e24);
    let lengths = squares.iter().all(|s| (1e-24..=1e24).contains(s));
    offsets && lengths && volume * volume >= 1e-8 * product
}

/// What majorants must bound.
struct Boxes<'a> {
    medium: &'a Medium,
    grid: &'a Grid,
    values: &'a [u32],
}

impl Boxes<'_> {
    /// Whether `majorant` is 0 or in range, and at least σ_t of every channel in box `index`. As there are no more boxes than texels
    /// along any axis, a texel is looked at from at most four boxes along each.
    fn by(&self, index: u32, majorant: f32) -> bool {
        let [nx, ny, _] = self.medium.cells;
        let (row, x) = (index / nx.max(1), index % nx.max(1));
        let (z, y) = (row / ny.max(1), row % ny.max(1));
        let spans = [x, y, z];
        let mut most = [0.0f32; 3];
        let [sx, sy, _] = self.grid.size.map(|n| n as usize);
        let channels = self.grid.channels as usize;
        for k in self.span(spans, 2) {
            for j in self.span(spans, 1) {
                for i in self.span(spans, 0) {
                    let first = ((k * sy + j) * sx + i) * channels;
                    for (channel, most) in most.iter_mut().enumerate() {
                        let word = self.values.get(first + channel % channels.max(1));
                        *most = most.max(word.map_or(0.0, |&w| f32::from_bits(w)));
                    }
                }
            }
        }
        let mut sigmas = self.medium.sigma_t.iter().zip(most);
        extinction(&majorant) && sigmas.all(|(sigma, most)| sigma * most <= majorant)
    }

    /// The texels that matter in box `index` along `axis`.
    fn span(&self, index: [u32; 3], axis: usize) -> core::ops::RangeInclusive<usize> {
        let of = |v: &[u32; 3]| v.get(axis).copied().unwrap_or(0);
        let (index, cells, size) = (of(&index), of(&self.medium.cells), of(&self.grid.size));
        // All are at most 4096: nothing wraps.
        let last = size.saturating_sub(1);
        let (low, high) = if self.grid.nearest == 1 {
            let ceiling = (index + 1) * size + cells.saturating_sub(1);
            (
                quotient(index * size, cells),
                quotient(ceiling, cells).saturating_sub(1),
            )
        } else {
            // Texel i is at i + ½, so the box reaches from index·size/cells − ½ on in units of texels.
            let half = |i: u32| (2 * i * size).saturating_sub(cells);
            let twice = 2 * cells;
            (
                quotient(half(index), twice),
                quotient(half(index + 1) + twice.saturating_sub(1), twice),
            )
        };
        low as usize..=high.min(last) as usize
    }
}

/// ⌊a/b⌋; 0 where there is none.
fn quotient(a: u32, b: u32) -> u32 {
    a.checked_div(b).unwrap_or(0)
}
