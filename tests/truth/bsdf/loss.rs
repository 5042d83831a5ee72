//! What single scattering by microfacets loses, and that compensation gives it back: materials as the compiler makes them.

use super::energy::albedo;
use super::kernel::Rgb;
use super::kernel::blob::format::{Header, Material, Toc, section};
use super::kernel::surface::{Surface, TextureView};
use super::zoo::{All, MODES, Random, Specimen, channels, direction, taken};
use etendue_host::description::{ColorSource, Distribution, Facets, Masking, Model};
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;
use etendue_tests::statistics::{Family, Moments};

const WHITE: ColorSource = ColorSource::Constant([1.0; 3]);
const COSINES: [f64; 4] = [1.0, 0.7, 0.3, 0.1];

/// The local model that a description's becomes.
fn compiled(model: Model) -> Specimen {
    let mut b = Builder::new();
    let material = b.material(model);
    b.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], Some(material));
    let blob = blob(&b.description);
    let bytes = blob.bytes();
    let head = size_of::<Header>();
    let header: &Header = bytemuck::from_bytes(&bytes[..head]);
    let table = &bytes[head..head + header.section_count as usize * size_of::<Toc>()];
    let find = |kind| {
        let table: &[Toc] = bytemuck::cast_slice(table);
        let t = table.iter().find(|t| t.kind == kind).unwrap();
        let start = t.offset as usize;
        &bytes[start..start + (t.count * u64::from(t.stride)) as usize]
    };
    let materials: &[Material] = bytemuck::cast_slice(find(section::MATERIALS));
    let view = TextureView {
        textures: &[],
        texels: bytemuck::cast_slice(find(section::TEXELS)),
    };
    Specimen {
        name: "compiled",
        surface: Surface::<Rgb>::resolve::<All>(&materials[0], view, &(), 0, [0.5; 2]),
        lossless: false,
        glossy: true,
        reciprocal: Some(1.0),
    }
}

fn facets(alpha: f32, distribution: Distribution, masking: Masking, compensated: bool) -> Facets {
    Facets {
        alpha: [alpha; 2],
        distribution,
        masking,
        compensated,
    }
}

fn conductor(facets: Facets) -> Model {
    Model::RoughConductor {
        spectra: None,
        eta: [0.0; 3],
        k: [1.0; 3],
        reflectance: WHITE,
        facets,
    }
}

fn dielectric(ior: f32, facets: Facets) -> Model {
    Model::RoughDielectric {
        ior,
        reflectance: WHITE,
        transmittance: WHITE,
        facets,
    }
}

fn plastic(facets: Option<Facets>) -> Model {
    Model::Plastic {
        ior: 1.5,
        diffuse_reflectance: WHITE,
        reflectance: WHITE,
        nonlinear: true,
        facets,
    }
}

/// The largest distance of the albedo from 1, from either side of the surface.
fn worst(specimen: &Specimen, both_sides: bool) -> f64 {
    let cosines = COSINES.into_iter().flat_map(|c| [c, -c]);
    cosines
        .enumerate()
        .filter(|(i, _)| taken(i / 2))
        .map(|(_, cos)| cos)
        .filter(|c| both_sides || *c > 0.0)
        .map(|cos| (albedo(specimen, direction(cos, 0.4))[1] - 1.0).abs())
        .fold(0.0, f64::max)
}

/// The numbers that `surface/rough_conductor.rs` states.
#[test]
fn single_scattering_loses_what_is_stated() {
    for (alpha, along, slanted) in [(0.1, 0.988, 0.936), (0.5, 0.69, 0.75), (1.0, 0.31, 0.56)] {
        let f = facets(alpha, Distribution::Ggx, Masking::Correlated, false);
        let specimen = compiled(conductor(f));
        for (cos, stated) in [(1.0, along), (0.3, slanted)] {
            let albedo = albedo(&specimen, direction(cos, 0.4))[1];
            println!("GGX, alpha {alpha}, cos {cos}: {albedo:.4}");
            assert!((albedo - stated).abs() < 0.006, "{alpha}, {cos}: {albedo}");
        }
    }
}

/// A white conductor that is compensated passes the furnace within 1 %: the curve's bytes and interpolation.
#[test]
fn compensated_conductors_pass_the_furnace() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for masking in [Masking::Correlated, Masking::Separable] {
            for alpha in [0.1, 0.5, 1.0] {
                let specimen = compiled(conductor(facets(alpha, distribution, masking, true)));
                let worst = worst(&specimen, false);
                println!("{distribution:?}, {masking:?}, alpha {alpha}: {worst:.4}");
                assert!(
                    worst < 0.01,
                    "{distribution:?} {masking:?} {alpha}: {worst}"
                );
            }
        }
    }
}

/// So does glass, from either side, within 1.5 %: near the critical angle what is lost bends between two of the curve's nodes.
#[test]
fn compensated_dielectrics_pass_the_furnace() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for (ior, alpha) in [(1.5, 0.1), (1.5, 0.5), (1.5, 1.0), (1.33, 0.7), (2.4, 0.7)] {
            let f = facets(alpha, distribution, Masking::Separable, true);
            let worst = worst(&compiled(dielectric(ior, f)), true);
            println!("{distribution:?}, {ior}, alpha {alpha}: {worst:.4}");
            assert!(worst < 0.015, "{distribution:?} {ior} {alpha}: {worst}");
        }
    }
}

/// And white plastic whose coat lets in what it doesn't reflect; with a smooth coat exactly.
#[test]
fn white_plastic_passes_the_furnace() {
    for alpha in [0.1, 0.5, 1.0] {
        let f = facets(alpha, Distribution::Ggx, Masking::Correlated, true);
        let worst = worst(&compiled(plastic(Some(f))), false);
        println!("alpha {alpha}: {worst:.4}");
        assert!(worst < 0.01, "{alpha}: {worst}");
    }
    let smooth = worst(&compiled(plastic(None)), false);
    assert!(smooth < 3e-4, "smooth: {smooth}");
}

/// Draws of compensated models carry the albedo as well, in both modes.
#[test]
fn draws_of_compensated_models_carry_the_albedo() {
    let f = |alpha, compensated| facets(alpha, Distribution::Ggx, Masking::Separable, compensated);
    let mut family = Family::new();
    let mut random = Random::new(12);
    for model in [
        conductor(f(0.9, true)),
        dielectric(1.5, f(0.9, true)),
        plastic(Some(f(0.4, false))),
    ] {
        let specimen = compiled(model);
        for cos in [1.0, -0.6, 0.3] {
            let w = direction(cos, 1.0);
            let truth = albedo(&specimen, w)[1];
            for mode in MODES {
                let mut moments = Moments::default();
                for _ in 0..40_000 {
                    let s = random.scatter(&specimen.surface, w, mode);
                    moments.add(s.map_or(0.0, |s| channels(s.weight * (1.0 / s.eta_scale))[1]));
                }
                family.add(moments.against(truth, 3e-4), format!("{cos} {mode:?}"));
            }
        }
    }
    family.judge();
}
