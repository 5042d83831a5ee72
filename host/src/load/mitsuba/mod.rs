//! Mitsuba 3 scenes. What this reads means what it means there; what it can't read it refuses.

mod bsdf;
mod constants;
mod document;
mod emitter;
mod glossy;
mod medium;
mod node;
mod plugin;
mod sensor;
mod shape;
mod texture;
mod transform;
mod value;

#[cfg(test)]
mod tests;

use super::error::{LoadError, Problem, file_place};
use super::{Loaded, bitmap};
use crate::description::{Description, Lobe};
use bsdf::Surface;
use document::Document;
use node::Node;
use plugin::{Plugin, resolve};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Loads a Mitsuba 3 scene; see [`super::load`].
pub fn load(path: &Path, defines: &[(String, String)]) -> Result<Loaded, LoadError> {
    let document = Document::read(path, defines)?;
    let mut loader = Loader::new(&document);
    loader.scene(path)?;
    Ok(Loaded {
        description: loader.out,
        warnings: loader.warnings,
    })
}

/// What is being put together.
struct Loader<'a> {
    document: &'a Document,
    out: Description,
    warnings: Vec<String>,
    /// Surfaces, textures, media and phase functions made, by element.
    surfaces: HashMap<usize, Surface>,
    textures: HashMap<(usize, bool), usize>,
    media: HashMap<usize, usize>,
    phases: HashMap<usize, Vec<Lobe>>,
    images: HashMap<(PathBuf, bool), Rc<crate::description::Image>>,
    /// Surfaces and phase functions being made: a cycle of references comes back here.
    open: Vec<usize>,
    integrator: Option<usize>,
    sensor: Option<usize>,
    environment: Option<usize>,
}

impl<'a> Loader<'a> {
    fn new(document: &'a Document) -> Self {
        Self {
            document,
            out: Description::default(),
            warnings: Vec::new(),
            surfaces: HashMap::new(),
            textures: HashMap::new(),
            media: HashMap::new(),
            phases: HashMap::new(),
            images: HashMap::new(),
            open: Vec::new(),
            integrator: None,
            sensor: None,
            environment: None,
        }
    }

    fn warn(&mut self, node: &Node, text: impl std::fmt::Display) {
        self.warnings.push(format!(
            "{}:{}: {text}",
            node.place.file.display(),
            node.place.line
        ));
    }

    /// What messages call an object: its id, or its type and place.
    fn name(&self, node: &Node) -> String {
        match node.get("id") {
            Some(id) => id.to_owned(),
            None => format!(
                "{} at {}:{}",
                node.get("type").unwrap_or(&node.tag),
                node.place.file.display(),
                node.place.line
            ),
        }
    }

    fn scene(&mut self, path: &Path) -> Result<(), LoadError> {
        let document = self.document;
        let root = &document.nodes[0];
        root.only(&["version"])?;
        if let Some(version) = root.get("version")
            && !(version.starts_with("3.") || version.starts_with("2."))
        {
            self.warn(
                root,
                format!("<scene> is of version {version}, it is read as version 3"),
            );
        }
        for &index in &root.children {
            let node = &document.nodes[index];
            match node.tag.as_str() {
                "integrator" => self.integrator(index)?,
                "sensor" => match self.sensor {
                    None => {
                        self.sensor = Some(index);
                        self.out.sensor = self.load_sensor(index)?;
                    }
                    Some(_) => self.warn(node, "only the first sensor is used"),
                },
                "shape" => self.shape(index)?,
                "emitter" => self.emitter(index)?,
                "bsdf" | "texture" | "medium" | "phase" | "volume" => {}
                "ref" if node.get("name") == Some("exterior") => {
                    let target = resolve(document, index)?;
                    self.exterior(index, target)?;
                }
                "ref" => {
                    resolve(document, index)?;
                }
                other => {
                    let expected = "integrator, sensor, bsdf, texture, medium, shape, emitter, default, include, alias or path";
                    return Err(node.error(
                        "<scene>",
                        Problem::Unknown {
                            what: "element",
                            found: format!("<{other}>"),
                            expected: expected.into(),
                        },
                    ));
                }
            }
        }
        if self.sensor.is_none() {
            let expected = "<sensor type=\"perspective\">".to_owned();
            return Err(LoadError::new(
                &file_place(path, root.place.line),
                "<scene>",
                Problem::Missing {
                    what: "sensor".into(),
                    expected,
                },
            ));
        }
        if self.out.emitters.is_empty() && self.out.shapes.iter().all(|s| s.emission.is_none()) {
            self.warn(root, "nothing in the scene emits light");
        }
        self.unused()
    }

