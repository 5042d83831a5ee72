//! Chains, and how they move.

use super::{State, anew, draw, evaluate};
use crate::blob::Scene;
use crate::estimate::Settings;
use crate::estimate::scratch::ScratchView;
use crate::random::{Mutation, Pcg, Purpose, Sampler as _, Tapes};
use crate::real::{Real, exp, log};
use crate::spectrum::Rgb;

/// The largest step in the image of what moves nothing else, of its width and height. Of 0.02, 0.05, 0.2 the one with the least noise on walls.
const VIEW: Real = 0.05;

/// The salt of the stream that moves chains.
const CHAIN: u64 = 0x6368_6169_0000_0000;

/// How chains move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutations {
    /// How often a step is a path drawn anew, 0 to 1.
    pub large: Real,
    /// The share of the others that move the path's place in the image and nothing else, 0 to 1; none are where that place doesn't matter (t = 1).
    pub view: Real,
    /// The largest change of a number in what steps are left; [`Mutations::tuned`] finds a good one.
    pub size: Real,
    /// What chains leave to whole samples: what a contribution carries up to so much, the mean channel of what it adds to pixels, a radiance. 0: nothing.
    /// Any value gives the same image in the mean.
    pub above: Real,
}

impl Default for Mutations {
    fn default() -> Self {
        Self {
            large: 0.01,
            view: 0.75,
            size: 1.0 / 64.0,
            above: 0.0,
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

/// A chain of paths. `N` bounds the vertices of either walk whose numbers are recorded: those beyond are drawn anew at every step.
#[derive(Clone, Debug)]
pub struct Chain<const N: usize = 16> {
    tapes: Tapes<N>,
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
            tapes: Tapes::new(),
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
        let numbers = &mut anew(settings, index, &mut self.tapes);
        // What isn't for chains is the bootstrap's to give.
        let below = &mut |_, _| ();
        let (_, edges, state) = draw(scene, settings, [id, index], numbers, scratch, below);
        self.tapes.accept(Mutation::Large);
        (self.state, self.edges) = (state, edges);
        (self.id, self.steps, self.small) = (id, 0, [0.0; 2]);
    }

    /// Takes `steps` steps, each of which hands out `scale`. With a mean of `scale` over the image (the mean of bootstrap estimates), and n steps per pixel of the image
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
        // The chances of having been here since the last splat, and whether the scratch has the light walk from here.
        let (mut stayed, mut lit) = (0.0, false);
        for _ in 0..steps {
            let mut random = Pcg::new(settings.seed, CHAIN ^ self.id, self.steps);
            self.steps += 1;
            let [kind, accept] = random.two(Purpose::Choice);
            let Mutations { large, .. } = settings.mutations;
            let view = self.state.views(settings);
            let mutation = if kind < large {
                Mutation::Large
            } else if kind < large + (1.0 - large) * view {
                Mutation::View(VIEW)
            } else {
                Mutation::Small(settings.mutations.size)
            };
            let mut numbers = self.tapes.propose(mutation, random);
            lit &= matches!(mutation, Mutation::View(_));
            let proposed = evaluate(scene, settings, self.edges, lit, &mut numbers, scratch);
            // Steps are symmetric but for how often they are small: a = min(1, f*(y) T(y→x)/(f*(x) T(x→y))) (Kelemen et al. 2002, eq. 5).
            let [mut from, mut to] = [self.state, proposed].map(|s| s.importance);
            if matches!(mutation, Mutation::Small(_)) {
                from *= 1.0 - view;
                to *= 1.0 - proposed.views(settings);
            }
            let chance = if to < from { to / from } else { 1.0 };
            if matches!(mutation, Mutation::Small(_)) {
                self.small = [self.small[0] + chance, self.small[1] + 1.0];
            }
            stayed += 1.0 - chance;
            let accepted = accept < chance;
            lit |= accepted;
            if accepted {
                self.state.splat(scene, stayed * scale, splat);
                self.tapes.accept(mutation);
                (self.state, stayed) = (proposed, chance);
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
