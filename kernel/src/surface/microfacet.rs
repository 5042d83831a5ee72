//! Microfacets: how their normals are distributed, how much of them is seen, and how to draw one that is seen.
//!
//! The distributions are GGX (Trowbridge & Reitz 1975; Walter et al. 2007) and Beckmann's, of roughness α along either
//! tangent. All of masking is said by the area A(ω) = ∫ ⟨ω·h⟩ D(h) dh of the facets that face ω (Heitz 2014, eq. 23), which is
//! regular in the tangent plane where Smith's G₁(ω) = |cos θ|/A(ω) and Λ are not. Directions and normals here have z ≥ 0.

use crate::blob::format::{Material, material};
use crate::real::{INV_PI, PI, Real, Vec3, erf, exp, log, safe_sqrt, sqrt, square};
use crate::warp::polar;

/// How facets hide each other from light and from the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// Smith's, where high facets are rarely hidden from either: G₂ = 1/(1 + Λ_o + Λ_i) (Heitz 2014, eq. 99). The
    /// default: of the three it is closest to a surface that has heights.
    Correlated,
    /// Smith's, each direction for itself: G₂ = G₁(ω_o)G₁(ω_i). Darker at grazing angles; what Mitsuba has.
    Separable,
    /// Torrance and Sparrow's, as Cook & Torrance 1982 have it: facets make V-shaped cavities.
    Cavities,
}

/// A distribution of facets and their masking.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets {
    /// α along the tangents.
    pub alpha: [Real; 2],
    /// Beckmann's distribution rather than GGX.
    pub beckmann: bool,
    /// G₂.
    pub masking: Masking,
}

/// √π.
#[allow(clippy::excessive_precision)] // not excessive in the double-precision package
const ROOT_PI: Real = 1.772_453_850_905_516;

