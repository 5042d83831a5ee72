//! One of each: the models that tests walk over, and the directions they look from.

use super::kernel::instance::GlossySurfaces;
use super::kernel::random::{Pcg, Purpose, Sampler};
use super::kernel::real::{ONE_MINUS, Real, Vec3};
use super::kernel::spectrum::{Rgb, Spectrum};
use super::kernel::surface::curve::Curve;
use super::kernel::surface::microfacet::{Masking, Microfacets};
use super::kernel::surface::{
    Conductor, Dielectric, Diffuse, Local, Mirror, Mode, Null, Outlined, Phong, Plastic,
    RoughConductor, RoughDielectric, RoughPlastic, Scatter, Sheet, Surface,
};

/// Knows all models.
pub type All = GlossySurfaces<Rgb>;

/// A local model with what tests need to know of it.
pub struct Specimen {
    pub name: &'static str,
    pub surface: Surface<Rgb>,
    /// Whether all light that comes leaves again.
    pub lossless: bool,
    /// Whether it has lobes: narrower than the quadrature of smooth things.
    pub glossy: bool,
    /// Whether its smooth part is declared reciprocal, and by which index: f/η_o² is symmetric.
    pub reciprocal: Option<f64>,
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
        glossy: false,
        reciprocal: Some(1.0),
    })
    .into_iter()
    .chain(glossy())
    .collect()
}

pub fn facets(alpha: Real, beckmann: bool, masking: Masking) -> Microfacets {
    Microfacets {
        alpha: [alpha; 2],
        beckmann,
        masking,
    }
}

/// Some loss at grazing angles: a curve needs no truth to be sampled.
fn some_loss(most: Real) -> Curve {
    Curve::through(|cos| most * (1.0 - 0.7 * cos))
}

