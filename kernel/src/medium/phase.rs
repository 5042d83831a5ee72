//! Phase functions: how light scatters within a volume. Both directions point away from the vertex, in the world's frame, so
//! the cosine between the directions of propagation is c = −w·wi. All are symmetric: the way back has the same density.

use crate::blob::format::{Lobe, medium};
use crate::real::{Frame, PI, Real, Vec3, cbrt, safe_sqrt, sqrt, square};
use crate::spectrum::Spectrum;
use crate::surface::Scatter;
use crate::warp::polar;

/// What scatters at a point of a medium: its parts blended by their shares, times σ_s.
#[derive(Clone, Copy, Debug)]
pub struct Phase<'a, S> {
    /// The parts.
    pub lobes: &'a [Lobe; 4],
    /// σ_s at the point.
    pub scattering: S,
}

impl<S: Spectrum> Phase<'_, S> {
    /// σ_s·p(wo ← wi) without the Dirac part; m⁻¹ sr⁻¹.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> S {
        self.scattering * self.pdf(wo, wi)
    }

    /// Density per solid angle of drawing `wi` when walking from `w`; the Dirac part has none.
    #[inline]
    pub fn pdf(&self, w: Vec3, wi: Vec3) -> Real {
        let pair = Pair::new(w, wi);
        let smooth = self.lobes.iter().map(|l| share(l) * value(l, &pair));
        smooth.fold(0.0, |sum, p| sum + p) * self.inverse()
    }

    /// Draws a direction: `lobe` chooses the part, `xi` the direction in it. The density is that of the whole blend, but
    /// if the part is the Dirac one: its probability.
    #[inline]
    pub fn sample(&self, w: Vec3, lobe: Real, xi: [Real; 2]) -> Scatter<S> {
        let inverse = self.inverse();
        let mut rest = lobe;
        let mut chosen = None;
        for part in self.lobes {
            let p = share(part) * inverse;
            // The last that has a share takes what rounding leaves.
            if p > 0.0 && rest >= 0.0 {
                chosen = Some((part, p));
            }
            rest -= p;
        }
        match chosen {
            Some((part, p)) if part.kind == medium::FORWARD => self.scatter(-w, p, true),
            Some((part, _)) => {
                let wi = direction(part, w, xi);
                self.scatter(wi, self.pdf(w, wi), false)
            }
            None => self.scatter(-w, 1.0, true),
        }
    }

    /// Whether there is a part that isn't Dirac: connections are possible.
    #[inline(always)]
    pub fn has_smooth(&self) -> bool {
        let smooth = |l: &Lobe| l.kind != medium::FORWARD && l.weight > 0.0;
        self.lobes.iter().any(smooth)
    }

    /// The shares add up to 1 but for rounding in the blob: what makes it exact.
    #[inline(always)]
    fn inverse(&self) -> Real {
        let sum = self.lobes.iter().fold(0.0, |sum, l| sum + share(l));
        if sum > 0.0 { 1.0 / sum } else { 0.0 }
    }

    #[inline(always)]
    fn scatter(&self, wi: Vec3, pdf: Real, dirac: bool) -> Scatter<S> {
        Scatter {
            wi,
            weight: self.scattering,
            pdf,
            pdf_reverse: pdf,
            dirac,
            transmitted: false,
            eta_scale: 1.0,
            chances: S::WHITE,
        }
    }
}

#[inline(always)]
fn share(l: &Lobe) -> Real {
    Real::from(l.weight)
}

/// The angle between two directions, with all its digits at both ends.
struct Pair {
    /// 1 − c = |w + wi|²/2, which doesn't cancel where light goes straight on.
    ahead: Real,
    /// 1 + c = |w − wi|²/2, nor this where it comes straight back.
    behind: Real,
}

impl Pair {
    #[inline(always)]
    fn new(w: Vec3, wi: Vec3) -> Self {
        Self {
            ahead: 0.5 * (w + wi).length_squared(),
            behind: 0.5 * (w - wi).length_squared(),
        }
    }
}

/// p of one part, its Dirac aside; sr⁻¹.
#[inline(always)]
fn value(l: &Lobe, pair: &Pair) -> Real {
    match l.kind {
        medium::ISOTROPIC => 1.0 / (4.0 * PI),
        medium::HENYEY_GREENSTEIN => {
            // (1 − g²)/(1 + g² − 2gc)^(3/2) is the same for (−g, −c), and with g ≥ 0 the base is (1 − g)² + 2g(1 − c): a sum
            // of what isn't negative.
            let g = Real::from(l.g).abs();
            let h = if l.g < 0.0 { pair.behind } else { pair.ahead };
            let base = square(1.0 - g) + 2.0 * g * h;
            (1.0 - g) * (1.0 + g) / (4.0 * PI * base * sqrt(base))
        }
        medium::RAYLEIGH => {
            let c = 0.5 * (pair.behind - pair.ahead);
            3.0 / (16.0 * PI) * (1.0 + c * c)
        }
        _ => 0.0,
    }
}

/// Draws from one part, not the Dirac one.
#[inline(always)]
fn direction(l: &Lobe, w: Vec3, xi: [Real; 2]) -> Vec3 {
    // What the direction is drawn about, and 1 − its cosine with that.
    let (axis, h) = match l.kind {
        medium::HENYEY_GREENSTEIN => {
            let axis = if l.g < 0.0 { w } else { -w };
            (axis, henyey_greenstein(Real::from(l.g).abs(), xi[0]))
        }
        medium::RAYLEIGH => (-w, 1.0 - rayleigh(xi[0])),
        _ => (-w, 2.0 * (1.0 - xi[0])),
    };
    let r = safe_sqrt(h * (2.0 - h));
    let phi = 2.0 * PI * xi[1];
    let [x, y] = polar(r, phi);
    let local = Vec3::new(x, y, 1.0 - h);
    let wi = Frame::around(axis).world(local);
    // Long walks scatter thousands of times: lengths would drift.
    wi * (1.0 / sqrt(wi.length_squared()))
}

/// 1 − c of Henyey and Greenstein's phase function (1941, eq. 2) for g in [0, 1): the inverse of the distribution,
/// c = (1 + g² − ((1 − g²)/(1 − g + 2gξ))²)/2g, with 2g divided out: nothing cancels, and g = 0 is no special case.
#[inline(always)]
fn henyey_greenstein(g: Real, xi: Real) -> Real {
    let q = (1.0 - g) / (1.0 - g + 2.0 * g * xi);
    2.0 * q * q * (1.0 - xi) * (1.0 + g * xi)
}

/// c of Rayleigh's phase function: the root of c³ + 3c = 8ξ − 4, which is u − 1/u with u³ − 1/u³ = 8ξ − 4 (Frisvad 2011, eq. 8).
#[inline(always)]
fn rayleigh(xi: Real) -> Real {
    let q = 4.0 * xi - 2.0;
    // By its absolute value: the sum doesn't cancel.
    let u = cbrt(q.abs() + sqrt(q * q + 1.0));
    (u - 1.0 / u).min(1.0).copysign(q)
}
