//! Renders until the image is accurate, with more samples where they buy more, and without bias (`transport.md` §10).
//!
//! The image is the mean of two halves that never see each other; each is the mean of two films with random numbers of their own. At checkpoints, whose numbers of passes are
//! stated ([`checkpoint`]), the difference of one half's films says whether the *other* half may stop: a half that stopped when it looks
//! accurate itself would stop early where it had missed light. Until both have stopped, both go on, so that neither's verdicts depend on the other; but
//! what a half looked like when it stopped is what enters the image. How samples are spread over pixels is found by samples that are thrown away.

use super::accuracy::{Verdict, relative, risk};
use super::crew::Run;
use super::rates::Rates;
use super::tiles::{cut, film};
use super::{Accuracy, Course, Job, Progress, RenderError, Rendered, Worker, add_up, lock};
use crate::render::Budget;
use etendue::film::Sum;
use etendue::{Estimator, Settings};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// Passes of each film at the first checkpoint.
const FIRST: u64 = 4;

/// Passes of each film at a checkpoint: 4, 6, 8, 12, 16, 24, …
fn checkpoint(number: u32) -> u64 {
    let step = if number.is_multiple_of(2) {
        FIRST
    } else {
        FIRST * 3 / 2
    };
    step.saturating_mul(1u64.checked_shl(number / 2).unwrap_or(u64::MAX))
}

/// Sums of some passes.
struct Film {
    seed: u64,
    passes: u64,
    own: Vec<Sum>,
    splats: Vec<Sum>,
}

/// Two films, and what they looked like when the other half's said stop.
struct Half {
    films: [Film; 2],
    stopped: Option<Look>,
}

/// An image, and its variance if that is known.
struct Look {
    image: Vec<[f32; 3]>,
    verdict: Option<Verdict>,
    passes: [u64; 2],
}

/// What all films have in common.
struct Until<'j, 'a> {
    job: &'j Job<'a>,
    rates: &'j Rates,
    run: &'j Run<'j>,
    stop: &'j AtomicBool,
    watch: &'j (dyn Fn(Progress) + Sync),
}

