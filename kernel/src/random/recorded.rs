//! Recorded numbers: what a path was made of, to be changed a little and made again (`transport.md` §7, Metropolis).

use super::{Pcg, Purpose, Sampler, Subpath};
use crate::real::{ONE_MINUS, Real};

/// Numbers of a vertex that are recorded.
const SLOTS: usize = 16;

/// Where the numbers for a purpose stand at a vertex, and how many are kept. [`Purpose::Lead`] is asked for at a walk's first vertex
/// alone, and stands where the later ones have their lobe.
#[inline(always)]
fn slots(purpose: Purpose) -> (u32, u32) {
    match purpose {
        // The pixel's, which is one number with the place in it.
        Purpose::Filter => (0, 0),
        Purpose::Blend => (0, 1),
        Purpose::Opacity => (1, 1),
        Purpose::Lens => (2, 2),
        Purpose::Choice => (4, 2),
        Purpose::Position => (6, 2),
        Purpose::Emission => (8, 2),
        Purpose::Lead | Purpose::Lobe => (10, 1),
        Purpose::Direction => (11, 2),
        Purpose::Roulette => (13, 1),
        Purpose::Flight => (14, 2),
    }
}

/// The numbers of one path: three streams, the walk from the sensor, that from the light, and what is chosen before either begins.
/// The first `N` vertices of each walk are recorded.
#[derive(Clone, Debug)]
struct Tape<const N: usize> {
    numbers: [[[Real; SLOTS]; N]; 2],
    recorded: [[u16; N]; 2],
    choice: [Real; CHOICES],
}

/// The stream of walks aside.
const ASIDE: usize = Subpath::Aside as usize;

/// Numbers of the third stream: column, row, strategy.
pub const CHOICES: usize = 3;
const STRATEGY: usize = 2;

impl<const N: usize> Tape<N> {
    /// Nothing recorded.
    const fn new() -> Self {
        Self {
            numbers: [[[0.0; SLOTS]; N]; 2],
            recorded: [[0; N]; 2],
            choice: [0.0; CHOICES],
        }
    }

    /// Of any length.
    #[inline(always)]
    fn view(&mut self) -> TapeView<'_> {
        TapeView {
            numbers: self.numbers.each_mut().map(<[_; N]>::as_mut_slice),
            recorded: self.recorded.each_mut().map(<[_; N]>::as_mut_slice),
            choice: &mut self.choice,
        }
    }
}

/// The numbers of a path, and room for those of the one that it is changed into.
#[derive(Clone, Debug)]
pub struct Tapes<const N: usize> {
    tapes: [Tape<N>; 2],
    /// Which of them is that of the path.
    here: usize,
}

impl<const N: usize> Tapes<N> {
    /// Nothing recorded.
    pub const fn new() -> Self {
        Self {
            tapes: [Tape::new(), Tape::new()],
            here: 0,
        }
    }

    /// The path changed by `mutation`, with randomness from `fresh`.
    #[inline(always)]
    pub fn propose(&mut self, mutation: Mutation, fresh: Pcg) -> Recorded<'_> {
        let [a, b] = &mut self.tapes;
        let (before, after) = if self.here == 0 { (a, b) } else { (b, a) };
        Recorded::new(before.view(), after.view(), mutation, fresh)
    }

    /// The path is what the last `mutation` made of it.
    #[inline(always)]
    pub fn accept(&mut self, mutation: Mutation) {
        let [a, b] = &mut self.tapes;
        let (before, after) = if self.here == 0 { (a, b) } else { (b, a) };
        if mutation.keeps() {
            (before.recorded, before.choice) = (after.recorded, after.choice);
        } else {
            self.here = 1 - self.here;
        }
    }
}

