//! Metropolis light transport in primary sample space (Kelemen et al. 2002), multiplexed over the strategies of [`super::bidirectional`] (Hachisuka
//! et al. 2014).
//!
//! The primary sample is a place in the image, a strategy (s, t), and the numbers of its two walks ([`Recorded`]). A chain has paths of one length, k = s + t − 1 edges:
//!
//! ```text
//! f*(u) = (k + 1)·max(0, c − above), c = mean channel of w_st·f/p          b = ∫ Σ_k f*_k du, the mean of the image that chains give
//! pixel = min(c, above)/c of the colours of samples + what chains give: Σ over steps of a/b-weighted colours, over the steps per pixel
//! ```
//!
//! 1. [`Scene::bootstrap`] makes whole samples, of all strategies: their mean is b. What a contribution carries up to [`Mutations::above`] they give
//!    to the image themselves: samples are better at what is found easily, chains at what is not. Where walks are split, chains start from
//!    walks aside too.
//! 2. A [`Chain`] starts from a contribution to one of them: the sample is drawn in proportion to its mean, the contribution in proportion to its
//!    own, anew by each chain. That draws k in proportion to b_k, of any length, and begins in the stationary distribution as far as there are enough samples.
//! 3. [`Chain::advance`] makes steps, each of which splats what it left and what it came to, by the chance of either.
//!
//! Of one strategy at a time b would be known far worse for as much work: where light is hard to find, few samples have any, and those have it
//! by one or two of all their strategies.

mod chain;

pub use chain::{Chain, Mutations};

use super::bidirectional::{self, LITTLE, Strategies};
use super::scratch::{ScratchView, Workspace};
use super::{Errand, Settings, accept, channels, dispatch};
use crate::blob::{Possible, Scene, View};
use crate::instance::Instance;
use crate::path::Trace;
use crate::random::{CHOICES, Mutation, Pcg, Purpose, Recorded, Sampler, Subpath, Tapes};
use crate::real::{ONE_MINUS, Real};
use crate::sensor::{Element, each_pixel};
use crate::spectrum::{Rgb, Spectrum};

/// What a strategy contributes.
#[derive(Clone, Copy, Debug)]
struct Contribution {
    /// Radiance, as the estimate of a pixel.
    value: Rgb,
    /// Where it is seen, if by all pixels whose filters cover that; else its own pixel.
    raster: Option<[Real; 2]>,
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

    /// Over the chance of the strategy, one of `count`.
    fn times(mut self, count: u32) -> Self {
        self.contribution.value *= count as Real;
        self.importance *= count as Real;
        self
    }

    /// How often what isn't a large step moves the place in the image alone. A light walk that the sensor sees has its own place.
    #[inline(always)]
    fn views(&self, settings: &Settings) -> Real {
        match self.contribution.raster {
            None => settings.mutations.view,
            Some(_) => 0.0,
        }
    }

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

/// Salts of the streams: what they are for is in their numbers.
const BOOTSTRAP: u64 = 0x626f_6f74_0000_0000;
const DRAW: u64 = 0x6472_6177_0000_0000;

/// Which way of joining the walks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strategy {
    /// Vertices of the light walk.
    s: usize,
    /// Vertices of the sensor walk.
    t: usize,
}

/// What is wanted of a sample.
enum Wanted<'w> {
    /// What this strategy contributes.
    Only(Strategy),
    /// What one of all contributes, drawn in proportion to f* by these numbers; what they leave to the sample goes here.
    Any(Pcg, &'w mut dyn FnMut([u32; 2], Rgb)),
}

/// What a sample contributes.
struct Drawn<'w> {
    wanted: Wanted<'w>,
    /// [`Mutations::above`], and what the pixel itself gets up to that.
    above: Real,
    below: Rgb,
    /// What the sample adds to its pixel so far, the mean channel.
    sum: Real,
    /// The sum of the importance of all that contributed.
    total: Real,
    /// What was drawn, and by which strategy it came, by a walk aside or not.
    state: State,
    strategy: Strategy,
    aside: bool,
    /// Whether the scratch has the sample's light walk already.
    lit: bool,
}

