//! An element of a scene file and its attributes.

use crate::description::Place;
use crate::load::error::{LoadError, Problem};

/// An element.
#[derive(Debug)]
pub struct Node {
    /// Its name.
    pub tag: String,
    /// Its attributes, after substitution.
    pub attributes: Vec<(String, String)>,
    /// Its elements, as indices into the document's nodes.
    pub children: Vec<usize>,
    /// Where it stands.
    pub place: Place,
}

impl Node {
    /// An attribute's value.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(n, _)| n == name)
            .map(|(_, v)| v.as_str())
    }

    /// An error about this element.
    pub fn error(&self, subject: impl Into<String>, problem: Problem) -> LoadError {
        LoadError::new(&self.place, subject, problem)
    }

    /// Refuses attributes other than `known`.
    pub fn only(&self, known: &[&str]) -> Result<(), LoadError> {
        match self
            .attributes
            .iter()
            .find(|(n, _)| !known.contains(&n.as_str()))
        {
            None => Ok(()),
            Some((name, _)) => Err(self.error(
                format!("<{}>", self.tag),
                Problem::Unknown {
                    what: "attribute",
                    found: format!("\"{name}\""),
                    expected: known.join(", "),
                },
            )),
        }
    }

    /// A required attribute's value.
    pub fn need(&self, name: &str) -> Result<&str, LoadError> {
        self.get(name).ok_or_else(|| {
            let what = format!("attribute \"{name}\"");
            self.error(
                format!("<{}>", self.tag),
                Problem::Missing {
                    what,
                    expected: format!("{name}=\"…\""),
                },
            )
        })
    }
}
