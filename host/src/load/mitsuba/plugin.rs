//! A plugin's view of its own parameters: what it asks for is known, the rest is an error.

use super::document::Document;
use super::node::Node;
use super::transform;
use super::value::{color, number, rows, vector};
use crate::description::{Color, Spectrum};
use crate::load::error::{LoadError, Problem};
use crate::spectra::{emitted, weighed};
use glam::DMat4;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::PathBuf;

/// A plugin: an element with a type and parameters.
pub struct Plugin<'a> {
    /// All elements.
    pub document: &'a Document,
    /// Its element.
    pub node: &'a Node,
    /// Its type.
    pub kind: &'a str,
    used: RefCell<Vec<bool>>,
    known: RefCell<Vec<String>>,
}

impl<'a> Plugin<'a> {
    /// The plugin at an element. Refuses parameters said twice.
    pub fn new(document: &'a Document, index: usize) -> Result<Self, LoadError> {
        let node = &document.nodes[index];
        node.only(&["type", "name", "id"])?;
        let kind = node.need("type")?;
        let mut names: HashMap<&str, u32> = HashMap::new();
        for &child in &node.children {
            let child = &document.nodes[child];
            let Some(name) = child.get("name") else {
                continue;
            };
            if let Some(line) = names.insert(name, child.place.line) {
                let what = format!("parameter \"{name}\"");
                return Err(child.error(kind, Problem::Duplicate { what, line }));
            }
        }
        let used = RefCell::new(vec![false; node.children.len()]);
        Ok(Self {
            document,
            node,
            kind,
            used,
            known: RefCell::default(),
        })
    }

    /// An error about the plugin.
    pub fn error(&self, problem: Problem) -> LoadError {
        self.node.error(self.kind, problem)
    }

    /// Where a parameter was given, or else the plugin.
    fn parameter(&self, name: &str) -> &Node {
        let mut children = self.node.children.iter().map(|&c| &self.document.nodes[c]);
        let given = children.find(|c| c.get("name") == Some(name));
        given.unwrap_or(self.node)
    }

    /// What is wrong with the file that a parameter names.
    pub fn within(&self, name: &str, error: LoadError) -> LoadError {
        error.named(&self.parameter(name).place, self.kind)
    }

    /// A value that makes no sense; the place is the parameter's, if it was given.
    pub fn invalid(
        &self,
        name: &str,
        expected: impl Into<String>,
        found: impl ToString,
    ) -> LoadError {
        let node = self.parameter(name);
        let problem = Problem::Invalid {
            what: name.into(),
            expected: expected.into(),
            found: found.to_string(),
        };
        node.error(self.kind, problem)
    }

    /// A required parameter that isn't there.
    pub fn missing(&self, name: &str, tag: &str) -> LoadError {
        self.error(Problem::Missing {
            what: name.into(),
            expected: format!("<{tag} name=\"{name}\" …/>"),
        })
    }

    /// A parameter that can't be honoured.
    pub fn unsupported(&self, what: impl Into<String>, instead: &str) -> LoadError {
        self.error(Problem::Unsupported {
            what: what.into(),
            instead: instead.into(),
        })
    }

    /// The type isn't one of `expected`.
    pub fn unknown(&self, expected: &str) -> LoadError {
        let found = format!("\"{}\"", self.kind);
        self.node.error(
            format!("<{}>", self.node.tag),
            Problem::Unknown {
                what: "plugin",
                found,
                expected: expected.into(),
            },
        )
    }

    /// The parameter of this name, references resolved.
    pub fn child(&self, name: &str) -> Result<Option<usize>, LoadError> {
        self.know(name);
        let find = |c: &&usize| self.document.nodes[**c].get("name") == Some(name);
        let Some(i) = self.node.children.iter().position(|c| find(&c)) else {
            return Ok(None);
        };
        self.used.borrow_mut()[i] = true;
        resolve(self.document, self.node.children[i]).map(Some)
    }

    fn know(&self, name: &str) {
        let mut known = self.known.borrow_mut();
        if !known.iter().any(|k| k == name) {
            known.push(name.to_owned());
        }
    }

