//! Glass that disperses: its index, the angles of a prism, and light that is neither lost nor made between channels.

use super::kernel::blob::format::{Material, NONE, material};
use super::kernel::instance::Complete;
use super::kernel::medium::Carried;
use super::kernel::real::{Real, Vec3};
use super::kernel::spectrum::{Hero, Rgb, Spectrum};
use super::kernel::surface::{
    Dielectric, Dispersive, Local, Mode, Outlined, Scatter, Surface, TextureView,
};
use bytemuck::Zeroable;
use etendue_host::description::Index;
use serde_json::Value;

const SINGLE: bool = size_of::<Real>() == 4;

fn rows(what: &str) -> Vec<Value> {
    let all: Vec<Value> = serde_json::from_str(include_str!("../../data/prism.json")).unwrap();
    let of = |row: &Value| row["id"].as_str().unwrap().starts_with(what);
    all.into_iter().filter(of).collect()
}

fn number(row: &Value, name: &str) -> f64 {
    row[name]
        .as_f64()
        .unwrap_or_else(|| panic!("{row}: no {name}"))
}

fn index(row: &Value) -> Index {
    let triple =
        |i: usize| std::array::from_fn(|k| row["sellmeier"][i][k].as_f64().unwrap() as f32);
    if row["sellmeier"].is_null() {
        return Index::Cauchy([1.5046, 0.0042, 0.0]);
    }
    Index::Sellmeier {
        b: triple(0),
        c: triple(1),
    }
}

/// Glass, and the words of its table.
fn glass(index: &Index) -> (Material, Vec<u32>) {
    let mut words = Vec::new();
    let mut m = Material {
        kind: material::DISPERSIVE,
        ior: 1.0,
        color: [[1.0; 3]; 4],
        texture: [NONE; 4],
        ..Material::zeroed()
    };
    match index {
        Index::Cauchy(c) => (m.flags, m.eta) = (material::CAUCHY, *c),
        Index::Sellmeier { b, c } => (m.flags, m.eta, m.k) = (material::SELLMEIER, *b, *c),
        Index::Table(rows) => {
            // Behind something else.
            words = vec![0x7fc0_0000; 3];
            (m.flags, m.link) = (material::TABLE, [3, rows.len() as u32]);
            words.extend(rows.iter().flatten().map(|x| x.to_bits()));
        }
    }
    (m, words)
}

fn resolved(
    (m, texels): &(Material, Vec<u32>),
    xi: Real,
    lead: usize,
) -> (Dispersive<Hero>, [Real; 4]) {
    let (waves, _) = Hero::draw(xi);
    let view = TextureView {
        textures: &[],
        texels,
    };
    match Surface::<Hero>::resolve::<Complete<Hero>>(m, view, &waves, lead, [0.5; 2]) {
        Surface::Outlined(Outlined::Dispersive(d)) => (d, Hero::wavelengths(&waves).0),
        other => panic!("{other:?}"),
    }
}

/// The host's formulas give the table's indices, and the kernel's what the host's do at any wavelength. Coefficients are in single
/// precision.
#[test]
fn indices() {
    let mut seen = 0;
    for row in rows("index_") {
        let index = index(&row);
        let n = index.at(1e3 * number(&row, "um"));
        assert!((n - number(&row, "n")).abs() < 2e-7, "{row}: {n}");
        for i in 0..64 {
            let (d, lambda) = resolved(&glass(&index), i as Real / 64.0, i % 4);
            for (n, nm) in d.ior.0.into_iter().zip(lambda) {
                let off = (n as f64 - index.at(nm as f64)).abs();
                assert!(off < if SINGLE { 1e-6 } else { 1e-12 }, "{nm}: {n}");
            }
            assert_eq!(d.leading.ior, d.ior.channel(i % 4));
        }
        seen += 1;
    }
    assert!(seen >= 7, "{seen}");
}

