//! What grids say of a medium as a whole.

use super::EXTINCTION;
use crate::description::{Grid, Grids, Medium};

/// Texels by axis that a majorant speaks for, as long as there are not too many majorants.
const TEXELS_PER_CELL: u32 = 4;
/// Majorants by axis.
const MOST_CELLS: u32 = 64;

/// Whether a medium with grids absorbs wherever it emits. Grids of the same size and filter weight the same texels anywhere, so that it is
/// enough to look at those.
pub fn absorbs(m: &Medium, grids: &Grids) -> Result<(), String> {
    let alike = |a: &Grid, b: &Grid| a.size == b.size && a.nearest == b.nearest;
    let extinction = &grids.extinction;
    if m.emission == [0.0; 3] {
        return Ok(());
    }
    if grids
        .emission
        .as_ref()
        .is_some_and(|e| !alike(e, extinction))
    {
        return Err("the grid of emission must have the size and filter of that of sigma_t".into());
    }
    let value = |grid: Option<&Grid>, texel: usize, c: usize| {
        grid.map_or(1.0, |g| {
            let (values, channels) = g.values.flat();
            values
                .get(texel * channels + c % channels)
                .copied()
                .unwrap_or(0.0)
        })
    };
    let texels = extinction.size.iter().map(|&n| n as usize).product();
    let most = |g: &Grid, c: usize| {
        let (values, channels) = g.values.flat();
        values
            .iter()
            .skip(c % channels)
            .step_by(channels)
            .fold(0.0f32, |a, b| a.max(*b))
    };
    for c in (0..3).filter(|&c| m.emission[c] > 0.0) {
        // An albedo below 1 everywhere may have any size.
        let albedo = grids
            .albedo
            .as_ref()
            .filter(|g| m.albedo[c] * most(g, c) >= 1.0);
        if albedo.is_some_and(|a| !alike(a, extinction)) {
            return Err("the grid of an albedo that reaches 1 must have the size and filter of that of sigma_t where the medium emits".into());
        }
        for texel in 0..texels {
            let emits = value(grids.emission.as_ref(), texel, c) > 0.0;
            let black = value(Some(extinction), texel, c) == 0.0;
            let white = albedo.is_some() && m.albedo[c] * value(albedo, texel, c) >= 1.0;
            if emits && (black || white) {
                let [w, h, _] = extinction.size.map(|n| n as usize);
                return Err(format!(
                    "emits where it doesn't absorb, at texel ({}, {}, {}); expected sigma_t > 0 and albedo < 1 wherever emission is > 0",
                    texel % w,
                    texel / w % h,
                    texel / w / h
                ));
            }
        }
    }
    Ok(())
}

/// Mean of a grid by channel.
pub fn grid_mean(grid: &Grid) -> [f64; 3] {
    let (values, channels) = grid.values.flat();
    let mut sums = [0.0; 3];
    for texel in values.chunks_exact(channels) {
        for (c, sum) in sums.iter_mut().enumerate() {
            *sum += f64::from(texel[c % channels]);
        }
    }
    sums.map(|s| s * channels as f64 / values.len() as f64)
}

/// Bounds on extinction in boxes of several texels, so that empty space costs little.
pub struct Majorants {
    pub cells: [u32; 3],
    pub values: Vec<f32>,
}

pub fn majorants(grid: &Grid, sigma_t: [f32; 3]) -> Majorants {
    let cells = grid
        .size
        .map(|n| n.div_ceil(TEXELS_PER_CELL).min(MOST_CELLS));
    let reach: [Vec<std::ops::RangeInclusive<usize>>; 3] = std::array::from_fn(|axis| {
        (0..cells[axis])
            .map(|i| texels_of(grid, axis, i, cells[axis]))
            .collect()
    });
    let (values, channels) = grid.values.flat();
    let [w, h, _] = grid.size.map(|n| n as usize);
    let mut out = Vec::with_capacity(cells.iter().map(|&n| n as usize).product());
    for z in &reach[2] {
        for y in &reach[1] {
            for x in &reach[0] {
                let mut most = [0.0f32; 3];
                for row in z
                    .clone()
                    .flat_map(|z| y.clone().map(move |y| (z * h + y) * w))
                {
                    let run = &values[(row + x.start()) * channels..(row + x.end() + 1) * channels];
                    for (i, &v) in run.iter().enumerate() {
                        let c = i % channels;
                        most[c] = most[c].max(v);
                    }
                }
                let by_channel = (0..3).map(|c| most[c % channels] * sigma_t[c]);
                let bound = by_channel.fold(0.0, f32::max);
                // A little above: interpolation rounds.
                out.push(match bound > 0.0 {
                    true => (bound * (1.0 + 1e-5)).max(EXTINCTION[0]),
                    false => 0.0,
                });
            }
        }
    }
    Majorants { cells, values: out }
}

/// The texels that have a say in box `i` of `cells` along `axis`, with some room for rounding at its ends.
pub fn texels_of(grid: &Grid, axis: usize, i: u32, cells: u32) -> std::ops::RangeInclusive<usize> {
    let n = f64::from(grid.size[axis]);
    let room = 1e-3;
    let end = |i: u32| f64::from(i) / f64::from(cells) * n;
    let (first, last) = if grid.nearest {
        ((end(i) - room).floor(), (end(i + 1) + room).floor())
    } else {
        (
            (end(i) - 0.5 - room).floor(),
            (end(i + 1) - 0.5 + room).floor() + 1.0,
        )
    };
    let clamp = |x: f64| x.clamp(0.0, n - 1.0) as usize;
    clamp(first)..=clamp(last)
}
