//! The flags that say how radiance is shown, for all commands that write PNGs of it.

use crate::develop::{Curve, Tone};

/// How radiance is shown.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Screen {
    /// PNG: stops of exposure, -64 to 64; radiance × 2^EV comes before the tone curve
    #[arg(
        long,
        value_name = "EV",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = stops
    )]
    exposure: f32,
    /// PNG: none (clamped), reinhard (x/(1+x)), both sRGB-coded, or gamma:a,c,γ, which is a·(x+c)^γ in place of
    /// the sRGB curve; gamma alone is gamma:1,0,0.4545
    #[arg(long, value_name = "CURVE", default_value = "none")]
    tonemap: Curve,
}

impl Screen {
    /// What these flags come to.
    pub fn tone(&self) -> Tone {
        Tone {
            exposure: self.exposure,
            curve: self.tonemap,
        }
    }
}

/// An exposure.
fn stops(text: &str) -> Result<f32, String> {
    let number = text.parse().ok();
    number
        .filter(|ev| (-64.0..=64.0).contains(ev))
        .ok_or_else(|| "expected a number from -64 to 64".into())
}
