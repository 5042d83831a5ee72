//! Renders in double precision, by the same source compiled a second time (`kernel/f64`): what single precision is charted against.

use super::{CAPACITY, RenderError};
use etendue::{Estimator, Heuristic, Settings};
use etendue_f64 as double;
use rayon::prelude::*;

/// The image of `passes` samples per pixel, on all threads of the current pool.
///
/// # Errors
/// If the estimator isn't one of samples of pixels, or can't answer for the scene.
pub fn render_double(
    blob: &[u8],
    settings: &Settings,
    passes: u64,
) -> Result<Vec<[f32; 3]>, RenderError> {
    let scene = double::Scene::open(blob)
        .map_err(|_| RenderError::Estimator("double precision doesn't open this scene"))?;
    let settings = wide(settings)?;
    if let Some(reason) = settings.estimator.refuses(&scene) {
        return Err(RenderError::Estimator(reason));
    }
    let [width, height] = scene.size().map(|n| n as usize);
    let black = || vec![[0.0f64; 3]; width * height];
    let sums = (0..passes)
        .into_par_iter()
        .fold(black, |mut sums, index| {
            pass(&scene, &settings, index, &mut sums);
            sums
        })
        .reduce(black, |mut a, b| {
            for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
                *a += b;
            }
            a
        });
    let mean = |x: f64| (x / passes.max(1) as f64) as f32;
    Ok(sums.into_iter().map(|sum| sum.map(mean)).collect())
}

/// One sample of each pixel. The one place where the estimators are compiled.
#[inline(never)]
fn pass(scene: &double::Scene<'_>, settings: &double::Settings, index: u64, sums: &mut [[f64; 3]]) {
    let [width, height] = scene.size();
    let mut scratch = Box::new(double::Scratch::<CAPACITY>::new());
    for at in 0..width * height {
        let pixel = [at % width, at / width];
        let mut add = |[x, y]: [u32; 2], value: double::Rgb| {
            if let Some(sum) = sums.get_mut((y * width + x) as usize) {
                for (s, v) in sum.iter_mut().zip(value.to_array()) {
                    *s += v;
                }
            }
        };
        let own = scene.estimate(settings, pixel, index, &mut scratch, &mut add);
        add(pixel, own);
    }
}

/// The same settings.
fn wide(s: &Settings) -> Result<double::Settings, RenderError> {
    Ok(double::Settings {
        estimator: match s.estimator {
            Estimator::Path => double::Estimator::Path,
            Estimator::Light => double::Estimator::Light,
            Estimator::Bidirectional => double::Estimator::Bidirectional,
            Estimator::Distributed => double::Estimator::Distributed,
            Estimator::Quadrature => double::Estimator::Quadrature,
            Estimator::QuadratureAndPath => double::Estimator::QuadratureAndPath,
            Estimator::Metropolis => {
                return Err(RenderError::Estimator(
                    "chains are rendered in single precision only",
                ));
            }
        },
        heuristic: match s.heuristic {
            Heuristic::Balance => double::Heuristic::Balance,
            Heuristic::Power => double::Heuristic::Power,
            Heuristic::Cutoff => double::Heuristic::Cutoff,
            Heuristic::Maximum => double::Heuristic::Maximum,
        },
        max_edges: s.max_edges,
        sequence: match s.sequence {
            etendue::random::Sequence::Independent => double::random::Sequence::Independent,
            etendue::random::Sequence::Sobol => double::random::Sequence::Sobol,
        },
        seed: s.seed,
        roulette: s.roulette.into(),
        tree: double::estimate::Tree {
            branching: s.tree.branching,
            lights: s.tree.lights,
        },
        rule: double::estimate::Rule {
            order: s.rule.order,
            steps: s.rule.steps,
            depth: s.rule.depth,
            shift: s.rule.shift,
        },
        ..double::Settings::default()
    })
}
