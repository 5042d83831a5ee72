//! `etendue compile`.

use super::{ColorName, Failure, define, warn};
use crate::develop::{check_writable, write_files};
use crate::scene::{is_blob, prepare};
use std::path::PathBuf;

/// Compile a scene to a blob that the kernel opens
#[derive(clap::Args, Debug)]
pub struct Compile {
    /// Mitsuba 3 scene (.xml)
    pub(super) scene: PathBuf,
    /// Blob to write (.etd)
    #[arg(short, long = "output", value_name = "OUT")]
    output: PathBuf,
    /// Value for $NAME in the scene; may be repeated
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = define)]
    define: Vec<(String, String)>,
    /// What paths carry; the default is wavelengths where the scene disperses or gives spectra
    #[arg(long, value_enum, default_value_t = ColorName::Auto)]
    color: ColorName,
}

impl Compile {
    pub(super) fn run(self) -> Result<(), Failure> {
        if !is_blob(&self.output) {
            return Err(format!(
                "{}: expected a name that ends in .etd",
                self.output.display()
            )
            .into());
        }
        check_writable(&self.output)?;
        let prepared = prepare(&self.scene, &self.define, self.color.changes())?;
        warn(&prepared.warnings);
        write_files(&[(&self.output, prepared.blob.bytes())])?;
        eprintln!(
            "{}: {} bytes",
            self.output.display(),
            prepared.blob.bytes().len()
        );
        Ok(())
    }
}
