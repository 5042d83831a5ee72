//! Local majorants: empty space costs no steps. How many a way takes is a Poisson variable of mean ∫ majorant.

use super::kernel::Scene;
use super::kernel::medium::{Carried, Flight};
use super::kernel::random::{Pcg, Purpose, Sampler};
use super::kernel::spectrum::{Rgb, Spectrum};
use super::ways::{FRESH, STEPS, ray, way};
use etendue::blob::format::{self, section};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::Medium;
use etendue_tests::media::{records, replaced};
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, grid};
use etendue_tests::statistics::{Family, normal};

const SIGMA: f32 = 20.0;

/// A puff of 4 × 4 × 4 in a grid of 32 × 32 × 32 texels, in the unit cube.
fn puff() -> AlignedBlob {
    let mut b = Builder::new();
    let within = |x: f32| (12.0..16.0).contains(&(32.0 * x));
    let value = |p: [f32; 3]| f32::from(u8::from(p.into_iter().all(within)));
    let smoke = Medium {
        sigma_t: [SIGMA, 0.5 * SIGMA, 0.1 * SIGMA],
        albedo: [0.5; 3],
        ..Medium::default()
    };
    let smoke = b.smoke([0.0; 3], [1.0; 3], grid([32; 3], value), smoke);
    b.fog([0.0; 3], [1.0; 3], smoke);
    blob(&b.description)
}

/// The same with one majorant for all.
fn with_one_majorant(of: &AlignedBlob) -> AlignedBlob {
    let mut words: Vec<u32> = records(of, section::TEXELS);
    let mut media: Vec<format::Medium> = records(of, section::MEDIA);
    media[0].cells = [1; 3];
    media[0].majorants = words.len() as u32;
    words.push((SIGMA * 1.0001).to_bits());
    let blob = replaced(of, section::TEXELS, &words);
    replaced(&blob, section::MEDIA, &media)
}

/// Rays through the cube: through any point of it into any direction.
fn rays() -> Vec<([f64; 3], [f64; 3])> {
    let mut random = Pcg::from_seed(40);
    let mut two = || random.two(Purpose::Direction).map(|x| x as f64);
    (0..300)
        .map(|_| {
            let ([x, y], [z, a], [b, _]) = (two(), two(), two());
            let (cos, phi) = (2.0 * a - 1.0, std::f64::consts::TAU * b);
            let sin = (1.0 - cos * cos).sqrt();
            let d = [sin * phi.cos(), sin * phi.sin(), cos];
            let from: [f64; 3] = std::array::from_fn(|i| [x, y, z][i] - 2.0 * d[i]);
            (from, d)
        })
        .collect()
}

/// ∫ majorant along a ray, by equal steps: an edge of a box is off by half a step at most, 1e-4, one way or the other.
fn expected(scene: &AlignedBlob, from: [f64; 3], d: [f64; 3]) -> f64 {
    let words: Vec<u32> = records(scene, section::TEXELS);
    let media: Vec<format::Medium> = records(scene, section::MEDIA);
    let m = &media[0];
    const PARTS: u32 = 20_000;
    let step = 4.0 / f64::from(PARTS);
    let mut sum = 0.0;
    for i in 0..PARTS {
        let t = (f64::from(i) + 0.5) * step;
        let p: [f64; 3] = std::array::from_fn(|a| from[a] + t * d[a]);
        if p.iter().all(|x| (0.0..1.0).contains(x)) {
            let [x, y, z] = std::array::from_fn(|a| (p[a] * f64::from(m.cells[a])) as u32);
            let index = m.majorants + (z * m.cells[1] + y) * m.cells[0] + x;
            sum += f64::from(f32::from_bits(words[index as usize])) * step;
        }
    }
    sum
}

#[test]
fn empty_space_costs_no_steps() {
    const REPEATS: u32 = 100;
    let local = puff();
    let global = with_one_majorant(&local);
    let mut family = Family::new();
    let mut means = Vec::new();
    for (name, bytes) in [("local", &local), ("one", &global)] {
        let scene = Scene::open(bytes.bytes()).unwrap();
        let mut random = Pcg::from_seed(41);
        let (mut taken, mut mean, mut free) = (0u32, 0.0, 0);
        for (from, d) in rays() {
            let way = way(&scene, 0, ray(from, d, 4.0));
            let rate = expected(bytes, from, d);
            let (mut here, mut flown) = (0, 0);
            for _ in 0..REPEATS {
                let mut left = STEPS;
                let _: Rgb = way.transmittance(&mut left, &mut random);
                here += STEPS - left;
                let mut left = STEPS;
                let mut carried: Carried<Rgb> = FRESH;
                let mut glow = Rgb::BLACK;
                let end = way.fly(0, &mut carried, &mut glow, &mut left, &mut random);
                assert!(!matches!(end, Flight::Cut));
                flown += STEPS - left;
            }
            if rate == 0.0 {
                free += 1;
                assert_eq!((here, flown), (0, 0), "{name}: {from:?} {d:?}");
            }
            taken += here;
            mean += rate * f64::from(REPEATS);
        }
        // Edges of boxes: 6e-3 of a step per ray at most, of any sign.
        let z = (f64::from(taken) - mean) / (mean.sqrt() + 2e-3 * mean);
        family.add(normal(z), format!("{name}: {taken} steps for {mean}"));
        means.push(mean);
        assert_eq!(
            free > 100,
            name == "local",
            "{name}: {free} rays meet nothing"
        );
    }
    family.judge();
    // 27 of 512 boxes have something in them, near the middle, where more rays pass.
    let saved = means[1] / means[0];
    assert!((10.0..19.0).contains(&saved), "{saved}");
}
