//! One of each: the models that tests walk over, and the directions they look from.

use super::kernel::random::{Pcg, Purpose, Sampler};
use super::kernel::real::{ONE_MINUS, Real, Vec3};
use super::kernel::spectrum::{Rgb, Spectrum};
use super::kernel::surface::{
    Conductor, Dielectric, Diffuse, Local, Mirror, Mode, Null, Scatter, Sheet, Surface,
};

/// A local model with what tests need to know of it.
pub struct Specimen {
    pub name: &'static str,
    pub surface: Surface<Rgb>,
    /// Whether all light that comes leaves again.
    pub lossless: bool,
}

pub const MODES: [Mode; 2] = [Mode::Radiance, Mode::Importance];

const BLACK: Rgb = Rgb::BLACK;
const WHITE: Rgb = Rgb::WHITE;
const WARM: Rgb = Rgb::new(0.8, 0.5, 0.1);
const COLD: Rgb = Rgb::new(0.1, 0.4, 0.7);

fn grey(x: Real) -> Rgb {
    Rgb::grey(x)
}

fn diffuse(reflectance: Rgb, transmittance: Rgb) -> Surface<Rgb> {
    Surface::Diffuse(Diffuse {
        reflectance,
        transmittance,
    })
}

fn glass(ior: Real, schlick: bool, reflectance: Rgb, transmittance: Rgb) -> Surface<Rgb> {
    Surface::Dielectric(Dielectric {
        ior,
        schlick,
        reflectance,
        transmittance,
    })
}

fn sheet(colors: [Rgb; 4]) -> Surface<Rgb> {
    Surface::Sheet(Sheet {
        specular_reflectance: colors[0],
        specular_transmittance: colors[1],
        diffuse: Diffuse {
            reflectance: colors[2],
            transmittance: colors[3],
        },
    })
}

pub fn zoo() -> Vec<Specimen> {
    let gold = Surface::Conductor(Conductor {
        eta: Rgb::new(0.143, 0.375, 1.442),
        k: Rgb::new(3.983, 2.386, 1.603),
        reflectance: WARM,
    });
    let tenths = |a: Real, b: Real, c: Real, d: Real| [grey(a), grey(b), grey(c), grey(d)];
    [
        ("black", Surface::BLACK, false),
        ("diffuse, white", diffuse(WHITE, BLACK), true),
        ("diffuse, coloured", diffuse(WARM, BLACK), false),
        ("diffuse, transmitting", diffuse(BLACK, COLD), false),
        (
            "diffuse, both",
            diffuse(WARM, Rgb::new(0.1, 0.2, 0.8)),
            false,
        ),
        (
            "diffuse, both, white",
            diffuse(grey(0.75), grey(0.25)),
            true,
        ),
        (
            "mirror, white",
            Surface::Mirror(Mirror { reflectance: WHITE }),
            true,
        ),
        (
            "mirror, coloured",
            Surface::Mirror(Mirror { reflectance: WARM }),
            false,
        ),
        ("gold, tinted", gold, false),
        ("glass", glass(1.5, false, WHITE, WHITE), true),
        ("diamond", glass(2.4, false, WHITE, WHITE), true),
        ("warm air", glass(1.0001, false, WHITE, WHITE), true),
        ("bubble", glass(0.75, false, WHITE, WHITE), true),
        ("no boundary", glass(1.0, false, WHITE, WHITE), true),
        ("glass, Schlick", glass(1.5, true, WHITE, WHITE), true),
        ("bubble, Schlick", glass(0.75, true, WHITE, WHITE), true),
        ("glass, coloured", glass(1.5, false, WARM, COLD), false),
        ("null", Surface::Null(Null), true),
        ("sheet", sheet(tenths(0.125, 0.25, 0.5, 0.125)), true),
        (
            "sheet, coloured",
            sheet([COLD * 0.5, WARM * 0.25, COLD * 0.25, WARM * 0.5]),
            false,
        ),
        ("sheet, specular", sheet(tenths(0.25, 0.75, 0.0, 0.0)), true),
        ("sheet, diffuse", sheet(tenths(0.0, 0.0, 0.5, 0.5)), true),
        ("sheet, black", sheet(tenths(0.0, 0.0, 0.0, 0.0)), false),
    ]
    .map(|(name, surface, lossless)| Specimen {
        name,
        surface,
        lossless,
    })
    .into()
}

/// From straight above to grazing, on both sides.
pub fn directions() -> Vec<Vec3> {
    [1.0, 0.9, 0.5, 0.1, 0.001]
        .into_iter()
        .flat_map(|cos| [cos, -cos])
        .enumerate()
        .map(|(i, cos)| direction(cos, 0.7 * i as f64))
        .collect()
}

/// By cosine and azimuth.
pub fn direction(cos: f64, phi: f64) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(
        (sin * phi.cos()) as Real,
        (sin * phi.sin()) as Real,
        cos as Real,
    )
}

pub fn channels(s: Rgb) -> [f64; 3] {
    s.to_array().map(|x| x as f64)
}

/// The Dirac lobes by which a walk may leave. Lobes are found by trying, so one that ξ can hardly hit may be missing.
pub fn dirac_lobes(surface: &Surface<Rgb>, w: Vec3, mode: Mode) -> Vec<Scatter<Rgb>> {
    const TRIES: u32 = 4096;
    let mut found: Vec<Scatter<Rgb>> = Vec::new();
    for i in 0..=TRIES {
        let lobe = (i as Real / TRIES as Real).min(ONE_MINUS);
        let Some(s) = surface.sample(w, mode, lobe, [0.25, 0.5]) else {
            continue;
        };
        if s.dirac && found.iter().all(|f| f.transmitted != s.transmitted) {
            found.push(s);
        }
    }
    found
}

/// Independent numbers.
pub struct Random(Pcg);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(Pcg::from_seed(seed))
    }

    pub fn one(&mut self) -> Real {
        self.0.one(Purpose::Lobe)
    }

    pub fn two(&mut self) -> [Real; 2] {
        self.0.two(Purpose::Direction)
    }

    /// Uniform over the sphere, by its own formula.
    pub fn direction(&mut self) -> Vec3 {
        let [a, b] = self.two();
        direction(2.0 * a as f64 - 1.0, std::f64::consts::TAU * b as f64)
    }

    /// A step by `surface`.
    pub fn scatter(&mut self, surface: &Surface<Rgb>, w: Vec3, mode: Mode) -> Option<Scatter<Rgb>> {
        let lobe = self.one();
        surface.sample(w, mode, lobe, self.two())
    }
}
