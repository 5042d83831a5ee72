//! Wavelengths: what disperses and what gives spectra by every estimator, and grey scenes, which are the same in both.

use super::{Z, agree, estimates};
use etendue::real::Real;
use etendue::spectrum::{interpolate, seen};
use etendue::{Estimator, Heuristic};
use etendue_host::description::{
    Carry, ColorSource, Description, Distribution, EmitterKind, Facets, Index, Masking, Medium,
    Model, Pattern, Phase, Projection, Texture,
};
use etendue_tests::matrix::Complete::{FromLight, FromSensor};
use etendue_tests::matrix::Named;
use etendue_tests::scenes::{Builder, room};

const WHITE: ColorSource = ColorSource::Constant([1.0; 3]);

fn flint(b: &mut Builder) -> usize {
    b.material(Model::Dispersive {
        index: Index::Sellmeier {
            b: [1.737_597, 0.313_747_35, 1.898_781],
            c: [0.013_188_707, 0.062_306_814, 155.236_3],
        },
        outside: 1.0,
        reflectance: WHITE,
        transmittance: WHITE,
        schlick: false,
    })
}

/// A ball of flint glass before coloured walls; with `fog`, coloured fog in it and around it.
fn glass_ball(fog: bool, carry: Carry) -> Description {
    let mut d = room(|b| {
        let (glass, grey) = (flint(b), Some(b.diffuse([0.7; 3])));
        b.cuboid([-0.7, 0.2, 0.0], [-0.2, 0.7, 0.8], false, grey);
        // A large lamp: a path tracer has to find it through glass.
        b.sphere([0.5, -0.2, 1.4], 0.3, None).emission = Some([4.0, 3.0, 2.0]);
        if fog {
            let around = b.medium([0.3, 0.2, 0.6], [0.9, 0.8, 0.5], Phase::Isotropic);
            b.fog([-1.1, -1.2, -0.1], [1.1, 1.1, 2.1], around);
            let within = b.medium(
                [0.2, 1.0, 3.0],
                [0.95; 3],
                Phase::HenyeyGreenstein { g: 0.5 },
            );
            b.ball([0.2, -0.1, 0.45], 0.35, glass, within).exterior = Some(around);
        } else {
            b.sphere([0.2, -0.1, 0.45], 0.35, Some(glass));
        }
    })
    .description;
    d.carry = carry;
    d
}

/// [`glass_ball`] for other estimators.
pub fn dispersing() -> Named {
    let d = glass_ball(false, Carry::AsNeeded);
    ("a dispersing ball", d, FromSensor)
}

/// A medium that is spectra in all of its parts.
fn burning() -> Medium {
    let spectra = [
        vec![[400.0, 4.0], [520.0, 0.5], [560.0, 3.0], [700.0, 1.0]],
        vec![[450.0, 0.2], [650.0, 0.8]],
        vec![[420.0, 0.1], [590.0, 1.0], [610.0, 0.2]],
    ];
    Medium {
        sigma_t: [1.5, 1.5, 2.5],
        albedo: [0.7, 0.5, 0.3],
        emission: [0.6, 0.4, 0.1],
        spectra: spectra.map(Some),
        ..Medium::default()
    }
}

