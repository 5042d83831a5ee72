//! Free flight through what is the same everywhere.

use super::kernel::Scene;
use super::kernel::medium::Flight;
use super::kernel::random::Pcg;
use super::kernel::real::Real;
use super::kernel::spectrum::Rgb;
use super::ways::{FRESH, STEPS, channels, flights, fly, holding, lead, p_value, ray, way};
use etendue_tests::media::{Matter, homogeneous};
use etendue_tests::oracles::oracles;
use etendue_tests::statistics::{Family, Moments, chi_square};

fn matter(sigma_t: [f32; 3], emission: [f32; 3]) -> Matter {
    let medium = homogeneous(sigma_t, [0.5; 3]);
    let emission = etendue::blob::format::Medium { emission, ..medium };
    Matter {
        media: vec![emission],
        ..Matter::default()
    }
}

#[test]
fn flights_meet_the_oracles() {
    const COUNT: u32 = 400_000;
    let mut family = Family::new();
    for oracle in oracles("P17_free_flight", "ff_") {
        let sigma = oracle.parameter("sigma_t") as f32;
        let length = oracle.parameter("length");
        let blob = holding(&matter([sigma; 3], [0.0; 3]));
        let scene = Scene::open(blob.bytes()).unwrap();
        let way = way(&scene, 0, ray([0.0; 3], [0.0, 0.6, 0.8], length));
        // The parameters are rounded.
        let depth = oracle.parameter("sigma_t") * length;
        let rounding = 2e-7 * depth.max(1.0);
        let mut random = Pcg::from_seed(11);
        let (mut through, mut mean) = (Moments::default(), Moments::default());
        for _ in 0..COUNT {
            let (flight, carried, _) = fly(&way, 0, &mut random);
            assert!(
                channels(carried.ratio)
                    .iter()
                    .all(|r| (r - 1.0).abs() < 1e-6)
            );
            let (t, arrived) = match flight {
                Flight::Collided(c) => (c.t as f64, 0.0),
                _ => (length, 1.0),
            };
            assert!(t >= 0.0 && t <= length * (1.0 + 1e-6));
            through.add(arrived);
            mean.add(t);
        }
        let id = oracle.id.as_str();
        if id.starts_with("ff_T") {
            let tau: Rgb = way.transmittance(&mut 0, &mut random);
            for tau in channels(tau) {
                assert!((tau / oracle.value - 1.0).abs() < rounding, "{id}: {tau}");
            }
            family.add(through.against(oracle.value, rounding), id);
            let expected = way.expected(1) as f64;
            assert!(
                (expected / oracle.value - 1.0).abs() < rounding,
                "{id}: {expected}"
            );
        } else if id.starts_with("ff_meanlen") {
            family.add(mean.against(oracle.value, rounding), id);
        } else {
            // Rare ones too: ξ has too few digits for them, were they not refined.
            family.add(poisson(&through, COUNT, oracle.value), id);
        }
    }
    family.judge();
}

/// The p-value of how many didn't get through.
fn poisson(through: &Moments, count: u32, probability: f64) -> f64 {
    let n = f64::from(count);
    let expected = [n * probability, n * (1.0 - probability)];
    let collided = ((1.0 - through.mean()) * n).round() as u64;
    chi_square(&[collided, u64::from(count) - collided], &expected)
}

/// Collisions at optical depth 1e-6: half a step of a single-precision ξ is 3 % of that. Of 2³¹ flights 2147 would collide; counted
/// are those with ξ in the lowest 2⁻¹² of its range, by a sampler that only draws there.
#[test]
fn what_is_rare_happens_as_often_as_it_should() {
    use super::kernel::random::{Purpose, Sampler, Subpath};
    struct Low(Pcg, bool);
    impl Sampler for Low {
        fn at(&mut self, _: Subpath, _: u32) {}
        fn one(&mut self, purpose: Purpose) -> Real {
            self.1 = !self.1;
            let xi = self.0.one(purpose);
            if self.1 {
                // As an even ξ would be, with as many digits.
                let step = super::kernel::real::UNIT_STEP;
                let steps = (1.0 / 4096.0) / step;
                (xi * steps).floor() * step
            } else {
                xi
            }
        }
    }
    const COUNT: u32 = 4_000_000;
    let blob = holding(&matter([1e-6; 3], [0.0; 3]));
    let scene = Scene::open(blob.bytes()).unwrap();
    let way = way(&scene, 0, ray([0.0; 3], [0.0, 0.0, 1.0], 1.0));
    let mut random = Low(Pcg::from_seed(12), false);
    let mut through = Moments::default();
    for _ in 0..COUNT {
        let (flight, ..) = fly(&way, 0, &mut random);
        assert!(!random.1, "two numbers a flight");
        through.add(f64::from(u8::from(matches!(flight, Flight::Through))));
    }
    let mut family = Family::new();
    family.add(poisson(&through, COUNT, 4096.0 * 1e-6), "collisions");
    family.judge();
}

