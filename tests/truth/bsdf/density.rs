//! `sample` draws from what `pdf` reports, and says of each draw what `eval` and `pdf` say.

use super::kernel::real::{Real, Vec3};
use super::kernel::spectrum::{Rgb, Spectrum};
use super::kernel::surface::{Local, Mode, Scatter};
use super::zoo::{
    All, COLUMNS, MODES, ROWS, Random, Specimen, cells, channels, dirac_lobes, directions,
    some_directions, zoo,
};
use etendue_tests::statistics::{Family, chi_square};
use std::f64::consts::TAU;

/// Behind the cells of the sphere: Dirac reflection, Dirac transmission, nothing.
pub const BINS: usize = COLUMNS * ROWS + 3;

fn cell(w: Vec3) -> usize {
    let row = (0.5 * (w.z as f64 + 1.0) * ROWS as f64) as usize;
    let phi = (w.y as f64).atan2(w.x as f64) / TAU;
    let column = ((phi - phi.floor()) * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Where a draw fell.
pub fn bin(drawn: Option<Scatter<Rgb>>) -> usize {
    match drawn {
        Some(s) if s.dirac => COLUMNS * ROWS + usize::from(s.transmitted),
        Some(s) => cell(s.wi),
        None => BINS - 1,
    }
}

/// Where draws should fall: ∫ pdf over each cell, the Dirac lobes' probabilities, and what is left.
pub fn shares(specimen: &Specimen, w: Vec3, mode: Mode) -> Vec<f64> {
    let surface = &specimen.surface;
    let pdf = |wi| [surface.of::<All>().pdf(w, wi, mode) as f64, 0.0, 0.0];
    let mut shares: Vec<f64> = cells(specimen.glossy, w, pdf)
        .iter()
        .map(|c| c[0])
        .collect();
    if specimen.glossy {
        // The quadrature may miss a sliver of a lobe's end in a cell; how much may be in it χ² still judges.
        shares.iter_mut().for_each(|s| *s = s.max(1e-9));
    }
    shares.resize(BINS, 0.0);
    for lobe in dirac_lobes(surface, w, mode) {
        shares[COLUMNS * ROWS + usize::from(lobe.transmitted)] = lobe.pdf as f64;
    }
    let nothing = 1.0 - shares.iter().sum::<f64>();
    let rounding = if specimen.glossy { 1e-3 } else { 1e-5 };
    assert!(
        nothing > -rounding,
        "probabilities add up to {}",
        1.0 - nothing
    );
    // Lobes that `dirac_lobes` may have missed and edges of ξ: not nothing at all.
    shares[BINS - 1] = nothing.max(1e-7);
    shares[BINS - 2] = shares[BINS - 2].max(1e-7);
    shares[BINS - 3] = shares[BINS - 3].max(1e-7);
    shares
}

#[test]
fn draws_follow_their_density() {
    const DRAWS: u32 = 40_000;
    let mut family = Family::new();
    let mut random = Random::new(1);
    for specimen in zoo() {
        for w in some_directions() {
            for mode in MODES {
                let mut counts = [0; BINS];
                for _ in 0..DRAWS {
                    counts[bin(random.scatter(&specimen.surface, w, mode))] += 1;
                }
                let expected: Vec<f64> = shares(&specimen, w, mode)
                    .iter()
                    .map(|share| share * f64::from(DRAWS))
                    .collect();
                let p = chi_square(&counts, &expected);
                family.add(p, format!("{} from {w} in {mode:?}", specimen.name));
            }
        }
    }
    family.judge();
}

/// Relative difference, or zero if both are.
fn off(a: f64, b: f64) -> f64 {
    if a == b {
        0.0
    } else {
        (a - b).abs() / a.abs().max(b.abs())
    }
}

const ROUNDING: f64 = 16.0 * Real::EPSILON as f64;

#[test]
fn weights_and_densities_agree_with_the_functions() {
    let mut random = Random::new(2);
    for specimen in zoo() {
        let surface = &specimen.surface;
        for w in directions() {
            for mode in MODES {
                for _ in 0..200 {
                    let Some(s) = random.scatter(surface, w, mode) else {
                        continue;
                    };
                    let context = format!("{} from {w} in {mode:?}: {s:?}", specimen.name);
                    assert_eq!(s.transmitted, (s.wi.z < 0.0) != (w.z < 0.0), "{context}");
                    assert!((s.wi.length() as f64 - 1.0).abs() < ROUNDING, "{context}");
                    if s.dirac {
                        continue;
                    }
                    assert!(surface.of::<All>().has_smooth(), "{context}");
                    let (wo, wi) = match mode {
                        Mode::Radiance => (w, s.wi),
                        Mode::Importance => (s.wi, w),
                    };
                    let pdf = surface.of::<All>().pdf(w, s.wi, mode) as f64;
                    assert!(off(pdf, s.pdf as f64) < ROUNDING, "{context}: {pdf}");
                    let reverse = surface.of::<All>().pdf(s.wi, w, mode.reversed()) as f64;
                    assert!(
                        off(reverse, s.pdf_reverse as f64) < ROUNDING,
                        "{context}: {reverse}"
                    );
                    let f = channels(surface.of::<All>().eval(wo, wi));
                    for (f, weight) in f.into_iter().zip(channels(s.weight)) {
                        let should = f * s.wi.z.abs() as f64 / pdf;
                        assert!(off(should, weight) < ROUNDING, "{context}: {should}");
                    }
                }
            }
        }
    }
}

/// The way back from a Dirac lobe is a Dirac lobe, and each knows the other's probability.
#[test]
fn dirac_lobes_know_the_way_back() {
    let mut lobes = 0;
    for specimen in zoo() {
        for w in directions() {
            for mode in MODES {
                for there in dirac_lobes(&specimen.surface, w, mode) {
                    let context = format!("{} from {w} in {mode:?}: {there:?}", specimen.name);
                    let back = dirac_lobes(&specimen.surface, there.wi, mode.reversed())
                        .into_iter()
                        .find(|back| back.transmitted == there.transmitted)
                        .unwrap_or_else(|| panic!("{context}: no way back"));
                    // cos²_t is a difference: its ulp of 1 is 1/cos² ulps of it.
                    let cos = w.z.abs().min(there.wi.z.abs()) as f64;
                    let rounding = ROUNDING * (1.0 + 1.0 / (cos * cos));
                    if rounding > 0.05 {
                        continue; // single precision has nothing to say
                    }
                    assert!(
                        (back.wi - w).length() as f64 <= rounding,
                        "{context}: {back:?}"
                    );
                    let pairs = [(there.pdf_reverse, back.pdf), (there.pdf, back.pdf_reverse)];
                    for (a, b) in pairs {
                        assert!(off(a as f64, b as f64) < rounding, "{context}: {back:?}");
                    }
                    lobes += 1;
                }
            }
        }
    }
    assert!(lobes > 300, "{lobes} lobes: this would test nothing");
}

/// Black surfaces end walks rather than carry nothing on.
#[test]
fn black_absorbs() {
    let mut random = Random::new(3);
    for name in ["black", "sheet, black"] {
        let zoo = zoo();
        let specimen = zoo.iter().find(|s| s.name == name).expect("in the zoo");
        assert!(!specimen.surface.of::<All>().has_smooth());
        for w in directions() {
            let eval: super::kernel::Rgb = specimen.surface.of::<All>().eval(w, -w);
            assert!(eval.is_black());
            assert!(
                random
                    .scatter(&specimen.surface, w, Mode::Radiance)
                    .is_none()
            );
        }
    }
}
