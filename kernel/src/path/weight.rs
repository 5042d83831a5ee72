//! Multiple importance sampling over all strategies (s, t) of a path, in two forms.
//!
//! With q_s = n_s·p_s and z₀ … z_k the path from light to sensor, neighbours differ by one vertex:
//!
//! ```text
//! q_{s+1}/q_s = p_L(z_s)/p_E(z_s)            p_L: density by the walk from the light, p_E: from the sensor
//! ```
//!
//! (Veach 1997, §10.2.1), except where x₀ is drawn anew: s = 1 has p_connect(x₀ | x₁) in place of p_trace(x₀)
//! (Georgiev 2012), and t = 1 has n = the number of light walks per sensor walk.
//!
//! **(a) Running sums**, for balance (β = 1) and power (β = 2). Let W_i be the sum of (q/q_now)^β over all
//! strategies with fewer vertices of this walk than now, z_i being its latest vertex:
//!
//! ```text
//! W_i = r_i^β·(v_i + r_{i−1}^β·(v_{i−1} + …))            r_i = p_other(z_i)/p_forward(z_i)
//! ```
//!
//! where v_i is 1 if the edge z_{i−1} z_i can be made by a connection, else 0 (and carries the exceptions above). r_i is known once the other walk is;
//! r_{i−1} = pdf_reverse(z_i → z_{i−1})·back_i/p_forward(z_{i−1}) once the direction at z_i is. So a vertex keeps
//!
//! ```text
//! a_i = v_i        b_i = (back_i/p_forward(z_{i−1}))^β·(a_{i−1} + pdf_reverse(z_{i−1})^β·b_{i−1})
//! W_i = r_i^β·(a_i + pdf_reverse(z_i)^β·b_i)
//! ```
//!
//! These are Georgiev's dVCM and dVC, divided by p_forward so that every factor is a ratio of densities of
//! the same vertex: nothing leaves the range of single precision at any scale of the scene.
//!
//! **(b) The ratio walk** visits the strategies one by one: for every heuristic, and where strategies
//! with more light vertices than the storage has (s > N, p = 0) must be left out.

use super::history::{HistoryView, Link};
use crate::real::{Real, square};

/// How strategies share a path (Veach 1997, §9.2.2–9.2.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heuristic {
    /// q_i/Σq.
    Balance,
    /// q_i²/Σq².
    #[default]
    Power,
    /// Balance among those with q ≥ [`CUTOFF`]·q_max.
    Cutoff,
    /// All to the largest; ties to the lowest number of light vertices.
    Maximum,
}

/// α of the cutoff heuristic.
pub const CUTOFF: Real = 0.1;

/// The heuristic, and what all weights of one estimate have in common.
#[derive(Clone, Copy, Debug)]
pub struct Mis {
    /// Which heuristic.
    pub heuristic: Heuristic,
    /// n of the strategies with t = 1 per sensor walk; 0 if they don't exist.
    pub light_paths: Real,
    /// N, the most vertices that a light walk keeps: strategies with more don't exist.
    pub capacity: usize,
    /// Always the ratio walk: for tests.
    pub explicit: bool,
}

/// The ends of a connection, as the weights see them: x is the light walk's latest vertex, y the sensor walk's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Junction {
    /// s, the vertices on the light's side.
    pub light_vertices: usize,
    /// t, the vertices on the sensor's side.
    pub sensor_vertices: usize,
    /// p_E(x)/p_forward(x); with t = 1 also over n.
    pub x_ratio: Real,
    /// Density per solid angle of the sensor's walk going on from x to the vertex before it.
    pub x_reverse: Real,
    /// p_L(y)/p_forward(y), for the strategy with one light vertex more.
    pub y_ratio: Real,
    /// What p_L(y) must be multiplied by for all strategies after that one: p_trace/p_connect if y itself is x₀ (s = 0), else 1.
    pub y_later: Real,
    /// Density per solid angle of the light's walk going on from y to the vertex before it.
    pub y_reverse: Real,
}

/// What a vertex keeps for the running sums.
#[derive(Clone, Copy, Debug, Default)]
pub struct Terms {
    /// Density of the vertex by its own walk.
    pub forward: Real,
    /// |cos|/d² that turns a density per solid angle here into one per area at the previous vertex
    /// (without d², or 1, at infinity).
    pub back: Real,
    /// a_i before it is raised to β: n of the strategy that joins the edge before this vertex, relative to
    /// its neighbours'; 0 if that edge can't be joined.
    pub a: Real,
    /// b_i.
    pub b: Real,
}

impl Mis {
    /// x^β.
    #[inline(always)]
    fn power(&self, x: Real) -> Real {
        if matches!(self.heuristic, Heuristic::Power) {
            square(x)
        } else {
            x
        }
    }

