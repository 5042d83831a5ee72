//! The XML as one tree: included files spliced in, `$names` replaced, ids collected, lines kept.

use super::node::Node;
use crate::description::Place;
use crate::load::error::{LoadError, Problem, file_place};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Deeper nesting is refused: no scene needs it, and the tree may then be walked by recursion.
const DEEPEST: usize = 64;
/// Includes within includes.
const MOST_INCLUDES: usize = 32;
/// Elements of all files together, so that includes of includes can't multiply without end.
const MOST_NODES: usize = 20_000_000;
/// What `$names` stand for in all attributes together, in bytes: defaults made of defaults would double without end.
const MOST_REPLACED: usize = 1 << 26;

/// All elements of a scene.
#[derive(Debug, Default)]
pub struct Document {
    /// Elements; 0 is `<scene>`.
    pub nodes: Vec<Node>,
    /// Elements by id.
    pub ids: HashMap<String, usize>,
    /// Where files are looked for, after the folder of the file that names them.
    pub folders: Vec<PathBuf>,
}

struct Reading<'a> {
    document: Document,
    values: HashMap<String, String>,
    defines: &'a [(String, String)],
    used: HashSet<String>,
    open: Vec<PathBuf>,
    included: usize,
    replaced: usize,
}

impl Document {
    /// Reads a scene file and what it includes.
    pub fn read(path: &Path, defines: &[(String, String)]) -> Result<Self, LoadError> {
        let mut reading = Reading {
            document: Self::default(),
            values: defines.iter().cloned().collect(),
            defines,
            used: HashSet::new(),
            open: Vec::new(),
            included: 0,
            replaced: 0,
        };
        reading.document.folders.push(folder(path));
        reading.file(path, None)?;
        for (name, _) in defines {
            if !reading.used.contains(name) {
                let problem = Problem::Missing {
                    what: format!("a use for the value given for ${name}"),
                    expected: format!("${name} in an attribute"),
                };
                return Err(LoadError::file(path, problem));
            }
        }
        Ok(reading.document)
    }

    /// Finds a file named in the scene at `place`: beside the file that says so, beside the scene,
    /// in `<path>` folders.
    pub fn find(&self, name: &str, place: &Place) -> PathBuf {
        let beside = folder(&place.file).join(name);
        if beside.exists() {
            return beside;
        }
        let others = self.folders.iter().map(|f| f.join(name));
        others.into_iter().find(|p| p.exists()).unwrap_or(beside)
    }
}

fn folder(path: &Path) -> PathBuf {
    path.parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Line numbers from byte positions.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Self {
        Self(
            text.bytes()
                .enumerate()
                .filter(|(_, b)| *b == b'\n')
                .map(|(i, _)| i)
                .collect(),
        )
    }

    fn of(&self, at: usize) -> u32 {
        self.0.partition_point(|&n| n < at) as u32 + 1
    }
}