fn glossy() -> Vec<Specimen> {
    let conductor = |facets, loss| {
        Surface::Outlined(Outlined::RoughConductor(RoughConductor {
            facets,
            eta: Rgb::new(0.143, 0.375, 1.442),
            k: Rgb::new(3.983, 2.386, 1.603),
            reflectance: WARM,
            mean: grey(0.7),
            loss,
        }))
    };
    let ground = |ior, facets, loss| {
        Surface::Outlined(Outlined::RoughDielectric(RoughDielectric {
            facets,
            ior,
            reflectance: WARM,
            transmittance: COLD,
            loss,
        }))
    };
    let phong = |colors: [Rgb; 4], exponent: Real, ior, fresnel| {
        Surface::Outlined(Outlined::Phong(Phong {
            diffuse: Diffuse {
                reflectance: colors[0],
                transmittance: colors[3],
            },
            reflectance: colors[1],
            transmittance: colors[2],
            exponent,
            normalization: (exponent + 2.0) / (2.0 * std::f64::consts::PI as Real),
            ior,
            fresnel,
        }))
    };
    let plastic = Surface::Outlined(Outlined::Plastic(Plastic {
        base: COLD * 0.8,
        reflectance: grey(0.9),
        ior: 1.5,
    }));
    let rough_plastic = |facets, ior| {
        Surface::Outlined(Outlined::RoughPlastic(RoughPlastic {
            facets,
            base: COLD * 0.8,
            reflectance: grey(0.9),
            ior,
            entering: Curve::through(|cos| 0.9 - 0.6 * (1.0 - cos) * (1.0 - cos)),
        }))
    };
    let none = Curve::ZERO;
    let (correlated, separable, cavities) =
        (Masking::Correlated, Masking::Separable, Masking::Cavities);
    let uneven = Microfacets {
        alpha: [0.15, 0.6],
        beckmann: false,
        masking: correlated,
    };
    let uneven_beckmann = Microfacets {
        beckmann: true,
        ..uneven
    };
    let all = [grey(0.25), WARM * 0.25, COLD * 0.25, grey(0.1)];
    let lobes = [BLACK, WARM, COLD, BLACK];
    let some = Some(1.0);
    let [ggx, beckmann] = [false, true];
    [
        (
            "conductor, GGX 0.05",
            conductor(facets(0.05, ggx, correlated), none),
            some,
        ),
        (
            "conductor, GGX 0.3",
            conductor(facets(0.3, ggx, separable), none),
            some,
        ),
        (
            "conductor, GGX 1",
            conductor(facets(1.0, ggx, correlated), none),
            some,
        ),
        ("conductor, GGX uneven", conductor(uneven, none), some),
        (
            "conductor, Beckmann 0.1",
            conductor(facets(0.1, beckmann, separable), none),
            some,
        ),
        (
            "conductor, Beckmann 0.6",
            conductor(facets(0.6, beckmann, correlated), none),
            some,
        ),
        (
            "conductor, Beckmann uneven",
            conductor(uneven_beckmann, none),
            some,
        ),
        (
            "conductor, cavities",
            conductor(facets(0.4, beckmann, cavities), none),
            some,
        ),
        (
            "conductor, compensated",
            conductor(facets(0.8, ggx, correlated), some_loss(0.6)),
            some,
        ),
        (
            "ground glass, GGX 0.1",
            ground(1.5, facets(0.1, ggx, separable), [none; 2]),
            Some(1.5),
        ),
        (
            "ground glass, GGX 0.7",
            ground(1.5, facets(0.7, ggx, correlated), [none; 2]),
            Some(1.5),
        ),
        (
            "ground glass, Beckmann 0.3",
            ground(1.5, facets(0.3, beckmann, correlated), [none; 2]),
            Some(1.5),
        ),
        (
            "rough bubble",
            ground(0.75, facets(0.4, ggx, separable), [none; 2]),
            Some(0.75),
        ),
        (
            "ground glass, compensated",
            ground(
                1.5,
                facets(0.8, ggx, correlated),
                [some_loss(0.3), some_loss(0.5)],
            ),
            Some(1.5),
        ),
        ("plastic", plastic, some),
        (
            "plastic, GGX 0.3",
            rough_plastic(facets(0.3, ggx, separable), 1.5),
            some,
        ),
        (
            "plastic, Beckmann 0.1",
            rough_plastic(facets(0.1, beckmann, separable), 1.5),
            some,
        ),
        (
            "Phong 0",
            phong([grey(0.1), WARM, BLACK, BLACK], 0.0, 1.0, false),
            some,
        ),
        (
            "Phong 30, composite",
            phong([COLD, grey(0.2), BLACK, BLACK], 30.0, 1.0, false),
            some,
        ),
        (
            "Phong 300",
            phong([BLACK, WARM, BLACK, BLACK], 300.0, 1.0, false),
            some,
        ),
        ("Phong sheet", phong(all, 40.0, 1.0, false), some),
        ("Phong glass", phong(lobes, 50.0, 1.5, true), None),
        ("Phong glass, dull", phong(lobes, 5.0, 1.5, true), None),
        ("Phong bubble", phong(lobes, 20.0, 0.75, true), None),
    ]
    .map(|(name, surface, reciprocal)| Specimen {
        name,
        surface,
        lossless: false,
        glossy: true,
        reciprocal,
    })
    .into()
}

/// Rows (of cos θ) and columns (of azimuth) of the cells below.
pub const ROWS: usize = 16;
pub const COLUMNS: usize = 12;

