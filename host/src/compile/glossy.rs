//! What glossy materials have worked out for them: normalisations, mean reflectances, and the curves of what microfacets lose
//! or let in, by quadrature over the facets that a direction sees, with the kernel's own functions.

use crate::description::{Color, Distribution, Facets, Masking, Spectrum};
use crate::spectra::at;
use etendue::blob::format::{Material, material};
use etendue::real::Vec3;
use etendue::surface::curve::Curve;
use etendue::surface::fresnel;
use etendue::surface::microfacet::Microfacets;
use std::f32::consts::PI;

/// Phong's constant.
pub(super) fn normalization(exponent: f32, modified: bool) -> f32 {
    (exponent + if modified { 2.0 } else { 1.0 }) / (2.0 * PI)
}

/// The blob's flags.
pub(super) fn flags(f: &Facets) -> u32 {
    let beckmann = match f.distribution {
        Distribution::Beckmann => material::BECKMANN,
        Distribution::Ggx => 0,
    };
    let masking = match f.masking {
        Masking::Correlated => 0,
        Masking::Separable => material::SEPARABLE,
        Masking::Cavities => material::CAVITIES,
    };
    let compensated = if f.compensated {
        material::COMPENSATED
    } else {
        0
    };
    beckmann | masking | compensated
}

/// ∫ f(cos θ) cos θ dσ/π over the hemisphere, by the midpoint rule in √cos θ: as fine as needed at grazing angles.
fn hemisphere(steps: u32, f: impl Fn(f32) -> f32) -> f32 {
    let sum: f64 = (0..steps)
        .map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            4.0 * t.powi(3) * f64::from(f((t * t) as f32))
        })
        .sum();
    (sum / f64::from(steps)) as f32
}

/// Mean reflectance of index `eta` + i`k` under diffuse light.
fn mean(eta: f32, k: f32) -> f32 {
    hemisphere(256, |cos| fresnel::conductor(eta, k, cos)).clamp(0.0, 1.0)
}

/// The same of a conductor, by channel.
pub(super) fn mean_reflectance(eta: Color, k: Color) -> Color {
    std::array::from_fn(|c| mean(eta[c], k[c]))
}

/// The same by wavelength, at each row of either table.
pub(super) fn mean_reflectances(eta: &[[f32; 2]], k: &[[f32; 2]]) -> Spectrum {
    let mut rows: Vec<f32> = eta.iter().chain(k).map(|[nm, _]| *nm).collect();
    rows.sort_by(f32::total_cmp);
    rows.dedup();
    let mean = |nm| [nm, mean(at(eta, nm), at(k, nm))];
    rows.into_iter().map(mean).collect()
}

/// How much of diffuse light inside a smooth coat is reflected: 1 − (1 − ρ_e)/η², as (1 − ρ_e) comes in from outside (Duntley 1942).
pub(super) fn smooth_internal(ior: f32) -> f32 {
    let enters = hemisphere(4096, |cos| fresnel::dielectric(1.0, ior, cos).transmitted);
    (1.0 - enters / (ior * ior)).clamp(0.0, 0.9999)
}

/// What facets do with light of unit flux from a direction.
struct Scattered {
    reflected: f32,
    transmitted: f32,
}

/// Single scattering of light from `cos`. Facets share it between both sides by `share`; `back` is the index here over the
/// one there. A curve knows no azimuth: where α differs along the tangents it is the mean over them.
fn scattered(
    facets: &Microfacets,
    cos: f32,
    share: impl Fn(f32) -> fresnel::Dielectric,
    back: f32,
) -> Scattered {
    const STEPS: u32 = 64;
    const TURNS: u32 = 32;
    let at = |i: u32, count: u32| (i as f32 + 0.5) / count as f32;
    let [u, v] = facets.alpha;
    let azimuths = if u == v { 1 } else { 4 };
    // In the tangent plane nothing is seen but its limit.
    let cos = cos.max(1e-4);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (mut reflected, mut transmitted) = (0.0, 0.0);
    for azimuth in 0..azimuths {
        let phi = (azimuth as f32 + 0.5) / azimuths as f32 * 0.5 * PI;
        let w = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
        let area = facets.area(w);
        for (i, j) in (0..STEPS).flat_map(|i| (0..TURNS).map(move |j| (i, j))) {
            // Denser towards the ends of ξ, where the few facets are that lean a lot.
            let t = at(i, STEPS);
            let weight = 6.0 * t * (1.0 - t);
            let h = facets.sample(w, [t * t * (3.0 - 2.0 * t), at(j, TURNS)]);
            let cos = w.dot(h);
            let share = share(cos);
            let wi = h * (2.0 * cos) - w;
            if wi.z > 0.0 {
                let masked = facets.masking_over_cosines(w, wi, h, cos) * wi.z * area;
                reflected += weight * share.reflected * masked;
            }
            // The refracted direction's opposite.
            let wt = h * (share.cos_t - back * cos) + w * back;
            if share.transmitted > 0.0 && wt.z > 0.0 {
                let masked = facets.separable_over_cosines(w, wt) * wt.z * area;
                transmitted += weight * share.transmitted * masked;
            }
        }
    }
    let scale = 1.0 / (azimuths * STEPS * TURNS) as f32;
    Scattered {
        reflected: reflected * scale,
        transmitted: transmitted * scale,
    }
}

fn boundary(facets: &Microfacets, cos: f32, from: f32, to: f32) -> Scattered {
    let share = |cos: f32| fresnel::dielectric(from, to, cos.min(1.0));
    scattered(facets, cos, share, from / to)
}

/// What facets that reflect everything lose.
pub(super) fn conductor_loss(m: &Material) -> Curve {
    let all = fresnel::Dielectric {
        reflected: 1.0,
        transmitted: 0.0,
        cos_t: 0.0,
    };
    let facets = Microfacets::of(m);
    Curve::through(|cos| 1.0 - scattered(&facets, cos, |_| all, 1.0).reflected)
}

/// What dielectric facets lose of light from outside and from inside.
pub(super) fn dielectric_losses(m: &Material) -> [Curve; 2] {
    let facets = Microfacets::of(m);
    [(1.0, m.ior), (m.ior, 1.0)].map(|(from, to)| {
        Curve::through(|cos| {
            let s = boundary(&facets, cos, from, to);
            1.0 - s.reflected - s.transmitted
        })
    })
}

/// A rough coat: the curve of what it lets in and how much of diffuse light inside it reflects. `compensated`: what single
/// scattering loses enters too.
pub(super) fn coat(m: &Material, compensated: bool) -> (Curve, f32) {
    let facets = Microfacets::of(m);
    if compensated {
        let enters = Curve::through(|cos| 1.0 - boundary(&facets, cos, 1.0, m.ior).reflected);
        let internal = 1.0 - enters.mean() / (m.ior * m.ior);
        return (enters, internal.clamp(0.0, 0.9999));
    }
    let enters = Curve::through(|cos| boundary(&facets, cos, 1.0, m.ior).transmitted);
    let internal = hemisphere(48, |cos| boundary(&facets, cos, m.ior, 1.0).reflected);
    (enters, internal.clamp(0.0, 0.9999))
}