impl Reading<'_> {
    fn file(&mut self, path: &Path, parent: Option<usize>) -> Result<(), LoadError> {
        let bytes = crate::load::error::read(path)?;
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            let line = bytes[..e.valid_up_to()]
                .iter()
                .filter(|&&b| b == b'\n')
                .count() as u32
                + 1;
            LoadError::malformed(
                path,
                line,
                "text isn't UTF-8, expected an XML file in UTF-8",
            )
        })?;
        let options = roxmltree::ParsingOptions {
            nodes_limit: MOST_NODES as u32,
            ..Default::default()
        };
        let xml = roxmltree::Document::parse_with_options(text, options).map_err(|e| {
            LoadError::malformed(path, e.pos().row, format!("{e}, expected well-formed XML"))
        })?;
        let lines = Lines::new(text);
        let root = xml.root_element();
        let place = |n: &roxmltree::Node| file_place(path, lines.of(n.range().start));
        if root.tag_name().name() != "scene" {
            return Err(LoadError::new(
                &place(&root),
                "",
                Problem::Unknown {
                    what: "root element",
                    found: format!("<{}>", root.tag_name().name()),
                    expected: "<scene>".into(),
                },
            ));
        }
        self.open
            .push(path.canonicalize().unwrap_or_else(|_| path.to_path_buf()));
        let top = match parent {
            Some(parent) => parent,
            None => self.element(&root, place(&root))?,
        };
        // Depth first, in order: defaults hold for what follows them.
        let mut stack: Vec<(roxmltree::Node, usize, usize)> = Vec::new();
        let children = |of: &roxmltree::Node<'_, '_>| -> Vec<roxmltree::NodeId> {
            of.children()
                .filter(|c| c.is_element() || c.is_text())
                .map(|c| c.id())
                .rev()
                .collect()
        };
        stack.extend(
            children(&root)
                .into_iter()
                .filter_map(|id| xml.get_node(id))
                .map(|n| (n, top, 1)),
        );
        while let Some((node, parent, depth)) = stack.pop() {
            let at = place(&node);
            if node.is_text() {
                let text = node.text().unwrap_or("").trim();
                if !text.is_empty() {
                    let start: String = text.chars().take(20).collect();
                    return Err(LoadError::malformed(
                        path,
                        at.line,
                        format!("text {start:?}, expected only elements"),
                    ));
                }
                continue;
            }
            if depth > DEEPEST {
                return Err(LoadError::new(
                    &at,
                    "",
                    Problem::Malformed(format!(
                        "elements nest {depth} deep, expected at most {DEEPEST}"
                    )),
                ));
            }
            match node.tag_name().name() {
                "default" => self.default(&node, at)?,
                "include" => self.include(&node, at)?,
                "path" => self.path(&node, at)?,
                "alias" => self.alias(&node, at)?,
                _ => {
                    let index = self.element(&node, at)?;
                    self.document.nodes[parent].children.push(index);
                    let inner = children(&node)
                        .into_iter()
                        .filter_map(|id| xml.get_node(id));
                    stack.extend(inner.map(|n| (n, index, depth + 1)));
                }
            }
        }
        self.open.pop();
        Ok(())
    }

    /// Adds an element; its id must be new.
    fn element(&mut self, xml: &roxmltree::Node, place: Place) -> Result<usize, LoadError> {
        let node = self.node(xml, place)?;
        if self.document.nodes.len() >= MOST_NODES {
            let text = format!("more than {MOST_NODES} elements, expected fewer");
            return Err(node.error("", Problem::Malformed(text)));
        }
        let index = self.document.nodes.len();
        if node.tag != "ref"
            && let Some(id) = node.get("id")
        {
            self.name(id.to_owned(), index, &node)?;
        }
        self.document.nodes.push(node);
        Ok(index)
    }

    fn name(&mut self, id: String, index: usize, at: &Node) -> Result<(), LoadError> {
        if let Some(&first) = self.document.ids.get(&id) {
            let what = format!("id \"{id}\"");
            let line = self.document.nodes[first].place.line;
            return Err(at.error(format!("<{}>", at.tag), Problem::Duplicate { what, line }));
        }
        self.document.ids.insert(id, index);
        Ok(())
    }

    /// An element without its children.
    fn node(&mut self, xml: &roxmltree::Node, place: Place) -> Result<Node, LoadError> {
        let mut node = Node {
            tag: xml.tag_name().name().to_owned(),
            attributes: Vec::new(),
            children: Vec::new(),
            place,
        };
        for attribute in xml.attributes() {
            let value = self
                .substitute(attribute.name(), attribute.value())
                .map_err(|problem| node.error(format!("<{}>", node.tag), problem))?;
            node.attributes.push((attribute.name().to_owned(), value));
        }
        Ok(node)
    }

    /// Replaces `$name`s in an attribute; the longest name wins.
    fn substitute(&mut self, attribute: &str, text: &str) -> Result<String, Problem> {
        let mut out = String::new();
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            out.push_str(&rest[..at]);
            let tail = &rest[at + 1..];
            let end = tail
                .find(|c: char| !(c.is_alphanumeric() || c == '_'))
                .unwrap_or(tail.len());
            let name = &tail[..end];
            let value = self.values.get(name).ok_or_else(|| Problem::Dangling {
                what: format!("attribute \"{attribute}\""),
                found: format!("${name}"),
            })?;
            self.replaced += value.len();
            if self.replaced > MOST_REPLACED {
                let text =
                    format!("$names stand for more than {MOST_REPLACED} bytes, expected fewer");
                return Err(Problem::Malformed(text));
            }
            out.push_str(value);
            self.used.insert(name.to_owned());
            rest = &tail[end..];
        }
        out.push_str(rest);
        Ok(out)
    }

    fn default(&mut self, xml: &roxmltree::Node, place: Place) -> Result<(), LoadError> {
        let node = self.node(xml, place)?;
        node.only(&["name", "value"])?;
        let (name, value) = (node.need("name")?, node.need("value")?);
        if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '_') {
            let expected = "letters, digits and _".to_owned();
            let found = format!("\"{name}\"");
            return Err(node.error(
                "<default>",
                Problem::Invalid {
                    what: "name".into(),
                    expected,
                    found,
                },
            ));
        }
        if !self.defines.iter().any(|(n, _)| n == name) {
            self.values.insert(name.to_owned(), value.to_owned());
        }
        Ok(())
    }

    fn include(&mut self, xml: &roxmltree::Node, place: Place) -> Result<(), LoadError> {
        let node = self.node(xml, place)?;
        node.only(&["filename"])?;
        let path = self.document.find(node.need("filename")?, &node.place);
        let canonical = path.canonicalize().unwrap_or_else(|_| path.clone());
        let found = path.display().to_string();
        let invalid = |expected: &str| {
            let problem = Problem::Invalid {
                what: "file".into(),
                expected: expected.into(),
                found: found.clone(),
            };
            Err(node.error("<include>", problem))
        };
        if self.open.contains(&canonical) {
            return invalid("one that isn't including this one");
        }
        self.included += 1;
        if self.open.len() >= MOST_INCLUDES || self.included > 10_000 {
            return invalid("one of fewer includes");
        }
        if !path.exists() {
            return invalid("one that exists");
        }
        // Only at the top can an include stand: what it holds belongs to the scene.
        if xml
            .parent_element()
            .is_some_and(|p| p.tag_name().name() != "scene")
        {
            return invalid("directly in <scene>");
        }
        self.file(&path, Some(0))
    }

    fn path(&mut self, xml: &roxmltree::Node, place: Place) -> Result<(), LoadError> {
        let node = self.node(xml, place)?;
        node.only(&["value"])?;
        let path = folder(&node.place.file).join(node.need("value")?);
        if !path.is_dir() {
            let problem = Problem::Invalid {
                what: "value".into(),
                expected: "a folder".into(),
                found: path.display().to_string(),
            };
            return Err(node.error("<path>", problem));
        }
        self.document.folders.push(path);
        Ok(())
    }

    fn alias(&mut self, xml: &roxmltree::Node, place: Place) -> Result<(), LoadError> {
        let node = self.node(xml, place)?;
        node.only(&["id", "as"])?;
        let id = node.need("id")?;
        let Some(&index) = self.document.ids.get(id) else {
            let found = format!("\"{id}\"");
            return Err(node.error(
                "<alias>",
                Problem::Dangling {
                    what: "id".into(),
                    found,
                },
            ));
        };
        let new = node.need("as")?.to_owned();
        self.name(new, index, &node)
    }
}
