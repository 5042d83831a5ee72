//! The smooth dielectric boundary whose index depends on wavelength: a prism.
//!
//! As [`Dielectric`] for each channel; directions are the leading one's. All channels reflect into the same direction, each with its own
//! probability, so that one-sample MIS over them goes on; refraction takes the leading one its own way, which no other would have gone.

use crate::blob::format::{Material, material, table};
use crate::real::{Real, Vec3, sqrt};
use crate::spectrum::{Spectrum, interpolate};
use crate::surface::{Dielectric, Local, Mode, Scatter, TextureView};

/// Glass that disperses.
#[derive(Clone, Copy, Debug)]
pub struct Dispersive<S> {
    /// As the leading channel sees it.
    pub leading: Dielectric<S>,
    /// Index inside over index outside, by channel.
    pub ior: S,
    /// The channel that leads.
    pub lead: usize,
}

impl<S: Spectrum> Dispersive<S> {
    /// What a material stands for. `colors` scale reflection and transmission.
    pub(in crate::surface) fn new(
        m: &Material,
        textures: TextureView<'_>,
        waves: &S::Waves,
        lead: usize,
        [reflectance, transmittance]: [S; 2],
    ) -> Self {
        let ior = S::wavelengths(waves).map(|nm| index(m, textures.texels, nm));
        Self {
            leading: Dielectric {
                ior: ior.channel(lead),
                schlick: m.flags & material::SCHLICK != 0,
                reflectance,
                transmittance,
            },
            ior,
            lead,
        }
    }

    /// Fresnel's share of reflection by channel.
    #[inline(always)]
    fn reflected(&self, w: Vec3) -> S {
        self.ior.map(|ior| {
            let one = Dielectric {
                ior,
                ..self.leading
            };
            one.boundary(w).2.reflected
        })
    }

    /// `s` of all channels, whose `chances` differ from the leading one's.
    #[inline(always)]
    fn reflection(&self, w: Vec3, s: Scatter<S>) -> Scatter<S> {
        let reflected = self.reflected(w);
        let chances = reflected * (1.0 / reflected.channel(self.lead));
        Scatter {
            weight: s.weight * chances,
            chances,
            ..s
        }
    }

    /// `s` of the leading channel alone.
    #[inline(always)]
    fn refraction(&self, s: Scatter<S>) -> Scatter<S> {
        Scatter {
            weight: s.weight.only(self.lead),
            chances: S::WHITE.only(self.lead),
            ..s
        }
    }
}

impl<S: Spectrum> Local<S> for Dispersive<S> {
    #[inline(always)]
    fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi: [Real; 2]) -> Option<Scatter<S>> {
        let s = self.leading.sample(w, mode, lobe, xi)?;
        Some(match s.transmitted {
            true => self.refraction(s),
            false => self.reflection(w, s),
        })
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        let s = self.leading.dirac_lobe(w, mode, index)?;
        Some(match s.transmitted {
            true => self.refraction(s),
            // Taken for certain by all channels.
            false => Scatter {
                weight: self.leading.reflectance * self.reflected(w),
                ..s
            },
        })
    }
}

/// The index of refraction of a material, inside over outside, at a wavelength of `nm`.
pub(crate) fn index(m: &Material, texels: &[u32], nm: Real) -> Real {
    let um = nm * 1e-3;
    let square = um * um;
    let [a, b, c] = m.eta.map(Real::from);
    let [p, q, r] = m.k.map(Real::from);
    let n = match m.flags & material::FORMULA {
        material::CAUCHY => a + b / square + c / (square * square),
        // Sellmeier 1871.
        material::SELLMEIER => {
            let term = |b: Real, c: Real| b * square / (square - c);
            sqrt((1.0 + term(a, p) + term(b, q) + term(c, r)).max(0.0))
        }
        _ => {
            let [first, rows] = m.link;
            interpolate(table(texels, first, rows), nm)
        }
    };
    n * Real::from(m.ior)
}
