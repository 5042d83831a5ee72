//! `etendue compile`.

use super::reading::Reading;
use super::{Failure, warn};
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
    #[command(flatten)]
    reading: Reading,
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
        let prepared = prepare(&self.scene, &self.reading.define, self.reading.changes())?;
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
