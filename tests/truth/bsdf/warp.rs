//! Warps: each draws from its density, and no ξ leads out of its domain.

use super::kernel::real::{ONE_MINUS, Real, Vec3};
use super::kernel::warp::{self, Gaussian};
use super::zoo::Random;
use etendue_tests::statistics::{Family, chi_square};
use std::f64::consts::{PI, TAU};

const DRAWS: u32 = 200_000;
/// Cells per side of a square.
const SIDE: usize = 16;

/// p of draws that should be uniform over the unit square.
fn uniform(mut draw: impl FnMut() -> [f64; 2]) -> f64 {
    let mut counts = [0; SIDE * SIDE];
    for _ in 0..DRAWS {
        let [a, b] = draw().map(|x| ((x * SIDE as f64) as usize).min(SIDE - 1));
        counts[a * SIDE + b] += 1;
    }
    chi_square(
        &counts,
        &[f64::from(DRAWS) / counts.len() as f64; SIDE * SIDE],
    )
}

/// Azimuth over 2π.
fn turn(x: Real, y: Real) -> f64 {
    let turn = (y as f64).atan2(x as f64) / TAU;
    turn - turn.floor()
}

/// 1 − z of a unit vector, from x and y.
fn one_minus_z(w: Vec3) -> f64 {
    let [x, y, z] = [w.x, w.y, w.z].map(|x| x as f64);
    (x * x + y * y) / (1.0 + z)
}

#[test]
fn points_and_directions_are_uniform() {
    let mut random = Random::new(10);
    let mut family = Family::new();
    let p = uniform(|| {
        let [x, y] = warp::disc(random.two());
        [(x * x + y * y) as f64, turn(x, y)]
    });
    family.add(p, "disc");
    // Per projected solid angle.
    let p = uniform(|| {
        let w = warp::cosine_hemisphere(random.two());
        [(w.z as f64).powi(2), turn(w.x, w.y)]
    });
    family.add(p, "cosine hemisphere");
    let p = uniform(|| {
        let w = warp::sphere(random.two());
        [0.5 * (w.z as f64 + 1.0), turn(w.x, w.y)]
    });
    family.add(p, "sphere");
    for narrow in [2.0, 1.0, 0.1, 1e-6, 1e-12, 1e-30] {
        let p = uniform(|| {
            let w = warp::cone(narrow as Real, random.two());
            let height = if narrow > 0.5 {
                1.0 - w.z as f64
            } else {
                one_minus_z(w)
            };
            [height / narrow, turn(w.x, w.y)]
        });
        family.add(p, format!("cone of 1 − cos = {narrow}"));
    }
    // A triangle's (v, u/(1 − v)), with 1 − v squared to make it uniform.
    let p = uniform(|| {
        let [u, v] = warp::triangle(random.two()).map(|x| x as f64);
        [(1.0 - v).powi(2), u / (1.0 - v)]
    });
    family.add(p, "triangle");
    family.judge();
}

#[test]
fn cosine_density_is_cosine() {
    assert_eq!(warp::cosine_hemisphere_pdf(0.0), 0.0);
    assert_eq!(warp::cosine_hemisphere_pdf(-0.5), 0.0);
    let pdf = warp::cosine_hemisphere_pdf(0.5) as f64;
    assert!((pdf * 2.0 * PI - 1.0).abs() < 1e-6);
}

/// A filter under test.
struct Specimen {
    name: String,
    radius: f64,
    filter: Filter,
    /// The density before it is normalised.
    shape: Box<dyn Fn(f64) -> f64>,
}

fn filters() -> Vec<Specimen> {
    let tents = [1.0, 0.7, 3.0].map(|radius| Specimen {
        name: format!("tent of {radius}"),
        radius,
        filter: Filter::Tent(radius as Real),
        shape: Box::new(move |x| radius - x.abs()),
    });
    // Radius over σ from a parabola, as far as a blob may go, to nearly no cut.
    let gaussians = [
        (2.0, 0.5),
        (1.5, 1.5),
        (1.0, 2.0),
        (1.0, 8.0),
        (1e-3, 8.0),
        (0.5, 0.03),
        (8.0, 1.0),
        (0.7, 0.3),
    ]
    .map(|(radius, sigma)| {
        let exponent = move |x: f64| -0.5 * x * x / (sigma * sigma);
        Specimen {
            name: format!("Gaussian of {sigma} cut at {radius}"),
            radius,
            filter: Filter::Gaussian(Gaussian::new(radius as Real, sigma as Real)),
            shape: Box::new(move |x| {
                exponent(x).exp() * -(exponent(radius) - exponent(x)).exp_m1()
            }),
        }
    });
    tents.into_iter().chain(gaussians).collect()
}

enum Filter {
    Tent(Real),
    Gaussian(Gaussian),
}

impl Filter {
    fn sample(&self, xi: Real) -> Real {
        match self {
            Filter::Tent(radius) => warp::tent(*radius, xi),
            Filter::Gaussian(g) => g.sample(xi),
        }
    }

