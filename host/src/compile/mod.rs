//! A description to a blob: everything the kernel would otherwise have to work out.

mod alias;
pub mod bvh;
mod doubts;
mod emitters;
mod geometry;
mod glossy;
mod media;
mod surfaces;
mod writer;

use crate::blob::AlignedBlob;
use crate::description::{Description, Geometry, Place};
use crate::spectra::append;
use emitters::{Emitters, Emitting};
use etendue::Scene;
use etendue::blob::BlobError;
use etendue::blob::format::{
    Emitter, LANES, Material, NONE, Node, Shape, Sphere, Triangle, World, child, emitter, material,
    needs, section,
};
use geometry::{Flat, size, sphere_area, triangle_area};
use media::space::{self, Found};
use media::{Media, contact, lines};
use std::path::Path;
use surfaces::Surfaces;

/// The least area of a light: the density of a point on it, 1 over it at most, still fits single precision.
const LEAST_AREA: f64 = 1e-37;

/// A light is small if it is of less than this part of the scene's size.
const SMALL: f64 = 0.05;

/// A compiled scene.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The blob.
    pub blob: AlignedBlob,
    /// What the builder says of its tree.
    pub quality: bvh::Quality,
    /// The tree's shape, for [`recompile`].
    pub tree: bvh::Tree,
    /// Whether the tree has the shape of one that was given.
    pub refitted: bool,
    /// What the reader should know: what stands in which medium, where objects and the description don't agree; what can't be rendered well.
    pub warnings: Vec<String>,
}

/// Why a description can't be compiled.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}{name}: {reason}", describe(.place))]
pub struct CompileError {
    /// Where the object was said.
    pub place: Place,
    /// What the object is called.
    pub name: String,
    /// What is wrong and what was expected.
    pub reason: String,
}

impl CompileError {
    /// The same, in `file` if it isn't known to be about another.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        if self.place.file.as_os_str().is_empty() {
            self.place.file = file.to_path_buf();
        }
        self
    }
}

fn describe(place: &Place) -> String {
    let file = place.file.display();
    match place.line {
        _ if place.file.as_os_str().is_empty() => String::new(),
        0 => format!("{file}: "),
        line => format!("{file}:{line}: "),
    }
}

/// Compiles a scene.
///
/// # Errors
/// A number out of its range, a light without area, a second background, or more of something than the format can count. What
/// is returned opens: the kernel's gate has seen it.
pub fn compile(d: &Description) -> Result<Compiled, CompileError> {
    assemble(d, None)
}

/// Compiles a scene whose objects have moved since it was compiled to `tree`: the tree keeps its shape and gets new boxes, which
/// takes a small part of the time of building one. [`bvh::Quality::sah_cost`] says what rays lose by it. Where the tree doesn't fit (another
/// number of primitives; a triangle got or lost its area), a new one is built.
///
/// # Errors
/// As [`compile`].
pub fn recompile(d: &Description, tree: &bvh::Tree) -> Result<Compiled, CompileError> {
    assemble(d, Some(tree))
}