/// ∫ f dσ over each cell by the midpoint rule; where there may be lobes, by halves wherever that changes it.
/// `w` is the direction whose mirror image lobes are about: at its azimuth, parts are halved whether that changes them or not.
pub fn cells(glossy: bool, w: Vec3, f: impl Fn(Vec3) -> [f64; 3]) -> Vec<[f64; 3]> {
    let turn = (-w.y as f64).atan2(-w.x as f64) / std::f64::consts::TAU;
    let ideal = (turn - turn.floor()) * COLUMNS as f64;
    (0..ROWS * COLUMNS)
        .map(|cell| {
            let (row, column) = (cell / COLUMNS, cell % COLUMNS);
            let part = Part {
                ideal: ideal - column as f64,
                row,
                column,
                low: [0.0; 2],
                side: 1.0,
                graded: glossy,
            };
            if !glossy {
                return part.rule(&f);
            }
            let parts = part.quarters().into_iter().flat_map(|p| p.quarters());
            parts.fold([0.0; 3], |sum, p| add(sum, p.adapted(&f, p.rule(&f), 8)))
        })
        .collect()
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// A square part of a cell, in units of it.
#[derive(Clone, Copy)]
struct Part {
    row: usize,
    column: usize,
    low: [f64; 2],
    side: f64,
    /// The column of the mirror image.
    ideal: f64,
    /// Whether its steps are smaller towards the horizon.
    graded: bool,
}

impl Part {
    fn quarters(self) -> [Self; 4] {
        std::array::from_fn(|i| Self {
            low: [0, 1].map(|axis| self.low[axis] + 0.5 * self.side * (i >> axis & 1) as f64),
            side: 0.5 * self.side,
            ..self
        })
    }

    /// Four by four midpoints.
    fn rule(self, f: &impl Fn(Vec3) -> [f64; 3]) -> [f64; 3] {
        const FINE: usize = 4;
        let mut sum = [0.0; 3];
        for (i, j) in (0..FINE).flat_map(|i| (0..FINE).map(move |j| (i, j))) {
            let at =
                |axis: usize, i: usize| self.low[axis] + self.side * (i as f64 + 0.5) / FINE as f64;
            // Light that grazes is refracted into slivers at the horizon, where steps are smaller.
            let t = at(0, i);
            let (row, weight) = match self.row {
                row if self.graded && row == ROWS / 2 => (t * t, 2.0 * t),
                row if self.graded && row + 1 == ROWS / 2 => {
                    (1.0 - (1.0 - t) * (1.0 - t), 2.0 - 2.0 * t)
                }
                _ => (t, 1.0),
            };
            let cos = 2.0 * (self.row as f64 + row) / ROWS as f64 - 1.0;
            let phi = std::f64::consts::TAU * (self.column as f64 + at(1, j)) / COLUMNS as f64;
            sum = add(sum, f(direction(cos, phi)).map(|f| weight * f));
        }
        let cells = (ROWS * COLUMNS * FINE * FINE) as f64;
        sum.map(|s| s * 2.0 * std::f64::consts::TAU * self.side * self.side / cells)
    }

    fn adapted(self, f: &impl Fn(Vec3) -> [f64; 3], whole: [f64; 3], depth: u32) -> [f64; 3] {
        let quarters = self.quarters().map(|q| (q, q.rule(f)));
        let sum = quarters.iter().fold([0.0; 3], |sum, q| add(sum, q.1));
        let [_, first] = self.low;
        let forced = depth > 2 && (first..=first + self.side).contains(&self.ideal);
        let stays = !forced && (0..3).all(|i| (sum[i] - whole[i]).abs() < 1e-7);
        if stays || depth == 0 {
            return sum;
        }
        let parts = quarters.iter();
        parts.fold([0.0; 3], |sum, (q, r)| {
            add(sum, q.adapted(f, *r, depth - 1))
        })
    }
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

/// For what takes long: of each cosine one side in single and the other in double precision, or both if tests are to be deep.
pub fn some_directions() -> impl Iterator<Item = Vec3> {
    let all = directions().into_iter().enumerate();
    all.filter(|(i, _)| taken(i / 2 + i)).map(|(_, w)| w)
}

/// Whether case `i` of many is for this precision: every other one, or all if tests are to be deep.
pub fn taken(i: usize) -> bool {
    let precision = size_of::<Real>() / 4;
    etendue_tests::takes(i + precision, 2)
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
        let Some(s) = surface.of::<All>().sample(w, mode, lobe, [0.25, 0.5]) else {
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
        surface.of::<All>().sample(w, mode, lobe, self.two())
    }
}
