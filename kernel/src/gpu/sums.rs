//! The film's sums where many threads add to one: two words each, exact in any order.

use crate::film::{Refused, Step};
use crate::spectrum::Rgb;
use core::sync::atomic::{AtomicU64, Ordering};

/// Adds to a sum of 128 bits, low word first: each carry out of the low word is seen by exactly one thread.
fn add(sum: &[AtomicU64], value: i128) {
    let [low, high] = sum else { return };
    let before = low.fetch_add(value as u64, Ordering::Relaxed);
    let carry = u64::from(before.checked_add(value as u64).is_none());
    let above = ((value >> 64) as u64).wrapping_add(carry);
    if above != 0 {
        high.fetch_add(above, Ordering::Relaxed);
    }
}

/// Adds a contribution to a pixel of a film (6 words a pixel), or counts that it can't be.
pub(super) fn contribute(
    step: Step,
    film: &[AtomicU64],
    pixel: u64,
    value: Rgb,
    refused: &mut Refused,
) {
    let at = pixel as usize * 6;
    let Some(sums) = film.get(at..at + 6) else {
        return;
    };
    let [r, g, b] = value.to_array();
    if let (Some(r), Some(g), Some(b)) = (
        step.count(r, refused),
        step.count(g, refused),
        step.count(b, refused),
    ) {
        for (sum, value) in sums.chunks_exact(2).zip([r, g, b]) {
            add(sum, value);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::contribute;
    use crate::film::{Refused, Step, Sum};
    use crate::spectrum::Rgb;
    use core::sync::atomic::{AtomicU64, Ordering};

    /// Values whose low words carry often, from four threads, give the film's own sums.
    #[test]
    fn threads_add_what_one_would() {
        let step = Step::new(0);
        let value = |i: u32| {
            Rgb::new(
                0.75 + i as crate::real::Real,
                1e-9,
                3.0e5 - 61.0 * i as crate::real::Real,
            )
        };
        let film: [AtomicU64; 12] = core::array::from_fn(|_| AtomicU64::new(0));
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let film = &film;
                scope.spawn(move || {
                    for i in 0..5000 {
                        let value = value(i * 4 + thread);
                        contribute(step, film, 1, value, &mut Refused::default());
                    }
                });
            }
        });
        let mut sum: Sum = [0; 3];
        (0..20_000).for_each(|i| step.add(&mut sum, value(i), &mut Refused::default()));
        let words = film.map(|w| w.load(Ordering::Relaxed));
        let expected = sum.map(|s| [s as u64, (s >> 64) as u64]);
        assert_eq!(words[..6], [0; 6]);
        assert_eq!(words[6..], *expected.as_flattened());
    }
}
