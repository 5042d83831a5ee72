//! Scattering volumes: slabs (van de Hulst, Chandrasekhar, adding-doubling), single scattering of a point and of the sun, absorbing glass.
//!
//! An infinite slab is a square column between perfect mirrors. By reciprocity what it returns of a beam along the normal is
//! the radiance seen along the normal under a uniform light from that side.

use super::{Ask, ORACLES, ask, ask_by, mean_by, single_by, sky};
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{EmitterKind, Grid, GridValues, Medium, Phase, Tracking};
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, phase};
use etendue_tests::takes;
use std::panic::catch_unwind;

/// What a slab of thickness 1 is made of.
#[derive(Clone, Copy)]
struct Slab {
    /// Optical thickness.
    tau: f32,
    albedo: f32,
    g: f32,
    /// Of what it is embedded in 1.
    ior: f32,
    /// As a constant grid, tracked like this.
    grid: Option<Tracking>,
    /// How large everything is.
    scale: f32,
}

impl Slab {
    fn new(tau: f32, albedo: f32, g: f32) -> Self {
        Self {
            tau,
            albedo,
            g,
            ior: 1.0,
            grid: None,
            scale: 1.0,
        }
    }

    fn blob(&self) -> AlignedBlob {
        let mut b = Builder::new();
        let mirror = Some(b.mirror(1.0));
        let (low, height) = (-0.75, 2.5);
        b.quad([0.0, 0.0, low], [1.0, 0.0, 0.0], [0.0, 0.0, height], mirror);
        b.quad([0.0, 1.0, low], [1.0, 0.0, 0.0], [0.0, 0.0, height], mirror);
        b.quad([0.0, 0.0, low], [0.0, 1.0, 0.0], [0.0, 0.0, height], mirror);
        b.quad([1.0, 0.0, low], [0.0, 1.0, 0.0], [0.0, 0.0, height], mirror);
        // The light from above; below it is dark.
        b.quad([0.0, 0.0, 1.5], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], None)
            .emission = Some([1.0; 3]);
        let phase = phase(self.g);
        let matter = Medium {
            sigma_t: [self.tau / self.scale; 3],
            albedo: [self.albedo; 3],
            phase: vec![phase.into()],
            ..Medium::default()
        };
        // Beyond the mirrors, so that no boundaries coincide.
        let (low, high) = ([-0.5, -0.5, 0.0], [1.5, 1.5, 1.0]);
        let medium = match self.grid {
            None => b.matter(matter),
            Some(tracking) => {
                let grid = Grid {
                    size: [3, 2, 5],
                    values: GridValues::Gray(vec![1.0; 30]),
                    nearest: false,
                };
                let id = b.smoke(low, high, grid, matter);
                b.description.media[id].grids.as_mut().unwrap().tracking = tracking;
                id
            }
        };
        let boundary = if self.ior == 1.0 {
            b.null()
        } else {
            b.glass(self.ior)
        };
        b.cuboid(low, high, false, Some(boundary)).interior = Some(medium);
        blob(&b.transformed(self.scale, [0.0; 3]).description)
    }

    /// Where one of its four numbers is seen: UR1, UT1 (along the normal), URU, UTU (diffuse).
    fn what(&self, id: &str) -> Ask {
        let at = |z: f32| [0.37, 0.41, z].map(|x| x * self.scale);
        match id.rsplit('_').next().unwrap() {
            "UR1" => Ask::Ray(at(1.4), [0.0, 0.0, -1.0]),
            "UT1" => Ask::Ray(at(-0.4), [0.0, 0.0, 1.0]),
            "URU" => Ask::Irradiance(at(1.3), [0.0, 0.0, -1.0]),
            _ => Ask::Irradiance(at(-0.4), [0.0, 0.0, 1.0]),
        }
    }

    /// Asks for it.
    fn ask(&self, id: &str, samples: u64, precision: f64) {
        // Of the diffuse ones the file has π times the value: an irradiance.
        ask(&self.blob(), id, self.what(id), samples, None, precision);
    }
}

