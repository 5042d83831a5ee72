//! Dirac lobes go where geometrical optics says, with the share that Fresnel's equations give.

use super::kernel::Rgb;
use super::kernel::real::{Real, Vec3};
use super::kernel::surface::{Local, Mode, Outlined, Scatter, Surface};
use super::zoo::{All, MODES, channels, dirac_lobes, directions, zoo};
use etendue_tests::fresnel;
use glam::DVec3;

fn double(v: Vec3) -> DVec3 {
    DVec3::new(v.x as f64, v.y as f64, v.z as f64)
}

/// What a lobe should be: its direction, and weight·probability by channel.
type Lobe = (DVec3, [f64; 3]);

/// Reflection and transmission; zero where there is none.
fn truth(surface: &Surface<Rgb>, w: DVec3, mode: Mode) -> [Lobe; 2] {
    let mirrored = DVec3::new(-w.x, -w.y, w.z);
    let none = [0.0; 3];
    match surface {
        Surface::Diffuse(_) => [(mirrored, none), (-w, none)],
        Surface::Outlined(Outlined::Dispersive(_)) => unreachable!("in the tests of spectra"),
        Surface::Mirror(m) => [(mirrored, channels(m.reflectance)), (-w, none)],
        Surface::Conductor(c) => {
            let (eta, k, scale) = (channels(c.eta), channels(c.k), channels(c.reflectance));
            let r = std::array::from_fn(|i| scale[i] * fresnel::conductor(eta[i], k[i], w.z.abs()));
            [(mirrored, r), (-w, none)]
        }
        Surface::Null(_) => [(mirrored, none), (-w, [1.0; 3])],
        Surface::Sheet(s) => [
            (mirrored, channels(s.specular_reflectance)),
            (-w, channels(s.specular_transmittance)),
        ],
        Surface::Outlined(Outlined::Plastic(p)) => {
            let (r, _) = fresnel::dielectric(1.0, p.ior as f64, w.z.abs());
            [
                (mirrored, channels(p.reflectance).map(|k| k * r)),
                (-w, none),
            ]
        }
        Surface::Outlined(Outlined::Phong(_))
        | Surface::Outlined(Outlined::RoughConductor(_))
        | Surface::Outlined(Outlined::RoughDielectric(_))
        | Surface::Outlined(Outlined::RoughPlastic(_)) => [(mirrored, none), (-w, none)],
        Surface::Dielectric(d) => {
            let ior = d.ior as f64;
            let (n1, n2) = if w.z > 0.0 { (1.0, ior) } else { (ior, 1.0) };
            let (exact, cos_t) = fresnel::dielectric(n1, n2, w.z.abs());
            let r = if d.schlick {
                fresnel::schlick(n1, n2, w.z.abs())
            } else {
                exact
            };
            let refracted = DVec3::new(-w.x * n1 / n2, -w.y * n1 / n2, -cos_t * w.z.signum());
            // (η_o/η_i)², in radiance alone: there w is wo.
            let scale = match mode {
                Mode::Radiance => (n1 / n2) * (n1 / n2),
                Mode::Importance => 1.0,
            };
            [
                (mirrored, channels(d.reflectance).map(|k| k * r)),
                (
                    refracted,
                    channels(d.transmittance).map(|k| k * (1.0 - r) * scale),
                ),
            ]
        }
    }
}

#[test]
fn lobes_are_where_optics_puts_them() {
    for specimen in zoo() {
        for w in directions() {
            for mode in MODES {
                let lobes = dirac_lobes(&specimen.surface, w, mode);
                let unit = double(w).normalize();
                let truth = truth(&specimen.surface, unit, mode);
                for (transmitted, (direction, share)) in [false, true].into_iter().zip(truth) {
                    let context = format!(
                        "{} from {w} in {mode:?}, transmitted: {transmitted}",
                        specimen.name
                    );
                    let Some(s) = lobes.iter().find(|s| s.transmitted == transmitted) else {
                        // ξ may have passed a small lobe by.
                        assert!(share.iter().all(|&x| x < 1e-3), "{context}: {share:?}");
                        continue;
                    };
                    // Grazing cosines carry an error of an ulp of 1.
                    let rounding = 16.0 * Real::EPSILON as f64 / w.z.abs().min(s.wi.z.abs()) as f64;
                    assert!(
                        (double(s.wi) - direction).length() < rounding,
                        "{context}: {} for {direction}",
                        s.wi
                    );
                    for (weight, share) in channels(s.weight).into_iter().zip(share) {
                        let got = weight * s.pdf as f64;
                        // Single precision's absolute error, and the textbook's.
                        let floor = (1e-3 * rounding).max(1e-15);
                        assert!(
                            (got - share).abs() < rounding * share + floor,
                            "{context}: {got} for {share}"
                        );
                    }
                    let eta_scale = match (&specimen.surface, mode) {
                        (Surface::Dielectric(d), Mode::Radiance) if transmitted => {
                            let back = (d.ior as f64).powi(if w.z > 0.0 { -1 } else { 1 });
                            back * back
                        }
                        _ => 1.0,
                    };
                    assert!(
                        (s.eta_scale as f64 / eta_scale - 1.0).abs() < 1e-6,
                        "{context}"
                    );
                }
            }
        }
    }
}

/// The lobes that a model lists are those that it draws, each with its whole weight; so what follows all of them misses nothing.
#[test]
fn the_lobes_that_are_listed_are_those_that_are_drawn() {
    for specimen in zoo() {
        for w in directions() {
            for mode in MODES {
                let drawn = dirac_lobes(&specimen.surface, w, mode);
                let listed: Vec<_> = (0..16)
                    .map_while(|i| specimen.surface.of::<All>().dirac_lobe(w, mode, i))
                    .collect();
                for s in &drawn {
                    let same = listed.iter().find(|l| l.transmitted == s.transmitted);
                    let l = same.unwrap_or_else(|| panic!("{} from {w}: {s:?}", specimen.name));
                    assert!(l.dirac && l.pdf == 1.0 && l.eta_scale == s.eta_scale);
                    assert_eq!(l.wi, s.wi, "{} from {w}", specimen.name);
                    for (listed, drawn) in channels(l.weight).into_iter().zip(channels(s.weight)) {
                        let whole = drawn * s.pdf as f64;
                        let allowed = 4.0 * Real::EPSILON as f64 * whole;
                        assert!((listed - whole).abs() <= allowed, "{}", specimen.name);
                    }
                }
                // And none that isn't: what isn't drawn has hardly any weight.
                let extra =
                    |l: &&Scatter<Rgb>| drawn.iter().all(|s| s.transmitted != l.transmitted);
                for l in listed.iter().filter(extra) {
                    assert!(channels(l.weight).iter().all(|&x| x < 1e-3), "{l:?}");
                }
            }
        }
    }
}