fn assemble(d: &Description, tree: Option<&bvh::Tree>) -> Result<Compiled, CompileError> {
    let (apart, touching) = contact::set_apart(d);
    let d = apart.as_ref().unwrap_or(d);
    let mut surfaces = Surfaces::compile(d);
    let mut media =
        Media::compile(d, &mut surfaces.texels).map_err(|(id, reason)| CompileError {
            place: d.media[id].place.clone(),
            name: d.media[id].name.clone(),
            reason,
        })?;
    let mut emitters = Emitters::default();
    let mut geometry = Flat::default();
    let mut shapes = Vec::new();
    for (id, s) in d.shapes.iter().enumerate() {
        let fail = |reason: String| CompileError {
            place: s.place.clone(),
            name: s.name.clone(),
            reason,
        };
        let id = id as u32;
        let emission = s.emission.filter(|l| l.iter().any(|&x| x > 0.0));
        let mut shape = Shape {
            front: optional(s.front),
            back: optional(s.back),
            interior: optional(s.interior),
            exterior: optional(s.exterior),
            emitter: emission.map_or(NONE, |l| {
                let rows = s.spectrum.as_deref();
                let spectrum = rows.map_or([0; 2], |rows| append(&mut surfaces.texels, rows));
                emitters.area(id, l, spectrum)
            }),
            opacity: s.opacity.map_or(NONE, |o| surfaces.as_texture(o)),
            normals: NONE,
            uvs: NONE,
            ..bytemuck::Zeroable::zeroed()
        };
        if s.opacity.is_some() {
            surfaces.needs |= needs::MASKS;
        }
        let area = match &s.geometry {
            Geometry::Mesh(mesh) => geometry.mesh(id, mesh, &mut shape).map_err(fail)?,
            Geometry::Sphere {
                center,
                radius,
                flipped,
            } => geometry
                .sphere(id, *center, *radius, *flipped)
                .map_err(fail)?,
        };
        if emission.is_some() && area < LEAST_AREA {
            return Err(fail(format!(
                "a light needs an area of at least {LEAST_AREA:e}, found {area:e}"
            )));
        }
        shapes.push(shape);
    }
    let whole = |reason: String| CompileError {
        place: Place::default(),
        name: "scene".into(),
        reason,
    };
    let refitted = tree.and_then(|tree| bvh::refit(tree, &geometry.corners, &geometry.spheres));
    let was_refitted = refitted.is_some();
    let mut built = match refitted {
        Some(built) => built,
        None => {
            bvh::build(&geometry.corners, &geometry.spheres).map_err(|e| whole(e.to_string()))?
        }
    };
    name_parents(&mut built.nodes);
    let (center, radius) = geometry.bounds();
    // Primitives get the ids that the tree gave them.
    let empty = Triangle {
        index: [0; 3],
        shape: NONE,
    };
    let triangles: Vec<Triangle> = built
        .slots
        .iter()
        .map(|&source| {
            geometry
                .triangles
                .get(source as usize)
                .copied()
                .unwrap_or(empty)
        })
        .collect();
    let spheres: Vec<Sphere> = built
        .sphere_order
        .iter()
        .map(|&s| geometry.sphere_records[s as usize])
        .collect();
    let found = if d.media.is_empty() {
        Found::vacuum(d)
    } else {
        let tree = lines::Tree {
            nodes: &built.nodes,
            packets: &built.packets,
            triangles: &triangles,
            spheres: &spheres,
        };
        space::find(d, &tree, center, radius)?
    };
    for glowing in &media.glowing {
        let emitter = emitters.volume(glowing);
        media.media[glowing.medium as usize].emitter = emitter;
    }
    for (e, medium) in d.emitters.iter().zip(&found.emitters) {
        let fail = |reason: String| CompileError {
            place: e.place.clone(),
            name: e.name.clone(),
            reason,
        };
        emitters
            .add(
                &e.kind,
                *medium,
                e.spectrum.as_deref(),
                f64::from(radius),
                &mut surfaces.texels,
            )
            .map_err(fail)?;
    }
    let sphere_base = (built.packets.len() * LANES) as u32;
    let mut emitting = Vec::new();
    let mut push = |shape: u32, primitive: u32, area: f64| {
        let emitter = shapes
            .get(shape as usize)
            .map_or(NONE, |s: &Shape| s.emitter);
        if emitter != NONE {
            emitting.push(Emitting {
                emitter,
                primitive,
                area,
            });
        }
    };
    for (slot, (t, &source)) in triangles.iter().zip(&built.slots).enumerate() {
        if t.shape != NONE {
            push(
                t.shape,
                slot as u32,
                triangle_area(&geometry.corners[source as usize]),
            );
        }
    }
    for (i, s) in spheres.iter().enumerate() {
        push(s.shape, sphere_base + i as u32, sphere_area(s.radius));
    }
    emitters.choose(&emitting);
    let world = World {
        center,
        radius,
        depth: built.depth,
        sphere_base,
        background: emitters.background.unwrap_or(NONE),
        exterior: optional(found.exterior),
        reserved: [0; 8],
    };
    let used = |m: &u32| *m != NONE;
    let null = shapes
        .iter()
        .flat_map(|s| [s.front, s.back])
        .filter(used)
        .any(|m| surfaces.materials[m as usize].kind == material::NULL);
    let mut bits = surfaces.needs & !needs::NULL | if null { needs::NULL } else { 0 } | media.needs;
    let small = |s: &crate::description::Shape| {
        s.emission.is_some() && size(&s.geometry) < SMALL * f64::from(radius)
    };
    let small = d.shapes.iter().any(small) || !d.emitters.iter().all(|e| is_distant(&e.kind));
    for (holds, bit) in [
        (
            small && media.needs & needs::MEDIA != 0,
            needs::SMALL_LIGHTS,
        ),
        (d.spectral(), needs::SPECTRAL),
        (!spheres.is_empty(), needs::SPHERES),
        (!geometry.normals.is_empty(), needs::SMOOTH_NORMALS),
        (
            d.emitters.iter().any(|e| is_distant(&e.kind)),
            needs::DISTANT,
        ),
    ] {
        bits |= if holds { bit } else { 0 };
    }
    let mut writer = writer::Writer::default();
    writer.section(section::WORLD, &[world]);
    writer.section(
        section::SENSOR,
        &[surfaces::sensor(&d.sensor, found.sensor)],
    );
    writer.section(section::NODES, &built.nodes);
    writer.section(section::PACKETS, &built.packets);
    writer.section(section::TRIANGLES, &triangles);
    writer.section(section::SPHERES, &spheres);
    writer.section(section::NORMALS, &geometry.normals);
    writer.section(section::UVS, &geometry.uvs);
    writer.section(section::SHAPES, &shapes);
    writer.section(section::MATERIALS, &surfaces.materials);
    writer.section(section::TEXTURES, &surfaces.textures);
    writer.section(section::TEXELS, &surfaces.texels);
    writer.section(section::EMITTERS, &emitters.emitters);
    writer.section(section::CHOICES, &emitters.choices);
    writer.section(section::CELLS, &emitters.cells);
    writer.section(section::MEDIA, &media.media);
    writer.section(section::GRIDS, &media.grids);
    let blob = writer.finish(bits, film_exponent(emitters.scale));
    if let Err(e) = Scene::open(blob.bytes()) {
        return Err(refused(d, &e, &emitters.emitters, &surfaces.materials));
    }
    Ok(Compiled {
        blob,
        quality: built.quality,
        tree: bvh::Tree {
            nodes: built.nodes,
            slots: built.slots,
            sphere_order: built.sphere_order,
            depth: built.depth,
        },
        refitted: was_refitted,
        warnings: [touching, found.warnings, doubts::doubts(d)].concat(),
    })
}

