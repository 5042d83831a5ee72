//! The weights of all strategies of one path sum to 1, in both forms, and the forms agree.

use etendue::path::{Heuristic, History, HistoryView, Junction, Link, Mis, Terms};
use etendue::random::{Pcg, Purpose, Sampler};

/// A path as densities: what each walk would have, whoever makes it.
struct Path {
    /// p_L(z_i) and p_E(z_i) per area, except that `light[0]` is p_trace.
    light: Vec<f32>,
    sensor: Vec<f32>,
    /// Whether z_i scatters by a Dirac lobe.
    dirac: Vec<bool>,
    /// Whether a walk may happen on z_0.
    hittable: bool,
    /// p_connect/p_trace.
    connect: f32,
    light_paths: f32,
}

impl Path {
    fn random(rng: &mut Pcg, vertices: usize) -> Self {
        let mut number = |low: f32, high: f32| low * (high / low).powf(rng.one(Purpose::Position));
        let mut path = Self {
            light: (0..vertices).map(|_| number(1e-2, 1e2)).collect(),
            sensor: (0..vertices).map(|_| number(1e-2, 1e2)).collect(),
            dirac: vec![false; vertices],
            hittable: number(1.0, 4.0) > 1.3,
            connect: number(0.5, 2.0),
            light_paths: number(1.0, 1e3),
        };
        for i in 1..vertices - 1 {
            path.dirac[i] = number(1.0, 4.0) > 3.0;
        }
        path
    }

    fn joint(&self, i: usize) -> bool {
        i > 0 && !self.dirac[i - 1] && !self.dirac[i]
    }

    /// Whether strategy `s` exists: its connecting edge isn't Dirac, and s = 0 can happen.
    fn exists(&self, s: usize, capacity: usize) -> bool {
        if s == 0 {
            self.hittable
        } else {
            s <= capacity && self.joint(s)
        }
    }

    /// q_s up to a common factor, from the definition.
    fn q(&self, s: usize) -> f64 {
        let n = self.light.len();
        let mut q = 1.0f64;
        for i in 0..s {
            q *= f64::from(self.light[i]);
        }
        for i in s..n - 1 {
            q *= f64::from(self.sensor[i]);
        }
        if s == 1 && n > 2 {
            q *= f64::from(self.connect);
        }
        if s == n - 1 {
            q * f64::from(self.light_paths)
        } else {
            q
        }
    }