/// By channel: the share that gets through is τ, collisions fall as σ_t·τ says, and no weight exceeds the number of channels.
#[test]
fn channels_are_combined_without_bias() {
    const COUNT: u32 = 300_000;
    let mut family = Family::new();
    for (i, sigma) in [
        [0.0, 1.0, 1000.0],
        [2.0, 1.0, 0.5],
        [1.0, 1.0, 1.0],
        [1e-6, 0.0, 0.0],
        [1e4, 30.0, 3.0],
    ]
    .into_iter()
    .enumerate()
    {
        let blob = holding(&matter(sigma, [0.0; 3]));
        let scene = Scene::open(blob.bytes()).unwrap();
        let length = 1.5;
        let way = way(&scene, 0, ray([0.0; 3], [1.0, 0.0, 0.0], length));
        let sigma = sigma.map(f64::from);
        let f = flights(&way, 20 + i as u64, COUNT, (0.0, length, 6), |_| sigma);
        assert!(f.largest < 3.0001, "{sigma:?}: a weight of {}", f.largest);
        for k in 0..3 {
            let tau = |t: f64| (-sigma[k] * t).exp();
            family.add(
                p_value(&f.through[k], COUNT, tau(length), 1e-5),
                format!("τ of {sigma:?}, channel {k}"),
            );
            for (bin, seen) in f.collided.iter().enumerate() {
                let [a, b] = [bin, bin + 1].map(|i| tau(length * i as f64 / 6.0));
                let p = p_value(&seen[k], COUNT, a - b, 1e-5);
                family.add(
                    p,
                    format!("collisions of {sigma:?}, channel {k}, part {bin}"),
                );
            }
        }
    }
    family.judge();
}

/// Two media in turn: what is carried over counts.
#[test]
fn what_is_carried_goes_on() {
    let mut both = matter([0.5, 1.0, 3.0], [0.0; 3]);
    both.media.extend(matter([4.0, 0.25, 0.0], [0.0; 3]).media);
    let blob = holding(&both);
    let scene = Scene::open(blob.bytes()).unwrap();
    let ways = [0, 1].map(|i| way(&scene, i, ray([0.0; 3], [1.0, 0.0, 0.0], 0.7)));
    let mut random = Pcg::from_seed(30);
    let mut through: [Moments; 3] = Default::default();
    for _ in 0..300_000 {
        let leading = lead(&mut random);
        let mut carried = FRESH;
        let mut arrived = true;
        for way in &ways {
            let flight = way.fly(
                leading,
                &mut carried,
                &mut super::kernel::Rgb::default(),
                &mut STEPS.clone(),
                &mut random,
            );
            arrived &= matches!(flight, Flight::Through);
            if !arrived {
                break;
            }
        }
        for (m, t) in through.iter_mut().zip(channels(carried.throughput)) {
            assert!(!arrived || t < 3.0001);
            m.add(if arrived { t } else { 0.0 });
        }
    }
    let mut family = Family::new();
    for (k, depth) in [4.5, 1.25, 3.0].into_iter().enumerate() {
        let truth = f64::exp(-0.7 * depth);
        family.add(through[k].against(truth, 1e-5), format!("channel {k}"));
    }
    family.judge();
}

/// The glow is exact whatever the flight does.
#[test]
fn the_glow_is_in_closed_form() {
    for (sigma, length) in [
        ([0.5, 2.0, 1e-3], 1.0),
        ([1e-6, 1e4, 1.0], 3.0),
        ([1e-12, 1e-9, 1e12], 1e-3),
        ([0.5, 2.0, 4.0], f64::INFINITY),
        ([1.0, 1e-12, 1.0], 1e-20),
    ] {
        let emission = [1.0, 10.0, 0.0];
        let blob = holding(&matter(sigma, emission));
        let scene = Scene::open(blob.bytes()).unwrap();
        let way = way(&scene, 0, ray([0.0; 3], [1.0, 0.0, 0.0], length));
        let mut random = Pcg::from_seed(31);
        for leading in [0, 1, 2, 0] {
            let (_, _, glow) = fly(&way, leading, &mut random);
            for (k, glow) in channels(glow).into_iter().enumerate() {
                let sigma = f64::from(sigma[k]);
                let truth = f64::from(emission[k]) * -(-sigma * length).exp_m1() / sigma;
                let off = (glow - truth).abs();
                assert!(
                    off <= 8.0 * Real::EPSILON as f64 * truth,
                    "{sigma} over {length}: {glow} for {truth}"
                );
            }
        }
    }
}