impl Microfacets {
    /// Those of a blob's material.
    #[inline(always)]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    pub fn of(m: &Material) -> Self {
        Self {
            alpha: m.gloss.map(|a| a as Real),
            beckmann: m.flags & material::BECKMANN != 0,
            masking: if m.flags & material::CAVITIES != 0 {
                Masking::Cavities
            } else if m.flags & material::SEPARABLE != 0 {
                Masking::Separable
            } else {
                Masking::Correlated
            },
        }
    }

    /// D(h): facets per solid angle of their normals, area of the surface taken as 1.
    pub fn density(&self, h: Vec3) -> Real {
        let [u, v] = self.alpha;
        let slope = square(h.x / u) + square(h.y / v);
        let z_squared = square(h.z);
        let scale = INV_PI / (u * v);
        let d = if self.beckmann {
            scale * exp(-slope / z_squared) / square(z_squared)
        } else {
            scale / square(slope + z_squared)
        };
        if h.z > 0.0 && d.is_finite() { d } else { 0.0 }
    }

    /// A(ω), at least |cos θ|.
    pub fn area(&self, w: Vec3) -> Real {
        let [u, v] = self.alpha;
        let width = sqrt(square(u * w.x) + square(v * w.y));
        if !self.beckmann {
            return 0.5 * (w.z + sqrt(square(w.z) + square(width)));
        }
        if width <= 0.0 {
            return w.z;
        }
        let s = w.z / width;
        let a = 0.5 * w.z * (1.0 + erf(s)) + width * exp(-square(s)) / (2.0 * ROOT_PI);
        a.max(w.z)
    }

    /// G₁(ω): the share of the facets that face ω which aren't hidden from it.
    pub fn visible(&self, w: Vec3) -> Real {
        let a = self.area(w);
        if a > 0.0 { w.z / a } else { 0.0 }
    }

    /// G₂/(|cos θ_o||cos θ_i|) of two directions on one side, h between them; `cos` is either's to h.
    pub fn masking_over_cosines(&self, wo: Vec3, wi: Vec3, h: Vec3, cos: Real) -> Real {
        let g = match self.masking {
            Masking::Separable => self.separable_over_cosines(wo, wi),
            Masking::Correlated => {
                // Λ·cos θ = A − cos θ: nothing divides by a cosine.
                1.0 / (wi.z * self.area(wo) + wo.z * self.area(wi) - wo.z * wi.z)
            }
            Masking::Cavities => {
                let (low, high) = if wo.z < wi.z {
                    (wo.z, wi.z)
                } else {
                    (wi.z, wo.z)
                };
                (1.0 / low).min(2.0 * h.z / cos) / high
            }
        };
        if g.is_finite() { g } else { 0.0 }
    }

    /// The same, each direction for itself: what two sides have.
    pub fn separable_over_cosines(&self, wo: Vec3, wi: Vec3) -> Real {
        let g = 1.0 / (self.area(wo) * self.area(wi));
        if g.is_finite() { g } else { 0.0 }
    }

    /// f over Fresnel's share, D·G₂/(4|cos θ_o||cos θ_i|), and cos of the angle between either direction and h.
    pub fn reflection(&self, wo: Vec3, wi: Vec3) -> Option<(Real, Real)> {
        let (h, cos) = halfway(wo, wi)?;
        let f = 0.25 * self.density(h) * self.masking_over_cosines(wo, wi, h, cos);
        Some((f, cos))
    }

    /// Density per solid angle of drawing `wi` as the reflection of `w` by a facet that `w` sees: D/4A.
    pub fn reflection_pdf(&self, w: Vec3, wi: Vec3) -> Real {
        let pdf = match halfway(w, wi) {
            Some((h, _)) => 0.25 * self.density(h) / self.area(w),
            None => 0.0,
        };
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// The reflection of `w` by a facet that it sees; `None` if it goes below the surface.
    pub fn sample_reflection(&self, w: Vec3, xi: [Real; 2]) -> Option<Vec3> {
        let h = self.sample(w, xi);
        let wi = h * (2.0 * w.dot(h)) - w;
        let length = sqrt(wi.dot(wi));
        (wi.z > 0.0).then(|| wi * (1.0 / length))
    }

    /// Density per solid angle of drawing `h` by [`Self::sample`]: ⟨ω·h⟩ D(h)/A(ω).
    pub fn pdf(&self, w: Vec3, h: Vec3) -> Real {
        let pdf = w.dot(h).max(0.0) * self.density(h) / self.area(w);
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// Draws the normal of a facet that `w` sees, in proportion to how much of it it sees.
    pub fn sample(&self, w: Vec3, xi: [Real; 2]) -> Vec3 {
        let [u, v] = self.alpha;
        // In a surface stretched to α = 1.
        let stretched = Vec3::new(u * w.x, v * w.y, w.z);
        let length = sqrt(stretched.dot(stretched));
        let w = stretched * (1.0 / length);
        let h = if self.beckmann {
            beckmann(w, xi)
        } else {
            ggx(w, xi)
        };
        let h = Vec3::new(u * h.x, v * h.y, h.z);
        h * (1.0 / sqrt(h.dot(h)))
    }
}

/// The unit vector in the middle, and the cosine to it, half the sum's length.
fn halfway(a: Vec3, b: Vec3) -> Option<(Vec3, Real)> {
    let sum = a + b;
    let length = sqrt(sum.dot(sum));
    (length > 0.0).then(|| (sum * (1.0 / length), (0.5 * length).min(1.0)))
}

/// A normal of GGX with α = 1 that `w` sees: w plus a direction of a spherical cap (Dupuy & Benyoub 2023, listing 3). Of the
/// cap's direction c, 1 − c_z and w_z + c_z are products: nothing cancels. Not of unit length.
fn ggx(w: Vec3, xi: [Real; 2]) -> Vec3 {
    let top = 1.0 + w.z;
    let z = (1.0 - xi[0]) * top;
    let r = safe_sqrt(xi[0] * top * (z + (1.0 - w.z)));
    let phi = 2.0 * PI * xi[1];
    let [x, y] = polar(r, phi);
    Vec3::new(x + w.x, y + w.y, z)
}

/// The steps of [`beckmann`]'s Newton iteration, at most; it halves its bracket where a step would leave it.
const STEPS: u32 = 32;

/// A normal of Beckmann's distribution with α = 1 that `w` sees. The slope x towards `w` has density ∝ ⟨cos θ − x sin θ⟩e^(−x²),
/// whose integral C is closed and inverted here, the slope across is normal (Heitz & d'Eon 2014, §5.1). Not of unit length.
fn beckmann(w: Vec3, xi: [Real; 2]) -> Vec3 {
    let sin_theta = safe_sqrt(square(w.x) + square(w.y));
    let across = inverse_erf(2.0 * xi[1] - 1.0);
    if sin_theta < 1e-4 {
        // A disc of slopes.
        return Vec3::new(-inverse_erf(2.0 * xi[0] - 1.0), -across, 1.0);
    }
    let integral = |x: Real| 0.5 * (ROOT_PI * w.z * (1.0 + erf(x)) + sin_theta * exp(-square(x)));
    /// Slopes beyond have a share below rounding.
    const FAR: Real = 5.0;
    let (mut low, mut high) = (-FAR, (w.z / sin_theta).min(FAR));
    let target = xi[0] * integral(high);
    let mut x = if high > 0.0 { 0.0 } else { 0.5 * (low + high) };
    for _ in 0..STEPS {
        let excess = integral(x) - target;
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let next = x - excess / ((w.z - x * sin_theta) * exp(-square(x)));
        let next = if next > low && next < high {
            next
        } else {
            0.5 * (low + high)
        };
        let step = (next - x).abs();
        x = next;
        if step < 1e-6 {
            break;
        }
    }
    // Slopes are −h.x/h.z, −h.y/h.z; `along` points to w.
    let (along_x, along_y) = (w.x / sin_theta, w.y / sin_theta);
    Vec3::new(
        -(x * along_x - across * along_y),
        -(x * along_y + across * along_x),
        1.0,
    )
}

/// erf⁻¹ to a few parts in 10⁷ (Giles 2010, "Approximating the erfinv function", single precision). What is drawn with it
/// takes its density from elsewhere.
fn inverse_erf(x: Real) -> Real {
    #[rustfmt::skip]
    const CENTRE: [Real; 9] = [
        2.810_226_4e-8, 3.432_739_4e-7, -3.523_387_7e-6, -4.391_506_5e-6, 2.185_808_7e-4, -1.253_725e-3,
        -4.177_681_6e-3, 0.246_640_73, 1.501_409_4,
    ];
    #[rustfmt::skip]
    const TAIL: [Real; 9] = [
        -2.002_142_6e-4, 1.009_505_6e-4, 1.349_343_2e-3, -3.673_428_4e-3, 5.739_507_7e-3, -7.622_461_3e-3,
        9.438_870_5e-3, 1.001_674, 2.832_976_8,
    ];
    let horner = |terms: &[Real; 9], t: Real| terms.iter().fold(0.0, |sum, c| sum * t + c);
    let rest = (1.0 - x) * (1.0 + x);
    let w = if rest > 0.0 { -log(rest) } else { 80.0 };
    x * if w < 5.0 {
        horner(&CENTRE, w - 2.5)
    } else {
        horner(&TAIL, sqrt(w) - 3.0)
    }
}