impl<const N: usize> Default for Tapes<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A [`Tape`] of any length: what works with it is compiled once for all.
#[derive(Debug)]
struct TapeView<'t> {
    numbers: [&'t mut [[Real; SLOTS]]; 2],
    recorded: [&'t mut [u16]; 2],
    choice: &'t mut [Real; CHOICES],
}

impl TapeView<'_> {
    /// The next place for `purpose` that nothing is recorded in yet; none if that is more than are kept.
    fn free(&self, walk: usize, vertex: usize, purpose: Purpose) -> Option<usize> {
        let mask = self.recorded.get(walk)?.get(vertex)?;
        let (first, count) = slots(purpose);
        let taken = (mask >> first).trailing_ones();
        (taken < count).then_some((first + taken) as usize)
    }

    /// What is recorded.
    fn known(&self, walk: usize, vertex: usize, slot: usize) -> Option<Real> {
        let mask = self.recorded.get(walk)?.get(vertex)?;
        let number = self.numbers.get(walk)?.get(vertex)?.get(slot)?;
        (mask & 1 << slot != 0).then_some(*number)
    }

    /// Records a number.
    fn set(&mut self, walk: usize, vertex: usize, slot: usize, number: Real) {
        self.mark(walk, vertex, slot);
        self.write(walk, vertex, slot, number);
    }

    /// Says that a number is recorded.
    fn mark(&mut self, walk: usize, vertex: usize, slot: usize) {
        let masks = self.recorded.get_mut(walk);
        if let Some(mask) = masks.and_then(|m| m.get_mut(vertex)) {
            *mask |= 1 << slot;
        }
    }

    /// Notes a number, recorded or not.
    fn write(&mut self, walk: usize, vertex: usize, slot: usize, number: Real) {
        let numbers = self.numbers.get_mut(walk);
        if let Some(place) = numbers.and_then(|n| n.get_mut(vertex)?.get_mut(slot)) {
            *place = number;
        }
    }
}

/// How a proposal differs from the path before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mutation {
    /// In everything.
    Large,
    /// In the place in the image alone, by steps of at most this size; their logarithms, too, are uniform or nearly so, down to a 32nd of it.
    View(Real),
    /// By steps of at most this size in each number (Kelemen et al. 2002, §4.3: their logarithms are uniform, or nearly so, down to
    /// a 1024th of it).
    Small(Real),
}

impl Mutation {
    /// Whether the numbers of both walks stay what they are, and where they are.
    #[inline(always)]
    fn keeps(self) -> bool {
        matches!(self, Self::View(_))
    }
}

/// How often the largest step can be halved: Kelemen has 4, but a chain that has got onto a peak narrower than its smallest step stays there for good.
const OCTAVES: u32 = 10;
/// The same for [`Mutation::View`]: less would stay in the pixel.
const VIEW_OCTAVES: u32 = 5;
/// 1 halved so often.
const HALVED: [Real; OCTAVES as usize] = {
    let (mut halved, mut k) = ([1.0; OCTAVES as usize], 1);
    while k < halved.len() {
        halved[k] = halved[k - 1] / 2.0;
        k += 1;
    }
    halved
};

/// The numbers of a proposal: those of the path before it, changed. What isn't asked for isn't kept: its distribution, given the path, is
/// uniform, so that drawing it anew when it is asked for again leaves the target as it is. Nor is what doesn't fit on the tape; it is drawn anew at
/// each proposal (pseudo-marginal chains, Andrieu & Roberts 2009).
#[derive(Debug)]
pub struct Recorded<'t> {
    before: TapeView<'t>,
    after: TapeView<'t>,
    mutation: Mutation,
    fresh: Pcg,
    walk: usize,
    vertex: usize,
    /// Given out in place of [`Purpose::Filter`]: position and pixel are one number.
    within: [Real; 2],
    given: usize,
    /// Where the walk aside began, and the one that was kept.
    aside: [usize; 2],
}

