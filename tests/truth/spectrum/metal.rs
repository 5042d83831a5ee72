//! Conductors whose index is known by wavelength.

use super::kernel::Scene;
use super::kernel::instance::Complete;
use super::kernel::real::{Real, Vec3};
use super::kernel::spectrum::{Hero, Rgb, Spectrum, seen, white};
use super::kernel::surface::{Local, Mode, Surface, fresnel};
use etendue_host::description::{ColorSource, Distribution, Facets, Masking, Model};
use etendue_tests::render::blob;
use etendue_tests::scenes::room;

/// Like a red metal, but with a step in the middle of the visible that three channels can't follow.
const ETA: [[f32; 2]; 5] = [
    [400.0, 1.4],
    [540.0, 1.2],
    [560.0, 0.4],
    [600.0, 0.2],
    [700.0, 0.25],
];
const K: [[f32; 2]; 4] = [[380.0, 2.0], [550.0, 2.6], [600.0, 3.4], [750.0, 4.6]];

/// Linear between rows, by a search of its own.
fn at(rows: &[[f32; 2]], nm: Real) -> Real {
    let [first, .., last] = rows else { panic!() };
    let nm = nm.clamp(Real::from(first[0]), Real::from(last[0]));
    let pair = rows.windows(2).find(|w| nm <= Real::from(w[1][0])).unwrap();
    let [a, b] = [pair[0].map(Real::from), pair[1].map(Real::from)];
    a[1] + (b[1] - a[1]) * (nm - a[0]) / (b[0] - a[0])
}

fn reflectance(nm: Real, cos: Real) -> Real {
    fresnel::conductor(at(&ETA, nm), at(&K, nm), cos)
}

/// A blob with the metal as its last material, smooth or rough.
fn metal(rough: bool) -> etendue_host::blob::AlignedBlob {
    let (eta, k) = ([0.3, 0.8, 1.3], [3.6, 2.8, 2.3]);
    let spectra = Some([ETA.to_vec(), K.to_vec()]);
    let reflectance = ColorSource::Constant([1.0; 3]);
    let model = match rough {
        false => Model::Conductor {
            eta,
            k,
            spectra,
            reflectance,
        },
        true => Model::RoughConductor {
            eta,
            k,
            spectra,
            reflectance,
            facets: Facets {
                alpha: [0.5; 2],
                distribution: Distribution::Ggx,
                masking: Masking::Correlated,
                compensated: true,
            },
        },
    };
    let b = room(|b| {
        let metal = b.material(model);
        b.sphere([0.0, 0.0, 1.0], 0.2, Some(metal));
    });
    blob(&b.description)
}

fn resolved(scene: &Scene<'_>, waves: &<Hero as Spectrum>::Waves) -> Surface<Hero> {
    let m = scene.materials().last().unwrap();
    Surface::resolve::<Complete<Hero>>(m, scene.texture_view(), waves, 0, [0.5; 2])
}

/// At each wavelength of a path it is Fresnel's of the tables there, and white light reflected by it has the colour of the whole spectrum.
#[test]
fn reflects_by_wavelength() {
    const STEPS: u32 = 20_000;
    let blob = metal(false);
    let scene = Scene::open(blob.bytes()).unwrap();
    for cos in [1.0, 0.6, 0.1] {
        let wo = Vec3::new((1.0 as Real - cos * cos).sqrt(), 0.0, cos);
        let mut sum = Rgb::BLACK;
        for i in 0..STEPS {
            let (waves, _) = Hero::draw((i as Real + 0.5) / STEPS as Real);
            let s = resolved(&scene, &waves)
                .of::<Complete<Hero>>()
                .sample(wo, Mode::Radiance, 0.5, [0.5; 2])
                .unwrap();
            for (weight, nm) in s.weight.0.iter().zip(Hero::wavelengths(&waves).0) {
                let truth = reflectance(nm, cos);
                assert!(
                    (weight / truth - 1.0).abs() < 2e-5,
                    "{weight} for {truth} at {nm} nm"
                );
            }
            sum +=
                (s.weight * Hero::light([1.0; 3], &waves)).to_rgb(&waves) * (1.0 / STEPS as Real);
        }
        let truth = seen(|nm| reflectance(nm, cos) * white(nm)).to_array();
        for (a, b) in sum.to_array().iter().zip(truth) {
            assert!((a - b).abs() < 2e-4, "{sum:?} for {truth:?}");
        }
    }
}

/// What a rough one gives back of what its facets lose is as red as they are: the mean reflectance at each wavelength.
#[test]
fn gives_back_by_wavelength() {
    let blob = metal(true);
    let scene = Scene::open(blob.bytes()).unwrap();
    for i in 0..50 {
        let (waves, _) = Hero::draw((i as Real + 0.5) / 50.0);
        let Surface::Outlined(super::kernel::surface::Outlined::RoughConductor(m)) =
            resolved(&scene, &waves)
        else {
            panic!()
        };
        for (mean, nm) in m.mean.0.iter().zip(Hero::wavelengths(&waves).0) {
            let steps = 2000;
            // ∫ F cos θ dσ/π = ∫ F d(cos² θ).
            let truth = (0..steps)
                .map(|i| reflectance(nm, ((i as Real + 0.5) / steps as Real).sqrt()))
                .sum::<Real>()
                / steps as Real;
            // Linear between the tables' rows, where the truth is curved.
            assert!((mean - truth).abs() < 0.03, "{mean} for {truth} at {nm} nm");
        }
    }
}