impl<'w> Drawn<'w> {
    fn new(wanted: Wanted<'w>, settings: &Settings, pixel: [u32; 2]) -> Self {
        Self {
            wanted,
            above: settings.mutations.above,
            below: Rgb::BLACK,
            sum: 0.0,
            total: 0.0,
            state: State {
                pixel,
                ..State::NONE
            },
            strategy: Strategy { s: 0, t: 2 },
            aside: false,
            lit: false,
        }
    }
}

/// [`Drawn`], of contributions as an instance of the estimator makes them.
struct Drawing<'d, 'w, 's, 'a, S: Spectrum> {
    drawn: &'d mut Drawn<'w>,
    scene: View<'s, 'a, S>,
    possible: Possible,
    /// Of [`Drawn::sum`], what is little.
    share: Real,
    /// A connection that carries no more, whatever is in between, is below [`Drawn::above`] for certain.
    bound: Real,
    /// Contributions that weren't finite, or negative.
    rejected: u64,
}

impl<S: Spectrum> Strategies<S> for Drawing<'_, '_, '_, '_, S> {
    #[inline(always)]
    fn has(&self, s: usize, t: usize) -> bool {
        match self.drawn.wanted {
            Wanted::Only(only) => only == Strategy { s, t },
            Wanted::Any(..) => true,
        }
    }
    #[inline(always)]
    fn keeps_light(&self) -> bool {
        self.drawn.lit
    }
    #[inline(always)]
    fn has_more(&self, end: Subpath, vertices: usize) -> bool {
        match (&self.drawn.wanted, end) {
            (Wanted::Any(..), _) => bidirectional::has_more(self.possible, end, vertices),
            (Wanted::Only(only), Subpath::Sensor) => only.t > vertices,
            // s = 1 draws its light anew, but where the sensor sees it.
            (Wanted::Only(only), Subpath::Light) => {
                only.s > vertices && (only.s > 1 || only.t == 1)
            }
            (Wanted::Only(_), Subpath::Aside) => false,
        }
    }
    #[inline(always)]
    fn take(&mut self, strategy: [usize; 2], value: S, share: Real, raster: Option<[Real; 2]>) {
        if self.consider(strategy, value, share, raster) {
            self.drawn.aside = false;
        }
    }
    #[inline(always)]
    fn take_aside(&mut self, t: usize, value: S, share: Real) -> bool {
        let taken = self.consider([0, t], value, share, None);
        self.drawn.aside |= taken;
        taken
    }
    /// Nothing that is for chains: a path of theirs has the same value whatever else its numbers make.
    #[inline(always)]
    fn little(&self) -> Real {
        match self.drawn.wanted {
            Wanted::Any(..) => (self.share * self.drawn.sum).min(self.bound),
            Wanted::Only(_) => self.bound,
        }
    }
    #[inline(always)]
    fn luck<P: Sampler>(&mut self, share: Real, _: &mut P) -> Real {
        match &mut self.drawn.wanted {
            // By numbers of its own: those of the path are recorded.
            Wanted::Any(random, _) => bidirectional::roulette(share, random),
            Wanted::Only(_) => 0.0,
        }
    }
    #[inline(always)]
    fn more(&self) -> u32 {
        match self.drawn.wanted {
            Wanted::Any(..) => bidirectional::more(&self.scene, self.possible),
            Wanted::Only(_) => 0,
        }
    }
}