/// The number behind `key` in an id.
pub(super) fn number(id: &str, key: &str) -> Option<f32> {
    id.split('_')
        .find_map(|part| part.strip_prefix(key)?.parse().ok())
}

/// The numbers in `slab_a0.5_tau1_g0.75_UR1`, or in a name of the others.
fn named(id: &str) -> Slab {
    let number = |key| number(id, key);
    let (albedo, g) = (number("a").unwrap_or(1.0), number("g").unwrap_or(0.0));
    // Radiance falls by e in each diffusion length, there and back: nothing that is noticed comes from ten deep.
    let diffusion = 1.0 / (3.0 * (1.0 - albedo) * (1.0 - albedo * g)).sqrt();
    let tau = number("tau").filter(|t| t.is_finite());
    Slab {
        ior: number("n").unwrap_or(1.0),
        ..Slab::new(tau.unwrap_or(10.0 * diffusion.max(2.0)), albedo, g)
    }
}

pub(super) fn ids(prefix: &str) -> Vec<String> {
    let all = ORACLES.as_object().unwrap().keys();
    let mut found: Vec<String> = all.filter(|k| k.starts_with(prefix)).cloned().collect();
    found.sort();
    assert!(!found.is_empty(), "no oracle {prefix}");
    found
}

/// How many samples per batch this estimator takes for a relative noise, by others of its samples: for half of what they say, because where little comes back
/// a few tell it badly.
fn enough(estimator: Estimator, bytes: &AlignedBlob, ask: Ask, precision: f64) -> u64 {
    const PILOT: u64 = 1000;
    let settings = Settings {
        estimator,
        seed: 1,
        ..Settings::default()
    };
    let pilot = single_by(&Scene::open(bytes.bytes()).unwrap(), &settings, ask, PILOT);
    let times = (2.0 * pilot.error / (precision * pilot.mean)).powi(2);
    // Nothing came back: as many as there may be.
    let times = if times.is_finite() { times } else { f64::MAX };
    (PILOT as f64 * times).clamp(100.0, 400_000.0) as u64
}

/// Those that can be asked of an optical thickness: in deep matter light scatters a thousand times, and path's cost grows with that number alone.
pub(super) fn estimators(tau: f32) -> &'static [Estimator] {
    match tau {
        ..=40.0 => &[Estimator::Path, Estimator::Bidirectional],
        _ => &[Estimator::Path],
    }
}

/// Asks each of them with as many samples as it takes.
pub(super) fn ask_enough(
    estimators: &[Estimator],
    bytes: &AlignedBlob,
    id: &str,
    ask: Ask,
    precision: f64,
) {
    for &estimator in estimators {
        let samples = enough(estimator, bytes, ask, precision);
        ask_by(&[estimator], bytes, id, ask, samples, None, precision);
    }
}

