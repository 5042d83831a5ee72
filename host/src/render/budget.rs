//! When a render ends: after so many passes, or at the first whole pass after so much time.

use std::time::Duration;

/// How much to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples per pixel.
    Passes(u64),
    /// Rendering time; ends with the pass that reaches it.
    Time(Duration),
}

/// A budget being spent.
pub(super) struct Spending {
    budget: Budget,
}

/// Passes in a batch at most: what Ctrl-C has to wait for.
const LARGEST_BATCH: u64 = 16;

impl Budget {
    pub(super) fn begin(self) -> Spending {
        Spending { budget: self }
    }
}

impl Spending {
    /// How many passes to do next; `None` if the budget is spent.
    pub fn next(&mut self, done: u64, elapsed: Duration) -> Option<u64> {
        match self.budget {
            Budget::Passes(n) => (done < n).then(|| (n - done).min(LARGEST_BATCH)),
            Budget::Time(limit) => {
                if done == 0 {
                    return Some(1);
                }
                let left = limit.checked_sub(elapsed)?;
                // What fits into a quarter of the rest, by the speed so far: the end is met to within a pass.
                let per_pass = elapsed.as_secs_f64() / done as f64;
                let fits = (0.25 * left.as_secs_f64() / per_pass) as u64;
                (!left.is_zero()).then(|| fits.clamp(1, LARGEST_BATCH))
            }
        }
    }

    /// The share that is spent, within a batch of which `part` is done.
    pub fn share(&self, done: u64, batch: u64, part: f64, elapsed: Duration) -> f64 {
        let share = match self.budget {
            Budget::Passes(n) => (done as f64 + batch as f64 * part) / n.max(1) as f64,
            Budget::Time(limit) => elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9),
        };
        share.clamp(0.0, 1.0)
    }
}
