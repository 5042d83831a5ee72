//! Blends: what a walk draws where it meets one follows the mixture of its parts' densities, and carries the mixture of what they do. The
//! part is drawn before the direction and without regard to it: a mixture of reciprocal parts is reciprocal.

use super::compiled::{NONE, materials, surface};
use super::density::{BINS, bin, shares};
use super::energy::albedo;
use super::kernel::blob::format::Material;
use super::kernel::surface::{Mode, chosen};
use super::zoo::{MODES, Random, Specimen, channels, some_directions};
use etendue_host::description::{ColorSource, Distribution, Facets, Masking, Model};
use etendue_tests::scenes::Builder;
use etendue_tests::statistics::{Family, Moments, chi_square};

/// A blend, which of the records it is, and its parts with their shares: parts that let light pass, smooth and rough, and blends of them.
struct Blend {
    name: &'static str,
    id: usize,
    parts: Vec<(f64, usize)>,
}

fn blends() -> (Vec<Material>, Vec<Blend>) {
    let constant = |c: f32| ColorSource::Constant([c; 3]);
    let mut blends = Vec::new();
    let all = materials(|b| {
        let leaf = b.material(Model::Diffuse {
            reflectance: ColorSource::Constant([0.5, 0.2, 0.1]),
            transmittance: ColorSource::Constant([0.2, 0.6, 0.1]),
        });
        let glass = b.glass(1.5);
        let ground = b.material(Model::RoughDielectric {
            ior: 1.4,
            reflectance: constant(0.9),
            transmittance: ColorSource::Constant([0.9, 0.7, 0.4]),
            facets: Facets {
                alpha: [0.4; 2],
                distribution: Distribution::Ggx,
                masking: Masking::Correlated,
                compensated: false,
            },
        });
        let cloth = b.material(Model::Phong {
            diffuse_reflectance: constant(0.2),
            reflectance: constant(0.3),
            transmittance: constant(0.3),
            diffuse_transmittance: constant(0.1),
            exponent: 20.0,
            modified: true,
            ior: 1.0,
            fresnel: false,
        });
        let mut blend = |b: &mut Builder, name, weight: f32, of: [usize; 2], parts| {
            let weight = constant(weight);
            let id = b.material(Model::Blend { parts: of, weight });
            blends.push(Blend { name, id, parts });
            id
        };
        let both = vec![(0.75, leaf), (0.25, ground)];
        let waxed = blend(b, "a leaf, ground glass", 0.25, [leaf, ground], both);
        let both = vec![(0.5, glass), (0.5, cloth)];
        let veil = blend(b, "glass, cloth", 0.5, [glass, cloth], both);
        let three = vec![(0.45, leaf), (0.15, ground), (0.4, cloth)];
        blend(b, "a blend, cloth", 0.4, [waxed, cloth], three);
        let shares = [0.3 * 0.75, 0.3 * 0.25, 0.7 * 0.5, 0.7 * 0.5];
        let four = shares.into_iter().zip([leaf, ground, glass, cloth]);
        blend(b, "two blends", 0.7, [waxed, veil], four.collect());
        let one = vec![(1.0, ground)];
        blend(b, "nothing, ground glass", 1.0, [leaf, ground], one);
    });
    (all, blends)
}

impl Blend {
    /// Its parts as others know them.
    fn specimens(&self, all: &[Material]) -> Vec<(f64, Specimen)> {
        let parts = self.parts.iter();
        let specimen = |&(share, id): &(f64, usize)| {
            let specimen = Specimen {
                name: self.name,
                surface: surface(&all[id]),
                lossless: false,
                glossy: true,
                reciprocal: None,
            };
            (share, specimen)
        };
        parts.map(specimen).collect()
    }

    /// The part that a walk meets.
    fn met<'a>(&self, all: &'a [Material], random: &mut Random) -> &'a Material {
        chosen(all, &all[self.id], NONE, [0.5; 2], || random.one())
    }
}

#[test]
fn draws_follow_the_mixture() {
    const DRAWS: u32 = 40_000;
    let mut family = Family::new();
    let mut random = Random::new(30);
    let (all, blends) = blends();
    for blend in &blends {
        for w in some_directions() {
            for mode in MODES {
                let mut expected = vec![0.0; BINS];
                for (share, specimen) in blend.specimens(&all) {
                    for (sum, of) in expected.iter_mut().zip(shares(&specimen, w, mode)) {
                        *sum += share * of * f64::from(DRAWS);
                    }
                }
                let mut counts = [0; BINS];
                for _ in 0..DRAWS {
                    let part = surface(blend.met(&all, &mut random));
                    counts[bin(random.scatter(&part, w, mode))] += 1;
                }
                let p = chi_square(&counts, &expected);
                family.add(p, format!("{} from {w} in {mode:?}", blend.name));
            }
        }
    }
    family.judge();
}

/// The furnace: at most all of the light, and the mixture of what the parts give back.
#[test]
fn walks_carry_the_mixture() {
    const WALKS: u32 = 20_000;
    let mut family = Family::new();
    let mut random = Random::new(31);
    let (all, blends) = blends();
    for blend in &blends {
        for w in some_directions() {
            let mut truth = [0.0; 3];
            for (share, specimen) in blend.specimens(&all) {
                for (sum, of) in truth.iter_mut().zip(albedo(&specimen, w)) {
                    *sum += share * of;
                }
            }
            assert!(truth.iter().all(|&t| t < 1.0), "{}: {truth:?}", blend.name);
            let mut moments = [Moments::default(); 3];
            for _ in 0..WALKS {
                let part = surface(blend.met(&all, &mut random));
                let s = random.scatter(&part, w, Mode::Importance);
                let weight = s.map_or([0.0; 3], |s| channels(s.weight));
                for (m, x) in moments.iter_mut().zip(weight) {
                    m.add(x);
                }
            }
            for (m, truth) in moments.iter().zip(truth) {
                // What the sum of Dirac lobes misses is less than one of its steps.
                family.add(m.against(truth, 3e-4), format!("{} from {w}", blend.name));
            }
        }
    }
    family.judge();
}