/// Spectra of a surface, a medium and of lights, and smooth surfaces of every colour: all light is made from the lights as well.
fn spectra() -> Description {
    room(|b| {
        let rows = vec![[380.0, 0.05], [500.0, 0.9], [530.0, 0.1], [700.0, 0.8]];
        b.description.textures.push(Texture {
            name: "paper".into(),
            pattern: Pattern::Spectrum(rows),
            to_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        });
        let paper = b.material(Model::Diffuse {
            reflectance: ColorSource::Texture(0),
            transmittance: ColorSource::Constant([0.0; 3]),
        });
        b.cuboid([-0.7, 0.2, 0.0], [-0.2, 0.7, 0.8], false, Some(paper));
        let bronze = b.material(Model::RoughConductor {
            eta: [0.8, 1.1, 1.4],
            k: [3.5, 2.6, 2.2],
            spectra: Some([
                vec![[400.0, 1.4], [540.0, 1.2], [580.0, 0.5], [700.0, 0.3]],
                vec![[400.0, 2.1], [560.0, 2.7], [700.0, 4.1]],
            ]),
            reflectance: ColorSource::Constant([1.0; 3]),
            facets: Facets {
                alpha: [0.3; 2],
                distribution: Distribution::Ggx,
                masking: Masking::Correlated,
                compensated: true,
            },
        });
        b.cuboid([0.3, -0.7, 0.0], [0.7, -0.2, 0.6], false, Some(bronze));
        let smoke = b.matter(Medium {
            sigma_t: [3.0, 1.0, 0.0],
            albedo: [0.9, 0.6, 0.5],
            emission: [0.5, 0.2, 0.0],
            ..Medium::default()
        });
        b.fog([0.0, 0.0, 0.1], [0.7, 0.7, 1.0], smoke);
        let flame = b.matter(burning());
        b.fog([-0.8, -0.8, 0.1], [-0.2, -0.2, 0.8], flame);
        b.sphere([0.5, -0.4, 1.5], 0.2, None).emission = Some([8.0, 6.0, 4.0]);
        b.description.shapes.last_mut().unwrap().spectrum =
            Some(vec![[420.0, 2.0], [560.0, 12.0], [600.0, 5.0]]);
        b.light(EmitterKind::Point {
            position: [-0.4, -0.5, 1.6],
            intensity: [0.5; 3],
        });
        b.description.emitters[0].spectrum = Some(vec![[500.0, 0.2], [650.0, 0.8]]);
    })
    .description
}

#[test]
fn dispersion() {
    agree(
        "a prism of wavelengths",
        &glass_ball(false, Carry::AsNeeded),
        FromSensor,
        None,
    );
    agree(
        "a prism of three channels",
        &glass_ball(false, Carry::Rgb),
        FromSensor,
        None,
    );
}

#[test]
fn dispersion_in_fog() {
    agree(
        "wavelengths in fog",
        &glass_ball(true, Carry::AsNeeded),
        FromSensor,
        None,
    );
}

#[test]
fn tables_of_wavelengths() {
    let mut d = spectra();
    agree("spectra", &d, FromLight, None);
    d.carry = Carry::Rgb;
    agree("what spectra stand for", &d, FromLight, None);
}

/// Light of a known spectrum S through a slab that absorbs and glows, seen straight on: S·e^(−σd) + E/σ_a·(1 − e^(−σd)) at each wavelength, where nothing
/// scatters.
#[test]
fn a_filter_that_glows_in_closed_form() {
    const DEPTH: f32 = 0.8;
    let light = vec![[420.0, 0.3], [550.0, 1.5], [640.0, 0.4]];
    let mut b = Builder::new().camera([0.0, -3.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], 1.0, [4, 4]);
    b.description.sensor.projection = Projection::Orthographic {
        half_extent: [0.2; 2],
    };
    let mut medium = burning();
    medium.albedo = [0.0; 3];
    medium.spectra[1] = None;
    let [Some(sigma), _, Some(glow)] = medium.spectra.clone() else {
        unreachable!()
    };
    let filter = b.matter(medium);
    b.fog([-1.0, 0.0, -1.0], [1.0, DEPTH, 1.0], filter);
    b.light(EmitterKind::Constant { radiance: [1.0; 3] });
    b.description.emitters[0].spectrum = Some(light.clone());
    let at = |rows: &[[f32; 2]], nm: Real| {
        let words: Vec<[u32; 2]> = rows.iter().map(|row| row.map(f32::to_bits)).collect();
        interpolate(&words, nm)
    };
    let expected = seen(|nm| {
        let (s, e, radiance) = (at(&sigma, nm), at(&glow, nm), at(&light, nm));
        let tau = (-s * DEPTH).exp();
        radiance * tau + e / s * (1.0 - tau)
    });
    for estimator in [Estimator::Path, Estimator::Bidirectional] {
        let all = estimates(&b.description, estimator, Heuristic::Power, None, 2000);
        for (i, e) in all.iter().enumerate() {
            let truth = f64::from(expected.to_array()[i % 3]);
            let z = (e.mean - truth) / e.error;
            assert!(
                e.error < 0.01 * truth && z.abs() < Z,
                "{estimator:?}: {e:?}, expected {truth}, z = {z:.1}"
            );
        }
    }
}

