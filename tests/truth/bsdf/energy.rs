//! No energy is made: what leaves is at most what came, from whatever direction it came (`transport.md` §1).
//!
//! Incident light is the walk from the light: Σ over where it leaves is the albedo. Seen from the sensor,
//! refraction gathers (η_o/η_i)², and only the throughput without that factor is bounded.

use super::kernel::real::{Real, Vec3};
use super::kernel::surface::{Local, Mode};
use super::zoo::{
    All, MODES, Random, Specimen, cells, channels, dirac_lobes, some_directions, zoo,
};
use etendue_tests::statistics::{Family, Moments};

/// ∫ f(wo ← wi)|cos wo| dσ(wo) of the smooth part, by the midpoint rule, plus the Dirac lobes.
pub fn albedo(specimen: &Specimen, wi: Vec3) -> [f64; 3] {
    let surface = &specimen.surface;
    let mut sum = [0.0; 3];
    let f = |wo: Vec3| channels(surface.of::<All>().eval(wo, wi)).map(|f| f * wo.z.abs() as f64);
    for cell in cells(specimen.glossy, wi, f) {
        for (sum, f) in sum.iter_mut().zip(cell) {
            *sum += f;
        }
    }
    for lobe in dirac_lobes(surface, wi, Mode::Importance) {
        for (sum, weight) in sum.iter_mut().zip(channels(lobe.weight)) {
            *sum += weight * lobe.pdf as f64;
        }
    }
    sum
}

#[test]
fn albedo_is_at_most_one() {
    for specimen in zoo() {
        for wi in some_directions() {
            for albedo in albedo(&specimen, wi) {
                let context = format!("{} from {wi}: {albedo}", specimen.name);
                let rounding = if specimen.glossy {
                    1e-4
                } else {
                    4.0 * Real::EPSILON as f64
                };
                assert!(albedo <= 1.0 + rounding, "{context}");
                if specimen.lossless {
                    // A lobe that ξ can hardly hit is missing from the sum, see `dirac_lobes`.
                    assert!(albedo > 1.0 - 3e-4, "{context}");
                } else {
                    assert!(albedo < 0.99, "{context}");
                }
            }
        }
    }
}

/// The furnace: walks carry the albedo on average, in both modes once η² is divided out; from the sensor only where f is
/// reciprocal.
#[test]
fn walks_carry_the_albedo() {
    const WALKS: u32 = 20_000;
    let mut family = Family::new();
    let mut random = Random::new(4);
    for specimen in zoo() {
        for w in some_directions() {
            let truth = albedo(&specimen, w);
            for mode in MODES {
                if specimen.reciprocal.is_none() && mode == Mode::Radiance {
                    continue;
                }
                let mut moments = [Moments::default(); 3];
                for _ in 0..WALKS {
                    let s = random.scatter(&specimen.surface, w, mode);
                    let weight = s.map_or([0.0; 3], |s| {
                        channels(s.weight).map(|x| x / s.eta_scale as f64)
                    });
                    for (m, x) in moments.iter_mut().zip(weight) {
                        m.add(x);
                    }
                }
                for (m, truth) in moments.iter().zip(truth) {
                    let context = format!("{} from {w} in {mode:?}", specimen.name);
                    // What `dirac_lobes` misses is less than one of its steps.
                    family.add(m.against(truth, 3e-4), context);
                }
            }
        }
    }
    family.judge();
}
