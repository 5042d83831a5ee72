//! The flags that say how light is estimated, for all commands that do it.

use crate::render::{Budget, Crew, Found, RenderError, pilot};
use clap::ValueEnum;
use etendue::estimate::{LEVELS, Mutations, Rule, Tree};
use etendue::random::Sequence;
use etendue::{Estimator, Heuristic, Scene, Settings};
use std::time::{Duration, Instant};

/// How light is estimated.
#[derive(clap::Args, Debug)]
pub struct How {
    /// How light is estimated
    #[arg(long, value_enum, default_value_t = EstimatorName::Auto)]
    estimator: EstimatorName,
    /// How strategies share a path (multiple importance sampling)
    #[arg(long, value_enum, default_value_t = HeuristicName::Power)]
    mis: HeuristicName,
    /// Where random numbers come from
    #[arg(long, value_enum, default_value_t = SamplerName::Independent)]
    sampler: SamplerName,
    /// Walks that carry less than this share of what they began with go on by Russian roulette, 0 to 1; so are connections of bidirectional looked at that
    /// carry less than a tenth of this share of what their sample has so far; 0: no roulette
    #[arg(long, value_name = "SHARE", default_value_t = Settings::default().roulette, value_parser = share)]
    roulette: f32,
    /// metropolis: how often a step is a path drawn anew, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Mutations::default().large, value_parser = share)]
    large_steps: f32,
    /// metropolis: the share of the other steps that move the path's place in the image and nothing else
    #[arg(long, value_name = "SHARE", default_value_t = Mutations::default().view, value_parser = share)]
    view_steps: f32,
    /// distributed: rays that go on from a vertex, by level; paths have at most an edge more than there are levels
    #[arg(long, value_name = "N,N,…", default_value = "8,4,2,1", value_parser = branching)]
    branching: Branching,
    /// distributed: samples of lights at each vertex
    #[arg(long, value_name = "N", default_value_t = Tree::default().lights, value_parser = clap::value_parser!(u8).range(1..))]
    light_samples: u8,
    /// quadrature: nodes of the Gauss–Legendre rule in each direction across a light
    #[arg(long, value_name = "N", default_value_t = Rule::default().order, value_parser = clap::value_parser!(u8).range(1..=i64::from(Rule::MAX_ORDER)))]
    quadrature: u8,
    /// quadrature: steps of the trapezoid rule along a way through a medium
    #[arg(long, value_name = "N", default_value_t = Rule::default().steps, value_parser = clap::value_parser!(u16).range(1..))]
    steps: u16,
    /// quadrature: equal steps shifted at random in place of these rules, without bias
    #[arg(long)]
    shift: bool,
    /// Selects the random numbers: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Most edges of a path: 1 shows emitters, 2 adds direct light; -1 is no limit [default: what the scene says, or no limit]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(i32).range(-1..))]
    max_depth: Option<i32>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum EstimatorName {
    /// path or bidirectional, whichever a short pilot finds more efficient on this scene
    Auto,
    /// walk from the camera, lights sampled at each vertex
    Path,
    /// walk from the lights, vertices joined to the camera
    Light,
    /// both walks and all connections between them
    Bidirectional,
    /// chains of paths over bidirectional, changed a little at each step
    Metropolis,
    /// ray trees to a stated depth; longer paths are left out
    Distributed,
    /// direct light and single scattering by deterministic rules; all other light is left out
    Quadrature,
    /// the same, and what it leaves out by path
    #[value(name = "quadrature+path")]
    QuadratureAndPath,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum HeuristicName {
    /// in proportion to the densities
    Balance,
    /// in proportion to their squares
    Power,
    /// balance among those within a tenth of the largest
    Cutoff,
    /// all to the largest
    Maximum,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SamplerName {
    /// independent of each other
    Independent,
    /// Owen-scrambled Sobol' points: the samples of a pixel spread evenly; best for 2^n samples
    Sobol,
}

/// Rays by level.
#[derive(Clone, Copy, Debug)]
struct Branching([u8; LEVELS]);

/// The most rays of a tree: a level's vertices come to as many as this, in all.
const MOST_RAYS: u32 = 1 << 14;

/// `8,4,2`.
fn branching(text: &str) -> Result<Branching, String> {
    let expected = || {
        format!(
            "expected 1 to {LEVELS} numbers from 1 to 255 like 8,4,2, whose product is at most {MOST_RAYS}, found {text:?}"
        )
    };
    let mut levels = [0; LEVELS];
    let mut rays = 1u32;
    for (i, number) in text.split(',').enumerate() {
        let n = number.trim().parse::<u8>().ok().filter(|&n| n > 0);
        let (Some(slot), Some(n)) = (levels.get_mut(i), n) else {
            return Err(expected());
        };
        *slot = n;
        rays = rays.saturating_mul(n.into());
    }
    if rays > MOST_RAYS {
        return Err(expected());
    }
    Ok(Branching(levels))
}

impl EstimatorName {
    /// The kernel's; `auto` is `path`, unless [`How::choose`] is asked.
    fn estimator(self) -> Estimator {
        match self {
            Self::Auto | Self::Path => Estimator::Path,
            Self::Light => Estimator::Light,
            Self::Bidirectional => Estimator::Bidirectional,
            Self::Metropolis => Estimator::Metropolis,
            Self::Distributed => Estimator::Distributed,
            Self::Quadrature => Estimator::Quadrature,
            Self::QuadratureAndPath => Estimator::QuadratureAndPath,
        }
    }
}

/// All estimators, and what the command line calls them.
pub fn estimators() -> impl Iterator<Item = (Estimator, String)> {
    let named = EstimatorName::value_variants().iter();
    named.filter_map(|e| {
        let name = e.to_possible_value()?.get_name().to_owned();
        (*e != EstimatorName::Auto).then_some((e.estimator(), name))
    })
}

/// What the command line calls it.
pub fn name(estimator: Estimator) -> String {
    let found = estimators().find(|(e, _)| *e == estimator);
    found.map_or_else(String::new, |(_, name)| name)
}

/// A share.
fn share(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x| (0.0..=1.0).contains(x))
        .ok_or_else(|| format!("expected a number from 0 to 1, found {text:?}"))
}

/// What was chosen.
pub struct Choice {
    /// The estimator, as the command line calls it.
    pub name: String,
    why: String,
    /// Rays of a sample.
    cost: f64,
    /// Rays of the pilot.
    pub rays: u64,
    /// Its time.
    pub seconds: f64,
}

impl Choice {
    /// The pilot's share of what a render of so much takes: of its time, if it has one, else of its rays; `None` where neither is known beforehand, and where there was
    /// no pilot.
    pub fn share(&self, budget: Budget, pixels: usize) -> Option<f64> {
        let share = match budget {
            Budget::Time(time) => self.seconds / time.as_secs_f64(),
            Budget::Passes(passes) => {
                self.rays as f64 / (passes as f64 * pixels as f64 * self.cost)
            }
            Budget::Error { .. } => return None,
        };
        Some(share).filter(|s| self.rays > 0 && s.is_finite())
    }

    /// What was chosen and why, and what that took, in one line.
    pub fn line(&self, budget: Option<(Budget, usize)>) -> String {
        let Self { name, why, .. } = self;
        if self.rays == 0 {
            return format!("{name}: {why}");
        }
        let millions = 1e-6 * self.rays as f64;
        let share = budget.and_then(|(budget, pixels)| Some((budget, self.share(budget, pixels)?)));
        let took = match share {
            // A time isn't the same each time: it is said only where the image isn't either.
            Some((Budget::Time(_), share)) => {
                format!(
                    "{:.2} s, {:.1} % of the render's time",
                    self.seconds,
                    100.0 * share
                )
            }
            Some((_, share)) => {
                format!(
                    "{millions:.2} M rays, {:.1} % of what the render takes",
                    100.0 * share
                )
            }
            None => format!("{millions:.2} M rays"),
        };
        format!("{name}: {why}; the pilot took {took}")
    }
}

/// Why the best is.
fn why(best: &Found, second: Option<&Found>) -> String {
    let Some(second) = second else {
        return "the other one can't make all of this scene's light".into();
    };
    let of = |f: &Found| {
        format!(
            "{} has an error of {:.2e} at {:.1} rays a sample",
            name(f.estimator),
            f.pilot.mse(),
            f.pilot.cost()
        )
    };
    let (first, other) = (of(best), of(second));
    if best.pilot.bright && !second.pilot.bright {
        format!(
            "by a pilot in which {} met no light ({first})",
            name(second.estimator)
        )
    } else if best.pilot.mse() <= 0.0 {
        format!("by a pilot without error ({first}; {other})")
    } else {
        let times = best.pilot.efficiency() / second.pilot.efficiency();
        format!("by a pilot {times:.2} times as efficient ({first}; {other})")
    }
}

impl How {
    /// Lets a pilot on so many threads (0: one per core) choose the estimator, if none is named.
    pub fn choose(
        &self,
        settings: &mut Settings,
        scene: &Scene<'_>,
        threads: usize,
        time: Option<Duration>,
    ) -> Result<Option<Choice>, RenderError> {
        if self.estimator != EstimatorName::Auto {
            return Ok(None);
        }
        let begun = Instant::now();
        let found = pilot(scene, settings, Crew::Own(threads), time)?;
        let seconds = begun.elapsed().as_secs_f64();
        let Some(best) = found.first() else {
            return Ok(None);
        };
        settings.estimator = best.estimator;
        Ok(Some(Choice {
            name: name(best.estimator),
            why: why(best, found.get(1)),
            cost: best.pilot.cost(),
            rays: found.iter().map(|f| f.pilot.rays).sum(),
            seconds,
        }))
    }

    /// The kernel's settings; `auto` is `path`, unless [`Self::choose`] is asked. With what the scene's file advises on the length of paths.
    pub fn settings(&self, advised_depth: Option<u32>) -> Settings {
        Settings {
            estimator: self.estimator.estimator(),
            heuristic: match self.mis {
                HeuristicName::Balance => Heuristic::Balance,
                HeuristicName::Power => Heuristic::Power,
                HeuristicName::Cutoff => Heuristic::Cutoff,
                HeuristicName::Maximum => Heuristic::Maximum,
            },
            max_edges: match self.max_depth {
                Some(n) => u32::try_from(n).ok(),
                None => advised_depth,
            },
            sequence: match self.sampler {
                SamplerName::Independent => Sequence::Independent,
                SamplerName::Sobol => Sequence::Sobol,
            },
            seed: self.seed,
            roulette: self.roulette,
            mutations: Mutations {
                large: self.large_steps,
                view: self.view_steps,
                ..Mutations::default()
            },
            tree: Tree {
                branching: self.branching.0,
                lights: self.light_samples,
            },
            rule: Rule {
                order: self.quadrature,
                steps: self.steps,
                shift: self.shift,
                ..Rule::default()
            },
            ..Settings::default()
        }
    }
}