/// A table's, between its rows and beyond them. The host's wavelengths are in single precision: half an ulp of 700 nm is 3e-5 nm, and no row here is
/// steeper than 2e-3 per nm.
#[test]
fn tables_of_indices() {
    let tables: [&[[f32; 2]]; 3] = [
        &[[550.0, 1.5]],
        &[[400.0, 1.6], [550.0, 1.5], [700.0, 1.45]],
        // Uneven, up and down, and beyond what is seen.
        &[
            [100.0, 2.0],
            [390.0, 1.7],
            [440.0, 1.6],
            [445.0, 1.61],
            [580.0, 1.5],
            [900.0, 1.4],
        ],
    ];
    for rows in tables {
        let index = Index::Table(rows.to_vec());
        let glass = glass(&index);
        let mut beyond = [false; 2];
        for i in 0..256 {
            let (d, lambda) = resolved(&glass, i as Real / 256.0, i % 4);
            for (n, nm) in d.ior.0.into_iter().zip(lambda) {
                let off = (n as f64 - index.at(nm as f64)).abs();
                assert!(off < 5e-7, "{nm}: {n} of {rows:?}");
                let [first, last] = [rows[0], rows[rows.len() - 1]];
                for ((end, side), out) in
                    [first, last].into_iter().zip([-1.0, 1.0]).zip(&mut beyond)
                {
                    if (nm as f64 - f64::from(end[0])) * side > 0.0 {
                        assert_eq!(n as f32, end[1], "{nm}: beyond {rows:?}");
                        *out = true;
                    }
                }
            }
        }
        let inside = rows.len() > 4;
        assert!(inside || beyond == [true; 2], "{rows:?}: {beyond:?}");
    }
}

/// f(a ← b)/η_a² is symmetric in each channel: whoever leads, a lobe carries the same share there and back, and what it says of the other
/// channels' chances are their own shares.
#[test]
fn both_ways_carry_the_same() {
    let m = glass(&Index::Cauchy([1.4, 0.02, 0.0]));
    let mut lobes = 0;
    for cos in [0.999, 0.7, 0.2, -0.2, -0.75, -0.999] {
        let w = Vec3::new((1.0 - cos * cos as Real).sqrt(), 0.0, cos);
        for (lead, xi) in (0..4).flat_map(|lead| [0.1, 0.37].map(|xi| (lead, xi))) {
            let (d, _) = resolved(&m, xi, lead);
            for mode in [Mode::Radiance, Mode::Importance] {
                let lobe = |w: Vec3, transmitted: bool| {
                    let xi = if transmitted {
                        1.0 - Real::EPSILON
                    } else {
                        0.0
                    };
                    let s = d.sample(w, mode, xi, [0.5; 2]);
                    s.filter(|s| s.transmitted == transmitted)
                };
                for transmitted in [false, true] {
                    // All of it is reflected.
                    let Some(there) = lobe(w, transmitted) else {
                        continue;
                    };
                    let what = format!("{w} {mode:?} {lead}: {there:?}");
                    let back = lobe(there.wi, transmitted).unwrap_or_else(|| panic!("{what}"));
                    // cos²_t is a difference: its ulp of 1 is 1/cos² ulps of it.
                    let least = w.z.abs().min(there.wi.z.abs());
                    let rounding = 16.0 * Real::EPSILON * (1.0 + 1.0 / (least * least));
                    let near = |a: Real, b: Real| {
                        assert!(
                            (a - b).abs() <= rounding * a.abs(),
                            "{what}: {a} and {b}, {back:?}"
                        );
                    };
                    assert!((back.wi - w).length() <= rounding, "{what}: {back:?}");
                    near(there.pdf, back.pdf);
                    near(there.pdf_reverse, back.pdf);
                    near(there.eta_scale * back.eta_scale, 1.0);
                    if mode == Mode::Importance {
                        assert_eq!(there.eta_scale, 1.0, "{what}");
                    } else if transmitted {
                        // Seen from outside it is what is inside, over the square of the index there.
                        let n = d.ior.channel(lead);
                        near(
                            there.eta_scale,
                            if cos > 0.0 { 1.0 / (n * n) } else { n * n },
                        );
                    }
                    for k in 0..4 {
                        let share = |s: &Scatter<Hero>| s.weight.channel(k) * s.pdf / s.eta_scale;
                        near(share(&there), share(&back));
                        near(there.chances.channel(k) * there.pdf, share(&there));
                        assert_eq!(share(&there) > 0.0, !transmitted || k == lead, "{what}");
                    }
                    lobes += 1;
                }
            }
        }
    }
    assert!(lobes > 150, "{lobes}");
}

