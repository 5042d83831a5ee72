//! Metropolis light transport in primary sample space (Kelemen et al. 2002), multiplexed over the strategies of [`super::bidirectional`] (Hachisuka
//! et al. 2014).
//!
//! The primary sample is a place in the image, a strategy (s, t), and the numbers of its two walks ([`Recorded`]). A chain has paths of one length, k = s + t − 1 edges:
//!
//! ```text
//! f*(u) = (k + 1)·mean channel of w_st·f/p                   b = ∫ Σ_k f*_k du, the image's mean
//! pixel = Σ over steps of a/b-weighted colours, so that Σ splats / (steps per pixel) estimates it
//! ```
//!
//! 1. [`Scene::bootstrap`] estimates f*/P(k) of independent paths with k drawn from P ([`Lengths`]): their mean is b.
//! 2. A [`Chain`] starts from one of them, drawn in proportion to its estimate: that draws k in proportion to b_k, of any length, and begins in the
//!    stationary distribution as far as there are enough of them.
//! 3. [`Chain::advance`] makes steps, each of which splats what it left and what it came to, by the chance of either.

use super::bidirectional::One;
use super::scratch::ScratchView;
use super::{Settings, strategy_with};
use crate::blob::Scene;
use crate::random::{CHOICES, Mutation, Pcg, Purpose, Recorded, Sampler as _, Tape, TapeView};
use crate::real::{Real, exp, log, safe_sqrt};
use crate::sensor::{Element, each_pixel};
use crate::spectrum::{Rgb, Spectrum};

/// How chains move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutations {
    /// How often a step is a path drawn anew, 0 to 1.
    pub large: Real,
    /// The largest change of a number in the other steps; [`Mutations::tuned`] finds a good one.
    pub size: Real,
}

impl Default for Mutations {
    fn default() -> Self {
        Self {
            large: 0.3,
            size: 1.0 / 64.0,
        }
    }
}

impl Mutations {
    /// The share of small steps that should be accepted.
    pub const TARGET: Real = 0.5;

    /// After a chain of which `accepted` of the small steps were: a size nearer to [`Self::TARGET`]. For chains that are thrown away: a chain
    /// that learns as it goes has another target.
    #[must_use]
    pub fn tuned(self, accepted: Real) -> Self {
        /// How fast: ln of the size changes by this much times what is amiss.
        const GAIN: Real = 1.5;
        let size = exp(log(self.size) + GAIN * (accepted - Self::TARGET));
        Self {
            size: size.clamp(1e-5, 0.25),
            ..self
        }
    }
}

/// What a primary sample contributes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// Radiance, as the estimate of a pixel.
    pub value: Rgb,
    /// Where it is seen, if by all pixels whose filters cover that; else its own pixel.
    pub raster: Option<[Real; 2]>,
}

impl Contribution {
    const NONE: Self = Self {
        value: Rgb::BLACK,
        raster: None,
    };
}

/// A contribution, its pixel, and f*.
#[derive(Clone, Copy, Debug)]
struct State {
    contribution: Contribution,
    pixel: [u32; 2],
    importance: Real,
}

impl State {
    const NONE: Self = Self {
        contribution: Contribution::NONE,
        pixel: [0; 2],
        importance: 0.0,
    };

    /// Hands `share`/f* of the contribution to its pixels.
    #[inline(always)]
    fn splat(&self, scene: &Scene<'_>, share: Real, splat: &mut dyn FnMut([u32; 2], Rgb)) {
        // 0/0, and what is so small that 1/f* isn't a number any more.
        let factor = share / self.importance;
        if !(share > 0.0 && factor.is_finite()) {
            return;
        }
        let value = self.contribution.value * factor;
        spread(scene, self.contribution.raster, self.pixel, value, splat);
    }
}

/// As [`super::light::spread`] does, of what is known by now.
#[inline(always)]
fn spread(
    scene: &Scene<'_>,
    raster: Option<[Real; 2]>,
    pixel: [u32; 2],
    value: Rgb,
    splat: &mut dyn FnMut([u32; 2], Rgb),
) {
    match raster {
        None => splat(pixel, value),
        Some(raster) => {
            let value = value * (1.0 / Element::Pixel(pixel).light_paths(scene));
            each_pixel(scene, raster, |pixel, filter| {
                splat(pixel, value * filter);
            });
        }
    }
}

/// The mean channel; of wavelengths, which may be negative, what they amount to.
#[inline(always)]
fn importance(value: Rgb) -> Real {
    let [r, g, b] = value.to_array();
    (r.abs() + g.abs() + b.abs()) * (1.0 / 3.0)
}

