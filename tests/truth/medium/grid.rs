//! Grids: every way of tracking against closed forms, against quadrature of the grid's own formula, and against each other.

use super::kernel::Scene;
use super::kernel::medium::{Flight, Way};
use super::kernel::random::{Pcg, Purpose, Sampler};
use super::kernel::spectrum::Rgb;
use super::ways::{STEPS, back, channels, flights, fly, holding, p_value, ray, way};
use etendue::blob::format::{Grid, medium};
use etendue_tests::media::{Matter, homogeneous};
use etendue_tests::oracles::{Oracle, oracles};
use etendue_tests::statistics::{Family, Moments};

/// How to track.
const FLAGS: [(&str, u32); 3] = [
    ("ratio", 0),
    ("residual", medium::RESIDUAL),
    ("regular", medium::REGULAR),
];

/// A mean of transmittances by channel.
fn transmittance(way: &Way<'_, '_, Rgb>, seed: u64, count: u32) -> [Moments; 3] {
    let mut random = Pcg::from_seed(seed);
    let mut moments: [Moments; 3] = Default::default();
    for _ in 0..count {
        let tau: Rgb = way.transmittance(&mut STEPS.clone(), &mut random);
        for (m, tau) in moments.iter_mut().zip(channels(tau)) {
            m.add(tau);
        }
    }
    moments
}

/// σ_t of an oracle at s, and where it ends.
fn profile(oracle: &Oracle) -> (Box<dyn Fn(f64) -> f64>, f64) {
    let [s0, k, length] = ["s0", "k", "length"].map(|name| oracle.parameter(name));
    if oracle.id.starts_with("linear") {
        (Box::new(move |s| s0 + k * s), length)
    } else {
        let length = if length < 0.0 { 20.0 / k } else { length };
        (Box::new(move |s| s0 * f64::exp(-k * s)), length)
    }
}

/// The oracles' media as grids, and for each its flags' index.
#[test]
fn transmittance_meets_the_oracles() {
    const COUNT: u32 = 30_000;
    const TEXELS: u32 = 2048;
    let mut family = Family::new();
    for (i, oracle) in oracles("P18_heterogeneous_transmittance", "")
        .iter()
        .enumerate()
    {
        let mut matter = Matter::default();
        let layers = oracle.id.starts_with("layers");
        let (grid, length, scale) = if layers {
            let n = oracle.parameter("layers") as u32;
            let [first, step, length] = ["first", "step", "length"].map(|p| oracle.parameter(p));
            let value = |x: u32| first + step * f64::from(x);
            (
                matter.grid([n, 1, 1], true, |[x, ..]| [value(x) as f32]),
                length,
                1.0,
            )
        } else {
            // From the first texel's centre to the last one's; the half cells beyond are outside the way.
            let (sigma, length) = profile(oracle);
            let value = |x: u32| sigma(length * f64::from(x) / f64::from(TEXELS - 1));
            let grid = matter.grid([TEXELS, 1, 1], false, |[x, ..]| [value(x) as f32]);
            (grid, length, f64::from(TEXELS - 1) / f64::from(TEXELS))
        };
        let cells = matter.grids[grid as usize].size[0].min(32);
        for (_, flags) in FLAGS {
            let index = matter.gridded(grid, [1.0; 3], [0.5; 3], [cells, 1, 1]);
            matter.media[index].flags = flags;
            let [x, ..] = &mut matter.media[index].to_grid;
            (x[0], x[3]) = ((scale / length) as f32, (0.5 * (1.0 - scale)) as f32);
        }
        let blob = holding(&matter);
        let scene = Scene::open(blob.bytes()).unwrap();
        // Linear between texels rather than curved: h²k²/12 of the optical depth.
        let rounding = if layers { 2e-6 } else { 1e-4 };
        for (j, (name, _)) in FLAGS.iter().enumerate() {
            let there = way(&scene, j, ray([0.0, 0.5, 0.5], [1.0, 0.0, 0.0], length));
            for (way, sense) in [(back(&there), "back"), (there, "there")] {
                let id = format!("{}, {name}, {sense}", oracle.id);
                if *name == "regular" {
                    let tau = channels(way.transmittance(&mut 0, &mut Pcg::from_seed(0)))[0];
                    assert!((tau / oracle.value - 1.0).abs() < rounding, "{id}: {tau}");
                } else {
                    let tau = transmittance(&way, 40 + i as u64, COUNT)[0];
                    family.add(tau.against(oracle.value, rounding), &id);
                }
                let mut random = Pcg::from_seed(60 + i as u64);
                let mut through = Moments::default();
                // Through all cells one by one: slow, and the same but for the last of them.
                let count = if *name == "regular" {
                    COUNT / 10
                } else {
                    COUNT
                };
                for _ in 0..count {
                    let (flight, ..) = fly(&way, 0, &mut random);
                    through.add(f64::from(u8::from(matches!(flight, Flight::Through))));
                }
                family.add(
                    through.against(oracle.value, rounding),
                    format!("{id}, flights"),
                );
            }
        }
    }
    family.judge();
}

