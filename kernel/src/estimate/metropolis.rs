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
//! 1. [`Scene::bootstrap`] makes whole samples, of all strategies: their mean is b.
//! 2. A [`Chain`] starts from a contribution to one of them: the sample is drawn in proportion to its mean, the contribution in proportion to its
//!    own. That draws k in proportion to b_k, of any length, and begins in the stationary distribution as far as there are enough samples.
//! 3. [`Chain::advance`] makes steps, each of which splats what it left and what it came to, by the chance of either.
//!
//! Of one strategy at a time b would be known far worse for as much work: where light is hard to find, few samples have any, and those have it
//! by one or two of all their strategies.

use super::bidirectional::{self, Strategies};
use super::scratch::{ScratchView, Workspace};
use super::{Errand, Settings, accept, channels, dispatch};
use crate::blob::{Possible, Scene, View};
use crate::instance::Instance;
use crate::path::Trace;
use crate::random::{
    CHOICES, Mutation, Pcg, Purpose, Recorded, Sampler as _, Subpath, Tape, TapeView,
};
use crate::real::{Real, exp, log};
use crate::sensor::{Element, each_pixel};
use crate::spectrum::{Rgb, Spectrum};

/// How chains move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutations {
    /// How often a step is a path drawn anew, 0 to 1.
    pub large: Real,
    /// The share of the others that keep the light's walk and draw the sensor's anew, anywhere in the image, 0 to 1.
    pub view: Real,
    /// The largest change of a number in what steps are left; [`Mutations::tuned`] finds a good one.
    pub size: Real,
}

impl Default for Mutations {
    fn default() -> Self {
        Self {
            large: 0.1,
            view: 0.3,
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
const CHAIN: u64 = 0x6368_6169_0000_0000;

/// Which way of joining the walks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strategy {
    /// Vertices of the light walk.
    s: usize,
    /// Vertices of the sensor walk.
    t: usize,
}

/// What is wanted of a sample.
#[derive(Debug)]
enum Wanted {
    /// What this strategy contributes.
    Only(Strategy),
    /// What one of all contributes, drawn in proportion to f* by these numbers.
    Any(Pcg),
}

/// What a sample contributes.
struct Drawn {
    wanted: Wanted,
    /// The sum of the importance of all that contributed.
    total: Real,
    /// What was drawn, and by which strategy it came.
    state: State,
    strategy: Strategy,
}

impl Drawn {
    fn new(wanted: Wanted, pixel: [u32; 2]) -> Self {
        Self {
            wanted,
            total: 0.0,
            state: State {
                pixel,
                ..State::NONE
            },
            strategy: Strategy { s: 0, t: 2 },
        }
    }
}

/// [`Drawn`], of contributions as an instance of the estimator makes them.
struct Drawing<'w, 's, 'a, S: Spectrum> {
    drawn: &'w mut Drawn,
    scene: View<'s, 'a, S>,
    possible: Possible,
    /// Contributions that weren't finite, or negative.
    rejected: u64,
}

impl<S: Spectrum> Strategies<S> for Drawing<'_, '_, '_, S> {
    #[inline(always)]
    fn has(&self, s: usize, t: usize) -> bool {
        match self.drawn.wanted {
            Wanted::Only(only) => only == Strategy { s, t },
            Wanted::Any(_) => true,
        }
    }
    #[inline(always)]
    fn has_more(&self, end: Subpath, vertices: usize) -> bool {
        match (&self.drawn.wanted, end) {
            (Wanted::Any(_), _) => bidirectional::has_more(self.possible, end, vertices),
            (Wanted::Only(only), Subpath::Sensor) => only.t > vertices,
            // s = 1 draws its light anew, but where the sensor sees it.
            (Wanted::Only(only), Subpath::Light) => {
                only.s > vertices && (only.s > 1 || only.t == 1)
            }
            (Wanted::Only(_), Subpath::Aside) => false,
        }
    }
    // Not inlined: nine places take.
    #[inline(never)]
    fn take(&mut self, [s, t]: [usize; 2], value: S, raster: Option<[Real; 2]>) {
        let Some(value) = accept(value, &self.scene.waves) else {
            self.rejected += 1;
            return;
        };
        let drawn = &mut *self.drawn;
        let (pixel, mut sum) = (drawn.state.pixel, 0.0);
        spread(&self.scene, raster, pixel, value, &mut |_, v| {
            sum += importance(v);
        });
        drawn.total += sum;
        // A reservoir of one (Chao 1982); the first is drawn for certain.
        let certain = sum >= drawn.total;
        let taken = match &mut drawn.wanted {
            Wanted::Any(random) if !certain => random.one(Purpose::Choice) * drawn.total < sum,
            _ => true,
        };
        if sum > 0.0 && taken {
            drawn.strategy = Strategy { s, t };
            drawn.state.contribution = Contribution { value, raster };
            drawn.state.importance = sum;
        }
    }
    // A path has the same value whatever else its numbers make.
    #[inline(always)]
    fn little(&self) -> Real {
        0.0
    }
    #[inline(always)]
    fn more(&self) -> u32 {
        0
    }
}

