//! Light maps: a texture of the irradiance on a mesh with texture coordinates. A texel is a patch on the mesh, all that its
//! square of the map covers; its value is the mean irradiance there on the side of the normal, uniformly over the map.
//!
//! Texel (x, y)'s sample `index` is a pure function of (blob, settings, seed) and these numbers, and sums are taken in order, so the
//! bits are the same on any number of threads.

use super::atlas::{Atlas, AtlasError, Piece, normal};
use super::crew::{Crew, each_once};
use super::{RenderError, accept, lock};
use crate::description::Mesh;
use crate::memory::attempt;
use etendue::random::{Purpose, Sampler};
use etendue::real::Vec3;
use etendue::sensor::Element;
use etendue::{Counters, Scene, Scratch, Settings};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Vertices that a light walk keeps.
const CAPACITY: usize = super::CAPACITY;

/// How to bake.
#[derive(Clone, Copy, Debug)]
pub struct Bake {
    /// Estimator, weights, depth, seed.
    pub settings: Settings,
    /// Columns and rows of the map.
    pub size: [u32; 2],
    /// Samples of each texel.
    pub samples: u64,
    /// Texels that the borders of what is covered spread outwards.
    pub dilate: u32,
    /// Threads; 0 for one per core.
    pub threads: usize,
}

/// A finished map.
#[derive(Clone, Debug)]
pub struct Baked {
    /// Mean irradiance per texel, row by row from v = 0; black where nothing is covered.
    pub texels: Vec<[f32; 3]>,
    /// How many texels something covers.
    pub covered: usize,
    /// What the kernel counted.
    pub counters: Counters,
}

/// Why there is no map.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The mesh can't have one.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
    /// The render fails.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Bakes the light that `scene` throws on `mesh`, which is part of it. `watch` is told the share of the work that is done.
///
/// # Errors
/// As [`AtlasError`] and [`RenderError`] say.
pub fn bake(
    scene: &Scene<'_>,
    mesh: &Mesh,
    how: &Bake,
    watch: &(dyn Fn(f64) + Sync),
) -> Result<Baked, BakeError> {
    accept(scene, &how.settings)?;
    let [width, height] = how.size.map(|n| n as usize);
    let too_large = || RenderError::TooLarge { size: how.size };
    let mut texels = attempt(width * height).map_err(|_| too_large())?;
    texels.resize(width * height, [0.0; 3]);
    let atlas = Atlas::new(mesh, how.size)?;
    let counters = Mutex::new(Counters::default());
    let done = AtomicUsize::new(0);
    let rows: Vec<_> = texels.chunks_mut(width).map(Mutex::new).collect();
    Crew::Own(how.threads).employ(|run| {
        each_once(run, height, &|y| {
            let mut scratch = Box::new(Scratch::<CAPACITY>::new());
            for (x, texel) in (0u32..).zip(lock(&rows[y]).iter_mut()) {
                let place = [x, y as u32];
                *texel = irradiance(scene, mesh, how, place, atlas.texel(place), &mut scratch);
            }
            *lock(&counters) += scratch.counters;
            watch((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / height as f64);
        })
    })?;
    drop(rows);
    let mut known: Vec<bool> = (0..width * height)
        .map(|i| {
            let place = [(i % width) as u32, (i / width) as u32];
            !atlas.texel(place).is_empty()
        })
        .collect();
    let covered = known.iter().filter(|&&k| k).count();
    for _ in 0..how.dilate {
        if !dilate(&mut texels, &mut known, width) {
            break;
        }
    }
    Ok(Baked {
        texels,
        covered,
        counters: counters.into_inner().unwrap_or_default(),
    })
}

/// The mean of all samples of one texel.
fn irradiance(
    scene: &Scene<'_>,
    mesh: &Mesh,
    how: &Bake,
    [x, y]: [u32; 2],
    pieces: &[Piece],
    scratch: &mut Scratch<CAPACITY>,
) -> [f32; 3] {
    let mut sum = [0.0f64; 3];
    if pieces.is_empty() {
        return [0.0; 3];
    }
    for index in 0..how.samples {
        let id = u64::from(y) << 32 | u64::from(x);
        let sampler = &mut how.settings.numbers(id, index);
        let Some((position, normal)) = point(mesh, pieces, sampler) else {
            continue;
        };
        let element = Element::irradiance(scene, position, normal);
        let none = &mut |_, _| ();
        let settings = &how.settings;
        let value =
            scene.estimate_element(settings, &element, sampler, &mut scratch.view(scene), none);
        for (sum, value) in sum.iter_mut().zip(value.to_array()) {
            *sum += f64::from(value);
        }
    }
    sum.map(|s| (s / how.samples as f64) as f32)
}

/// A point of a patch, uniform on the map, and the normal there.
fn point(mesh: &Mesh, pieces: &[Piece], sampler: &mut impl Sampler) -> Option<(Vec3, Vec3)> {
    let which = f64::from(sampler.one(Purpose::Choice));
    let at = pieces.partition_point(|p| p.until <= which);
    let piece = pieces.get(at).or(pieces.last())?;
    let [u, v] = etendue::warp::triangle(sampler.two(Purpose::Position)).map(f64::from);
    let [a, b, c] = piece.corners;
    let weights = a + (b - a) * u + (c - a) * v;
    let index = mesh.triangles.get(piece.triangle as usize)?;
    let [p, q, r] = mesh.corners(index)?;
    let position = p + (q - p) * weights.x + (r - p) * weights.y;
    Some((position.as_vec3(), normal(mesh, index)?.as_vec3()))
}

/// Gives every texel beside known ones their mean; whether there was any.
fn dilate(texels: &mut [[f32; 3]], known: &mut [bool], width: usize) -> bool {
    let height = texels.len() / width;
    let mut new = Vec::new();
    for at in (0..texels.len()).filter(|&at| !known[at]) {
        let (x, y) = (at % width, at / width);
        let around = (y.saturating_sub(1)..(y + 2).min(height))
            .flat_map(|j| (x.saturating_sub(1)..(x + 2).min(width)).map(move |i| j * width + i))
            .filter(|&i| known[i]);
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for i in around {
            sum = std::array::from_fn(|c| sum[c] + texels[i][c]);
            count += 1.0;
        }
        if count > 0.0 {
            new.push((at, sum.map(|s| s / count)));
        }
    }
    for &(at, value) in &new {
        (texels[at], known[at]) = (value, true);
    }
    !new.is_empty()
}