    /// Our own: `<ref name="exterior" id="…"/>` in the scene names the medium outside of all objects.
    fn exterior(&mut self, index: usize, target: usize) -> Result<(), LoadError> {
        let node = &self.document.nodes[index];
        let tag = &self.document.nodes[target].tag;
        if tag != "medium" {
            let problem = Problem::Invalid {
                what: "exterior".into(),
                expected: "a <medium>".into(),
                found: format!("<{tag}>"),
            };
            return Err(node.error("<scene>", problem));
        }
        if self.out.exterior.is_some() {
            let text = "names a second exterior, expected one".to_owned();
            return Err(node.error("<scene>", Problem::Malformed(text)));
        }
        self.out.exterior = Some(self.medium(target)?);
        Ok(())
    }

    /// Checks named objects that nothing refers to: one that isn't supported is only told of.
    fn unused(&mut self) -> Result<(), LoadError> {
        let document = self.document;
        let refs = document.nodes.iter().filter(|n| n.tag == "ref");
        let referred: HashSet<usize> = refs
            .filter_map(|n| document.ids.get(n.get("id")?).copied())
            .collect();
        for &index in &document.nodes[0].children {
            if referred.contains(&index) {
                continue;
            }
            let node = &document.nodes[index];
            if !["bsdf", "texture", "medium", "phase", "volume"].contains(&node.tag.as_str()) {
                continue;
            }
            let kept = (
                self.out.materials.len(),
                self.out.textures.len(),
                self.out.media.len(),
                self.warnings.len(),
            );
            let made = (
                self.surfaces.clone(),
                self.textures.clone(),
                self.media.clone(),
            );
            let result = match node.tag.as_str() {
                "bsdf" => self.surface(index).map(|_| ()),
                "texture" => self.texture(index, false).map(|_| ()),
                "medium" => self.medium(index).map(|_| ()),
                "phase" => self.phase(index).map(|_| ()),
                _ => medium::volume(document, index).map(|_| ()),
            };
            self.out.materials.truncate(kept.0);
            self.out.textures.truncate(kept.1);
            self.out.media.truncate(kept.2);
            self.warnings.truncate(kept.3);
            (self.surfaces, self.textures, self.media) = made;
            self.open.clear();
            match result {
                Err(error) if matches!(*error.problem, Problem::Unsupported { .. }) => {
                    let text = format!("{error} (nothing refers to it, so it is left out)");
                    self.warnings.push(text);
                }
                other => other?,
            }
        }
        Ok(())
    }

    fn integrator(&mut self, index: usize) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.document, index)?;
        if let Some(first) = self.integrator.replace(index) {
            let line = self.document.nodes[first].place.line;
            return Err(plugin.node.error(
                "<scene>",
                Problem::Duplicate {
                    what: "<integrator>".into(),
                    line,
                },
            ));
        }
        match plugin.kind {
            "path" | "volpath" | "volpathmis" => {}
            "bdpt" | "ptracer" => {
                let text = format!(
                    "integrator {}: the command line picks the estimator",
                    plugin.kind
                );
                self.warn(plugin.node, text);
            }
            "direct" | "aov" | "depth" | "moment" | "stokes" | "prb" | "prb_basic" => {
                return Err(
                    plugin.unsupported(format!("integrator {}", plugin.kind), "choose path")
                );
            }
            _ => return Err(plugin.unknown("path, volpath or volpathmis (or bdpt, ptracer)")),
        }
        self.out.advice.max_depth = match plugin.integer("max_depth")? {
            None | Some(-1) => None,
            Some(n) => match u32::try_from(n) {
                Ok(n) => Some(n),
                Err(_) => return Err(plugin.invalid("max_depth", "-1 (unlimited), 0 or more", n)),
            },
        };
        plugin.integer("rr_depth")?;
        if plugin.boolean("hide_emitters")? == Some(true) {
            return Err(plugin.unsupported("hide_emitters", "leave it false"));
        }
        plugin.ignore(&["samples_per_pass", "block_size", "timeout"])?;
        plugin.finish()
    }

    /// An image; each file is read once.
    fn image(
        &mut self,
        path: PathBuf,
        raw: bool,
    ) -> Result<Rc<crate::description::Image>, LoadError> {
        let key = (path, raw);
        if let Some(image) = self.images.get(&key) {
            return Ok(image.clone());
        }
        let image = Rc::new(bitmap::load(&key.0, raw)?);
        self.images.insert(key, image.clone());
        Ok(image)
    }
}
