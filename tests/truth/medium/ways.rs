//! Ways through media, and what flights along them say.

use super::kernel::Scene;
use super::kernel::blob::View;
use super::kernel::medium::{Carried, Flight, Way};
use super::kernel::random::{Pcg, Purpose, Sampler, Subpath};
use super::kernel::real::{Real, Vec3};
use super::kernel::shape::Ray;
use super::kernel::spectrum::{Rgb, Spectrum};
use etendue_host::blob::AlignedBlob;
use etendue_tests::media::Matter;
use etendue_tests::render::blob;
use etendue_tests::scenes::room;
use etendue_tests::statistics::{Moments, normal};

/// A scene that holds `matter`.
pub fn holding(matter: &Matter) -> AlignedBlob {
    matter.put_into(&blob(&room(|_| ()).description))
}

pub fn ray(origin: [f64; 3], direction: [f64; 3], t_max: f64) -> Ray {
    let v = |a: [f64; 3]| Vec3::from_array(a.map(|x| x as Real));
    Ray {
        origin: v(origin),
        direction: v(direction).normalize(),
        t_min: 0.0,
        t_max: t_max as Real,
    }
}

/// The way along `ray` through the scene's medium `index`.
pub fn way<'s, 'a>(scene: &'s Scene<'a>, index: usize, ray: Ray) -> Way<'s, 'a, Rgb> {
    Way {
        scene: View::new(scene, ()),
        medium: &scene.media()[index],
        ray,
    }
}

/// The same way from its other end.
pub fn back<'s, 'a>(way: &Way<'s, 'a, Rgb>) -> Way<'s, 'a, Rgb> {
    let r = way.ray;
    Way {
        ray: Ray {
            origin: r.origin + r.direction * r.t_max,
            direction: -r.direction,
            ..r
        },
        ..*way
    }
}

pub const STEPS: u32 = 1_000_000;

/// What a walk starts with.
pub const FRESH: Carried<Rgb> = Carried {
    throughput: Rgb::WHITE,
    ratio: Rgb::WHITE,
};

/// One flight: how it ended, what was carried then, and the glow.
pub fn fly(
    way: &Way<'_, '_, Rgb>,
    lead: usize,
    random: &mut impl Sampler,
) -> (Flight<Rgb>, Carried<Rgb>, Rgb) {
    let (mut carried, mut glow, mut steps) = (FRESH, Rgb::BLACK, STEPS);
    let flight = way.fly(lead, &mut carried, &mut glow, &mut steps, random);
    (flight, carried, glow)
}

/// Which channel leads.
pub fn lead(random: &mut Pcg) -> usize {
    (random.one(Purpose::Lead) as f64 * 3.0) as usize
}

pub fn channels(s: Rgb) -> [f64; 3] {
    s.to_array().map(|x| x as f64)
}

/// What many flights say of a way, by channel, led by channels drawn uniformly: the throughput of those that got through, the
/// probability (σ_t·throughput) of collisions in each of `bins` equal parts, the glow; and the largest of the weights.
pub struct Flights {
    pub through: [Moments; 3],
    pub collided: Vec<[Moments; 3]>,
    pub glow: [Moments; 3],
    pub largest: f64,
}

/// `start` and `end` say where the bins are; `extinction` is σ_t at t.
pub fn flights(
    way: &Way<'_, '_, Rgb>,
    seed: u64,
    count: u32,
    (start, end, bins): (f64, f64, usize),
    extinction: impl Fn(f64) -> [f64; 3],
) -> Flights {
    let mut f = Flights {
        through: Default::default(),
        collided: vec![Default::default(); bins],
        glow: Default::default(),
        largest: 0.0,
    };
    let mut random = Pcg::from_seed(seed);
    for _ in 0..count {
        let leading = lead(&mut random);
        let (flight, carried, glow) = fly(way, leading, &mut random);
        let throughput = channels(carried.throughput);
        let mean = channels(carried.ratio).iter().sum::<f64>() / 3.0;
        assert!((mean - 1.0).abs() < 1e-5, "the mean ratio is {mean}");
        let (mut through, mut place) = ([0.0; 3], None);
        match flight {
            Flight::Through => through = throughput,
            Flight::Collided(c) => {
                let t = c.t as f64;
                let sigma = extinction(t);
                let weight = std::array::from_fn(|k| throughput[k] * sigma[k]);
                let bin = ((t - start) / (end - start) * bins as f64) as usize;
                place = Some((bin.min(bins - 1), weight));
            }
            Flight::Cut => panic!("cut"),
        }
        for k in 0..3 {
            f.through[k].add(through[k]);
            f.glow[k].add(channels(glow)[k]);
            f.largest = f.largest.max(through[k]);
            for (i, bin) in f.collided.iter_mut().enumerate() {
                let weight: f64 = place
                    .filter(|p| p.0 == i)
                    .map_or(0.0, |p: (usize, [f64; 3])| p.1[k]);
                bin[k].add(weight);
                f.largest = f.largest.max(weight);
            }
        }
    }
    f
}

/// The p-value of a mean of `count` weights, of which `rounding` (relative) is nobody's fault. What hardly ever happens isn't
/// normal: three events of weight 3 are nobody's fault either, and the variance is the largest that weights up to 3 can have.
pub fn p_value(seen: &Moments, count: u32, truth: f64, rounding: f64) -> f64 {
    let count = f64::from(count);
    let off = (seen.mean() - truth).abs();
    if off < 10.0 / count {
        1.0
    } else if truth < 1e-2 {
        normal((off - rounding * truth).max(0.0) / (3.0 * truth / count).sqrt())
    } else {
        seen.against(truth, rounding)
    }
}

/// Always the same number.
pub struct Fixed(pub Real);

impl Sampler for Fixed {
    fn at(&mut self, _: Subpath, _: u32) {}
    fn one(&mut self, _: Purpose) -> Real {
        self.0
    }
}
