//! Phase functions: what is drawn against what `pdf` says, closed forms, and the ends of their ranges.

use super::kernel::blob::format::{Lobe, medium};
use super::kernel::medium::Phase;
use super::kernel::random::{Pcg, Purpose, Sampler};
use super::kernel::real::{ONE_MINUS, Real, Vec3};
use super::kernel::spectrum::{Rgb, Spectrum};
use etendue_tests::oracles::oracles;
use etendue_tests::statistics::{Family, Moments, chi_square};
use std::f64::consts::{PI, TAU};

const SCATTERING: Rgb = Rgb::new(0.5, 2.0, 0.0);

fn lobes(parts: &[(u32, f32, f32)]) -> [Lobe; 4] {
    std::array::from_fn(|i| {
        let (kind, g, weight) = parts.get(i).copied().unwrap_or((0, 0.0, 0.0));
        Lobe {
            kind,
            g,
            weight,
            reserved: 0,
        }
    })
}

fn phase(lobes: &[Lobe; 4]) -> Phase<'_, Rgb> {
    Phase {
        lobes,
        scattering: SCATTERING,
    }
}

fn zoo() -> Vec<(String, [Lobe; 4])> {
    let mut zoo = vec![
        ("isotropic".into(), lobes(&[(medium::ISOTROPIC, 0.0, 1.0)])),
        ("Rayleigh".into(), lobes(&[(medium::RAYLEIGH, 0.0, 1.0)])),
        (
            "blend of all".into(),
            lobes(&[
                (medium::HENYEY_GREENSTEIN, 0.8, 0.5),
                (medium::FORWARD, 0.0, 0.125),
                (medium::RAYLEIGH, 0.0, 0.25),
                (medium::HENYEY_GREENSTEIN, -0.4, 0.125),
            ]),
        ),
        (
            "blend with nothing first and last".into(),
            lobes(&[
                (medium::FORWARD, 0.0, 0.0),
                (medium::ISOTROPIC, 0.0, 0.75),
                (medium::FORWARD, 0.0, 0.25),
                (medium::RAYLEIGH, 0.0, 0.0),
            ]),
        ),
    ];
    for g in [0.0, 1e-5, -1e-3, 0.3, -0.7, 0.95, -0.99] {
        let parts = lobes(&[(medium::HENYEY_GREENSTEIN, g, 1.0)]);
        zoo.push((format!("Henyey–Greenstein {g}"), parts));
    }
    zoo
}

/// A frame about `axis`, by its own formula.
fn frame(axis: Vec3) -> [[f64; 3]; 3] {
    let z = glam::DVec3::from_array(axis.to_array().map(|x| x as f64)).normalize();
    let x = z.any_orthonormal_vector();
    [x, z.cross(x), z].map(|v| v.to_array())
}

fn direction(axis: Vec3, c: f64, phi: f64) -> Vec3 {
    let [x, y, z] = frame(axis).map(glam::DVec3::from_array);
    let s = (1.0 - c * c).max(0.0).sqrt();
    let d = x * (s * phi.cos()) + y * (s * phi.sin()) + z * c;
    Vec3::from_array(d.to_array().map(|x| x as Real))
}

fn ws() -> Vec<Vec3> {
    [
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.6, 0.0, 0.8],
        [-0.48, 0.6, -0.64],
    ]
    .map(|w: [f64; 3]| Vec3::from_array(w.map(|x| x as Real)))
    .into()
}

const ROWS: usize = 40;
const COLUMNS: usize = 6;

/// Where row i of the bins begins: 1 − c, fine at both ends.
fn edge(i: usize) -> f64 {
    let x = i as f64 / ROWS as f64;
    if x < 0.5 {
        (2.0 * x).powi(4)
    } else {
        2.0 - (2.0 - 2.0 * x).powi(4)
    }
}

/// The share of each row: 2π∫p dc by Simpson's rule.
fn shares(p: &Phase<'_, Rgb>, w: Vec3) -> Vec<f64> {
    const PARTS: usize = 64;
    (0..ROWS)
        .map(|row| {
            let (a, b) = (edge(row), edge(row + 1));
            let sum: f64 = (0..=PARTS)
                .map(|i| {
                    let h = a + (b - a) * i as f64 / PARTS as f64;
                    let weight = match i {
                        0 | PARTS => 1.0,
                        i if i % 2 == 1 => 4.0,
                        _ => 2.0,
                    };
                    weight * p.pdf(w, direction(-w, 1.0 - h, 0.3)) as f64
                })
                .sum();
            TAU * sum * (b - a) / (3.0 * PARTS as f64)
        })
        .collect()
}