impl<'t> Recorded<'t> {
    /// Changes `before`, writing to `after`, with randomness from `fresh`. If the mutation keeps the numbers, they are those of `before`, and what is new
    /// is added there: `after` says which of them the path has asked for.
    fn new(before: TapeView<'t>, mut after: TapeView<'t>, mutation: Mutation, fresh: Pcg) -> Self {
        for mask in after.recorded.iter_mut().flat_map(|walk| walk.iter_mut()) {
            *mask = 0;
        }
        Self {
            before,
            after,
            mutation,
            fresh,
            walk: 0,
            vertex: 0,
            within: [0.0; 2],
            given: 0,
            aside: [0; 2],
        }
    }

    /// What the path begins with: a place in the image, in [0, 1)², and a number for the strategy.
    pub fn choose(&mut self) -> [Real; CHOICES] {
        let pairs = self.after.choice.iter_mut().zip(self.before.choice.iter());
        for ((new, old), i) in pairs.zip(0..) {
            *new = match self.mutation {
                Mutation::Small(size) => {
                    moved(*old, size, OCTAVES, self.fresh.one(Purpose::Choice))
                }
                Mutation::View(_) if i == STRATEGY => *old,
                Mutation::View(size) => {
                    moved(*old, size, VIEW_OCTAVES, self.fresh.one(Purpose::Choice))
                }
                Mutation::Large => self.fresh.one(Purpose::Choice),
            };
        }
        *self.after.choice
    }

    /// Records the place in the image, and the number that chose the strategy, of a path that was made by others.
    pub fn decide(&mut self, [x, y]: [Real; 2], strategy: Real) {
        *self.after.choice = [x, y, strategy];
    }

    /// The walk from the light is the same as before, of a mutation that keeps the numbers: all that it has asked for is asked for again.
    pub fn keep_light(&mut self) {
        let [after, before] = [&mut self.after, &mut self.before].map(|t| &mut t.recorded[1]);
        after.copy_from_slice(before);
    }

    /// The path is that of the walk aside that was kept, from where that left the sensor's: so are its numbers.
    pub fn adopt(&mut self) {
        let (from, to) = (Subpath::Light as usize, Subpath::Sensor as usize);
        for vertex in self.aside[1]..self.before.recorded[from].len() {
            let mut mask = self.before.recorded[from][vertex];
            while mask != 0 {
                let slot = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if let Some(number) = self.before.known(from, vertex, slot) {
                    self.after.set(to, vertex, slot, number);
                }
            }
        }
    }

    /// Says where in its pixel the path begins, in [0, 1)².
    pub fn begin(&mut self, within: [Real; 2]) {
        self.within = within;
    }
}

/// `x` moved by a small step, around the ends, by a number in [0, 1): up by those below 1/2, down by the others.
#[inline(always)]
fn moved(x: Real, size: Real, octaves: u32, xi: Real) -> Real {
    // No branch, which would be taken as often as not.
    let down = if xi < 0.5 { 0.0 } else { 1.0 };
    // Evenly in one of the octaves, all equally likely: an exponential for each number would cost as much as a ray for each path.
    let place = (2.0 * xi - down) * octaves as Real;
    let octave = place as u32;
    let largest = HALVED.get(octave as usize).copied().unwrap_or_default();
    let step = size * largest * (1.0 - 0.5 * (place - octave as Real));
    let y = x + step * (1.0 - 2.0 * down);
    let y = if y >= 1.0 {
        y - 1.0
    } else if y < 0.0 {
        y + 1.0
    } else {
        y
    };
    // Rounding may reach 1.
    y.min(ONE_MINUS)
}