/// Slabs whose names begin like this: all, or one in some unless tests are to be deep.
fn each(prefix: &str) {
    const SOME: usize = 33;
    let right = |id: &String| {
        let slab = named(id);
        let asked = estimators(slab.tau);
        ask_enough(asked, &slab.blob(), id, slab.what(id), 0.05);
    };
    // All that are wrong are named, not the first alone.
    let wrong: Vec<_> = (0..)
        .zip(ids(prefix))
        .filter(|(i, id)| takes(*i, SOME) && catch_unwind(|| right(id)).is_err())
        .map(|(_, id)| id)
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Matched boundaries, over albedo, thickness and asymmetry.
#[test]
fn slabs() {
    each("slab_a");
}

/// Dielectric boundaries; specular reflection included.
#[test]
fn slabs_of_another_index() {
    each("slab_n1.33_a");
    each("slab_n1.5_a");
}

/// A constant grid is the homogeneous medium, however it is tracked.
#[test]
fn slabs_of_constant_grids() {
    let id = "slab_a0.95_tau2_g0.5_UR1";
    for tracking in [Tracking::Woodcock, Tracking::Residual, Tracking::Regular] {
        let slab = Slab {
            grid: Some(tracking),
            ..named(id)
        };
        slab.ask(id, 400, 0.03);
    }
}

/// Where single precision would fail first.
#[test]
fn extreme_slabs() {
    Slab::new(1.0, 1.0, -0.999).ask("peak_g-0.999_tau1_URU", 200, 0.03);
    Slab::new(10.0, 1.0, 0.99).ask("peak_g0.99_tau10_URU", 300, 0.05);
    for (id, scale) in [("scale_medium_0.0001", 1e-4), ("scale_medium_1e+06", 1e6)] {
        let slab = Slab {
            scale,
            ..Slab::new(2.0, 0.9, 0.75)
        };
        let bytes = slab.blob();
        let at = [0.37, 0.41, 1.4].map(|x| x * scale);
        ask(&bytes, id, Ask::Ray(at, [0.0, 0.0, -1.0]), 600, None, 0.03);
    }
}

/// Light that scatters a thousand times and more before it comes back or is absorbed, or goes through a hundred free paths: by `path`, whose
/// cost grows with that number alone. At an albedo of 0.999999 one walk in 450 would go on for more edges than there may be: 2e-3 of the light is missing, a
/// tenth of the noise that is asked for.
#[test]
fn endless_slabs() {
    let path = [Estimator::Path];
    for (id, slab, samples, precision) in [
        (
            "highalbedo_a0.99999_tau10000_g0.0_UR1",
            Slab::new(1e4, 0.99999, 0.0),
            24,
            0.02,
        ),
        (
            "highalbedo_a0.99999_tau10000_g0.0_URU",
            Slab::new(1e4, 0.99999, 0.0),
            24,
            0.02,
        ),
        (
            "highalbedo_a0.99999_tauinf_g0.0_URU",
            named("highalbedo_a0.99999_tauinf_g0.0_URU"),
            24,
            0.02,
        ),
        (
            "highalbedo_a0.999999_tauinf_g0.0_UR1",
            named("highalbedo_a0.999999_tauinf_g0.0_UR1"),
            24,
            0.02,
        ),
        (
            "highalbedo_a0.999999_tauinf_g0.0_URU",
            named("highalbedo_a0.999999_tauinf_g0.0_URU"),
            24,
            0.02,
        ),
        (
            "highalbedo_a0.99999_tauinf_g0.9_UR1",
            named("highalbedo_a0.99999_tauinf_g0.9_UR1"),
            24,
            0.03,
        ),
        (
            "peak_g0.999_tau1000_URU",
            Slab::new(1000.0, 1.0, 0.999),
            60,
            0.05,
        ),
        (
            "highalbedo_a0.99999_tau100_g0.9_UR1",
            Slab::new(100.0, 0.99999, 0.9),
            60,
            0.03,
        ),
        (
            "thick_cons_tau100_UT1",
            Slab::new(100.0, 1.0, 0.0),
            400,
            0.08,
        ),
        (
            "peak_g0.999_tau10_UR1",
            Slab::new(10.0, 1.0, 0.999),
            3000,
            0.1,
        ),
    ] {
        let (bytes, what) = (slab.blob(), slab.what(id));
        ask_by(&path, &bytes, id, what, samples, None, precision);
    }
}

/// Ten thousand free paths of matter that absorbs nothing: what gets through (1.3e-4; P30's thick_cons_tau10000) has scattered τ² times, more often than a
/// walk may. It is missing, and the kernel says so.
#[test]
fn walks_through_the_thickest_slab_are_counted() {
    let bytes = Slab::new(1e4, 1.0, 0.0).blob();
    let scene = Scene::open(bytes.bytes()).unwrap();
    let mut scratch = Scratch::<8>::new();
    let settings = Settings::default();
    let (below, up) = ([0.37, 0.41, -0.4].into(), [0.0, 0.0, 1.0].into());
    for i in 0..4000 {
        scene.irradiance(&settings, below, up, 0, i, &mut scratch);
    }
    // Of n scatterings survive 1/√(πn) in a half-space: one in 450 of MAX_STEPS.
    assert!(scratch.counters.cut_walks > 0, "{:?}", scratch.counters);
}

/// Two layers, of fog over milk; lit by a uniform lamp above, or by the sun from below.
fn layers(sun: bool) -> AlignedBlob {
    let mut b = Builder::new();
    let mirror = Some(b.mirror(1.0));
    let height = [0.0, 0.0, 2.5];
    for (corner, side) in [
        ([0.0, 0.0, -0.75], [1.0, 0.0, 0.0]),
        ([0.0, 1.0, -0.75], [1.0, 0.0, 0.0]),
        ([0.0, 0.0, -0.75], [0.0, 1.0, 0.0]),
        ([1.0, 0.0, -0.75], [0.0, 1.0, 0.0]),
    ] {
        b.quad(corner, side, height, mirror);
    }
    if sun {
        b.light(EmitterKind::Directional {
            direction: [0.0, 0.0, 1.0],
            irradiance: [1.0; 3],
        });
    } else {
        b.quad([0.0, 0.0, 1.5], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], None)
            .emission = Some([1.0; 3]);
    }
    let milk = b.medium([1.5; 3], [0.7; 3], Phase::HenyeyGreenstein { g: 0.8 });
    let fog = b.medium([0.6; 3], [0.95; 3], Phase::HenyeyGreenstein { g: -0.3 });
    let null = b.null();
    b.cuboid([-0.5, -0.5, 0.0], [1.5, 1.5, 0.45], false, Some(null))
        .interior = Some(milk);
    b.cuboid([-0.5, -0.5, 0.55], [1.5, 1.5, 1.0], false, Some(null))
        .interior = Some(fog);
    blob(&b.description)
}