/// A sample of `pixel`, of paths of `limit` edges at most.
struct Draw<'w, 's, 'a, 'n> {
    scene: &'s Scene<'a>,
    settings: &'w Settings,
    limit: u32,
    pixel: [u32; 2],
    drawn: &'w mut Drawn,
    sampler: &'w mut Recorded<'n>,
}

impl Errand for Draw<'_, '_, '_, '_> {
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
        let mut drawing = Drawing {
            drawn,
            scene: view,
            possible: scene.possible(),
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

/// The pixel that `numbers` begin in, and their number for the strategy.
fn begin(scene: &Scene<'_>, numbers: &mut Recorded<'_>) -> ([u32; 2], Real) {
    let size = scene.size();
    let [x, y, choice]: [Real; CHOICES] = numbers.choose();
    let (column, row) = (within(x, size[0]), within(y, size[1]));
    numbers.begin([column.1, row.1]);
    ([column.0, row.0], choice)
}

/// The path of `edges` edges that `numbers` make, by the strategy that they choose.
fn evaluate(
    scene: &Scene<'_>,
    settings: &Settings,
    edges: u32,
    numbers: &mut Recorded<'_>,
    scratch: &mut ScratchView<'_>,
) -> State {
    let (pixel, choice) = begin(scene, numbers);
    let count = strategies(edges, scratch);
    let (s, _) = within(choice, count);
    let only = Strategy {
        s: s as usize,
        t: (edges + 1 - s) as usize,
    };
    let mut drawn = Drawn::new(Wanted::Only(only), pixel);
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
    (
        cell,
        (scaled - cell as Real).clamp(0.0, crate::real::ONE_MINUS),
    )
}

/// Sample `index` of the bootstrap: what all strategies contribute, and the edges and the state of the one that is drawn of them. The numbers go
/// to `to`.
fn draw(
    scene: &Scene<'_>,
    settings: &Settings,
    index: u64,
    [from, to]: [TapeView<'_>; 2],
    scratch: &mut ScratchView<'_>,
) -> (Real, u32, State) {
    let fresh = Pcg::new(settings.seed, BOOTSTRAP, index);
    let mut numbers = Recorded::new(from, to, Mutation::Large, fresh);
    let (pixel, xi) = begin(scene, &mut numbers);
    let random = Pcg::new(settings.seed, DRAW, index);
    let mut drawn = Drawn::new(Wanted::Any(random), pixel);
    let draw = Draw {
        scene,
        settings,
        limit: settings.limit(),
        pixel,
        drawn: &mut drawn,
        sampler: &mut numbers,
    };
    dispatch(scene, scratch, draw);
    let Strategy { s, t } = drawn.strategy;
    let edges = (s + t - 1) as u32;
    let count = strategies(edges, scratch);
    // Anywhere in its cell, but for what rounding could take to the next.
    numbers.decide((s as Real + 0.01 + 0.98 * xi) / count as Real);
    (drawn.total, edges, drawn.state.times(count))
}

impl Scene<'_> {
    /// Sample number `index` of those that chains start from, by both walks from anywhere in the image: all that it contributes, to whatever pixels,
    /// as an estimate of the image's mean over pixels and channels. The mean of such samples is what [`Chain::advance`] scales by; a chain
    /// starts from one of them, drawn in proportion to it.
    pub fn bootstrap(
        &self,
        settings: &Settings,
        index: u64,
        scratch: &mut ScratchView<'_>,
    ) -> Real {
        let (mut from, mut to) = (Tape::<0>::new(), Tape::<0>::new());
        let tapes = [from.view(), to.view()];
        draw(self, settings, index, tapes, scratch).0
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

    /// Starts over, as chain number `id`, from sample number `index` of [`Scene::bootstrap`].
    pub fn start(
        &mut self,
        scene: &Scene<'_>,
        settings: &Settings,
        id: u64,
        index: u64,
        scratch: &mut ScratchView<'_>,
    ) {
        let [from, to] = &mut self.tapes;
        let tapes = [from.view(), to.view()];
        let (_, edges, state) = draw(scene, settings, index, tapes, scratch);
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
            let Mutations { large, view, .. } = settings.mutations;
            let mutation = if kind < large {
                Mutation::Large
            } else if kind < large + (1.0 - large) * view {
                Mutation::View
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
            if matches!(mutation, Mutation::Small(_)) {
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