impl<S: Spectrum> Drawing<'_, '_, '_, '_, S> {
    /// Counts a contribution that has a share of its path's; whether it is the one that is drawn, so far.
    // Not inlined: ten places take.
    #[inline(never)]
    fn consider(
        &mut self,
        [s, t]: [usize; 2],
        value: S,
        share: Real,
        raster: Option<[Real; 2]>,
    ) -> bool {
        let Some(value) = accept(value, &self.scene.waves) else {
            self.rejected += 1;
            return false;
        };
        let drawn = &mut *self.drawn;
        let (pixel, mut sum) = (drawn.state.pixel, 0.0);
        spread(&self.scene, raster, pixel, value, &mut |_, v| {
            sum += importance(v);
        });
        if raster.is_none() {
            drawn.sum += share * sum;
        }
        // f = min(f, above) + f*; 0/0 where there is nothing.
        let beyond = (sum - drawn.above).max(0.0);
        let left = if beyond < sum { beyond / sum } else { 1.0 };
        if let Wanted::Any(_, below) = &mut drawn.wanted
            && left < 1.0
        {
            let value = value * (share * (1.0 - left));
            match raster {
                None => drawn.below += value,
                Some(_) => spread(&self.scene, raster, pixel, value, *below),
            }
        }
        let mine = share * beyond;
        drawn.total += mine;
        // A reservoir of one (Chao 1982); the first is drawn for certain.
        let certain = mine >= drawn.total;
        let taken = match &mut drawn.wanted {
            Wanted::Any(random, _) if !certain => random.one(Purpose::Choice) * drawn.total < mine,
            _ => true,
        };
        let drawn_now = mine > 0.0 && taken;
        if drawn_now {
            let value = value * left;
            drawn.strategy = Strategy { s, t };
            drawn.state.contribution = Contribution { value, raster };
            drawn.state.importance = beyond;
        }
        drawn_now
    }
}

/// A sample of `pixel`, of paths of `limit` edges at most.
struct Draw<'d, 'w, 's, 'a, 'n> {
    scene: &'s Scene<'a>,
    settings: &'d Settings,
    limit: u32,
    pixel: [u32; 2],
    drawn: &'d mut Drawn<'w>,
    sampler: &'d mut Recorded<'n>,
}

impl Errand for Draw<'_, '_, '_, '_, '_> {
    type Result = ();

    #[inline(never)]
    fn run<K: Instance>(self, scratch: &mut Workspace<'_, K::S>) {
        let Self {
            scene,
            settings,
            limit,
            pixel,
            drawn,
            sampler,
        } = self;
        let (waves, lead) = channels::<K, _>(sampler);
        let (view, tree) = (View::new(scene, waves), scene.tree());
        let mut trace = Trace::<_, K>::new(view, &tree, lead, settings.roulette);
        // Not of other channels than the film's, nor where an estimate of what media let through may be above 1; and but for rounding.
        let known = <K::S as Spectrum>::FILM && !K::MEDIA;
        let bound = if known {
            drawn.above * (1.0 - 8.0 * Real::EPSILON)
        } else {
            0.0
        };
        let mut drawing = Drawing {
            drawn,
            scene: view,
            possible: scene.possible(),
            share: LITTLE * settings.roulette,
            bound,
            rejected: 0,
        };
        let element = &Element::Pixel(pixel);
        bidirectional::join(
            &mut trace,
            settings,
            limit,
            element,
            &mut drawing,
            sampler,
            scratch,
        );
        trace.counters.rejected += drawing.rejected;
        *scratch.counters += trace.counters;
    }
}

/// Strategies of paths of `edges` edges that are chosen from: s = 0 … k, as far as light walks are stored.
#[inline(always)]
fn strategies(edges: u32, scratch: &ScratchView<'_>) -> u32 {
    (scratch.capacity() as u32).min(edges) + 1
}

/// The pixel that `numbers` begin in if they begin at a place, in [0, 1)² of the image.
fn begin(scene: &Scene<'_>, [x, y]: [Real; 2], numbers: &mut Recorded<'_>) -> [u32; 2] {
    let size = scene.size();
    let (column, row) = (within(x, size[0]), within(y, size[1]));
    numbers.begin([column.1, row.1]);
    [column.0, row.0]
}

/// The place of whole sample `index`: within its pixel it is where `xi` says.
fn place(scene: &Scene<'_>, index: u64, xi: [Real; 2]) -> [Real; 2] {
    let [width, height] = scene.size().map(u64::from);
    // A scene has a pixel at least.
    let at = [index % width.max(1), index / width.max(1) % height.max(1)];
    let at = |i: usize, n: u64| ((at[i] as Real + xi[i]) / n as Real).min(ONE_MINUS);
    [at(0, width), at(1, height)]
}