/// Light goes both ways alike (Helmholtz): what is seen along the normal from below, under a uniform light above, is what gets
/// through, in all directions, of a beam along the normal from below. The layers aren't symmetric.
#[test]
fn layers_from_either_end() {
    let seen = layers(false);
    let sent = layers(true);
    let ray = Ask::Ray([0.37, 0.41, -0.4], [0.0, 0.0, 1.0]);
    let probe = Ask::Irradiance([0.37, 0.41, 1.3], [0.0, 0.0, -1.0]);
    for estimator in [Estimator::Path, Estimator::Bidirectional] {
        let up = mean_by(estimator, &seen, ray, 500);
        let down = mean_by(estimator, &sent, probe, 2000);
        let z = up.z(&down);
        assert!(
            z.abs() < 5.0 && up.error < 0.02 * up.mean && down.error < 0.02 * down.mean,
            "{estimator:?}: {up:?} {down:?}: z = {z:.1}"
        );
    }
}

/// A half-space that scatters isotropically, by Chandrasekhar's H functions: its albedo towards a direction.
#[test]
fn half_spaces() {
    for id in ids("H_planealbedo") {
        let mu = number(&id, "mu").unwrap();
        let slab = named(&id);
        let bytes = slab.blob();
        let direction = [(1.0 - mu * mu).sqrt(), 0.0, -mu];
        let ray = Ask::Ray([0.37, 0.41, 1.2], direction);
        ask_by(estimators(slab.tau), &bytes, &id, ray, 400, None, 0.03);
    }
}

/// Fog that fills everything, seen along a ray that ends at a black wall.
fn fog(sigma_t: f32, albedo: f32, g: f32) -> Builder {
    let mut b = Builder::new();
    let phase = phase(g);
    let fog = b.medium([sigma_t; 3], [albedo; 3], phase);
    b.fog([-200.0; 3], [200.0; 3], fog);
    b
}

