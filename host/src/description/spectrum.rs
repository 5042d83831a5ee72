//! What depends on wavelength: spectra and indices of refraction.

use crate::spectra::at;

/// Rows of (nm, value) by rising wavelength; linear between, constant beyond.
pub type Spectrum = Vec<[f32; 2]>;

/// Whether rows are a spectrum: at least one, wavelengths from 1 nm on that rise, values in [0, `most`].
pub fn is_spectrum(rows: &[[f32; 2]], most: f32) -> bool {
    let rising = rows.windows(2).all(|w| w[0][0] < w[1][0]);
    let fine = |[nm, value]: &[f32; 2]| (1.0..1e6).contains(nm) && (0.0..=most).contains(value);
    !rows.is_empty() && rising && rows.iter().all(fine)
}

/// An index of refraction by wavelength; λ in µm.
#[derive(Clone, Debug, PartialEq)]
pub enum Index {
    /// A + B/λ² + C/λ⁴.
    Cauchy([f32; 3]),
    /// n² = 1 + Σ Bᵢ·λ²/(λ² − Cᵢ).
    Sellmeier {
        /// Bᵢ.
        b: [f32; 3],
        /// Cᵢ, µm².
        c: [f32; 3],
    },
    /// A table.
    Table(Spectrum),
}

impl Index {
    /// At a wavelength in nm.
    pub fn at(&self, nm: f64) -> f64 {
        let square = (nm * 1e-3).powi(2);
        let wide = |c: &[f32; 3]| c.map(f64::from);
        match self {
            Self::Cauchy(c) => {
                let [a, b, c] = wide(c);
                a + b / square + c / (square * square)
            }
            Self::Sellmeier { b, c } => {
                let terms = wide(b).into_iter().zip(wide(c));
                (1.0 + terms.map(|(b, c)| b * square / (square - c)).sum::<f64>()).sqrt()
            }
            Self::Table(rows) => f64::from(at(rows, nm as f32)),
        }
    }

    /// Whether it is something's at every visible wavelength, seen from where the index is `outside`: from 0.1 to 100.
    pub fn is_visible(&self, outside: f32) -> bool {
        let seen = |nm: i32| (0.1..=100.0).contains(&(self.at(nm.into()) / f64::from(outside)));
        (380..=780).all(seen)
    }
}

/// What paths carry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Carry {
    /// Wavelengths if the scene disperses or gives spectra, else red, green and blue.
    #[default]
    AsNeeded,
    /// Red, green and blue: spectra are what they stand for, an index has three values.
    Rgb,
    /// Wavelengths.
    Wavelengths,
}
