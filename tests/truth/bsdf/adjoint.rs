//! Light and importance are transported by the same f: walked from either end, a measurement is the same.

use super::kernel::Rgb;
use super::kernel::real::{Real, Vec3};
use super::kernel::surface::{Local, Mode, Surface};
use super::zoo::{All, Random, channels, dirac_lobes, directions, zoo};
use etendue_tests::statistics::{Family, Moments};

/// What arrives from a direction.
fn radiance(w: Vec3) -> f64 {
    let x = 1.0 + 0.5 * w.x as f64 - 0.6 * w.z as f64;
    x * x
}

/// What the sensor makes of light that leaves into a direction.
fn importance(w: Vec3) -> f64 {
    1.0 + 0.7 * w.y as f64 + 0.25 * w.z as f64
}

/// ∬ W(wo) f(wo ← wi) L(wi) |cos wo||cos wi|, walked in `mode` from uniform directions.
fn measure(surface: &Surface<Rgb>, mode: Mode, random: &mut Random) -> [Moments; 3] {
    let mut moments = [Moments::default(); 3];
    for _ in 0..60_000 {
        let w = random.direction();
        let start = 4.0 * std::f64::consts::PI * w.z.abs() as f64;
        let carried = match random.scatter(surface, w, mode) {
            None => [0.0; 3],
            Some(s) => {
                let ends = match mode {
                    Mode::Radiance => importance(w) * radiance(s.wi),
                    Mode::Importance => radiance(w) * importance(s.wi),
                };
                channels(s.weight).map(|weight| start * weight * ends)
            }
        };
        for (m, x) in moments.iter_mut().zip(carried) {
            m.add(x);
        }
    }
    moments
}

#[test]
fn both_ends_measure_the_same() {
    let mut family = Family::new();
    let mut random = Random::new(5);
    for specimen in zoo() {
        let [a, b] = [Mode::Radiance, Mode::Importance]
            .map(|mode| measure(&specimen.surface, mode, &mut random));
        for (a, b) in a.iter().zip(b) {
            let context = format!("{}: {} and {}", specimen.name, a.mean(), b.mean());
            family.add(a.same_as(&b, 1e-6), context);
        }
    }
    family.judge();
}

/// f(a ← b)/η_a² = f(b ← a)/η_b² of what is declared reciprocal; the rest really isn't.
#[test]
fn smooth_parts_are_reciprocal_where_they_say_so() {
    let mut random = Random::new(6);
    for specimen in zoo() {
        let surface = &specimen.surface;
        let square = |w: Vec3| match specimen.reciprocal {
            Some(ior) if w.z < 0.0 => ior * ior,
            _ => 1.0,
        };
        let mut worst = 0.0f64;
        for _ in 0..500 {
            let (a, b) = (random.direction(), random.direction());
            let there = channels(surface.of::<All>().eval(a, b)).map(|f| f / square(a));
            let back = channels(surface.of::<All>().eval(b, a)).map(|f| f / square(b));
            if !specimen.glossy {
                assert_eq!(there, back, "{}: {a} and {b}", specimen.name);
            }
            for (there, back) in there.into_iter().zip(back) {
                if there.max(back) > 1e-6 {
                    worst = worst.max((there - back).abs() / there.max(back));
                }
            }
        }
        // Halfway vectors carry an ulp over α, densities its square; refraction's denominator is a difference.
        let rounding = if Real::EPSILON as f64 > 1e-10 {
            0.04
        } else {
            1e-9
        };
        assert_eq!(
            worst < rounding,
            specimen.reciprocal.is_some(),
            "{}: {worst}",
            specimen.name
        );
    }
}

/// f(a ← b)/η_a² is symmetric: walked in radiance there and back, a Dirac lobe carries the same share but for
/// η², and the two factors undo each other.
#[test]
fn refraction_is_reciprocal_but_for_its_square() {
    for specimen in zoo() {
        for w in directions() {
            for there in dirac_lobes(&specimen.surface, w, Mode::Radiance) {
                let context = format!("{} from {w}: {there:?}", specimen.name);
                let back = dirac_lobes(&specimen.surface, there.wi, Mode::Radiance)
                    .into_iter()
                    .find(|back| back.transmitted == there.transmitted)
                    .unwrap_or_else(|| panic!("{context}: no way back"));
                let loop_scale = (there.eta_scale * back.eta_scale) as f64;
                assert!((loop_scale - 1.0).abs() < 1e-6, "{context}");
                let share = |s: &super::kernel::surface::Scatter<Rgb>| {
                    channels(s.weight).map(|x| x * (s.pdf / s.eta_scale) as f64)
                };
                let cos = w.z.abs().min(there.wi.z.abs()) as f64;
                // cos²_t is a difference: its ulp of 1 is 1/cos² ulps of it.
                let rounding = 16.0 * Real::EPSILON as f64 * (1.0 + 1.0 / (cos * cos));
                if rounding > 0.05 {
                    continue; // single precision has nothing to say
                }
                for (a, b) in share(&there).into_iter().zip(share(&back)) {
                    assert!((a - b).abs() <= rounding * a, "{context}: {a} and {b}");
                }
            }
        }
    }
}