    /// A parameter's element, which must have one of these tags and no attributes but these.
    fn value(
        &self,
        name: &str,
        tags: &[&str],
        attributes: &[&str],
    ) -> Result<Option<&'a Node>, LoadError> {
        let Some(index) = self.child(name)? else {
            return Ok(None);
        };
        let node = &self.document.nodes[index];
        if !tags.contains(&node.tag.as_str()) {
            let expected = tags
                .iter()
                .map(|t| format!("<{t}>"))
                .collect::<Vec<_>>()
                .join(" or ");
            return Err(self.invalid(name, expected, format!("<{}>", node.tag)));
        }
        node.only(attributes)?;
        if let Some(&inner) = node.children.first()
            && node.tag != "transform"
        {
            let inner = &self.document.nodes[inner];
            let problem = Problem::Malformed(format!(
                "<{}> within <{}>, expected nothing",
                inner.tag, node.tag
            ));
            return Err(inner.error(self.kind, problem));
        }
        Ok(Some(node))
    }

    /// A number.
    pub fn float(&self, name: &str) -> Result<Option<f32>, LoadError> {
        let Some(node) = self.value(name, &["float", "integer"], &["name", "value"])? else {
            return Ok(None);
        };
        let text = node.need("value")?;
        number(text)
            .map(Some)
            .ok_or_else(|| self.invalid(name, "a finite number", format!("\"{text}\"")))
    }

    /// A number > 0.
    pub fn positive(&self, name: &str) -> Result<Option<f32>, LoadError> {
        let value = self.float(name)?;
        match value {
            Some(v) if v <= 0.0 => Err(self.invalid(name, "> 0", v)),
            _ => Ok(value),
        }
    }

    /// A whole number.
    pub fn integer(&self, name: &str) -> Result<Option<i64>, LoadError> {
        let Some(node) = self.value(name, &["integer"], &["name", "value"])? else {
            return Ok(None);
        };
        let text = node.need("value")?;
        let parsed = text.trim().parse();
        parsed
            .map(Some)
            .map_err(|_| self.invalid(name, "a whole number", format!("\"{text}\"")))
    }

    /// A whole number in a range.
    pub fn integer_in(&self, name: &str, low: i64, high: i64) -> Result<Option<u32>, LoadError> {
        let Some(value) = self.integer(name)? else {
            return Ok(None);
        };
        match u32::try_from(value) {
            Ok(v) if (low..=high).contains(&value) => Ok(Some(v)),
            _ => Err(self.invalid(name, format!("from {low} to {high}"), value)),
        }
    }

    /// A boolean.
    pub fn boolean(&self, name: &str) -> Result<Option<bool>, LoadError> {
        let Some(node) = self.value(name, &["boolean"], &["name", "value"])? else {
            return Ok(None);
        };
        match node.need("value")?.trim() {
            "true" | "True" => Ok(Some(true)),
            "false" | "False" => Ok(Some(false)),
            other => Err(self.invalid(name, "true or false", format!("\"{other}\""))),
        }
    }

    /// A string.
    pub fn string(&self, name: &str) -> Result<Option<&'a str>, LoadError> {
        match self.value(name, &["string"], &["name", "value"])? {
            Some(node) => node.need("value").map(Some),
            None => Ok(None),
        }
    }

    /// The path of a file that is named by a required string.
    pub fn file(&self, name: &str) -> Result<PathBuf, LoadError> {
        let text = self
            .string(name)?
            .ok_or_else(|| self.missing(name, "string"))?;
        let path = self.document.find(text, &self.node.place);
        if path.is_file() {
            Ok(path)
        } else {
            Err(self.invalid(name, "a file that exists", path.display()))
        }
    }

    /// A point or vector.
    pub fn vector(&self, name: &str) -> Result<Option<[f64; 3]>, LoadError> {
        let attributes = ["name", "value", "x", "y", "z"];
        match self.value(name, &["point", "vector"], &attributes)? {
            Some(node) => vector(node, self.kind, 0.0).map(Some),
            None => Ok(None),
        }
    }

    /// A transform; identity if not given.
    pub fn transform(&self, name: &str) -> Result<DMat4, LoadError> {
        match self.value(name, &["transform"], &["name"])? {
            Some(node) => transform::parse(self.document, node),
            None => Ok(DMat4::IDENTITY),
        }
    }

    /// Whether a parameter was given.
    pub fn has(&self, name: &str) -> bool {
        self.node
            .children
            .iter()
            .any(|&c| self.document.nodes[c].get("name") == Some(name))
    }

    /// Light: a colour, or a spectrum and the colour that it stands for; white if nothing is said.
    pub fn light(&self, name: &str) -> Result<(Color, Option<Spectrum>), LoadError> {
        match self.rows(name)? {
            Some(rows) => Ok((emitted(&rows), Some(rows))),
            None => Ok((self.color(name)?.unwrap_or([1.0; 3]), None)),
        }
    }

    /// What is no light: a colour, or a spectrum and the colour that it stands for.
    pub fn number(&self, name: &str) -> Result<Option<(Color, Option<Spectrum>)>, LoadError> {
        match self.rows(name)? {
            Some(rows) => Ok(Some((weighed(&rows), Some(rows)))),
            None => Ok(self.color(name)?.map(|color| (color, None))),
        }
    }

    fn rows(&self, name: &str) -> Result<Option<Spectrum>, LoadError> {
        match self.child(name)? {
            Some(index) => rows(&self.document.nodes[index], self.kind, name),
            None => Ok(None),
        }
    }

    /// A colour without texture, each channel ≥ 0.
    pub fn color(&self, name: &str) -> Result<Option<Color>, LoadError> {
        let Some(index) = self.child(name)? else {
            return Ok(None);
        };
        let node = &self.document.nodes[index];
        if node.tag == "texture" {
            return Err(self.unsupported(format!("a texture as {name}"), "give an <rgb>"));
        }
        color(node, self.kind, name).map(Some)
    }

    /// Objects of one kind among the children, references resolved, those asked for by name left out.
    pub fn objects(&self, tag: &str) -> Result<Vec<usize>, LoadError> {
        self.know(&format!("<{tag}>"));
        let mut out = Vec::new();
        for (i, &child) in self.node.children.iter().enumerate() {
            if self.used.borrow()[i] {
                continue;
            }
            let target = resolve(self.document, child)?;
            if self.document.nodes[target].tag == tag {
                self.used.borrow_mut()[i] = true;
                out.push(target);
            }
        }
        Ok(out)
    }

    /// At most one object of a kind.
    pub fn object(&self, tag: &str) -> Result<Option<usize>, LoadError> {
        let all = self.objects(tag)?;
        match all.as_slice() {
            [] => Ok(None),
            [one] => Ok(Some(*one)),
            [first, second, ..] => {
                let line = self.document.nodes[*first].place.line;
                let second = &self.document.nodes[*second];
                Err(second.error(
                    self.kind,
                    Problem::Duplicate {
                        what: format!("<{tag}>"),
                        line,
                    },
                ))
            }
        }
    }

    /// Parameters that are accepted and don't change the image.
    pub fn ignore(&self, names: &[&str]) -> Result<(), LoadError> {
        for name in names {
            self.child(name)?;
        }
        Ok(())
    }

    /// Refuses whatever nobody asked for.
    pub fn finish(&self) -> Result<(), LoadError> {
        let used = self.used.borrow();
        let Some(i) = used.iter().position(|u| !u) else {
            return Ok(());
        };
        let node = &self.document.nodes[self.node.children[i]];
        resolve(self.document, self.node.children[i])?;
        let found = match node.get("name") {
            Some(name) => format!("\"{name}\""),
            None => format!("<{}>", node.tag),
        };
        let known = self.known.borrow();
        let expected = if known.is_empty() {
            "none".into()
        } else {
            known.join(", ")
        };
        Err(node.error(
            self.kind,
            Problem::Unknown {
                what: "parameter",
                found,
                expected,
            },
        ))
    }
}

/// The element itself, or what a `<ref>` refers to.
pub fn resolve(document: &Document, index: usize) -> Result<usize, LoadError> {
    let node = &document.nodes[index];
    if node.tag != "ref" {
        return Ok(index);
    }
    node.only(&["id", "name"])?;
    let id = node.need("id")?;
    let found = document.ids.get(id).copied();
    found.ok_or_else(|| {
        node.error(
            "<ref>",
            Problem::Dangling {
                what: "id".into(),
                found: format!("\"{id}\""),
            },
        )
    })
}