    fn pdf(&self, x: Real) -> Real {
        match self {
            Filter::Tent(radius) => warp::tent_pdf(*radius, x),
            Filter::Gaussian(g) => g.pdf(x),
        }
    }
}

/// Simpson's rule.
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const STEPS: u32 = 64;
    let h = (to - from) / f64::from(STEPS);
    let sum: f64 = (0..=STEPS)
        .map(|i| {
            let weight = match i {
                0 | STEPS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * f(from + h * f64::from(i))
        })
        .sum();
    sum * h / 3.0
}

#[test]
fn filters_draw_from_their_density() {
    const BINS: usize = 64;
    let mut random = Random::new(11);
    let mut family = Family::new();
    for Specimen {
        name,
        radius,
        filter,
        shape,
    } in filters()
    {
        let edge = |i: usize| radius * (2.0 * i as f64 / BINS as f64 - 1.0);
        let masses: Vec<f64> = (0..BINS)
            .map(|i| integral(&shape, edge(i), edge(i + 1)))
            .collect();
        let whole: f64 = masses.iter().sum();
        for i in 0..=4 * BINS {
            let x = radius * (2.0 * (i as f64) / (4 * BINS) as f64 - 1.0);
            let expected = (shape(x) / whole).max(0.0);
            let pdf = filter.pdf(x as Real) as f64;
            // Relative to the height of the filter: its foot is a difference.
            let rounding = 64.0 * Real::EPSILON as f64 * shape(0.0) / whole;
            assert!(
                (pdf - expected).abs() < rounding,
                "{name} at {x}: {pdf} for {expected}"
            );
        }
        let mut counts = [0; BINS];
        for _ in 0..4 * DRAWS {
            let x = filter.sample(random.one()) as f64;
            assert!(x.abs() <= radius as Real as f64, "{name}: {x}");
            let bin = (0.5 * (x / radius + 1.0) * BINS as f64) as usize;
            counts[bin.min(BINS - 1)] += 1;
        }
        let expected: Vec<f64> = masses
            .iter()
            .map(|m| m / whole * f64::from(4 * DRAWS))
            .collect();
        family.add(chi_square(&counts, &expected), &name);
    }
    family.judge();
}

/// Inverting the distribution: ∫ pdf from −r to x(ξ) is ξ, at the ends as well.
#[test]
fn filters_invert_their_distribution() {
    for Specimen {
        name,
        radius,
        filter,
        shape,
    } in filters()
    {
        let whole = 2.0 * integral(&shape, 0.0, radius);
        let mut before = -radius;
        for i in 0..=1000 {
            let xi = (f64::from(i) / 1000.0).min(ONE_MINUS as f64);
            let x = filter.sample(xi as Real) as f64;
            assert!(x >= before - 1e-5 * radius, "{name}: not monotonic at {xi}");
            before = x;
            let below = 0.5 + integral(&shape, 0.0, x) / whole;
            assert!(
                (below - xi as Real as f64).abs() < 1e-6,
                "{name}: {below} for {xi}"
            );
        }
    }
}

#[test]
fn no_number_leads_out() {
    let ends = [
        0.0,
        Real::MIN_POSITIVE,
        Real::EPSILON,
        0.25,
        0.5,
        0.75,
        ONE_MINUS,
    ];
    let rounding = 4.0 * Real::EPSILON;
    for xi in ends.into_iter().flat_map(|a| ends.map(|b| [a, b])) {
        let [x, y] = warp::disc(xi);
        assert!(x * x + y * y <= 1.0 + rounding, "disc {xi:?}: {x}, {y}");
        let mut directions = vec![warp::cosine_hemisphere(xi), warp::sphere(xi)];
        directions.extend([2.0, 0.5, 1e-12, 0.0].map(|h| warp::cone(h, xi)));
        for w in directions {
            assert!((w.length() - 1.0).abs() <= rounding, "{xi:?}: {w}");
        }
        assert!(warp::cosine_hemisphere(xi).z >= 0.0);
        let [u, v] = warp::triangle(xi);
        assert!(
            u >= 0.0 && v >= 0.0 && u + v < 1.0,
            "triangle {xi:?}: {u}, {v}"
        );
    }
    // As narrow as a blob may have it: too narrow for the quadrature of other tests.
    let spike = Specimen {
        name: "spike".into(),
        radius: 8.0,
        filter: Filter::Gaussian(Gaussian::new(8.0, 1e-3)),
        shape: Box::new(|_| 0.0),
    };
    for Specimen {
        name,
        radius,
        filter,
        ..
    } in filters().into_iter().chain([spike])
    {
        for xi in ends {
            let x = filter.sample(xi);
            assert!(x.abs() <= radius as Real, "{name} by {xi}: {x}");
            let pdf = filter.pdf(x);
            assert!(pdf.is_finite() && pdf >= 0.0, "{name} at {x}: {pdf}");
        }
    }
}
