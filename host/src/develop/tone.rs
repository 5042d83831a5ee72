//! From radiance to what a screen shows.

use std::str::FromStr;

/// Exposure and tone curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// Radiance is multiplied by 2^EV first.
    pub exposure: f32,
    /// Then this.
    pub curve: Curve,
}

/// Tone curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// Clamped, sRGB-coded.
    None,
    /// x/(1 + x) per channel (Reinhard 2002), sRGB-coded.
    Reinhard,
    /// a·(x + c)^γ, clamped: the whole transfer function, so nothing is coded after it.
    Gamma {
        /// Factor.
        a: f32,
        /// Offset.
        c: f32,
        /// Exponent.
        gamma: f32,
    },
}

impl Tone {
    /// What is stored for one channel.
    pub fn apply(&self, x: f32) -> u8 {
        let x = x * self.exposure.exp2();
        let coded = match self.curve {
            Curve::None => srgb(x.clamp(0.0, 1.0)),
            Curve::Reinhard => srgb((x / (1.0 + x)).clamp(0.0, 1.0)),
            Curve::Gamma { a, c, gamma } => a * (x + c).max(0.0).powf(gamma),
        };
        (coded.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
    }
}

/// The sRGB transfer function (IEC 61966-2-1).
fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

impl FromStr for Curve {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let expected = || {
            format!("expected none, reinhard, gamma or gamma:a,c,γ with three numbers, found {s:?}")
        };
        match s.split_once(':') {
            None if s == "none" => Ok(Self::None),
            None if s == "reinhard" => Ok(Self::Reinhard),
            None if s == "gamma" => Ok(Self::Gamma {
                a: 1.0,
                c: 0.0,
                gamma: 1.0 / 2.2,
            }),
            Some(("gamma", numbers)) => {
                let numbers: Vec<f32> = numbers
                    .split(',')
                    .map(|n| n.trim().parse().ok().filter(|x: &f32| x.is_finite()))
                    .collect::<Option<_>>()
                    .ok_or_else(expected)?;
                match numbers[..] {
                    [a, c, gamma] => Ok(Self::Gamma { a, c, gamma }),
                    _ => Err(expected()),
                }
            }
            _ => Err(expected()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, Tone};

    #[test]
    fn curves_meet_their_definitions() {
        let tone = |exposure, curve| Tone { exposure, curve };
        assert_eq!(tone(0.0, Curve::None).apply(0.215_861), 128);
        assert_eq!(tone(1.0, Curve::None).apply(0.5), 255);
        assert_eq!(
            tone(0.0, Curve::Reinhard).apply(1.0),
            tone(0.0, Curve::None).apply(0.5)
        );
        let gamma: Curve = "gamma:2,0.25,1".parse().unwrap();
        assert_eq!(tone(0.0, gamma).apply(0.0), 128);
        for bad in ["gamma:1,2", "gamma:a,b,c", "Gamma", "gamma:1,nan,1"] {
            assert!(bad.parse::<Curve>().is_err(), "{bad}");
        }
    }
}
