//! From radiance to what a screen shows.

// The kernel's functions: the same bytes on every platform.
use etendue::real::pow;
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

/// For images that hold what a screen shows, coded, from 0 to 1.
pub const AS_IT_IS: Tone = Tone {
    exposure: 0.0,
    curve: Curve::Gamma {
        a: 1.0,
        c: 0.0,
        gamma: 1.0,
    },
};

impl Tone {
    /// What is stored for one channel.
    pub fn apply(&self, x: f32) -> u8 {
        let x = x * pow(2.0, self.exposure);
        let coded = match self.curve {
            Curve::None => srgb(x.clamp(0.0, 1.0)),
            Curve::Reinhard => srgb(reinhard(x.max(0.0))),
            Curve::Gamma { a, c, gamma } => a * pow((x + c).max(0.0), gamma),
        };
        (coded.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
    }
}

/// x/(1 + x), also where x is too large to tell it from infinity.
fn reinhard(x: f32) -> f32 {
    if x < 1.0 {
        x / (1.0 + x)
    } else {
        1.0 / (1.0 + 1.0 / x)
    }
}

/// What [`srgb`] codes, from 0 to 1.
pub(super) fn linear(coded: f32) -> f32 {
    if coded <= 0.040_45 {
        coded / 12.92
    } else {
        pow((coded + 0.055) / 1.055, 2.4)
    }
}

/// The sRGB transfer function (IEC 61966-2-1).
fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * pow(x, 1.0 / 2.4) - 0.055
    }
}

impl FromStr for Curve {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "expected none, reinhard, gamma or gamma:a,c,γ with three numbers, a and γ above 0, found {s:?}"
            )
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
                    [a, c, gamma] if a > 0.0 && gamma > 0.0 => Ok(Self::Gamma { a, c, gamma }),
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
        for curve in [Curve::None, Curve::Reinhard, gamma] {
            assert_eq!(tone(200.0, curve).apply(1.0), 255, "{curve:?}");
        }
        for coded in 0..=255 {
            let x = super::linear(f32::from(coded) / 255.0);
            assert_eq!(tone(0.0, Curve::None).apply(x), coded);
        }
        let bad = [
            "gamma:1,2",
            "gamma:a,b,c",
            "Gamma",
            "gamma:1,nan,1",
            "gamma:1,0,0",
            "gamma:-1,0,1",
        ];
        for bad in bad {
            assert!(bad.parse::<Curve>().is_err(), "{bad}");
        }
    }
}
