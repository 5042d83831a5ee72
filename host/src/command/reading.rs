//! The flags that say how a scene file is read, for all commands that read one.

use crate::description::{Carry, Tracking};
use crate::scene::Changes;
use clap::ValueEnum;

/// How a scene file is read.
#[derive(clap::Args, Debug)]
pub struct Reading {
    /// Value for $NAME in the scene; may be repeated
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = define)]
    pub define: Vec<(String, String)>,
    /// What paths carry; the default is wavelengths where the scene disperses or gives spectra
    #[arg(long, value_enum, default_value_t = ColorName::Auto)]
    color: ColorName,
    /// Reflectance of dielectrics, in place of what the file says of each
    #[arg(long, value_enum)]
    fresnel: Option<FresnelName>,
    /// How the way through media with grids is found, in place of what the file says of each
    #[arg(long, value_enum)]
    tracking: Option<TrackingName>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ColorName {
    /// wavelengths where the scene needs them, else red, green and blue
    Auto,
    /// red, green and blue; an index that disperses has three values
    Rgb,
    /// four wavelengths
    Spectral,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FresnelName {
    /// Fresnel's equations
    Exact,
    /// Schlick's approximation
    Schlick,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TrackingName {
    /// Woodcock's free flight, transmittance by ratio tracking
    Woodcock,
    /// the same, transmittance by residual ratio tracking; for extinction of one channel
    Residual,
    /// cell by cell, exactly
    Regular,
}

/// `NAME=VALUE`.
fn define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.into(), value.into())),
        _ => Err("expected NAME=VALUE".into()),
    }
}

impl Reading {
    /// What paths carry.
    fn carry(&self) -> Carry {
        match self.color {
            ColorName::Auto => Carry::AsNeeded,
            ColorName::Rgb => Carry::Rgb,
            ColorName::Spectral => Carry::Wavelengths,
        }
    }

    /// These flags as changes to what the file says.
    pub fn changes(&self) -> Changes {
        Changes {
            carry: self.carry(),
            schlick: self.fresnel.map(|f| matches!(f, FresnelName::Schlick)),
            tracking: self.tracking.map(|t| match t {
                TrackingName::Woodcock => Tracking::Woodcock,
                TrackingName::Residual => Tracking::Residual,
                TrackingName::Regular => Tracking::Regular,
            }),
            ..Changes::default()
        }
    }
}