    /// The terms of the vertex after one with terms `from`, reached with density `forward` by a step
    /// whose way back has density `pdf_reverse`.
    #[inline(always)]
    pub fn extend(
        &self,
        from: &Terms,
        forward: Real,
        back: Real,
        pdf_reverse: Real,
        dirac: bool,
    ) -> Terms {
        let a = if dirac { 0.0 } else { self.power(from.a) };
        let b = self.power(back / from.forward) * (a + self.power(pdf_reverse) * from.b);
        Terms {
            forward,
            back,
            a: if dirac { 0.0 } else { 1.0 },
            b: if b.is_finite() { b } else { 0.0 },
        }
    }

    /// The weight of a junction. `x` and `y` are the terms of its ends; `light` and `sensor` the
    /// links of both walks, latest last, for the ratio walk.
    #[inline(always)]
    pub fn weight(
        &self,
        j: &Junction,
        x: &Terms,
        y: &Terms,
        light: &[Link],
        sensor: &HistoryView,
    ) -> Real {
        let long = j.light_vertices + j.sensor_vertices > self.capacity + 1;
        if long || self.explicit || matches!(self.heuristic, Heuristic::Cutoff | Heuristic::Maximum)
        {
            return self.ratio_walk(j, x, y, light, sensor);
        }
        let w_light = self.power(j.x_ratio) * (self.power(x.a) + self.power(j.x_reverse) * x.b);
        let w_sensor =
            self.power(j.y_ratio) * (self.power(y.a) + self.power(j.y_later * j.y_reverse) * y.b);
        // An overflow means that other strategies are infinitely better.
        1.0 / (1.0 + w_light + w_sensor)
    }

    /// Form (b): visits every other strategy with its q relative to this one's.
    #[inline(never)]
    fn ratio_walk(
        &self,
        j: &Junction,
        x: &Terms,
        y: &Terms,
        light: &[Link],
        sensor: &HistoryView,
    ) -> Real {
        let visit = |f: &mut Others| {
            // Towards the light: the strategy with i light vertices joins the edge before x_i.
            let mut q = 1.0;
            let used = light.get(..j.light_vertices).unwrap_or(light);
            for (back, (i, link)) in used.iter().enumerate().rev().enumerate() {
                q *= match back {
                    0 => j.x_ratio,
                    1 => j.x_reverse * x.back / link.forward,
                    _ => link.reverse / link.forward,
                };
                let joint = back == 0 || !link.dirac;
                f.see(if joint { q * link.a } else { 0.0 }, i);
            }
            // Towards the sensor: the strategy with one light vertex more joins the edge before y.
            let mut q = 1.0;
            for (back, link) in sensor.backwards().enumerate() {
                let s = j.light_vertices + back + 1;
                if s > self.capacity {
                    break;
                }
                q *= match back {
                    0 => j.y_ratio,
                    1 => j.y_later * j.y_reverse * y.back / link.forward,
                    _ => link.reverse / link.forward,
                };
                let joint = back == 0 || !link.dirac;
                f.see(if joint { q * link.a } else { 0.0 }, s);
            }
        };
        let mut largest = Others::new(j.light_vertices);
        visit(&mut largest);
        let weight = match self.heuristic {
            Heuristic::Balance => 1.0 / (1.0 + largest.sum),
            Heuristic::Power => 1.0 / (1.0 + largest.sum_of_squares),
            Heuristic::Maximum => {
                if largest.beaten {
                    0.0
                } else {
                    1.0
                }
            }
            Heuristic::Cutoff => {
                let bar = CUTOFF * if largest.max > 1.0 { largest.max } else { 1.0 };
                if bar > 1.0 {
                    0.0
                } else {
                    let mut rest = Others::new(j.light_vertices);
                    rest.bar = bar;
                    visit(&mut rest);
                    1.0 / (1.0 + rest.sum)
                }
            }
        };
        if weight.is_finite() { weight } else { 0.0 }
    }
}

/// What is seen of the strategies' densities.
struct Others {
    /// s of the strategy they are relative to.
    own: usize,
    /// Those below are not summed.
    bar: Real,
    sum: Real,
    sum_of_squares: Real,
    max: Real,
    /// Whether one is larger, or as large with fewer light vertices.
    beaten: bool,
}

impl Others {
    fn new(own: usize) -> Self {
        Self {
            own,
            bar: 0.0,
            sum: 0.0,
            sum_of_squares: 0.0,
            max: 0.0,
            beaten: false,
        }
    }

    #[inline(always)]
    fn see(&mut self, q: Real, s: usize) {
        if q >= self.bar {
            self.sum += q;
            self.sum_of_squares += square(q);
        }
        if q > self.max {
            self.max = q;
        }
        self.beaten |= q > 1.0 || (q == 1.0 && s < self.own);
    }
}