/// How many edges the paths of a bootstrap have.
#[derive(Clone, Copy, Debug)]
pub struct Lengths {
    /// What is known: weights of 1, 2, … edges, in order, and their sum.
    weights: [Real; Lengths::KNOWN],
    total: Real,
}

impl Default for Lengths {
    fn default() -> Self {
        Self::learned([0.0; Self::KNOWN])
    }
}

impl Lengths {
    /// Lengths that have a weight of their own.
    pub const KNOWN: usize = 32;
    /// The share of paths that is drawn without regard to what is known.
    const FLOOR: Real = 0.2;
    /// The ratio of the geometric half of those.
    const GOES_ON: Real = 0.7;

    /// After a first bootstrap: `squares` are the means of f*² by number of edges, from 1 on (0: unknown). The mean over all lengths varies the least if
    /// k is drawn in proportion to its root (Neyman's allocation).
    pub fn learned(squares: [Real; Self::KNOWN]) -> Self {
        let weights = squares.map(safe_sqrt);
        Self {
            weights,
            total: weights.iter().sum(),
        }
    }

    /// The share of the floor.
    fn floor(&self) -> Real {
        if self.total > 0.0 { Self::FLOOR } else { 1.0 }
    }

    /// P(k).
    pub fn probability(&self, edges: u32) -> Real {
        let k = edges as Real;
        let geometric = (1.0 - Self::GOES_ON) * exp((k - 1.0) * log(Self::GOES_ON));
        let floor = self.floor() * (0.5 * geometric + 0.5 / (k * (k + 1.0)));
        let index = (edges as usize).wrapping_sub(1);
        match self.weights.get(index) {
            Some(w) if self.total > 0.0 => floor + (1.0 - self.floor()) * w / self.total,
            _ => floor,
        }
    }

    /// Draws k. Of the floor, half is geometric, because most light is short, and half follows a law without a scale, P(≥ k) = 1/k, because where it
    /// isn't no length may be too rare.
    fn draw(&self, random: &mut Pcg) -> u32 {
        let [which, xi] = random.two(Purpose::Choice);
        if which >= self.floor() {
            let mut left = xi * self.total;
            for (w, edges) in self.weights.iter().zip(1..) {
                left -= w;
                if left < 0.0 {
                    return edges;
                }
            }
        }
        let xi = 1.0 - xi; // (0, 1]
        let edges = if which < 0.5 * self.floor() {
            1.0 + log(xi) / log(Self::GOES_ON)
        } else {
            1.0 / xi
        };
        // A cast cuts off the fraction, and saturates.
        (edges as u32).clamp(1, 1 << 24)
    }
}

/// Salts of the streams: what they are for is in their numbers.
const BOOTSTRAP: u64 = 0x626f_6f74_0000_0000;
const CHAIN: u64 = 0x6368_6169_0000_0000;

/// The path of `edges` edges that `numbers` make, by the strategy that they choose.
fn evaluate(
    scene: &Scene<'_>,
    settings: &Settings,
    edges: u32,
    numbers: &mut Recorded<'_>,
    scratch: &mut ScratchView<'_>,
) -> State {
    let size = scene.size();
    let [x, y, choice]: [Real; CHOICES] = numbers.choose();
    let (column, row) = (within(x, size[0]), within(y, size[1]));
    numbers.begin([column.1, row.1]);
    let pixel = [column.0, row.0];
    // s = 0 … k, as far as light walks are stored.
    let most = (scratch.capacity() as u32).min(edges);
    let (s, _) = within(choice, most + 1);
    let strategy = One {
        s: s as usize,
        t: (edges + 1 - s) as usize,
    };
    let element = Element::Pixel(pixel);
    let mut contribution = strategy_with(
        scene,
        &scene.tree(),
        settings,
        &element,
        strategy,
        numbers,
        scratch,
    );
    // 1/P(s, t).
    contribution.value *= (most + 1) as Real;
    let Contribution { value, raster } = contribution;
    let mut sum = 0.0;
    spread(scene, raster, pixel, value, &mut |_, v| {
        sum += importance(v);
    });
    State {
        contribution,
        pixel,
        importance: sum,
    }
}

/// Which of `n` cells of [0, 1) `x` is in, and where in it.
#[inline(always)]
fn within(x: Real, n: u32) -> (u32, Real) {
    let scaled = x * n as Real;
    let cell = (scaled as u32).min(n.saturating_sub(1));
    (
        cell,
        (scaled - cell as Real).clamp(0.0, crate::real::ONE_MINUS),
    )
}

