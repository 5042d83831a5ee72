//! The ends of ξ and degenerate directions: finite, and never negative.

use super::kernel::Rgb;
use super::kernel::real::{ONE_MINUS, Real, Vec3};
use super::kernel::surface::{Local, Scatter};
use super::zoo::{All, MODES, channels, direction, zoo};

const XI: [Real; 4] = [0.0, 1e-7, 0.5, ONE_MINUS];

/// In the tangent plane, a little off it, and along the normal.
fn directions() -> Vec<Vec3> {
    let off = [0.0, -0.0, 1e-30, -1e-30, 1e-7, -1e-7];
    let mut all: Vec<Vec3> = off
        .into_iter()
        .flat_map(|z| [Vec3::new(1.0, 0.0, z), Vec3::new(0.6, -0.8, z)])
        .collect();
    all.extend([Vec3::Z, -Vec3::Z, direction(0.3, 1.0), direction(-0.3, 2.0)]);
    // One ulp longer than a unit vector, as rounding leaves them.
    all.push(Vec3::Z * (1.0 + Real::EPSILON));
    all
}

fn is_sane(x: f64) -> bool {
    x.is_finite() && x >= 0.0
}

#[test]
fn everything_is_finite() {
    let mut drawn = 0;
    for specimen in zoo() {
        let surface = &specimen.surface;
        for w in directions() {
            for mode in MODES {
                for other in directions() {
                    let f: Rgb = surface.of::<All>().eval(w, other);
                    let pdf = surface.of::<All>().pdf(w, other, mode) as f64;
                    assert!(
                        is_sane(pdf) && channels(f).into_iter().all(is_sane),
                        "{}: {w}, {other}: {pdf}, {f:?}",
                        specimen.name
                    );
                }
                for lobe in XI {
                    for xi in XI.into_iter().flat_map(|a| XI.map(|b| [a, b])) {
                        let Some(s) = surface.of::<All>().sample(w, mode, lobe, xi) else {
                            continue;
                        };
                        let Scatter {
                            wi,
                            weight,
                            pdf,
                            pdf_reverse,
                            eta_scale,
                            ..
                        } = s;
                        let sane = wi.is_finite()
                            && (wi.length() as f64 - 1.0).abs() < 1e-6
                            && channels(weight).into_iter().all(is_sane)
                            && is_sane(pdf as f64)
                            && pdf > 0.0
                            && is_sane(pdf_reverse as f64)
                            && eta_scale > 0.0;
                        assert!(sane, "{} from {w} by {lobe}, {xi:?}: {s:?}", specimen.name);
                        drawn += 1;
                    }
                }
            }
        }
    }
    assert!(drawn > 10_000, "{drawn} draws: this would test nothing");
}

/// In the tangent plane `eval`, `pdf` and `sample` agree on which side a direction is.
#[test]
fn the_tangent_plane_has_one_side() {
    for specimen in zoo() {
        let surface = &specimen.surface;
        for z in [0.0, -0.0] {
            let w = Vec3::new(1.0, 0.0, z);
            for mode in MODES {
                for lobe in XI {
                    let Some(s) = surface.of::<All>().sample(w, mode, lobe, [0.25, 0.3]) else {
                        continue;
                    };
                    if !s.dirac {
                        let pdf = surface.of::<All>().pdf(w, s.wi, mode);
                        assert_eq!(pdf, s.pdf, "{} from {w}: {s:?}", specimen.name);
                    }
                }
            }
        }
    }
}