#[test]
fn draws_follow_their_density() {
    const DRAWS: u32 = 100_000;
    let mut family = Family::new();
    let mut random = Pcg::from_seed(1);
    for (name, lobes) in zoo() {
        let p = phase(&lobes);
        let straight: f64 = lobes
            .iter()
            .filter(|l| l.kind == medium::FORWARD)
            .map(|l| f64::from(l.weight))
            .sum();
        for w in ws() {
            let shares = shares(&p, w);
            let whole: f64 = shares.iter().sum::<f64>() + straight;
            assert!((whole - 1.0).abs() < 2e-5, "{name}: ∫p = {whole}");
            let [x, y, z] = frame(-w).map(glam::DVec3::from_array);
            let mut counts = vec![0; ROWS * COLUMNS + 1];
            for _ in 0..DRAWS {
                let s = p.sample(w, random.one(Purpose::Lobe), random.two(Purpose::Direction));
                if s.dirac {
                    assert_eq!(s.wi, -w);
                    *counts.last_mut().unwrap() += 1;
                    continue;
                }
                let wi = glam::DVec3::from_array(s.wi.to_array().map(|x| x as f64));
                let ahead = 0.5 * (wi - z).length_squared();
                let row = (1..ROWS).find(|&i| ahead < edge(i)).unwrap_or(ROWS) - 1;
                let phi = wi.dot(y).atan2(wi.dot(x)) / TAU;
                let column = ((phi - phi.floor()) * COLUMNS as f64) as usize;
                counts[row * COLUMNS + column.min(COLUMNS - 1)] += 1;
            }
            let each = |share: &f64| [share * f64::from(DRAWS) / COLUMNS as f64; COLUMNS];
            let mut expected: Vec<f64> = shares.iter().flat_map(each).collect();
            expected.push(straight * f64::from(DRAWS));
            family.add(chi_square(&counts, &expected), format!("{name} from {w}"));
        }
    }
    family.judge();
}

#[test]
fn draws_say_of_themselves_what_the_functions_say() {
    let mut random = Pcg::from_seed(2);
    for (name, lobes) in zoo() {
        let p = phase(&lobes);
        assert!(p.has_smooth(), "{name}");
        for w in ws() {
            for _ in 0..500 {
                let s = p.sample(w, random.one(Purpose::Lobe), random.two(Purpose::Direction));
                let context = format!("{name} from {w}: {s:?}");
                assert_eq!(s.weight, SCATTERING, "{context}");
                assert_eq!(s.pdf, s.pdf_reverse, "{context}");
                assert_eq!((s.eta_scale, s.transmitted), (1.0, false), "{context}");
                assert!(
                    (s.wi.length() as f64 - 1.0).abs() < 4.0 * Real::EPSILON as f64,
                    "{context}"
                );
                if s.dirac {
                    let share = lobes.iter().filter(|l| l.kind == medium::FORWARD);
                    assert_eq!(
                        s.pdf,
                        share.map(|l| l.weight as Real).sum::<Real>(),
                        "{context}"
                    );
                    continue;
                }
                assert_eq!(s.pdf, p.pdf(w, s.wi), "{context}");
                assert_eq!(s.pdf, p.pdf(s.wi, w), "{context}: not symmetric");
                assert_eq!(p.eval(w, s.wi), SCATTERING * s.pdf, "{context}");
            }
        }
    }
    let forward = lobes(&[(medium::FORWARD, 0.0, 1.0)]);
    let p = phase(&forward);
    assert!(!p.has_smooth() && p.eval(Vec3::Z, -Vec3::Z).is_black());
    assert_eq!(p.sample(Vec3::Z, 0.0, [0.5; 2]).pdf, 1.0);
}

/// Densities straight ahead and straight back in closed form: (1+|g|)/(4π(1−|g|)²) at the peak.
#[test]
fn peaks_keep_their_digits() {
    for g in [
        0.5f32,
        0.99,
        0.9999,
        0.999_999_9,
        -0.5,
        -0.99,
        -0.9999,
        -0.999_999_9,
    ] {
        let lobes = lobes(&[(medium::HENYEY_GREENSTEIN, g, 1.0)]);
        let p = phase(&lobes);
        let a = f64::from(g.abs());
        let (peak, back) = (
            (1.0 + a) / (4.0 * PI * (1.0 - a).powi(2)),
            (1.0 - a) / (4.0 * PI * (1.0 + a).powi(2)),
        );
        let w = Vec3::Z;
        let (ahead, behind) = (p.pdf(w, -w) as f64, p.pdf(w, w) as f64);
        let (top, low) = if g > 0.0 {
            (ahead, behind)
        } else {
            (behind, ahead)
        };
        let rounding = 8.0 * Real::EPSILON as f64;
        assert!((top / peak - 1.0).abs() < rounding, "{g}: {top} for {peak}");
        assert!((low / back - 1.0).abs() < rounding, "{g}: {low} for {back}");
    }
}

