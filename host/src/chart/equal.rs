//! Images at equal time: what a ladder of budgets has shown says how many samples each variant is to have.

use super::measure::{Measured, Plan, Reference, Rung, Shown, Trial, image};
use etendue::Settings;
use std::sync::atomic::{AtomicBool, Ordering};

/// CPU seconds that the images of all are to take: as long as each has taken for one, at least.
pub fn time(all: &[Measured]) -> Option<f64> {
    let last = all.iter().filter_map(|m| Some(m.rungs.last()?.seconds()));
    last.min_by(f64::total_cmp)
}

/// Samples per pixel that take so long by these rungs, in proportion between two of them; one at least.
fn passes(rungs: &[Rung], seconds: f64) -> u64 {
    let above = rungs.iter().rposition(|r| r.seconds() < seconds);
    let Some((a, b)) = above.and_then(|i| Some((&rungs[i], rungs.get(i + 1)?))) else {
        // Longer than all, or shorter: then even the first.
        let end = if above.is_some() {
            rungs.last()
        } else {
            rungs.first()
        };
        return end.map_or(1, |r| r.passes);
    };
    let share = (seconds - a.seconds()) / (b.seconds() - a.seconds());
    a.passes + (share * (b.passes - a.passes) as f64).round() as u64
}

/// Renders the image of each that is shown. Returns whether all are there: `false` if `stop` was set.
///
/// # Errors
/// What a render says.
pub fn images(
    all: &mut [Measured],
    reference: &Reference,
    plan: &Plan,
    stop: &AtomicBool,
) -> Result<bool, String> {
    let Some(time) = time(all) else {
        return Ok(true);
    };
    for m in all.iter_mut().filter(|m| m.refused.is_none()) {
        let passes = passes(&m.rungs, time);
        let settings = Settings {
            // Of no other image of the chart.
            seed: m.subject.settings.seed ^ 1 << 62,
            ..m.subject.settings
        };
        let (image, seconds) = image(&m.subject, settings, passes, plan.threads, stop)?;
        if stop.load(Ordering::Relaxed) {
            return Ok(false);
        }
        let [_, errors] = reference.errors(&image);
        m.shown = Some(Shown {
            image,
            passes,
            trial: Trial { seconds, errors },
        });
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::{Rung, Trial, passes};

    #[test]
    fn times_between_rungs_have_samples_between_theirs() {
        let rung = |passes, seconds: [f64; 2]| Rung {
            passes,
            trials: seconds
                .map(|seconds| Trial {
                    seconds,
                    errors: [0.0; 2],
                })
                .into(),
            limited: false,
        };
        // The second is quicker than the first, by chance.
        let rungs = [
            rung(1, [0.9, 1.1]),
            rung(2, [0.8, 0.8]),
            rung(4, [2.8, 3.2]),
            rung(8, [6.0, 6.0]),
        ];
        for (seconds, expected) in [
            (0.1, 1),
            (0.8, 1),
            (0.9, 2),
            (1.9, 3),
            (3.0, 4),
            (4.5, 6),
            (6.0, 8),
            (9.0, 8),
        ] {
            assert_eq!(passes(&rungs, seconds), expected, "{seconds}");
        }
    }
}