/// Through two faces that enclose the apex angle, by the model itself.
#[test]
fn deviations() {
    let rows = rows("prism_");
    for row in &rows {
        let surface: Surface<Rgb> = Surface::Dielectric(Dielectric {
            ior: number(row, "n") as Real,
            schlick: false,
            reflectance: Rgb::WHITE,
            transmittance: Rgb::WHITE,
        });
        let sine = |degrees: f64| degrees.to_radians().sin_cos();
        let refract = |(s, c): (f64, f64)| {
            let w = Vec3::new(s as Real, 0.0, c as Real);
            let scattered = surface
                .of::<Complete<Rgb>>()
                .sample(w, Mode::Radiance, 1.0 - Real::EPSILON, [0.5; 2])
                .unwrap();
            assert!(scattered.transmitted, "{row}");
            (-scattered.wi.x as f64).atan2(scattered.wi.z.abs() as f64)
        };
        let (incidence, apex) = (number(row, "incidence"), number(row, "apex").to_radians());
        let within = refract(sine(incidence));
        // On the second face, from inside.
        let (s, c) = (apex - within).sin_cos();
        let out = refract((s, -c));
        let found = (incidence.to_radians() + out - apex).to_degrees();
        let truth = number(row, "deviation");
        let off = (found - truth).abs();
        // Near grazing exit an index's digits weigh most.
        assert!(off < if SINGLE { 2e-4 } else { 1e-9 }, "{row}: {found}");
    }
    assert_eq!(rows.len(), 25);
}

/// Reflected and refracted, averaged over who leads, every channel gets Fresnel's shares: one-sample MIS loses nothing. Also where
/// something before has treated the channels differently.
#[test]
fn channels_share() {
    let m = glass(&Index::Cauchy([1.4, 0.02, 0.0]));
    let before = Hero([0.4, 2.2, 0.6, 0.8]);
    for cos in [1.0, 0.7, 0.2, -0.3, -0.75, -1.0] {
        let w = Vec3::new((1.0 - cos * cos as Real).max(0.0).sqrt(), 0.0, cos);
        let mut sums = [Hero::BLACK; 2];
        for lead in 0..4 {
            let (d, _) = resolved(&m, 0.37, lead);
            for (sum, lobe) in sums.iter_mut().zip([0.0, 1.0 - Real::EPSILON]) {
                let Some(s) = d.sample(w, Mode::Importance, lobe, [0.5; 2]) else {
                    continue;
                };
                assert!(s.dirac && s.weight.channel(lead) > 0.0);
                if lobe > 0.0 && !s.transmitted {
                    // All of it is reflected.
                    continue;
                }
                let mut carried = Carried {
                    throughput: Hero::WHITE,
                    ratio: before,
                };
                carried.draw(s.weight, s.chances);
                assert!((carried.ratio.mean() - 1.0).abs() < 8.0 * Real::EPSILON);
                // A quarter of the walks are led by this channel; before, it was as much more likely as its ratio says.
                *sum += carried.throughput * (0.25 * before.channel(lead) * s.pdf);
            }
        }
        for k in 0..4 {
            let total = sums[0].channel(k) + sums[1].channel(k);
            let truth = 1.0 as Real;
            assert!(
                (total - truth).abs() < 64.0 * Real::EPSILON,
                "{cos}: {sums:?}"
            );
        }
    }
}