/// Light of a point, scattered once on its way to a ray ("airlight").
#[test]
fn airlight() {
    // Distance of the light, where the ray begins and ends, extinction, albedo, g.
    let cases = [
        ("airlight_iso_0", 1.0, -5.0, 5.0, 0.1, 1.0, 0.0),
        ("airlight_hg_0", 1.0, -5.0, 5.0, 0.1, 1.0, 0.75),
        ("airlight_hg_3", 0.1, -2.0, 2.0, 0.3, 1.0, 0.5),
        ("airlight_hg_6", 0.05, -4.0, -0.2, 0.2, 1.0, 0.95),
    ];
    for (id, height, camera, wall, sigma_t, albedo, g) in cases {
        let mut b = fog(sigma_t, albedo, g);
        // Small: it ends the ray, and must not stand between the light and what the ray passes.
        b.quad(
            [wall, -1e-4, -1e-4],
            [0.0, 2e-4, 0.0],
            [0.0, 0.0, 2e-4],
            None,
        );
        b.light(EmitterKind::Point {
            position: [0.0, height, 0.0],
            intensity: [1.0; 3],
        });
        b.description.emitters[0].medium = Some(0);
        let ray = Ask::Ray([camera, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let bytes = blob(&b.description);
        ask_by(&[Estimator::Path], &bytes, id, ray, 1500, Some(2), 0.01);
        // Without equiangular sampling there is more noise.
        let both = [Estimator::Bidirectional];
        ask_by(&both, &bytes, id, ray, 6000, Some(2), 0.06);
    }
}

/// The sun through a slit in a black plane, scattered once on its way to a ray.
#[test]
fn light_shafts() {
    let slanting = [0.6, -0.8, 0.0];
    // Height of the plane, the slit, the wall at which the ray ends; sun, extinction, albedo, g.
    let cases = [
        (
            "shaft_0",
            3.0,
            [4.0, 6.0],
            10.0,
            [0.0, -1.0, 0.0],
            [0.1, 1.0, 0.0],
        ),
        (
            "shaft_1",
            2.0,
            [1.0, 2.0],
            5.0,
            [0.0, -1.0, 0.0],
            [0.5, 0.8, 0.6],
        ),
        ("shaft_2", 1.0, [2.25, 2.75], 8.0, slanting, [0.2, 1.0, 0.6]),
    ];
    for (id, top, slit, wall, direction, [sigma_t, albedo, g]) in cases {
        let mut b = Builder::new();
        let phase = Phase::HenyeyGreenstein { g };
        let fog = b.medium([sigma_t; 3], [albedo; 3], phase);
        b.fog([-200.0, -200.0, -200.0], [200.0, top, 200.0], fog);
        // Just above the fog's surface: it casts the same shadow.
        for (from, to) in [(-200.0, slit[0]), (slit[1], 200.0)] {
            let corner = [from, top + 1e-3, -200.0];
            b.quad(corner, [to - from, 0.0, 0.0], [0.0, 0.0, 400.0], None);
        }
        b.quad(
            [wall, -50.0, -50.0],
            [0.0, 49.0 + top, 0.0],
            [0.0, 0.0, 100.0],
            None,
        );
        b.light(EmitterKind::Directional {
            direction,
            irradiance: [1.0; 3],
        });
        let ray = Ask::Ray([0.0; 3], [1.0, 0.0, 0.0]);
        ask(&blob(&b.description), id, ray, 4000, Some(2), 0.02);
    }
}

/// A plate of glass that absorbs, before a uniform sky.
#[test]
fn absorbing_plates() {
    for id in ids("slab_T_n").into_iter().filter(|id| id.contains("abs")) {
        let number = |key| number(&id, key).unwrap();
        let (ior, cos, absorption) = (number("n"), number("c"), number("abs"));
        let mut b = Builder::new();
        let tint = b.medium([absorption; 3], [0.0; 3], Phase::Isotropic);
        let glass = b.glass(ior);
        b.cuboid(
            [-500.0, -500.0, 0.0],
            [500.0, 500.0, 1.0],
            false,
            Some(glass),
        )
        .interior = Some(tint);
        // Black from above: only what comes through counts.
        b.quad(
            [-400.0, -400.0, 2.0],
            [800.0, 0.0, 0.0],
            [0.0, 800.0, 0.0],
            None,
        );
        sky(&mut b);
        let direction = [(1.0 - cos * cos).sqrt(), 0.0, -cos];
        let ray = Ask::Ray([-direction[0] / cos * 0.5, 0.0, 1.5], direction);
        let both = [Estimator::Path, Estimator::Bidirectional];
        ask_enough(&both, &blob(&b.description), &id, ray, 0.03);
    }
}
