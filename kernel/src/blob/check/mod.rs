//! The gate: every rule that the kernel relies on ([`Rule`]), checked once, in linear time.
//!
//! What the rest of the kernel may assume of a [`Scene`] is exactly what stands here. The unsafe code
//! in [`crate::shape`] relies on: node children in range, each node's parent link right (so the nodes
//! form a tree, however they are laid out), levels at most `world.depth` ≤ `MAX_DEPTH`, leaves within
//! the packets and spheres. Everything else keeps numbers finite and loops bounded.
//!
//! [`Rule`]: super::rule::Rule

mod contents;
mod geometry;
mod light;
mod media;
mod rules;
mod sensor;
mod surface;

use super::Possible;
use super::error::BlobError;
use super::format::section;
use super::rule::Rule;
use super::scene::Scene;
use crate::sensor::Filter;
use crate::shape::{Bounds, Instructions, IsaKind};
use contents::Contents;
use rules::{at, each, ensure};

pub use rules::MAX_COORDINATE;

/// [`Scene::open`].
pub(super) fn open(bytes: &[u8]) -> Result<Scene<'_>, BlobError> {
    let (header, contents) = Contents::read(bytes)?;
    let scene = Scene {
        bytes,
        header,
        world: contents.single(section::WORLD)?,
        sensor: contents.single(section::SENSOR)?,
        nodes: contents.section(section::NODES)?,
        packets: contents.section(section::PACKETS)?,
        triangles: contents.section(section::TRIANGLES)?,
        spheres: contents.section(section::SPHERES)?,
        normals: contents.section(section::NORMALS)?,
        uvs: contents.section(section::UVS)?,
        shapes: contents.section(section::SHAPES)?,
        materials: contents.section(section::MATERIALS)?,
        textures: contents.section(section::TEXTURES)?,
        texels: contents.section(section::TEXELS)?,
        emitters: contents.section(section::EMITTERS)?,
        choices: contents.section(section::CHOICES)?,
        cells: contents.section(section::CELLS)?,
        media: contents.section(section::MEDIA)?,
        grids: contents.section(section::GRIDS)?,
        isa: Instructions::select(IsaKind::best()),
        possible: Possible::default(),
        filter: Filter::PIXEL,
        bounds: Bounds::NOTHING,
    };
    let s = &scene;
    geometry::world(s).map_err(at(section::WORLD))?;
    sensor::sensor(s, s.sensor).map_err(at(section::SENSOR))?;
    ensure(!s.nodes.is_empty(), Rule::NodeRoot).map_err(at(section::NODES))?;
    each(section::NODES, s.nodes, |i, n| geometry::node(s, i, n))?;
    each(section::PACKETS, s.packets, |_, p| geometry::packet(p))?;
    each(section::TRIANGLES, s.triangles, |_, t| {
        geometry::triangle(s, t)
    })?;
    each(section::SPHERES, s.spheres, |_, b| geometry::sphere(s, b))?;
    each(section::NORMALS, s.normals, |_, n| {
        rules::unit(n, Rule::NormalLength)
    })?;
    each(section::UVS, s.uvs, |_, uv| {
        rules::finite(uv, Rule::UvFinite)
    })?;
    each(section::SHAPES, s.shapes, |i, o| geometry::shape(s, i, o))?;
    each(section::MATERIALS, s.materials, |_, m| {
        surface::material(s, m)
    })?;
    // What textures, environments and grids read may not add up to more than there is: this keeps the
    // passes over their texels and cells linear.
    let mut texels = s.texels.len() as u64;
    let mut cells = s.cells.len() as u64;
    each(section::TEXTURES, s.textures, |_, t| {
        surface::texture(s, t, &mut texels)
    })?;
    each(section::EMITTERS, s.emitters, |i, e| {
        light::emitter(s, i, e, &mut texels, &mut cells)
    })?;
    each(section::GRIDS, s.grids, |_, g| {
        media::grid(s, g, &mut texels)
    })?;
    let mut reads = media::SHARING * s.texels.len() as u64;
    each(section::MEDIA, s.media, |i, m| {
        media::medium(s, i, m, &mut reads)
    })?;
    each(section::CHOICES, s.choices, |_, c| light::choice(s, c))?;
    each(section::CELLS, s.cells, |_, c| light::cell(c))?;
    Ok(Scene {
        possible: Possible::of(s),
        filter: Filter::of(s.sensor),
        bounds: s.nodes.first().map_or(Bounds::NOTHING, Bounds::of),
        ..scene
    })
}