/// A path drawn anew: its numbers go to `to`.
fn draw(
    scene: &Scene<'_>,
    settings: &Settings,
    lengths: &Lengths,
    index: u64,
    [from, to]: [TapeView<'_>; 2],
    scratch: &mut ScratchView<'_>,
) -> (u32, State) {
    let mut random = Pcg::new(settings.seed, BOOTSTRAP, index);
    let edges = lengths.draw(&mut random);
    if edges > settings.limit() {
        return (edges, State::NONE);
    }
    let mut numbers = Recorded::new(from, to, Mutation::Large, random);
    let state = evaluate(scene, settings, edges, &mut numbers, scratch);
    (edges, state)
}

impl Scene<'_> {
    /// Path number `index` of those that chains start from: the edges that it has, k, and f* of it. The mean of f*/P(k) is that of the image, over pixels and
    /// channels, and what [`Chain::advance`] scales by; a chain starts from one of these paths, drawn in proportion to it.
    pub fn bootstrap(
        &self,
        settings: &Settings,
        lengths: &Lengths,
        index: u64,
        scratch: &mut ScratchView<'_>,
    ) -> (u32, Real) {
        let (mut from, mut to) = (Tape::<0>::new(), Tape::<0>::new());
        let tapes = [from.view(), to.view()];
        let (edges, state) = draw(self, settings, lengths, index, tapes, scratch);
        (edges, state.importance)
    }
}

/// A chain of paths. `N` bounds the vertices of either walk whose numbers are recorded: those beyond are drawn anew at every step.
#[derive(Clone, Debug)]
pub struct Chain<const N: usize = 16> {
    tapes: [Tape<N>; 2],
    /// Which tape is that of the path where it is.
    here: usize,
    state: State,
    edges: u32,
    id: u64,
    steps: u64,
    small: [Real; 2],
}

impl<const N: usize> Default for Chain<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Chain<N> {
    /// Nowhere yet: it contributes nothing.
    pub const fn new() -> Self {
        Self {
            tapes: [Tape::new(), Tape::new()],
            here: 0,
            state: State::NONE,
            edges: 1,
            id: 0,
            steps: 0,
            small: [0.0; 2],
        }
    }

    /// Starts over, as chain number `id`, from the path of [`Scene::bootstrap`] number `index`.
    pub fn start(
        &mut self,
        scene: &Scene<'_>,
        settings: &Settings,
        lengths: &Lengths,
        id: u64,
        index: u64,
        scratch: &mut ScratchView<'_>,
    ) {
        let [from, to] = &mut self.tapes;
        let tapes = [from.view(), to.view()];
        let (edges, state) = draw(scene, settings, lengths, index, tapes, scratch);
        (self.here, self.state, self.edges) = (1, state, edges);
        (self.id, self.steps, self.small) = (id, 0, [0.0; 2]);
    }

    /// Takes `steps` steps. With a mean of `scale` over the image (the mean of bootstrap estimates), and n steps per pixel of the image
    /// by all chains together, a pixel is
    ///
    /// ```text
    /// pixel = sum of splats to it / n
    /// ```
    pub fn advance(
        &mut self,
        scene: &Scene<'_>,
        settings: &Settings,
        scale: Real,
        steps: u64,
        scratch: &mut ScratchView<'_>,
        splat: &mut dyn FnMut([u32; 2], Rgb),
    ) {
        // The chances of having been here since the last splat.
        let mut stayed = 0.0;
        for _ in 0..steps {
            let mut random = Pcg::new(settings.seed, CHAIN ^ self.id, self.steps);
            self.steps += 1;
            let [kind, accept] = random.two(Purpose::Choice);
            let mutation = if kind < settings.mutations.large {
                Mutation::Large
            } else {
                Mutation::Small(settings.mutations.size)
            };
            let [a, b] = &mut self.tapes;
            let (before, after) = if self.here == 0 { (a, b) } else { (b, a) };
            let mut numbers = Recorded::new(before.view(), after.view(), mutation, random);
            let proposed = evaluate(scene, settings, self.edges, &mut numbers, scratch);
            // Steps are symmetric: a = min(1, f*(y)/f*(x)) (Kelemen et al. 2002, eq. 5).
            let chance = if proposed.importance < self.state.importance {
                proposed.importance / self.state.importance
            } else {
                1.0
            };
            if mutation != Mutation::Large {
                self.small = [self.small[0] + chance, self.small[1] + 1.0];
            }
            stayed += 1.0 - chance;
            if accept < chance {
                self.state.splat(scene, stayed * scale, splat);
                (self.state, self.here, stayed) = (proposed, 1 - self.here, chance);
            } else {
                proposed.splat(scene, chance * scale, splat);
            }
        }
        self.state.splat(scene, stayed * scale, splat);
    }

    /// The share of small steps that were accepted, since it started.
    pub fn accepted(&self) -> Real {
        self.small[0] / self.small[1].max(1.0)
    }

    /// The edges of its paths.
    pub fn edges(&self) -> u32 {
        self.edges
    }
}
