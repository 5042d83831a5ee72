//! `etendue compile`.

use super::{Failure, define, warn};
use crate::develop::{persist, temporary_beside};
use crate::scene::{Size, is_blob, prepare};
use std::io::Write;
use std::path::PathBuf;

/// Compile a scene to a blob that the kernel opens
#[derive(clap::Args, Debug)]
pub struct Compile {
    /// Mitsuba 3 scene (.xml)
    scene: PathBuf,
    /// Blob to write, by custom named .etd
    #[arg(short, long = "output", value_name = "OUT")]
    output: PathBuf,
    /// Value for $NAME in the scene; may be repeated
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = define)]
    define: Vec<(String, String)>,
}

impl Compile {
    pub(super) fn run(self) -> Result<(), Failure> {
        let fail = |e: std::io::Error| format!("{}: can't be written: {e}", self.output.display());
        if !is_blob(&self.output) {
            return Err(format!(
                "{}: expected a name that ends in .etd",
                self.output.display()
            )
            .into());
        }
        let mut file = temporary_beside(&self.output).map_err(fail)?;
        let prepared = prepare(&self.scene, &self.define, Size::default())?;
        warn(&prepared.warnings);
        file.write_all(prepared.blob.bytes()).map_err(fail)?;
        persist(file, &self.output).map_err(fail)?;
        eprintln!(
            "{}: {} bytes",
            self.output.display(),
            prepared.blob.bytes().len()
        );
        Ok(())
    }
}