/// c at ξ, counted from −1, as the textbooks have it.
fn inverse(g: f64, xi: f64) -> f64 {
    let q = (1.0 - g * g) / (1.0 - g + 2.0 * g * xi);
    (1.0 + g * g - q * q) / (2.0 * g)
}

/// ∫cosᵐ by draws; the inverse of the distribution at given ξ.
#[test]
fn henyey_greenstein_meets_the_oracles() {
    const DRAWS: u32 = 200_000;
    let mut family = Family::new();
    let mut random = Pcg::from_seed(3);
    for oracle in oracles("P16_HG_moments", "hg_m") {
        let lobes = lobes(&[(medium::HENYEY_GREENSTEIN, oracle.parameter("g") as f32, 1.0)]);
        let p = phase(&lobes);
        let w = ws()[2];
        let power = oracle.parameter("power") as i32;
        let mut moments = Moments::default();
        for _ in 0..DRAWS {
            let s = p.sample(w, 0.0, random.two(Purpose::Direction));
            let c = -(w.dot(s.wi) as f64);
            moments.add(c.powi(power));
        }
        family.add(moments.against(oracle.value, 1e-6), &oracle.id);
    }
    family.judge();
    for oracle in oracles("P16_HG_moments", "hg_inv") {
        let g = oracle.parameter("g") as f32;
        let lobes = lobes(&[(medium::HENYEY_GREENSTEIN, g, 1.0)]);
        // Ours counts from the side away from the peak.
        let xi = oracle.parameter("xi");
        let xi = if g < 0.0 { 1.0 - xi } else { xi };
        let s = phase(&lobes).sample(Vec3::Z, 0.0, [xi as Real, 0.5]);
        let c = -s.wi.z as f64;
        // A rounded ξ or g moves c by as much as its slopes say.
        let slope = 1.0 / (TAU * phase(&lobes).pdf(Vec3::Z, s.wi) as f64);
        let exact = oracle.parameter("g");
        let by_g = (inverse(exact, oracle.parameter("xi"))
            - inverse(g.into(), oracle.parameter("xi")))
        .abs();
        let rounding = Real::EPSILON as f64 * (4.0 + slope) + 1.01 * by_g;
        assert!(
            (c - oracle.value).abs() < rounding,
            "{}: {c} for {}",
            oracle.id,
            oracle.value
        );
    }
}

/// ⟨cos²⟩ of Rayleigh is 2/5, ⟨cos⟩ is 0.
#[test]
fn rayleigh_has_its_moments() {
    let lobes = lobes(&[(medium::RAYLEIGH, 0.0, 1.0)]);
    let mut random = Pcg::from_seed(4);
    let (mut first, mut second) = (Moments::default(), Moments::default());
    for _ in 0..200_000 {
        let s = phase(&lobes).sample(Vec3::X, 0.0, random.two(Purpose::Direction));
        let c = -s.wi.x as f64;
        first.add(c);
        second.add(c * c);
    }
    let mut family = Family::new();
    family.add(first.against(0.0, 0.0), "mean");
    family.add(second.against(0.4, 0.0), "mean square");
    family.judge();
}

#[test]
fn extremes_stay_finite() {
    for kind in [
        medium::ISOTROPIC,
        medium::HENYEY_GREENSTEIN,
        medium::RAYLEIGH,
    ] {
        for g in [0.0, 1e-38, -1e-38, 1e-4, 0.999_999_9, -0.999_999_9] {
            let lobes = lobes(&[(kind, g, 0.5), (medium::FORWARD, 0.0, 0.5)]);
            for w in ws() {
                for lobe in [0.0, 0.499, 0.5, ONE_MINUS] {
                    for a in [0.0, 1e-30, 0.5, ONE_MINUS] {
                        for b in [0.0, ONE_MINUS] {
                            let s = phase(&lobes).sample(w, lobe, [a, b]);
                            let context = format!("kind {kind}, g {g}: {s:?}");
                            assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{context}");
                            assert_eq!(s.dirac, lobe >= 0.5, "{context}");
                            assert!((s.wi.length() as f64 - 1.0).abs() < 1e-6, "{context}");
                        }
                    }
                }
            }
        }
    }
}
