//! When a render ends: after so many passes, at the first whole pass after so much time, or when it is as accurate as was asked for.

use std::time::Duration;

/// How much to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples per pixel.
    Passes(u64),
    /// Rendering time; ends with the pass that reaches it.
    Time(Duration),
    /// Until the image is accurate, or one of the limits is reached.
    Error {
        /// The root of the squared error's mean over that of the image's square; not above this with a confidence of [`super::CONFIDENCE`].
        relative: f64,
        /// Samples per pixel, their mean, at most.
        passes: u64,
        /// Rendering time at most.
        time: Option<Duration>,
    },
}

/// A budget being spent.
pub(super) struct Spending {
    passes: u64,
    time: Option<Duration>,
}

/// Passes in a batch at most.
const LARGEST_BATCH: u64 = 64;
/// What a batch should take, in seconds: Ctrl-C has to wait for it, and so have all threads for the slowest.
const BATCH_SECONDS: f64 = 0.5;

impl Budget {
    /// Samples per pixel at most where only an error is asked for.
    pub const MOST_PASSES: u64 = 1 << 16;

    pub(super) fn begin(self) -> Spending {
        let (passes, time) = match self {
            Self::Passes(passes) => (passes, None),
            Self::Time(limit) => (u64::MAX, Some(limit)),
            Self::Error { passes, time, .. } => (passes, time),
        };
        Spending { passes, time }
    }
}

impl Spending {
    /// How many passes to do next; `None` if the budget is spent.
    pub fn next(&self, done: u64, elapsed: Duration) -> Option<u64> {
        let left = self.time.map(|limit| limit.saturating_sub(elapsed));
        // A pass at least, however short the time.
        if done >= self.passes || done > 0 && left.is_some_and(|left| left.is_zero()) {
            return None;
        }
        // A quarter of the rest, so that the end is met to within a pass.
        let seconds = left.map_or(BATCH_SECONDS, |left| {
            BATCH_SECONDS.min(0.25 * left.as_secs_f64())
        });
        // The first pass tells the speed.
        let per_pass = elapsed.as_secs_f64() / done.max(1) as f64;
        let most = if done == 0 { 1 } else { LARGEST_BATCH };
        let batch = ((seconds / per_pass) as u64).clamp(1, most);
        Some(batch.min(self.passes - done))
    }

    /// The share that is spent after `done` passes, fractions included.
    pub fn share(&self, done: f64, elapsed: Duration) -> f64 {
        let passes = done / self.passes.max(1) as f64;
        let time = self.time.map_or(0.0, |limit| {
            elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9)
        });
        passes.max(time).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Budget;
    use std::time::Duration;

    #[test]
    fn passes_are_spent_exactly_and_slow_ones_singly() {
        let budget = Budget::Passes(100).begin();
        let (mut done, mut fast) = (0, Duration::ZERO);
        while let Some(batch) = budget.next(done, fast) {
            done += batch;
            fast += Duration::from_micros(batch);
        }
        assert_eq!(done, 100);
        let slow = Duration::from_secs(30);
        assert_eq!(budget.next(0, Duration::ZERO), Some(1));
        assert_eq!(budget.next(3, slow), Some(1));
        assert_eq!(Budget::Passes(0).begin().next(0, Duration::ZERO), None);
    }

    #[test]
    fn time_ends_with_the_pass_that_reaches_it() {
        let budget = Budget::Time(Duration::from_secs(10)).begin();
        let pass = Duration::from_millis(300);
        let (mut done, mut elapsed) = (0, Duration::ZERO);
        while let Some(batch) = budget.next(done, elapsed) {
            done += batch;
            elapsed += pass * batch as u32;
        }
        assert_eq!(done, 34);
        // A pass at least, however short the time.
        let none = Budget::Time(Duration::ZERO).begin();
        assert_eq!(none.next(0, pass), Some(1));
        assert_eq!(none.next(1, pass), None);
    }
}
