//! The medium that is the same everywhere: all in closed form.

use super::{Carried, Collision, Flight, depth, exponential};
use crate::blob::View;
use crate::blob::format::Medium;
use crate::random::Sampler;
use crate::real::{Real, exp, expm1};
use crate::spectrum::Spectrum;

/// Free flight over `length`, which may be infinite: [`super::Way::fly`].
#[inline(always)]
pub(super) fn fly<S: Spectrum>(
    scene: View<'_, '_, S>,
    m: &Medium,
    length: Real,
    lead: usize,
    carried: &mut Carried<S>,
    glow: &mut S,
    sampler: &mut impl Sampler,
) -> Flight<S> {
    let sigma = scene.sigma_t(m);
    let emission = scene.emission(m);
    if !emission.is_black() {
        *glow += carried.throughput * shine(scene, m, length);
    }
    let leading = sigma.channel(lead);
    // In a vacuum nobody collides.
    let s = if leading > 0.0 {
        exponential(sampler) / leading
    } else {
        Real::INFINITY
    };
    // Relative to the leading channel: its own optical depth is at most that of the largest ξ, so nothing overflows.
    let fade = |sigma: Real, s: Real| exp(depth(leading - sigma, s));
    if s < length {
        let f = sigma.map(|sigma| fade(sigma, s) / leading);
        carried.draw(f, sigma * f);
        return Flight::Collided(Collision {
            t: s,
            scattering: sigma * scene.albedo(m),
            emission,
        });
    }
    let f = sigma.map(|sigma| fade(sigma, length));
    carried.draw(f, f);
    Flight::Through
}

/// ∫E·τ over `length`, which may be infinite.
#[inline(always)]
pub(super) fn shine<S: Spectrum>(scene: View<'_, '_, S>, m: &Medium, length: Real) -> S {
    let sigma = scene.sigma_t(m);
    scene
        .emission(m)
        .zip(sigma, |e, sigma| e * saturation(sigma, length))
}

/// τ over `length`, which may be infinite.
#[inline(always)]
pub(super) fn transmittance<S: Spectrum>(scene: View<'_, '_, S>, m: &Medium, length: Real) -> S {
    scene.sigma_t(m).map(|sigma| exp(-depth(sigma, length)))
}

/// ∫₀ᴸ e^(−σs) ds = (1 − e^(−σL))/σ, regular at σ → 0. Where σ = 0 and L = ∞ nothing emits.
#[inline(always)]
fn saturation(sigma: Real, length: Real) -> Real {
    let d = depth(sigma, length);
    if d > 1e-8 {
        -expm1(-d) / sigma
    } else if length < Real::INFINITY {
        // To below an ulp.
        length * (1.0 - 0.5 * d)
    } else {
        0.0
    }
}
