//! Renders in double precision, by the same source compiled a second time (`kernel/f64`): what single precision is charted against.

use super::crew::{Crew, each_once};
use super::{CAPACITY, RenderError};
use etendue::{Estimator, Heuristic, Settings};
use etendue_f64 as double;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Most parts that the samples of a pixel are cut into: how many doesn't hang on the threads, so that sums round the same way.
const PARTS: u64 = 16;

/// The image of `passes` samples per pixel; if `stop` is set on the way, of fewer, that say nothing.
///
/// # Errors
/// If the estimator isn't one of samples of pixels, or can't answer for the scene; if there are no threads.
pub fn render_double(
    blob: &[u8],
    settings: &Settings,
    passes: u64,
    crew: Crew<'_>,
    stop: &AtomicBool,
) -> Result<Vec<[f32; 3]>, RenderError> {
    let scene = double::Scene::open(blob)
        .map_err(|_| RenderError::Estimator("double precision doesn't open this scene"))?;
    if settings.estimator == Estimator::Metropolis {
        return Err(RenderError::Estimator(
            "chains are rendered in single precision only",
        ));
    }
    let settings = wide(settings);
    if let Some(reason) = settings.estimator.refuses(&scene) {
        return Err(RenderError::Estimator(reason));
    }
    let [width, height] = scene.size().map(|n| n as usize);
    let mut total = vec![[0.0; 3]; width * height];
    let parts: Vec<_> = (0..passes.min(PARTS))
        .map(|_| Mutex::new(Vec::new()))
        .collect();
    crew.employ(|run| {
        each_once(run, parts.len(), &|part| {
            let mut sums = vec![[0.0; 3]; width * height];
            let mut indices = (part as u64..passes).step_by(parts.len());
            while let Some(index) = indices.next()
                && !stop.load(Ordering::Relaxed)
            {
                pass(&scene, &settings, index, &mut sums);
            }
            *parts[part].lock().unwrap_or_else(|e| e.into_inner()) = sums;
        })
    })?;
    for part in parts {
        let sums = part.into_inner().unwrap_or_else(|e| e.into_inner());
        for (t, s) in total.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
            *t += s;
        }
    }
    let mean = |x: f64| (x / passes.max(1) as f64) as f32;
    Ok(total.into_iter().map(|sum| sum.map(mean)).collect())
}

/// One sample of each pixel.
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

/// The same settings for the kernel in double precision.
pub(crate) fn wide(s: &Settings) -> double::Settings {
    double::Settings {
        estimator: match s.estimator {
            Estimator::Path => double::Estimator::Path,
            Estimator::Light => double::Estimator::Light,
            Estimator::Bidirectional => double::Estimator::Bidirectional,
            Estimator::Distributed => double::Estimator::Distributed,
            Estimator::Quadrature => double::Estimator::Quadrature,
            Estimator::QuadratureAndPath => double::Estimator::QuadratureAndPath,
            Estimator::Metropolis => double::Estimator::Metropolis,
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
        mutations: double::estimate::Mutations {
            large: s.mutations.large.into(),
            view: s.mutations.view.into(),
            size: s.mutations.size.into(),
            above: s.mutations.above.into(),
        },
        explicit_weights: s.explicit_weights,
    }
}