/// A grid's value by its own formula, in double precision.
fn look(matter: &Matter, grid: &Grid, u: [f64; 3], channel: usize) -> f64 {
    let axis = |u: f64, n: u32| {
        let last = f64::from(n - 1);
        if grid.nearest == 1 {
            let i = (u * f64::from(n)).floor().clamp(0.0, last);
            [(i as u32, 1.0), (i as u32, 0.0)]
        } else {
            let x = (u * f64::from(n) - 0.5).clamp(0.0, last);
            let low = x.floor();
            [
                (low as u32, 1.0 + low - x),
                ((low + 1.0).min(last) as u32, x - low),
            ]
        }
    };
    let [xs, ys, zs] = std::array::from_fn(|a| axis(u[a], grid.size[a]));
    let mut sum = 0.0;
    for (k, c) in zs {
        for (j, b) in ys {
            for (i, a) in xs {
                sum += a * b * c * f64::from(matter.texel(grid, [i, j, k], channel));
            }
        }
    }
    sum
}

/// What the world's points are in the cube: not its unit cube.
const TO_GRID: [[f32; 4]; 3] = [
    [0.25, 0.125, 0.0, 0.5],
    [-0.125, 0.25, 0.0625, 0.375],
    [0.0, -0.0625, 0.25, 0.5],
];

/// A cloud: grids of several sizes, of one and of three channels, nearest and trilinear, with empty space.
struct Cloud {
    matter: Matter,
    names: Vec<String>,
}

fn cloud() -> Cloud {
    let mut random = Pcg::from_seed(70);
    let mut numbers = || random.one(Purpose::Flight) as f32;
    let mut matter = Matter::default();
    let mut names = Vec::new();
    let values: Vec<f32> = (0..3 * 6 * 5 * 4)
        .map(|i| if i % 7 < 3 { 0.0 } else { 4.0 * numbers() })
        .collect();
    let at = |[x, y, z]: [u32; 3]| 3 * ((z * 5 + y) * 6 + x) as usize;
    let albedos = matter.grid([2, 2, 2], false, |[x, y, z]| {
        [0.25 * x as f32, 0.5 * y as f32, 0.9 * z as f32]
    });
    let emissions = matter.grid([3, 1, 7], false, |[x, _, z]| {
        [x as f32, 0.5, 0.1 * z as f32]
    });
    for nearest in [false, true] {
        let one = matter.grid([6, 5, 4], nearest, |i| {
            [if i[0] < 2 { 0.0 } else { values[at(i)] }]
        });
        let three = matter.grid([6, 5, 4], nearest, |i| {
            let v = &values[at(i)..];
            [v[0], v[1], v[2]]
        });
        for (grid, sigma_t, what) in [
            (one, [1.0; 3], "one"),
            (one, [0.0, 0.5, 3.0], "one, coloured"),
            (three, [0.25, 1.0, 2.0], "three"),
        ] {
            for (name, flags) in FLAGS {
                if what != "one" && flags == medium::RESIDUAL {
                    continue;
                }
                let index = matter.gridded(grid, sigma_t, [0.9, 0.5, 1.0], [3, 5, 2]);
                let m = &mut matter.media[index];
                (m.flags, m.to_grid) = (flags, TO_GRID);
                (m.albedos, m.emissions) = (albedos, emissions);
                // Where nothing is absorbed, nothing may be emitted.
                let emits = |k: usize| {
                    if sigma_t[k] > 0.0 {
                        [2.0, 1.0, 0.5][k]
                    } else {
                        0.0
                    }
                };
                m.emission = std::array::from_fn(emits);
                let kind = if nearest { "nearest" } else { "trilinear" };
                names.push(format!("{what}, {kind}, {name}"));
            }
        }
    }
    Cloud { matter, names }
}

