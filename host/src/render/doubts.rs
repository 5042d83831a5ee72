//! What a render itself has reason to doubt: that nothing is left out, that its error is what it seems to be, that its rules are fine enough. Each in a
//! sentence that names the cure.

use super::{CAPACITY, Rendered};
use crate::statistics::{FEWEST_ALIVE, Tail};
use etendue::blob::format::emitter;
use etendue::estimate::Rule;
use etendue::path::MAX_STEPS;
use etendue::{Estimator, Scene, Scratch, Settings};

/// With fewer samples nothing is said of their tail.
const FEWEST: u64 = 1024;

/// What may be better where an estimator has few samples that carry it all.
fn cure(estimator: Estimator) -> &'static str {
    match estimator {
        Estimator::Path => "try bidirectional, metropolis or quadrature+path, or more samples",
        Estimator::Bidirectional | Estimator::Metropolis => {
            "try path or quadrature+path, or more samples"
        }
        Estimator::Light | Estimator::Distributed | Estimator::QuadratureAndPath => {
            "try path or bidirectional, or more samples"
        }
        Estimator::Quadrature => "try path or bidirectional",
    }
}

/// All doubts at the end of a render.
pub fn doubts(scene: &Scene<'_>, settings: &Settings, r: &Rendered) -> Vec<String> {
    let estimator = settings.estimator;
    let mut all = losses(r, estimator);
    all.extend(r.tail.and_then(|t| tail(&t, estimator)));
    all.extend(rules(scene, settings));
    all
}

/// What a render had to leave out.
pub fn losses(r: &Rendered, estimator: Estimator) -> Vec<String> {
    let mut all = Vec::new();
    let lost = r.counters.rejected + r.refused.saturated + r.refused.invalid;
    if lost > 0 {
        all.push(format!(
            "{lost} values were not finite, negative or too large, and were left out"
        ));
    }
    all.extend(cut(r.counters.cut_walks, estimator));
    all
}

/// What walks that were cut had still to add.
pub fn cut(count: u64, estimator: Estimator) -> Option<String> {
    let cure = match estimator {
        Estimator::Quadrature | Estimator::QuadratureAndPath => {
            "with more lights than that choose path, else limit paths by --max-depth"
        }
        _ => "limit paths by --max-depth, or make surfaces and media darker",
    };
    (count > 0).then(|| {
        format!(
            "{count} walks were cut at {MAX_STEPS} steps, and what they had still to add is missing: {cure}"
        )
    })
}

/// Whether the error that samples seem to have can't be trusted: few found any light, or few carry it all.
pub fn tail(tail: &Tail, estimator: Estimator) -> Option<String> {
    if tail.samples < FEWEST || !tail.is_heavy() {
        return None;
    }
    let cure = cure(estimator);
    let (alive, all) = (tail.alive, tail.samples);
    Some(if alive < FEWEST_ALIVE {
        format!("{alive} of {all} samples found light: what the others missed isn't known; {cure}")
    } else {
        format!(
            "few samples carry this image: of {all} one has {:.1} % of it and the largest have {:.0} %, with a tail index of {:.1} (below 2 their variance is infinite), so that its error is larger than it seems; {cure}",
            100.0 * tail.share,
            100.0 * tail.top,
            tail.index
        )
    })
}

/// Pixels in each direction where rules are compared with finer ones.
const SIDE: u32 = 16;
/// Light that rules may be off by, relative to all of it: systematically, and in one pixel.
const MEAN: f64 = 1e-3;
const PIXEL: f64 = 0.05;
/// Standard errors that are no chance.
const CLEAR: f64 = 4.0;

/// Whether the rules of the quadrature are too coarse: they are compared with ones twice as fine, on some pixels. Across lights the finest there are have
/// nothing to be compared with.
pub fn rules(scene: &Scene<'_>, settings: &Settings) -> Option<String> {
    let rule = settings.rule;
    let by_rules = matches!(
        settings.estimator,
        Estimator::Quadrature | Estimator::QuadratureAndPath
    );
    let extended = scene.emitters().iter().any(|e| e.kind == emitter::AREA);
    let exact = !extended && scene.media().is_empty();
    if !by_rules || rule.shift || exact {
        return None;
    }
    let finer = Rule {
        order: rule.order.saturating_mul(2).min(Rule::MAX_ORDER),
        steps: rule.steps.saturating_mul(2),
        ..rule
    };
    let [coarse, fine] = [rule, finer].map(|rule| Settings {
        estimator: Estimator::Quadrature,
        rule,
        ..*settings
    });
    let mut scratch = Box::new(Scratch::<CAPACITY>::new());
    let mut grey = |settings: &Settings, pixel| {
        let value = scene.estimate(settings, pixel, 0, &mut scratch, &mut |_, _| ());
        value.to_array().iter().map(|&x| f64::from(x)).sum::<f64>()
    };
    let [columns, rows] = scene.size();
    let places = |n: u32| (0..n.min(SIDE)).map(move |i| (2 * i + 1) * n / (2 * n.min(SIDE)));
    let (mut sum, mut squares, mut off, mut off_squares) = (0.0, 0.0, 0.0, 0.0);
    for pixel in places(rows).flat_map(|y| places(columns).map(move |x| [x, y])) {
        let (value, better) = (grey(&coarse, pixel), grey(&fine, pixel));
        sum += better;
        squares += better * better;
        off += value - better;
        off_squares += (value - better) * (value - better);
    }
    let systematic = off.abs() > CLEAR * off_squares.sqrt() && off.abs() > MEAN * sum;
    if !(systematic || off_squares > PIXEL * PIXEL * squares) {
        return None;
    }
    Some(format!(
        "against rules twice as fine, quadrature is off by {:+.1} % of the whole and {:.1} % in a pixel: choose --quadrature {} and --steps {} or more, --shift, or path",
        100.0 * off / sum.abs().max(f64::MIN_POSITIVE),
        100.0 * (off_squares / squares.max(f64::MIN_POSITIVE)).sqrt(),
        finer.order,
        finer.steps
    ))
}