impl Sampler for Recorded<'_> {
    #[inline(always)]
    fn at(&mut self, subpath: Subpath, vertex: u32) {
        let vertex = vertex as usize;
        // Walks aside go forward: one that doesn't is the next. They are of paths that are made anew, of which there is nothing before: its tape is theirs.
        let next = self.walk != ASIDE || vertex <= self.vertex;
        if subpath == Subpath::Aside && next && self.mutation == Mutation::Large {
            self.aside[0] = vertex;
            self.before.recorded[0].fill(0);
        }
        (self.walk, self.vertex) = (subpath as usize, vertex);
    }

    fn keep(&mut self) {
        let TapeView {
            numbers: [numbers, kept],
            recorded: [masks, kept_masks],
            ..
        } = &mut self.before;
        kept.copy_from_slice(numbers);
        kept_masks.copy_from_slice(masks);
        self.aside[1] = self.aside[0];
    }

    fn one(&mut self, purpose: Purpose) -> Real {
        if matches!(purpose, Purpose::Filter) {
            self.given += 1;
            let number = self.within.get(self.given - 1);
            return number.copied().unwrap_or_default();
        }
        let Self {
            before,
            after,
            mutation,
            fresh,
            walk,
            vertex,
            ..
        } = self;
        if *walk == ASIDE {
            let value = fresh.one(purpose);
            if *mutation == Mutation::Large
                && let Some(slot) = before.free(0, *vertex, purpose)
            {
                before.set(0, *vertex, slot, value);
            }
            return value;
        }
        let Some(slot) = after.free(*walk, *vertex, purpose) else {
            return fresh.one(purpose);
        };
        after.mark(*walk, *vertex, slot);
        let known = before.known(*walk, *vertex, slot);
        let (value, tape) = match (*mutation, known) {
            (Mutation::View(_), Some(old)) => return old,
            (Mutation::View(_), None) => (fresh.one(purpose), before),
            (Mutation::Small(size), Some(old)) => {
                let value = moved(old, size, OCTAVES, fresh.one(Purpose::Choice));
                (value, after)
            }
            _ => (fresh.one(purpose), after),
        };
        tape.write(*walk, *vertex, slot, value);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENDS: [Real; 6] = [
        0.0,
        Real::MIN_POSITIVE,
        0.5 - Real::EPSILON / 4.0,
        0.5,
        0.999,
        ONE_MINUS,
    ];

    /// Whatever a number is and whatever draws its step: in [0, 1), and as far away as steps are, around the ends.
    #[test]
    fn numbers_move_by_steps_of_their_size_and_stay_numbers() {
        let rounding = 4.0 * Real::EPSILON;
        for (x, size) in ENDS
            .into_iter()
            .flat_map(|x| [1e-5, 0.01, 0.25, 0.5].map(|size| (x, size)))
        {
            for xi in ENDS {
                for octaves in [VIEW_OCTAVES, OCTAVES] {
                    let y = moved(x, size, octaves, xi);
                    assert!((0.0..1.0).contains(&y), "{x} by {size}, {xi}: {y}");
                    let way = (y - x).abs();
                    let way = way.min(1.0 - way);
                    let least = size / (1u32 << octaves) as Real;
                    assert!(way <= size + rounding, "{x} by {size}, {xi}: {y}");
                    assert!(way >= least - rounding, "{x} by {size}, {xi}: {y}");
                }
            }
        }
    }

    /// Chains are right only if there and back are as likely: a step of one side is undone by the same step of the other.
    #[test]
    fn steps_are_undone_by_steps_to_the_other_side() {
        for x in ENDS {
            for xi in ENDS {
                let there = moved(x, 0.25, OCTAVES, xi / 2.0);
                let back = moved(there, 0.25, OCTAVES, (xi / 2.0 + 0.5).min(ONE_MINUS));
                let off = (back - x).abs();
                assert!(
                    off.min(1.0 - off) <= 2.0 * Real::EPSILON,
                    "{x} by {xi}: {back}"
                );
            }
        }
    }

    /// Each halving is as likely as any other.
    #[test]
    fn steps_of_all_sizes_are_as_likely() {
        let mut counts = [0u32; OCTAVES as usize];
        for i in 0..1000 {
            let xi = (i as Real + 0.5) / 1000.0;
            let step = moved(0.0, 0.5, OCTAVES, xi / 2.0);
            // In (2^−k/2, 2^−k]/2.
            let octave = (0..).find(|&k| step > 0.25 / (1u32 << k) as Real);
            counts[octave.unwrap()] += 1;
        }
        assert_eq!(counts, [100; OCTAVES as usize]);
    }
}