/// Ways from within the cube, from outside, along an axis of it, and past it.
fn rays() -> Vec<super::kernel::shape::Ray> {
    vec![
        ray([0.1, 0.2, 0.3], [0.3, -0.5, 0.8], 3.0),
        ray([-6.0, 1.0, -4.0], [1.0, 0.0, 0.6], 40.0),
        ray([5.0, 5.0, 5.0], [-1.0, -1.0, -1.0], f64::INFINITY),
        ray([0.3, 0.3, -3.0], [0.0, 0.0, 1.0], 3.5),
        ray([9.0, 0.0, 0.0], [0.0, 1.0, 0.0], 9.0),
    ]
}

impl Cloud {
    /// σ_t, and E at a point of a way.
    fn at(
        &self,
        index: usize,
        r: &super::kernel::shape::Ray,
        t: f64,
    ) -> ([f64; 3], [f64; 3], [f64; 3]) {
        let m = &self.matter.media[index];
        let [o, d] = [r.origin, r.direction].map(|v| v.to_array().map(|x| x as f64));
        let u: [f64; 3] = m.to_grid.map(|row| {
            let row = row.map(f64::from);
            (0..3).map(|i| row[i] * (o[i] + t * d[i])).sum::<f64>() + row[3]
        });
        if u.iter().any(|u| !(0.0..=1.0).contains(u)) {
            return Default::default();
        }
        let grid = |id: u32, k| look(&self.matter, &self.matter.grids[id as usize], u, k);
        let sigma = std::array::from_fn(|k| f64::from(m.sigma_t[k]) * grid(m.extinctions, k));
        let scattering =
            std::array::from_fn(|k| sigma[k] * f64::from(m.albedo[k]) * grid(m.albedos, k));
        let emission = std::array::from_fn(|k| {
            if sigma[k] > 0.0 {
                f64::from(m.emission[k]) * grid(m.emissions, k)
            } else {
                0.0
            }
        });
        (sigma, scattering, emission)
    }

    /// Where along a way a plane of cells of some grid is passed, between 0 and `end`, in order, with `parts` equal steps.
    fn edges(
        &self,
        index: usize,
        r: &super::kernel::shape::Ray,
        end: f64,
        parts: usize,
    ) -> Vec<f64> {
        let m = &self.matter.media[index];
        let [o, d] = [r.origin, r.direction].map(|v| v.to_array().map(|x| x as f64));
        let mut edges: Vec<f64> = (0..=parts).map(|i| end * i as f64 / parts as f64).collect();
        for (axis, row) in m.to_grid.iter().enumerate() {
            let row = row.map(f64::from);
            let u: f64 = (0..3).map(|i| row[i] * o[i]).sum::<f64>() + row[3];
            let du: f64 = (0..3).map(|i| row[i] * d[i]).sum();
            for id in [m.extinctions, m.albedos, m.emissions] {
                let n = self.matter.grids[id as usize].size[axis];
                for half in 0..=2 * n {
                    edges.push((f64::from(half) / f64::from(2 * n) - u) / du);
                }
            }
        }
        edges.retain(|t| (0.0..=end).contains(t));
        edges.sort_by(f64::total_cmp);
        edges
    }

    /// τ up to each of `parts` equal steps of a way, and ∫E·τ over all of it: the midpoint rule between edges.
    fn quadrature(
        &self,
        index: usize,
        r: &super::kernel::shape::Ray,
        end: f64,
        parts: usize,
    ) -> (Vec<[f64; 3]>, [f64; 3]) {
        const FINE: usize = 100;
        let (mut depth, mut glow) = ([0.0; 3], [0.0; 3]);
        let mut taus = Vec::new();
        let edges = self.edges(index, r, end, parts);
        for pair in edges.windows(2) {
            while taus.len() as f64 * end / parts as f64 <= pair[0] {
                taus.push(depth.map(|d| f64::exp(-d)));
            }
            let h = (pair[1] - pair[0]) / FINE as f64;
            for i in 0..FINE {
                let (sigma, _, emission) = self.at(index, r, pair[0] + (i as f64 + 0.5) * h);
                for k in 0..3 {
                    glow[k] += h * emission[k] * f64::exp(-depth[k] - 0.5 * h * sigma[k]);
                    depth[k] += h * sigma[k];
                }
            }
        }
        taus.resize(parts + 1, depth.map(|d| f64::exp(-d)));
        (taus, glow)
    }
}