/// What the gate says of a blob, said of what the description calls it.
fn refused(
    d: &Description,
    e: &BlobError,
    emitters: &[Emitter],
    materials: &[Material],
) -> CompileError {
    let nowhere = |name: &str| (Place::default(), name.to_string());
    let of_shape = |s: usize| d.shapes.get(s).map(|s| (s.place.clone(), s.name.clone()));
    let index = e.index as usize;
    let of_medium = |m: usize| d.media.get(m).map(|m| (m.place.clone(), m.name.clone()));
    let of_material = |m: usize| d.materials.get(m).map(|m| nowhere(&m.name));
    // The lights of shapes and media stand before the others.
    let of_light = || {
        let e = emitters.get(index)?;
        if e.kind == emitter::AREA {
            return of_shape(e.shape as usize);
        }
        if e.kind == emitter::VOLUME {
            return of_medium(e.medium as usize);
        }
        let light = (index + d.emitters.len()).checked_sub(emitters.len())?;
        let light = d.emitters.get(light)?;
        Some((light.place.clone(), light.name.clone()))
    };
    let found = match e.section {
        section::SENSOR => Some(nowhere("sensor")),
        section::SHAPES => of_shape(index),
        section::MATERIALS => of_material(index),
        section::TEXTURES => d.textures.get(index).map(|t| nowhere(&t.name)).or_else(|| {
            // Made for a material.
            let its = |m: &Material| m.texture.contains(&e.index);
            let material = materials.iter().position(its);
            material.and_then(of_material)
        }),
        section::EMITTERS => of_light(),
        section::MEDIA => of_medium(index),
        _ => None,
    };
    let (place, name) = found.unwrap_or_else(|| nowhere("scene"));
    CompileError {
        place,
        name,
        reason: e.to_string(),
    }
}

/// Writes into every node whose child it is, and how deep: what lets the kernel prove in one pass that
/// the nodes form a tree. Parents come before their children.
fn name_parents(nodes: &mut [Node]) {
    for parent in 0..nodes.len() {
        let level = nodes[parent].level + 1;
        for reference in nodes[parent].children {
            if reference != child::EMPTY && reference & child::LEAF == 0 {
                let below = &mut nodes[reference as usize];
                (below.parent, below.level) = (parent as u32, level);
            }
        }
    }
}

/// The film counts in steps of 2^(e−64) up to 2^(e+63): 2¹⁶ above the scene's brightest radiance leaves 47 bits
/// for fireflies above it and 48 for rounding below.
fn film_exponent(scale: f64) -> i32 {
    if scale > 0.0 {
        (scale.log2().ceil() as i32 + 16).clamp(-40, 60)
    } else {
        16
    }
}

fn optional(id: Option<usize>) -> u32 {
    id.map_or(NONE, |id| id as u32)
}

fn is_distant(kind: &crate::description::EmitterKind) -> bool {
    use crate::description::EmitterKind::{Point, Spot};
    !matches!(kind, Point { .. } | Spot { .. })
}