    /// The weight of strategy `s` as the kernel computes it. `back` is 1, so reverse densities per solid angle
    /// are those per area.
    fn weight<const N: usize>(&self, mis: &Mis, s: usize) -> f32 {
        let n = self.light.len();
        let t = n - s;
        // The light's side: x_0 … x_{s−1}.
        let mut x = Terms {
            forward: self.light[0],
            back: 0.0,
            a: if self.hittable { 1.0 } else { 0.0 },
            b: 0.0,
        };
        let mut links = vec![Link {
            forward: x.forward,
            reverse: 0.0,
            a: x.a,
            dirac: false,
        }];
        for i in 1..s {
            let (before, dirac) = (i - 1, self.dirac[i - 1]);
            // The way back at x_{i−1} leads to x_{i−2}.
            let reverse = if i >= 2 { self.sensor[i - 2] } else { 0.0 };
            x = mis.extend(&x, self.light[i], 1.0, reverse, dirac);
            if !dirac {
                x.a = if i == 1 { self.connect } else { 1.0 };
            }
            links[before].dirac = dirac;
            if i >= 2 {
                links[i - 2].reverse = reverse;
            }
            links.push(Link {
                forward: x.forward,
                reverse: 0.0,
                a: x.a,
                dirac: false,
            });
        }
        if s == 1 && n > 2 {
            // Drawn anew: its density is p_connect.
            x.forward = self.light[0] * self.connect;
            links[0].forward = x.forward;
        }
        // The sensor's side: y_1 = z_{n−2} …
        let mut y = Terms {
            forward: 1.0,
            back: 0.0,
            a: 0.0,
            b: 0.0,
        };
        let history: &mut HistoryView = &mut History::<N>::new();
        for i in 1..t {
            let z = n - 1 - i;
            let (dirac, reverse) = if i >= 2 {
                (
                    self.dirac[z + 1],
                    if i >= 3 { self.light[z + 2] } else { 0.0 },
                )
            } else {
                (false, 0.0)
            };
            y = mis.extend(&y, self.sensor[z], 1.0, reverse, dirac);
            if !dirac {
                y.a = if i == 1 { self.light_paths } else { 1.0 };
            }
            if let Some(last) = history.recent(0) {
                last.dirac = dirac;
            }
            if let Some(before) = history.recent(1) {
                before.reverse = reverse;
            }
            history.push(Link {
                forward: y.forward,
                reverse: 0.0,
                a: y.a,
                dirac: false,
            });
        }
        let connected = if s == 0 && t == 2 { 1.0 } else { self.connect };
        let junction = Junction {
            light_vertices: s,
            sensor_vertices: t,
            x_ratio: if s == 0 {
                0.0
            } else {
                self.sensor[s - 1] / x.forward / if t == 1 { self.light_paths } else { 1.0 }
            },
            x_reverse: if s >= 2 { self.sensor[s - 2] } else { 0.0 },
            y_ratio: match s {
                _ if t == 1 => 0.0,
                0 => self.light[0] * connected / y.forward,
                1 => self.light[1] / self.connect / y.forward,
                _ => self.light[s] / y.forward,
            },
            y_later: if s == 0 { 1.0 / connected } else { 1.0 },
            y_reverse: if t >= 3 { self.light[s + 1] } else { 0.0 },
        };
        let none = Terms::default();
        let (x, links) = if s == 0 {
            (&none, &[][..])
        } else {
            (&x, &links[..])
        };
        let y = if t == 1 { &none } else { &y };
        mis.weight(&junction, x, y, links, history)
    }
}

fn check<const N: usize>(seed: u64, heuristic: Heuristic) {
    let mut rng = Pcg::from_seed(seed);
    for round in 0..2000 {
        let vertices = 2 + (rng.one(Purpose::Choice) * 7.0) as usize;
        let path = Path::random(&mut rng, vertices);
        let mis = |explicit| Mis {
            heuristic,
            light_paths: path.light_paths,
            capacity: N,
            explicit,
        };
        let strategies: Vec<usize> = (0..vertices).filter(|&s| path.exists(s, N)).collect();
        if strategies.is_empty() {
            continue;
        }
        for explicit in [false, true] {
            let sum: f32 = strategies
                .iter()
                .map(|&s| path.weight::<N>(&mis(explicit), s))
                .sum();
            assert!(
                (sum - 1.0).abs() < 2e-4,
                "{heuristic:?} N = {N}, round {round}, explicit {explicit}: weights sum to {sum}"
            );
        }
        // Against the definition.
        let q: Vec<f64> = strategies.iter().map(|&s| path.q(s)).collect();
        let largest = q.iter().copied().fold(0.0, f64::max);
        for (&s, &own) in strategies.iter().zip(&q) {
            let expected = match heuristic {
                Heuristic::Balance => own / q.iter().sum::<f64>(),
                Heuristic::Power => own * own / q.iter().map(|q| q * q).sum::<f64>(),
                Heuristic::Maximum => f64::from(u8::from(own == largest)),
                Heuristic::Cutoff => {
                    let bar = 0.1 * largest;
                    if own < bar {
                        0.0
                    } else {
                        own / q.iter().filter(|&&q| q >= bar).sum::<f64>()
                    }
                }
            };
            for explicit in [false, true] {
                let w = f64::from(path.weight::<N>(&mis(explicit), s));
                assert!(
                    (w - expected).abs() < 1e-4,
                    "{heuristic:?} N = {N}, round {round}, s = {s} of {vertices}, explicit {explicit}: {w}, expected {expected}"
                );
            }
        }
    }
}

#[test]
fn weights_sum_to_one_in_both_forms() {
    for heuristic in [
        Heuristic::Balance,
        Heuristic::Power,
        Heuristic::Cutoff,
        Heuristic::Maximum,
    ] {
        check::<32>(1, heuristic);
        check::<3>(2, heuristic);
        check::<2>(3, heuristic);
    }
}