/// τ, where walks collide, and the glow: by channel, against quadrature.
#[test]
fn tracking_meets_quadrature() {
    const COUNT: u32 = 40_000;
    const PARTS: usize = 5;
    let cloud = cloud();
    let blob = holding(&cloud.matter);
    let scene = Scene::open(blob.bytes()).unwrap();
    let mut family = Family::new();
    for (index, name) in cloud.names.iter().enumerate() {
        for (j, r) in rays().into_iter().enumerate() {
            let way = way(&scene, index, r);
            let end = if j == 2 { 20.0 } else { r.t_max as f64 };
            let (taus, glow) = cloud.quadrature(index, &r, end, PARTS);
            let name = format!("{name}, way {j}");
            // What the quadrature leaves, and rounding of where cells begin.
            let rounding = 1e-4;
            let tau = transmittance(&way, 71, if name.contains("regular") { 2 } else { COUNT });
            let f = flights(&way, 72 + j as u64, COUNT, (0.0, end, PARTS), |t| {
                cloud.at(index, &r, t).0
            });
            assert!(f.largest < 3.001, "{name}: a weight of {}", f.largest);
            for k in 0..3 {
                let truth = taus[PARTS][k];
                if name.contains("regular") {
                    let tau = tau[k].mean();
                    assert!(
                        (tau - truth).abs() < rounding * truth,
                        "{name}: {tau} for {truth}"
                    );
                } else {
                    family.add(
                        // Little gets through, and that by chance all or none.
                        p_value(&tau[k], COUNT, truth, rounding),
                        format!("{name}: τ, channel {k}"),
                    );
                }
                family.add(
                    p_value(&f.through[k], COUNT, truth, rounding),
                    format!("{name}: through, channel {k}"),
                );
                family.add(
                    p_value(&f.glow[k], COUNT, glow[k], rounding),
                    format!("{name}: glow, channel {k}"),
                );
                for part in 0..PARTS {
                    let share = taus[part][k] - taus[part + 1][k];
                    let p = p_value(&f.collided[part][k], COUNT, share, rounding);
                    family.add(p, format!("{name}: collisions in {part}, channel {k}"));
                }
            }
        }
    }
    family.judge();
}

/// What a collision says of its place.
#[test]
fn collisions_know_their_place() {
    let cloud = cloud();
    let blob = holding(&cloud.matter);
    let scene = Scene::open(blob.bytes()).unwrap();
    let mut collisions = 0;
    for (index, name) in cloud
        .names
        .iter()
        .enumerate()
        .filter(|(_, name)| name.contains("trilinear"))
    {
        for r in rays() {
            let way = way(&scene, index, r);
            let mut random = Pcg::from_seed(73);
            for _ in 0..50 {
                let (Flight::Collided(c), carried, _) = fly(&way, 2, &mut random) else {
                    continue;
                };
                let (_, scattering, emission) = cloud.at(index, &r, c.t as f64);
                for k in 0..3 {
                    let pairs = [(scattering, c.scattering), (emission, c.emission)];
                    for (truth, seen) in pairs.map(|(t, s)| (t[k], channels(s)[k])) {
                        assert!(
                            (truth - seen).abs() < 1e-5 * truth.max(1.0),
                            "{name}: {seen} for {truth}"
                        );
                    }
                }
                let x = r.origin + r.direction * c.t;
                let (_, emission) = super::kernel::medium::matter(way.scene, way.medium, x);
                for (a, b) in channels(emission).into_iter().zip(channels(c.emission)) {
                    assert!(
                        (a - b).abs() < 1e-5 * a.max(1.0),
                        "{name}: {a} at the point, {b} on the way"
                    );
                }
                assert!(channels(carried.ratio).iter().all(|r| *r <= 3.0001));
                collisions += 1;
            }
        }
    }
    assert!(collisions > 500, "{collisions}");
}

