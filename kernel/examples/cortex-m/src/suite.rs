//! The suite of renders that has the same bits everywhere (`tests/data/bits.txt`), on a Cortex-M4F: blobs in flash, no
//! allocator, everything else in 64 KB of RAM. Ends by printing how much of it the stack used.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use cortex_m as _;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use etendue::estimate::{Rule, Tree};
use etendue::film::{Refused, Step, Sum};
use etendue::random::Sequence;
use etendue::real::Vec3;
use etendue::{Estimator, Heuristic, Scene, Scratch, Settings};

/// A file in flash, aligned as a blob has to be.
#[repr(C, align(16))]
struct Aligned<T: ?Sized>(T);

macro_rules! include_blob {
    ($file:literal) => {{
        static BLOB: &Aligned<[u8]> = &Aligned(*include_bytes!(concat!(
            "../../../../tests/data/bits/",
            $file
        )));
        &BLOB.0
    }};
}

const SUITE: [(&str, Estimator, Heuristic, Sequence); 12] = {
    use {Estimator as E, Heuristic as H, Sequence::*};
    [
        ("path balance", E::Path, H::Balance, Independent),
        ("path maximum", E::Path, H::Maximum, Independent),
        ("path sobol", E::Path, H::Power, Sobol),
        ("light power", E::Light, H::Power, Independent),
        ("bidirectional balance", E::Bidirectional, H::Balance, Independent),
        ("bidirectional power", E::Bidirectional, H::Power, Independent),
        ("bidirectional cutoff", E::Bidirectional, H::Cutoff, Independent),
        ("bidirectional maximum", E::Bidirectional, H::Maximum, Independent),
        ("bidirectional sobol", E::Bidirectional, H::Power, Sobol),
        ("distributed power", E::Distributed, H::Power, Independent),
        ("quadrature power", E::Quadrature, H::Power, Independent),
        ("quadrature+path power", E::QuadratureAndPath, H::Power, Independent),
    ]
};

/// Ray trees and rules that there is time for.
const TREE: Tree = Tree {
    branching: [2, 2, 1, 0, 0, 0, 0, 0],
    lights: 2,
};
const RULE: Rule = Rule {
    order: 2,
    steps: 4,
    depth: 8,
    shift: false,
};

const PIXELS: usize = 16 * 12;
const PASSES: u64 = 2;

/// What is not on the stack.
struct Memory {
    scratch: Scratch<8>,
    samples: [Sum; PIXELS],
    splats: [Sum; PIXELS],
}

struct Static(UnsafeCell<Memory>);

// SAFETY: there is one thread, and only `main` takes the memory, once.
unsafe impl Sync for Static {}

static MEMORY: Static = Static(UnsafeCell::new(Memory {
    scratch: Scratch::new(),
    samples: [[0; 3]; PIXELS],
    splats: [[0; 3]; PIXELS],
}));

/// FNV-1a over the bits of numbers, lowest byte first.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, x: f32) {
        for b in x.to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(b)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

/// Renders the whole image.
fn image(scene: &Scene<'_>, settings: &Settings, memory: &mut Memory) -> u64 {
    let [w, h] = scene.size();
    let step = Step::new(scene.film_exponent());
    memory.samples.fill([0; 3]);
    memory.splats.fill([0; 3]);
    let Memory {
        scratch,
        samples,
        splats,
    } = memory;
    for (i, own) in samples.iter_mut().enumerate() {
        let pixel = [i as u32 % w, i as u32 / w];
        for index in 0..PASSES {
            let value = scene.estimate(settings, pixel, index, scratch, &mut |[x, y], v| {
                if let Some(sum) = splats.get_mut((y * w + x) as usize) {
                    step.add(sum, v, &mut Refused::default());
                }
            });
            step.add(own, value, &mut Refused::default());
        }
    }
    let mut hash = Hash::new();
    for (own, others) in samples.iter().zip(splats.iter()).take((w * h) as usize) {
        let value = step.resolve(own, others, PASSES, PASSES, 1);
        value.iter().for_each(|c| hash.add(*c as f32));
    }
    hash.0
}

/// Irradiance at the middle of the scene, and radiance along a ray from there.
fn probes(scene: &Scene<'_>, settings: &Settings, scratch: &mut Scratch<8>) -> u64 {
    let center = Vec3::from(scene.world().center);
    let mut hash = Hash::new();
    for index in 0..8 {
        let e = scene.irradiance(settings, center, Vec3::Z, 1, index, scratch);
        let l = scene.radiance(settings, center, -Vec3::Z, 2, index, scratch);
        let values = e.to_array().into_iter().chain(l.to_array());
        values.for_each(|x| hash.add(x));
    }
    hash.0
}

fn run(name: &str, blob: &[u8], memory: &mut Memory) -> bool {
    let Ok(scene) = Scene::open(blob) else {
        return false;
    };
    for (what, estimator, heuristic, sequence) in SUITE {
        // Lights that quadrature makes nothing of.
        if estimator.refuses(&scene).is_some() {
            continue;
        }
        let settings = Settings {
            estimator,
            heuristic,
            sequence,
            seed: 3,
            tree: TREE,
            rule: RULE,
            ..Settings::default()
        };
        let pixels = image(&scene, &settings, memory);
        let probes = probes(&scene, &settings, &mut memory.scratch);
        hprintln!("{} {} {:016x} {:016x}", name, what, pixels, probes);
    }
    true
}

unsafe extern "C" {
    /// The lowest word of the stack, and the one after the highest; cortex-m-rt paints all between before the start.
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Bytes of stack that have been written.
fn stack_used() -> usize {
    let (mut at, end) = (&raw const _stack_end, &raw const _stack_start);
    // SAFETY: between the two there is the stack, and reading it changes nothing.
    while at < end && unsafe { at.read_volatile() } == cortex_m_rt::STACK_PAINT_VALUE {
        at = at.wrapping_add(1);
    }
    end as usize - at as usize
}

#[entry]
fn main() -> ! {
    // SAFETY: `main` runs once.
    let memory = unsafe { &mut *MEMORY.0.get() };
    let fine = run("matter", include_blob!("matter.etd"), memory)
        && run("gloss", include_blob!("gloss.etd"), memory)
        && run("fog", include_blob!("fog.etd"), memory)
        && run("prism", include_blob!("prism.etd"), memory)
        && run("round", include_blob!("round.etd"), memory)
        && run("open_air", include_blob!("open_air.etd"), memory)
        && run("plan", include_blob!("plan.etd"), memory);
    hprintln!(
        "RAM: {} scratch, {} film, {} stack",
        size_of::<Scratch<8>>(),
        2 * size_of::<[Sum; PIXELS]>(),
        stack_used()
    );
    debug::exit(if fine { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {}
}

/// Only this program's own indexing could panic.
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