/// The path of `edges` edges that `numbers` make, by the strategy that they choose. If it is `lit`, the scratch has its light walk.
fn evaluate(
    scene: &Scene<'_>,
    settings: &Settings,
    edges: u32,
    lit: bool,
    numbers: &mut Recorded<'_>,
    scratch: &mut ScratchView<'_>,
) -> State {
    if lit {
        numbers.keep_light();
    }
    let [x, y, choice]: [Real; CHOICES] = numbers.choose();
    let pixel = begin(scene, [x, y], numbers);
    let count = strategies(edges, scratch);
    let (s, _) = within(choice, count);
    let only = Strategy {
        s: s as usize,
        t: (edges + 1 - s) as usize,
    };
    let mut drawn = Drawn::new(Wanted::Only(only), settings, pixel);
    drawn.lit = lit;
    let draw = Draw {
        scene,
        settings,
        limit: settings.limit().min(edges),
        pixel,
        drawn: &mut drawn,
        sampler: numbers,
    };
    dispatch(scene, scratch, draw);
    drawn.state.times(count)
}

/// Which of `n` cells of [0, 1) `x` is in, and where in it.
#[inline(always)]
fn within(x: Real, n: u32) -> (u32, Real) {
    let scaled = x * n as Real;
    let cell = (scaled as u32).min(n.saturating_sub(1));
    (cell, (scaled - cell as Real).clamp(0.0, ONE_MINUS))
}

/// Where the numbers of sample `index` of the bootstrap come from, and go to.
fn anew<'t, const N: usize>(
    settings: &Settings,
    index: u64,
    tapes: &'t mut Tapes<N>,
) -> Recorded<'t> {
    tapes.propose(Mutation::Large, Pcg::new(settings.seed, BOOTSTRAP, index))
}

/// Sample `index` of the bootstrap: what all strategies contribute to chains, and the edges and the state of the one that is drawn of them by the stream of
/// chain `id`: chains of one sample start from different contributions. Its numbers go to `numbers`, which are [`anew`], what isn't for chains to `below`.
fn draw(
    scene: &Scene<'_>,
    settings: &Settings,
    [id, index]: [u64; 2],
    numbers: &mut Recorded<'_>,
    scratch: &mut ScratchView<'_>,
    below: &mut dyn FnMut([u32; 2], Rgb),
) -> (Real, u32, State) {
    let [x, y, xi]: [Real; CHOICES] = numbers.choose();
    let place = place(scene, index, [x, y]);
    let pixel = begin(scene, place, numbers);
    let random = Pcg::new(settings.seed, DRAW ^ id, index);
    let mut drawn = Drawn::new(Wanted::Any(random, below), settings, pixel);
    let draw = Draw {
        scene,
        settings,
        limit: settings.limit(),
        pixel,
        drawn: &mut drawn,
        sampler: numbers,
    };
    dispatch(scene, scratch, draw);
    if let (Wanted::Any(_, below), true) = (drawn.wanted, drawn.below != Rgb::BLACK) {
        below(pixel, drawn.below);
    }
    let Strategy { s, t } = drawn.strategy;
    let edges = (s + t - 1) as u32;
    let count = strategies(edges, scratch);
    if drawn.aside {
        numbers.adopt();
    }
    // Anywhere in its cell, but for what rounding could take to the next.
    numbers.decide(place, (s as Real + 0.01 + 0.98 * xi) / count as Real);
    (drawn.total, edges, drawn.state.times(count))
}

impl Scene<'_> {
    /// Sample number `index` of those that chains start from, by both walks; as many in a row as the image has pixels begin in each of them once, row by row
    /// from the top. Its contributions, to whatever pixels, go to `below` as far as they carry up to [`Mutations::above`]; what they carry
    /// beyond, in all, is returned: an estimate of the mean, over pixels and channels, of what chains are to give. The mean of such estimates is what
    /// [`Chain::advance`] scales by; a chain starts from one of the samples, drawn in proportion to its estimate. With n samples per pixel
    ///
    /// ```text
    /// pixel = sum of what went below / n + what chains give
    /// ```
    pub fn bootstrap(
        &self,
        settings: &Settings,
        index: u64,
        scratch: &mut ScratchView<'_>,
        below: &mut dyn FnMut([u32; 2], Rgb),
    ) -> Real {
        let mut tapes = Tapes::<0>::new();
        let numbers = &mut anew(settings, index, &mut tapes);
        draw(self, settings, [0, index], numbers, scratch, below).0
    }
}
