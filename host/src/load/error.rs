//! Why a scene was refused: what was found where, and what was expected.

use crate::description::Place;
use std::path::{Path, PathBuf};

/// A scene that can't be loaded. Displays on one line: `scene.xml:12: sphere: radius must be > 0, found -1`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}: {problem}", at(.place), about(.subject))]
pub struct LoadError {
    /// Where it was said.
    pub place: Place,
    /// Whose fault: an element or a plugin's type; may be empty.
    pub subject: String,
    /// What is wrong; boxed so that results stay small.
    pub problem: Box<Problem>,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// The operating system didn't give the file.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The bytes aren't what the format asks for.
    #[error("{0}")]
    Malformed(String),
    /// A name that nobody knows.
    #[error("unknown {what} {found}, expected {expected}")]
    Unknown {
        /// Kind of thing.
        what: &'static str,
        /// The name.
        found: String,
        /// The names known.
        expected: String,
    },
    /// A value of the right type that makes no sense.
    #[error("{what} must be {expected}, found {found}")]
    Invalid {
        /// Which value.
        what: String,
        /// What would have been accepted.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// Something required isn't there.
    #[error("{what} is missing, expected {expected}")]
    Missing {
        /// What.
        what: String,
        /// Its form.
        expected: String,
    },
    /// Something said twice.
    #[error("{what} was already given at line {line}, expected it once")]
    Duplicate {
        /// What.
        what: String,
        /// Line of the first.
        line: u32,
    },
    /// A reference to nothing.
    #[error("{what} refers to {found}, which does not exist")]
    Dangling {
        /// The reference.
        what: String,
        /// Its target.
        found: String,
    },
    /// Known, but not done.
    #[error("{what} is not supported yet{}", about(.instead))]
    Unsupported {
        /// What.
        what: String,
        /// What to do instead; may be empty.
        instead: String,
    },
}

fn at(place: &Place) -> String {
    if place.line == 0 {
        place.file.display().to_string()
    } else {
        format!("{}:{}", place.file.display(), place.line)
    }
}

fn about(text: &str) -> String {
    if text.is_empty() {
        String::new()
    } else {
        format!(": {text}")
    }
}

impl LoadError {
    /// An error about `subject` at `place`.
    pub fn new(place: &Place, subject: impl Into<String>, problem: Problem) -> Self {
        Self {
            place: place.clone(),
            subject: subject.into(),
            problem: Box::new(problem),
        }
    }

    /// An error about a file as a whole.
    pub fn file(path: &Path, problem: Problem) -> Self {
        Self::new(&file_place(path, 0), "", problem)
    }

    /// The same of a file that `subject` names at `place`: `scene.xml:12: gridvolume: smoke.vol: …`.
    pub fn named(self, place: &Place, subject: &str) -> Self {
        let file = format!("{}{}", at(&self.place), about(&self.subject));
        Self {
            place: place.clone(),
            subject: format!("{subject}: {file}"),
            problem: self.problem,
        }
    }

    /// A file whose bytes aren't what its format asks for.
    pub fn malformed(path: &Path, line: u32, reason: impl Into<String>) -> Self {
        Self::new(
            &file_place(path, line),
            "",
            Problem::Malformed(reason.into()),
        )
    }
}

/// A place in a file.
pub fn file_place(path: &Path, line: u32) -> Place {
    Place {
        file: PathBuf::from(path),
        line,
    }
}

/// A whole file's bytes.
pub fn read(path: &Path) -> Result<Vec<u8>, LoadError> {
    std::fs::read(path).map_err(|e| LoadError::file(path, Problem::Unreadable(e.to_string())))
}