/// Renders until the relative error is `asked` or the budget is spent.
pub(super) fn render(
    job: &Job<'_>,
    asked: f64,
    budget: Budget,
    run: &Run<'_>,
    stop: &AtomicBool,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Rendered, RenderError> {
    if job.settings.estimator == Estimator::Metropolis {
        return Err(RenderError::Estimator(
            "an image of chains can't be stopped by its error: samples of a chain depend on each other",
        ));
    }
    let begun = Instant::now();
    let rates = &Rates::found(job.scene, &job.settings, run)?;
    // Passes that are needed, by the last checkpoint.
    let needed = AtomicU64::new(f64::INFINITY.to_bits());
    let until = Until {
        job,
        rates,
        run,
        stop,
        watch: &|p| {
            let share = p.passes as f64 / f64::from_bits(needed.load(Ordering::Relaxed));
            watch(Progress {
                done: p.done.max(share.min(1.0)),
                ..p
            });
        },
    };
    let half = |first: u64| {
        Ok::<_, RenderError>(Half {
            films: [until.film(first)?, until.film(first + 1)?],
            stopped: None,
        })
    };
    let mut halves = [half(1)?, half(3)?];
    let mut course = Course::new(budget, begun);
    let mut checkpoints = 0;
    while halves.iter().any(|h| h.stopped.is_none()) {
        for film in halves.iter_mut().flat_map(|h| &mut h.films) {
            until.grow(film, checkpoint(checkpoints), &mut course)?;
        }
        // The last to grow: without it the budget is spent.
        if halves[1].films[1].passes < checkpoint(checkpoints) {
            break;
        }
        let looks = [until.look(&halves[0])?, until.look(&halves[1])?];
        let bounds = [0, 1].map(|i| {
            let verdict = looks[1 - i].verdict;
            // The mean of two halves has half the squared error of one.
            verdict.map_or(f64::INFINITY, |v| v.bound(0.5, risk(checkpoints)))
        });
        for ((half, look), bound) in halves.iter_mut().zip(looks).zip(bounds) {
            if half.stopped.is_none() && bound <= asked {
                half.stopped = Some(look);
            }
        }
        let worst = bounds[0].max(bounds[1]) / asked;
        let passes = course.done as f64 * worst.max(1.0).powi(2);
        needed.store(passes.to_bits(), Ordering::Relaxed);
        checkpoints += 1;
    }
    let met = halves.iter().all(|h| h.stopped.is_some());
    let mut looks = Vec::new();
    for half in halves {
        looks.push(match half.stopped {
            Some(look) => look,
            None => until.look(&half)?,
        });
    }
    // What was interrupted before it began isn't in the image.
    looks.retain(|look| look.passes != [0; 2]);
    let (mut rendered, _) = course.collect(job.size);
    let [fewest, most, all] = until.samples(&looks);
    let image = mean(&mut looks);
    // Of the mean of all.
    let share = (looks.len() as f64).powi(-2);
    let known = looks
        .iter()
        .map(|look| look.verdict.map(|v| share * v.variance));
    let variance = known.sum::<Option<f64>>().unwrap_or(f64::INFINITY);
    let squares = image
        .as_flattened()
        .iter()
        .map(|&x| f64::from(x) * f64::from(x));
    let energy = squares.sum::<f64>() / (3 * image.len()) as f64;
    rendered.passes = all / image.len() as u64;
    rendered.image = image;
    rendered.tail = None;
    rendered.accuracy = Some(Accuracy {
        asked,
        found: relative(variance, energy - variance),
        met,
        checkpoints,
        samples: [fewest, most],
    });
    Ok(rendered)
}

/// The mean of images; takes the last.
fn mean(looks: &mut [Look]) -> Vec<[f32; 3]> {
    let share = 1.0 / looks.len() as f32;
    let Some((last, others)) = looks.split_last_mut() else {
        return Vec::new();
    };
    let mut image = std::mem::take(&mut last.image);
    for (i, x) in image.as_flattened_mut().iter_mut().enumerate() {
        let sum = others
            .iter()
            .map(|o| o.image.as_flattened()[i])
            .sum::<f32>();
        *x = share * (*x + sum);
    }
    image
}

impl Until<'_, '_> {
    /// An empty film with random numbers of its own.
    fn film(&self, number: u64) -> Result<Film, RenderError> {
        let splats = if self.job.settings.estimator.splats() {
            film(self.job.size)?
        } else {
            Vec::new()
        };
        Ok(Film {
            // Any odd multiple: others' seeds are small.
            seed: self.job.settings.seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15),
            passes: 0,
            own: film(self.job.size)?,
            splats,
        })
    }

    /// Passes up to number `end`.
    fn grow(&self, film: &mut Film, end: u64, course: &mut Course) -> Result<(), RenderError> {
        let job = &Job {
            settings: Settings {
                seed: film.seed,
                ..self.job.settings
            },
            ..*self.job
        };
        let first = course.done - film.passes;
        let tiles: Vec<_> = cut(&mut film.own, job.size)
            .into_iter()
            .map(Mutex::new)
            .collect();
        let work = |i: usize, passes: std::ops::Range<u64>, worker: &mut Worker| {
            let mut tile = lock(&tiles[i]);
            let passes = passes.start - first..passes.end - first;
            worker.render(job, self.rates, &mut tile, passes);
            tile.len()
        };
        let Self {
            run, stop, watch, ..
        } = self;
        job.spend(course, first + end, run, stop, watch, tiles.len(), &work)?;
        film.passes = course.done - first;
        let mut splats = course.harvest();
        splats.push(std::mem::take(&mut film.splats));
        film.splats = add_up(self.run, splats)?;
        Ok(())
    }

    /// What a half looks like.
    fn look(&self, half: &Half) -> Result<Look, RenderError> {
        let [a, b] = &half.films;
        let passes = [a.passes, b.passes];
        let (mut image, other) = (self.resolve(a)?, self.resolve(b)?);
        let known = a.passes > 0 && b.passes > 0;
        let verdict = known.then(|| Verdict::of(&image, &other));
        if known {
            let both = image
                .as_flattened_mut()
                .iter_mut()
                .zip(other.as_flattened());
            both.for_each(|(x, &o)| *x = 0.5 * (*x + o));
        }
        Ok(Look {
            image,
            verdict,
            passes,
        })
    }

    /// Samples of the pixel with the fewest, of that with the most, and of all.
    fn samples(&self, looks: &[Look]) -> [u64; 3] {
        let [width, height] = self.job.size;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let count = |pixel| -> u64 {
            let films = looks.iter().flat_map(|look| look.passes);
            films.map(|passes| self.rates.count(pixel, passes)).sum()
        };
        pixels
            .map(count)
            .fold([u64::MAX, 0, 0], |[fewest, most, all], n| {
                [fewest.min(n), most.max(n), all + n]
            })
    }

    fn resolve(&self, film: &Film) -> Result<Vec<[f32; 3]>, RenderError> {
        self.job
            .resolve(&film.own, &film.splats, self.rates, film.passes)
    }
}

#[cfg(test)]
mod tests {
    use super::checkpoint;

    #[test]
    fn checkpoints_are_those_stated() {
        let first: Vec<_> = (0..7).map(checkpoint).collect();
        assert_eq!(first, [4, 6, 8, 12, 16, 24, 32]);
        assert_eq!(checkpoint(200), u64::MAX);
    }
}
