//! The program's commands, one file each.

use crate::memory::about;
use std::io::Write;

mod bake;
mod chart;
mod compare;
mod compile;
mod figures;
pub(crate) mod how;
mod inspect;
mod reading;
mod render;
mod screen;
mod stability;

/// How a command ends badly.
#[derive(Debug)]
pub enum Failure {
    /// One line for the user.
    Error(String),
    /// Ctrl-C; what there was has been written.
    Interrupted,
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Error(message)
    }
}

impl From<crate::develop::ImageError> for Failure {
    fn from(error: crate::develop::ImageError) -> Self {
        Self::Error(error.to_string())
    }
}

/// What to do.
#[derive(clap::Subcommand, Debug)]
pub enum Command {
    /// Render a scene to images
    Render(render::Render),
    /// Bake a light map: irradiance on a mesh with texture coordinates
    Bake(bake::Bake),
    /// Compile a scene to a blob that the kernel opens
    Compile(compile::Compile),
    /// Say what a scene or a blob holds, and what the kernel leaves out
    Inspect(inspect::Inspect),
    /// Compare two images: MSE, relMSE, bias, difference image
    Compare(compare::Compare),
    /// Chart speed against accuracy: variants of a render on a ladder of budgets
    Chart(Box<chart::Chart>),
    /// Render the figures that a manifest lists to one contact sheet
    Figures(figures::Figures),
    /// Run the atlas of scenes at which methods break, and compare with what is written down
    Stability(stability::Stability),
}

impl Command {
    /// Does it.
    ///
    /// # Errors
    /// What went wrong, in one line.
    pub fn run(self) -> Result<(), Failure> {
        about(match &self {
            Self::Render(c) => &c.scene,
            Self::Bake(c) => &c.scene,
            Self::Compile(c) => &c.scene,
            Self::Inspect(c) => &c.scene,
            Self::Compare(c) => &c.a,
            Self::Chart(c) => &c.scene,
            Self::Figures(c) => &c.from,
            Self::Stability(_) => std::path::Path::new("stability"),
        });
        match self {
            Self::Render(c) => c.run(),
            Self::Bake(c) => c.run(),
            Self::Compile(c) => c.run(),
            Self::Inspect(c) => c.run(),
            Self::Compare(c) => c.run(),
            Self::Chart(c) => c.run(),
            Self::Figures(c) => c.run(),
            Self::Stability(c) => c.run(),
        }
    }
}

/// Prints a result. A reader who has seen enough (`| head`) is no error.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: can't be written: {e}").into())
        }
        _ => Ok(()),
    }
}

/// Prints what a loader wants known.
fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}
