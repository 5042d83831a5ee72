//! Volumes whose light is known in closed form: half-spaces lit by the sun (Chandrasekhar's H), balls and boxes that are in equilibrium with what is around
//! them, balls that absorb.

use super::media::{ask_enough, estimators, ids, number};
use super::{Ask, BATCHES, ask, batches, check, sky};
use etendue::{Scene, Scratch, Settings};
use etendue_host::description::{EmitterKind, Geometry, Medium, Phase};
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;
use etendue_tests::takes;

/// The sun on matter without end, seen from above: L = a/4π·μ₀/(μ + μ₀)·H(μ)·H(μ₀) (Chandrasekhar 1950). A layer so thick that less than 10⁻⁵ of what is
/// seen would have come from below it; where nothing is absorbed, 10⁻³.
#[test]
fn half_spaces_in_the_sun() {
    let all = (0..).zip(ids("H_radiance"));
    for (_, id) in all.filter(|(i, _)| takes(*i, 9)) {
        // H_radiance_a0.3_mu01.0_mu0.5
        let [albedo, sun] = ["a", "mu0"].map(|key| number(&id, key).unwrap());
        let eye: f32 = id.rsplit("mu").next().unwrap().parse().unwrap();
        let tau = match albedo {
            1.0 => 1000.0,
            a => 10.0 / (3.0 * (1.0 - a)).sqrt() + 5.0,
        };
        let mut b = Builder::new();
        let matter = b.medium([tau; 3], [albedo; 3], Phase::Isotropic);
        b.fog([-100.0, -100.0, 0.0], [100.0, 100.0, 1.0], matter);
        b.light(EmitterKind::Directional {
            direction: [-(1.0 - sun * sun).sqrt(), 0.0, -sun],
            irradiance: [1.0; 3],
        });
        let side = (1.0 - eye * eye).sqrt();
        let ray = Ask::Ray([0.3, 0.2 + 2.0 * side, 1.0 + 2.0 * eye], [0.0, -side, -eye]);
        ask_enough(estimators(tau), &blob(&b.description), &id, ray, 0.03);
    }
}

/// A ball of matter under a white sky, seen from above at `height` beside its middle.
fn ball(id: &str, sigma_t: f32, albedo: f32, g: f32, height: f32) {
    let mut b = Builder::new();
    let phase = Phase::HenyeyGreenstein { g };
    let matter = b.medium([sigma_t; 3], [albedo; 3], phase);
    let null = b.null();
    b.ball([0.0; 3], 1.0, null, matter);
    sky(&mut b);
    let ray = Ask::Ray([height, 0.0, 3.0], [0.0, 0.0, -1.0]);
    ask(&blob(&b.description), id, ray, 2000, None, 0.01);
}

/// What absorbs nothing can't be seen where light is the same everywhere.
#[test]
fn white_matter_is_invisible_under_a_white_sky() {
    ball("furnace_medium_a1.0_g-0.5_st5.0", 5.0, 1.0, -0.5, 0.3);
    ball("furnace_medium_a1.0_g0.0_st0.0001", 1e-4, 1.0, 0.0, 0.3);
}

/// e^(−2σ·√(1 − b²)) of the sky is seen through a ball that absorbs.
#[test]
fn chords_of_a_black_ball() {
    for height in [0.0, 0.5] {
        let id = format!("absorber_chord_b{height:.1}_s1.0");
        ball(&id, 1.0, 0.0, 0.0, height);
    }
}

/// A closed ball whose walls glow and reflect, full of matter that absorbs nothing: L = 1/(1 − ρ), with and without it.
#[test]
fn white_matter_in_a_glowing_ball() {
    for rho in [0.5, 0.8] {
        let mut b = Builder::new();
        let matter = b.medium([3.0; 3], [1.0; 3], Phase::HenyeyGreenstein { g: 0.6 });
        let wall = b.diffuse([rho; 3]);
        let shell = Geometry::Sphere {
            center: [0.0; 3],
            radius: 1.0,
            flipped: true,
        };
        let shell = b.shape(shell, Some(wall));
        // Its front is inside.
        (shell.emission, shell.exterior) = (Some([1.0; 3]), Some(matter));
        let ray = Ask::Ray([0.1, 0.2, -0.3], [0.36, 0.48, 0.8]);
        let id = format!("encl_medium_rho{rho:.1}");
        ask_enough(estimators(6.0), &blob(&b.description), &id, ray, 0.02);
    }
}

/// Black walls that send out B, and matter that sends out σ_a·B: B is seen everywhere (Kirchhoff).
#[test]
fn matter_in_equilibrium_with_its_walls() {
    for albedo in [0.0, 0.7] {
        let mut b = Builder::new();
        let matter = b.matter(Medium {
            sigma_t: [2.0; 3],
            albedo: [albedo; 3],
            emission: [2.0 * (1.0 - albedo); 3],
            phase: vec![Phase::HenyeyGreenstein { g: 0.3 }.into()],
            ..Medium::default()
        });
        let walls = b.cuboid([0.0; 3], [1.0; 3], true, None);
        (walls.emission, walls.exterior) = (Some([1.0; 3]), Some(matter));
        let ray = Ask::Ray([0.4, 0.3, 0.6], [0.36, 0.48, 0.8]);
        let id = format!("encl_emissive_medium_a{albedo:.1}");
        ask(&blob(&b.description), &id, ray, 2000, None, 0.02);
    }
}

/// How much of a beam a ball of tinted glass keeps: what the mean ray across it doesn't bring of a white sky.
#[test]
fn tinted_glass_balls() {
    for id in ids("ball_absorbed") {
        let mut b = Builder::new();
        let tint = b.medium([number(&id, "sa").unwrap(); 3], [0.0; 3], Phase::Isotropic);
        let glass = b.glass(number(&id, "n").unwrap());
        b.ball([0.0; 3], 1.0, glass, tint);
        sky(&mut b);
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        let mut scratch = Scratch::<32>::new();
        let settings = Settings::default();
        const RAYS: u64 = 3000;
        let e = batches(RAYS, |batch, i| {
            // Stratified over the disc that the beam covers, each batch with a shift of its own.
            let shift = (batch as f64 + 0.5) / BATCHES as f64;
            let b = ((i as f64 + shift) / etendue_tests::samples(RAYS) as f64).sqrt();
            let origin = glam::Vec3::new(b as f32, 0.0, 3.0);
            let seen = scene.radiance(&settings, origin, -glam::Vec3::Z, batch, i, &mut scratch);
            1.0 - f64::from(seen.g)
        });
        check(&id, "by path", e, 0.01);
    }
}