/// A grid of one value is the medium that is the same everywhere, as far as its cube reaches.
#[test]
fn a_constant_grid_is_homogeneous() {
    const COUNT: u32 = 100_000;
    let (sigma, albedo) = ([2.0, 0.5, 0.0], [0.5, 1.0, 0.25]);
    let emission = [1.0, 0.0, 0.0];
    let mut matter = Matter::default();
    let grid = matter.grid([4, 3, 2], false, |_| [0.5]);
    for (_, flags) in FLAGS {
        let index = matter.gridded(grid, sigma.map(|s| 2.0 * s), albedo, [2, 2, 2]);
        matter.media[index].flags = flags;
        matter.media[index].emission = emission;
        matter.media[index].mean = sigma;
    }
    let mut same = homogeneous(sigma, albedo);
    same.emission = emission;
    matter.media.push(same);
    // And residual tracking, for which extinction has one channel.
    let index = matter.gridded(grid, [4.0; 3], albedo, [2, 2, 2]);
    matter.media[index].flags = medium::RESIDUAL;
    matter.media[1].flags = 0;
    let blob = holding(&matter);
    let scene = Scene::open(blob.bytes()).unwrap();
    let r = ray([0.1, 0.2, 0.0], [0.0, 0.6, 0.8], 0.9);
    let ways: Vec<_> = (0..5).map(|i| way(&scene, i, r)).collect();
    let truth = channels(ways[3].transmittance(&mut 0, &mut Pcg::from_seed(0)));
    let mut family = Family::new();
    let all: Vec<_> = ways[..4]
        .iter()
        .map(|way| flights(way, 80, COUNT, (0.0, 0.9, 4), |_| sigma.map(f64::from)))
        .collect();
    for (i, f) in all[..3].iter().enumerate() {
        let tau = transmittance(&ways[i], 81, COUNT);
        for k in 0..3 {
            family.add(
                tau[k].against(truth[k], 1e-5),
                format!("τ {i}, channel {k}"),
            );
            family.add(
                f.through[k].same_as(&all[3].through[k], 1e-5),
                format!("through {i}, channel {k}"),
            );
            family.add(
                f.glow[k].same_as(&all[3].glow[k], 1e-5),
                format!("glow {i}, channel {k}"),
            );
            for part in 0..4 {
                let p = f.collided[part][k].same_as(&all[3].collided[part][k], 1e-5);
                family.add(p, format!("collisions {i}, part {part}, channel {k}"));
            }
        }
        for k in 0..3 {
            let [a, b] = [ways[i].expected(k), ways[3].expected(k)].map(|x| x as f64);
            assert!((a - b).abs() < 1e-6, "{a}, {b}");
            let back = back(&ways[i]).expected(k) as f64;
            assert!((a - back).abs() < 1e-6, "{a}, back {back}");
        }
    }
    family.judge();
    // Where the control is the extinction itself, residual tracking is exact.
    let tau = transmittance(&ways[4], 82, 100);
    let truth = f64::exp(-2.0 * 0.9);
    assert!(tau[0].variance() < 1e-12 && (tau[0].mean() / truth - 1.0).abs() < 1e-5);
}

/// Optical depths 1e-6 and 1e4, thin and thick texels side by side.
#[test]
fn thin_and_thick_grids() {
    const COUNT: u32 = 100_000;
    let mut family = Family::new();
    for (i, scale) in [1e-6f32, 1e4].into_iter().enumerate() {
        let mut matter = Matter::default();
        let grid = matter.grid([8, 1, 1], true, |[x, ..]| [if x == 3 { 1.0 } else { 0.0 }]);
        for (_, flags) in FLAGS {
            let index = matter.gridded(grid, [8.0 * scale; 3], [1.0; 3], [8, 1, 1]);
            matter.media[index].flags = flags;
        }
        let blob = holding(&matter);
        let scene = Scene::open(blob.bytes()).unwrap();
        for (j, (name, _)) in FLAGS.iter().enumerate() {
            let way = way(&scene, j, ray([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], 3.0));
            let truth = f64::exp(-f64::from(scale));
            let tau = transmittance(&way, 90 + i as u64, 100);
            assert!(
                (tau[1].mean() - truth).abs() < 1e-5,
                "{name} {scale}: {}",
                tau[1].mean()
            );
            let f = flights(&way, 92 + i as u64, COUNT, (1.375, 1.5, 1), |_| {
                [8.0 * f64::from(scale); 3]
            });
            let p = p_value(&f.through[0], COUNT, truth, 1e-6);
            family.add(p, format!("{name} {scale}"));
            let seen = f.collided[0][0];
            if scale > 1.0 {
                assert!((seen.mean() - 1.0).abs() < 1e-3, "{name}: {}", seen.mean());
            }
        }
    }
    family.judge();
}