/// Where all colours are grey, wavelengths are drawn in vain: the mean is that of red, green and blue, in every block.
#[test]
fn grey_scenes_are_the_same() {
    let mut d = room(|b| {
        let grey = Some(b.diffuse([0.6; 3]));
        b.cuboid([-0.6, 0.0, 0.0], [-0.1, 0.5, 0.9], false, grey);
        let glass = b.glass(1.5);
        let smoke = b.medium([2.0; 3], [0.8; 3], Phase::HenyeyGreenstein { g: 0.4 });
        b.ball([0.4, -0.1, 0.45], 0.35, glass, smoke);
        b.sphere([0.4, -0.3, 1.5], 0.25, None).emission = Some([5.0; 3]);
    })
    .description;
    for m in &mut d.materials {
        if let Model::Diffuse { reflectance, .. } = &mut m.model {
            *reflectance = ColorSource::Constant([0.6; 3]);
        }
    }
    for s in &mut d.shapes {
        s.emission = s.emission.map(|[_, g, _]| [g; 3]);
    }
    for estimator in [Estimator::Path, Estimator::Bidirectional] {
        let mut of = |carry| {
            d.carry = carry;
            estimates(&d, estimator, Heuristic::Power, None, 24)
        };
        let (rgb, spectral) = (of(Carry::Rgb), of(Carry::Wavelengths));
        super::assert_agree(&format!("grey by {estimator:?}"), &rgb, &spectral);
        // What a grey scene sends is white: the channels have one mean.
        for block in spectral.chunks(3) {
            for other in &block[1..] {
                let z = (other.mean - block[0].mean) / other.error.hypot(block[0].error);
                assert!(z.abs() < Z, "{block:?}: z = {z:.1}");
            }
        }
    }
}

/// White light all around, and glass that disperses and absorbs nothing: nothing is seen of it, at any wavelength.
#[test]
fn a_white_furnace() {
    let mut b = Builder::new().camera([0.0, -3.0, 0.5], [0.0; 3], [0.0, 0.0, 1.0], 40.0, [16, 16]);
    let glass = flint(&mut b);
    b.sphere([0.0; 3], 0.8, Some(glass));
    b.light(EmitterKind::Constant { radiance: [1.0; 3] });
    for carry in [Carry::AsNeeded, Carry::Rgb] {
        b.description.carry = carry;
        for estimator in [Estimator::Path, Estimator::Bidirectional] {
            let all = estimates(&b.description, estimator, Heuristic::Power, None, 40);
            for e in &all {
                let z = (e.mean - 1.0) / e.error.max(1e-6);
                assert!(
                    e.error < 0.03 && z.abs() < Z,
                    "{carry:?} {estimator:?}: {e:?}, z = {z:.1}"
                );
            }
            // One wavelength is noisy in every channel; all blocks together are less so.
            let n = all.len() as f64;
            let mean = all.iter().map(|e| e.mean).sum::<f64>() / n;
            let error = all.iter().map(|e| e.error.powi(2)).sum::<f64>().sqrt() / n;
            let z = (mean - 1.0) / error;
            assert!(
                error < 0.003 && z.abs() < Z,
                "{carry:?} {estimator:?}: {mean} ± {error}, z = {z:.1}"
            );
        }
    }
}
