//! The gate: every invariant that the kernel relies on, checked once, in linear time.
//!
//! What the rest of the kernel may assume of a [`Scene`] is exactly what stands here. The unsafe code
//! in [`crate::shape`] relies on: node children in range, each node's parent link right (so the nodes
//! form a tree, however they are laid out), levels at most `world.depth` ≤ [`MAX_DEPTH`], leaves within
//! the packets and spheres. Everything else keeps numbers finite and loops bounded.

use super::error::{BlobError, Problem};
use super::format::{
    Cell, Choice, Emitter, Header, LANES, MAGIC, MAX_DEPTH, Material, NONE, Node, Packet,
    SECTION_ALIGN, Sensor, Shape, Sphere, Texture, Toc, Triangle, VERSION, World, child, emitter,
    material, needs, section, sensor, texture,
};
use super::scene::Scene;
use crate::shape::{Instructions, IsaKind};
use bytemuck::{AnyBitPattern, NoUninit};

/// The largest coordinate: products of three differences stay finite in single precision.
pub const MAX_COORDINATE: f32 = 1e12;

type Checked = Result<(), Problem>;

fn ensure(holds: bool, otherwise: Problem) -> Checked {
    if holds { Ok(()) } else { Err(otherwise) }
}

/// Runs `check` over the records of a section, and says where it failed.
fn each<T>(
    kind: u32,
    records: &[T],
    mut check: impl FnMut(usize, &T) -> Checked,
) -> Result<(), BlobError> {
    for (i, record) in records.iter().enumerate() {
        check(i, record).map_err(|problem| BlobError {
            problem,
            section: kind,
            index: i as u32,
        })?;
    }
    Ok(())
}

fn at(section: u32) -> impl Fn(Problem) -> BlobError {
    move |problem| BlobError {
        problem,
        section,
        index: 0,
    }
}

fn finite(values: &[f32]) -> Checked {
    within(values, -f32::MAX, f32::MAX)
}

/// All of `values` in [low, high]; NaN never is.
fn within(values: &[f32], low: f32, high: f32) -> Checked {
    ensure(
        values.iter().all(|v| (low..=high).contains(v)),
        Problem::Range,
    )
}

fn coordinates(values: &[f32]) -> Checked {
    within(values, -MAX_COORDINATE, MAX_COORDINATE)
}

fn unit(v: &[f32; 3]) -> Checked {
    finite(v)?;
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    ensure((0.999..=1.001).contains(&square), Problem::Range)
}

fn optional(id: u32, count: usize) -> Checked {
    ensure(id == NONE || (id as usize) < count, Problem::Reference)
}

/// `first .. first + count` within `length`.
fn span(first: u32, count: u64, length: usize) -> Checked {
    let end = u64::from(first).checked_add(count);
    ensure(end.is_some_and(|e| e <= length as u64), Problem::Reference)
}

/// The table of contents, looked up by kind.
struct Contents<'a> {
    bytes: &'a [u8],
    table: &'a [Toc],
}

impl<'a> Contents<'a> {
    fn read(bytes: &'a [u8]) -> Result<(&'a Header, Self), Problem> {
        ensure(bytes.as_ptr().align_offset(16) == 0, Problem::Misaligned)?;
        let head = bytes.get(..64).ok_or(Problem::Truncated)?;
        let header: &Header = bytemuck::try_from_bytes(head).map_err(|_| Problem::Misaligned)?;
        ensure(header.magic == MAGIC, Problem::Magic)?;
        ensure(header.version == VERSION, Problem::Version)?;
        ensure(header.length == bytes.len() as u64, Problem::Truncated)?;
        ensure(header.needs & !needs::KNOWN == 0, Problem::Needs)?;
        ensure((-64..=64).contains(&header.film_exponent), Problem::Range)?;
        ensure(header.reserved == [0; 8], Problem::Reserved)?;
        ensure(
            header.section_count as usize == section::ALL.len(),
            Problem::Section,
        )?;
        let end = 64 + section::ALL.len() * size_of::<Toc>();
        let table = bytes.get(64..end).ok_or(Problem::Truncated)?;
        let table: &[Toc] = bytemuck::try_cast_slice(table).map_err(|_| Problem::Misaligned)?;
        for (i, a) in table.iter().enumerate() {
            ensure(a.reserved == 0, Problem::Reserved)?;
            let size = a
                .count
                .checked_mul(u64::from(a.stride))
                .ok_or(Problem::Section)?;
            let stop = a.offset.checked_add(size).ok_or(Problem::Section)?;
            ensure(
                a.offset % SECTION_ALIGN == 0
                    && a.offset >= end as u64
                    && stop <= header.length
                    && a.count < u64::from(NONE),
                Problem::Section,
            )?;
            // Fifteen sections: comparing each with each is still a constant.
            for b in table.iter().take(i) {
                let b_stop = b
                    .offset
                    .saturating_add(b.count.saturating_mul(u64::from(b.stride)));
                ensure(a.kind != b.kind, Problem::Section)?;
                ensure(
                    size == 0 || stop <= b.offset || a.offset >= b_stop,
                    Problem::Section,
                )?;
            }
        }
        Ok((header, Self { bytes, table }))
    }

    fn section<T: AnyBitPattern + NoUninit>(&self, kind: u32) -> Result<&'a [T], BlobError> {
        let find = || {
            let entry = self.table.iter().find(|t| t.kind == kind)?;
            if entry.stride as usize != size_of::<T>() {
                return None;
            }
            let start = usize::try_from(entry.offset).ok()?;
            let size = usize::try_from(entry.count.checked_mul(u64::from(entry.stride))?).ok()?;
            let bytes = self.bytes.get(start..start.checked_add(size)?)?;
            bytemuck::try_cast_slice(bytes).ok()
        };
        find().ok_or(at(kind)(Problem::Section))
    }

    /// A section that holds exactly one record.
    fn single<T: AnyBitPattern + NoUninit>(&self, kind: u32) -> Result<&'a T, BlobError> {
        match self.section::<T>(kind)? {
            [one] => Ok(one),
            _ => Err(at(kind)(Problem::Section)),
        }
    }
}

/// [`Scene::open`].
pub(super) fn open(bytes: &[u8]) -> Result<Scene<'_>, BlobError> {
    if cfg!(target_endian = "big") {
        return Err(at(0)(Problem::Version));
    }
    let (header, contents) = Contents::read(bytes).map_err(at(0))?;
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
        isa: Instructions::select(IsaKind::best()),
    };
    check_world(&scene).map_err(at(section::WORLD))?;
    check_sensor(scene.sensor).map_err(at(section::SENSOR))?;
    ensure(!scene.nodes.is_empty(), Problem::Tree).map_err(at(section::NODES))?;
    each(section::NODES, scene.nodes, |i, n| check_node(&scene, i, n))?;
    each(section::PACKETS, scene.packets, |_, p: &Packet| {
        coordinates(p.v.as_flattened().as_flattened())
    })?;
    each(section::TRIANGLES, scene.triangles, |_, t| {
        check_triangle(&scene, t)
    })?;
    each(section::SPHERES, scene.spheres, |_, s| {
        check_sphere(&scene, s)
    })?;
    each(section::NORMALS, scene.normals, |_, n| unit(n))?;
    each(section::UVS, scene.uvs, |_, uv| finite(uv))?;
    each(section::SHAPES, scene.shapes, |i, s| {
        check_shape(&scene, i, s)
    })?;
    each(section::MATERIALS, scene.materials, |_, m| {
        check_material(&scene, m)
    })?;
    // What textures and environments read may not add up to more than there is: this keeps the
    // pass over their texels linear.
    let mut budget = scene.texels.len() as u64;
    each(section::TEXTURES, scene.textures, |_, t| {
        check_texture(&scene, t, &mut budget)
    })?;
    let mut cells = scene.cells.len() as u64;
    each(section::EMITTERS, scene.emitters, |i, e| {
        check_emitter(&scene, i, e, &mut budget, &mut cells)
    })?;
    each(section::CHOICES, scene.choices, |_, c| {
        check_choice(&scene, c)
    })?;
    each(section::CELLS, scene.cells, |_, c: &Cell| {
        within(&[c.keep, c.probability], 0.0, 1.0)
    })?;
    Ok(scene)
}

fn check_world(scene: &Scene<'_>) -> Checked {
    let w: &World = scene.world;
    coordinates(&w.center)?;
    within(&[w.radius], f32::MIN_POSITIVE, 4.0 * MAX_COORDINATE)?;
    ensure(w.depth <= MAX_DEPTH, Problem::Tree)?;
    ensure(
        scene.packets.len().checked_mul(LANES) == Some(w.sphere_base as usize)
            && scene.triangles.len() == w.sphere_base as usize,
        Problem::Mismatch,
    )?;
    span(w.sphere_base, scene.spheres.len() as u64, NONE as usize)?;
    optional(w.background, scene.emitters.len())?;
    if let Some(e) = scene.emitter(w.background) {
        ensure(
            matches!(
                e.kind,
                emitter::CONSTANT | emitter::LATLONG | emitter::CUBEMAP
            ),
            Problem::Reference,
        )?;
    }
    ensure(w.exterior == NONE, Problem::Reference)?;
    ensure(w.reserved == [0; 8], Problem::Reserved)
}

fn check_sensor(s: &Sensor) -> Checked {
    ensure(
        s.kind <= sensor::ORTHOGRAPHIC && s.filter <= sensor::GAUSSIAN,
        Problem::Kind,
    )?;
    within(&[s.filter_radius], 1e-3, 8.0)?;
    within(
        &[s.filter_sigma],
        if s.filter == sensor::GAUSSIAN {
            1e-3
        } else {
            0.0
        },
        8.0,
    )?;
    for axis in 0..2 {
        let end = s.crop_offset[axis].checked_add(s.crop_size[axis]);
        ensure(
            s.crop_size[axis] >= 1
                && s.resolution[axis] <= 1 << 16
                && end.is_some_and(|e| e <= s.resolution[axis]),
            Problem::Range,
        )?;
    }
    within(&s.half_extent, 1e-9, MAX_COORDINATE)?;
    within(&[s.aperture], 0.0, MAX_COORDINATE)?;
    within(&[s.focus], 1e-9, MAX_COORDINATE)?;
    within(&s.clip, 0.0, f32::MAX)?;
    ensure(s.clip[0] < s.clip[1], Problem::Range)?;
    coordinates(&s.origin)?;
    finite(&s.principal)?;
    unit(&s.right)?;
    unit(&s.down)?;
    unit(&s.forward)?;
    ensure(s.medium == NONE, Problem::Reference)?;
    ensure(s.reserved == [0; 1], Problem::Reserved)
}

/// A child node names its parent and its parent's level plus one. As no two children of one node are the
/// same, no node is reached twice: the nodes that traversal can reach form a tree of bounded depth.
fn check_node(scene: &Scene<'_>, index: usize, n: &Node) -> Checked {
    ensure(n.level <= scene.world.depth, Problem::Tree)?;
    ensure(n.reserved == [0; 6], Problem::Reserved)?;
    if index == 0 {
        ensure(n.level == 0 && n.parent == NONE, Problem::Tree)?;
    }
    ensure(
        n.low
            .as_flattened()
            .iter()
            .chain(n.high.as_flattened())
            .all(|x| !x.is_nan()),
        Problem::Range,
    )?;
    for (i, &reference) in n.children.iter().enumerate() {
        if reference == child::EMPTY {
            continue;
        }
        if reference & child::LEAF == 0 {
            let below = scene
                .nodes
                .get(reference as usize)
                .ok_or(Problem::Reference)?;
            ensure(
                reference != 0 && below.parent as usize == index && below.level == n.level + 1,
                Problem::Tree,
            )?;
            ensure(
                n.children.iter().take(i).all(|&c| c != reference),
                Problem::Tree,
            )?;
        } else {
            let spheres = reference & child::SPHERES != 0;
            let count = ((reference >> child::COUNT_SHIFT) & 15) + 1;
            let all = if spheres {
                scene.spheres.len()
            } else {
                scene.packets.len()
            };
            span(reference & child::START_MASK, u64::from(count), all)?;
        }
    }
    Ok(())
}

fn check_triangle(scene: &Scene<'_>, t: &Triangle) -> Checked {
    if t.shape == NONE {
        return Ok(());
    }
    let shape = scene.shape(t.shape).ok_or(Problem::Reference)?;
    let indexed = shape.normals != NONE || shape.uvs != NONE;
    ensure(
        !indexed || t.index.iter().all(|&i| i < shape.vertices),
        Problem::Reference,
    )
}

fn check_sphere(scene: &Scene<'_>, s: &Sphere) -> Checked {
    coordinates(&s.center)?;
    within(&[s.radius], f32::MIN_POSITIVE, MAX_COORDINATE)?;
    ensure((s.shape as usize) < scene.shapes.len(), Problem::Reference)?;
    ensure(s.flipped <= 1, Problem::Kind)?;
    ensure(s.reserved == [0; 2], Problem::Reserved)
}

fn check_shape(scene: &Scene<'_>, index: usize, s: &Shape) -> Checked {
    optional(s.front, scene.materials.len())?;
    optional(s.back, scene.materials.len())?;
    ensure(s.interior == NONE && s.exterior == NONE, Problem::Reference)?;
    optional(s.opacity, scene.textures.len())?;
    optional(s.emitter, scene.emitters.len())?;
    if let Some(e) = scene.emitter(s.emitter) {
        ensure(
            e.kind == emitter::AREA && e.shape as usize == index,
            Problem::Reference,
        )?;
    }
    if s.normals != NONE {
        span(s.normals, u64::from(s.vertices), scene.normals.len())?;
    }
    if s.uvs != NONE {
        span(s.uvs, u64::from(s.vertices), scene.uvs.len())?;
    }
    ensure(s.reserved == [0; 7], Problem::Reserved)
}

fn check_material(scene: &Scene<'_>, m: &Material) -> Checked {
    ensure(m.kind <= material::SHEET, Problem::Kind)?;
    let known = if m.kind == material::DIELECTRIC {
        material::SCHLICK
    } else {
        0
    };
    ensure(m.flags & !known == 0, Problem::Kind)?;
    within(m.color.as_flattened(), 0.0, 1.0)?;
    for &t in &m.texture {
        optional(t, scene.textures.len())?;
    }
    within(&[m.ior], 1e-3, 1e3)?;
    within(&m.eta, 0.0, 1e6)?;
    within(&m.k, 0.0, 1e6)?;
    ensure(m.reserved == 0 && m.reserved2 == [0; 6], Problem::Reserved)
}

fn check_texture(scene: &Scene<'_>, t: &Texture, budget: &mut u64) -> Checked {
    ensure(cfg!(feature = "textures"), Problem::Needs)?;
    let known = texture::NEAREST | texture::CLAMP | texture::MIRROR | texture::ALPHA;
    ensure(
        t.kind <= texture::FLOAT && t.flags & !known == 0,
        Problem::Kind,
    )?;
    finite(t.to_uv.as_flattened())?;
    within(t.color.as_flattened(), 0.0, 1.0)?;
    ensure(t.reserved == 0 && t.reserved2 == [0; 6], Problem::Reserved)?;
    if t.kind == texture::CHECKERBOARD {
        return Ok(());
    }
    let words = if t.kind == texture::FLOAT { 3 } else { 1 };
    let texels = texels_of(scene, t.texels, t.width, t.height, words, budget)?;
    let unit = |w: &u32| (0.0..=1.0).contains(&f32::from_bits(*w));
    ensure(
        t.kind != texture::FLOAT || texels.iter().all(unit),
        Problem::Range,
    )
}

/// The words of an image, paid for from the budget.
fn texels_of<'a>(
    scene: &Scene<'a>,
    first: u32,
    width: u32,
    height: u32,
    words: u64,
    budget: &mut u64,
) -> Result<&'a [u32], Problem> {
    ensure(
        (1..=1 << 16).contains(&width) && (1..=1 << 18).contains(&height),
        Problem::Range,
    )?;
    let count = u64::from(width) * u64::from(height) * words;
    span(first, count, scene.texels.len())?;
    *budget = budget.checked_sub(count).ok_or(Problem::Section)?;
    let first = first as usize;
    scene
        .texels
        .get(first..first + count as usize)
        .ok_or(Problem::Reference)
}

fn check_emitter(
    scene: &Scene<'_>,
    index: usize,
    e: &Emitter,
    texels: &mut u64,
    cells: &mut u64,
) -> Checked {
    ensure(e.kind <= emitter::CUBEMAP, Problem::Kind)?;
    let image = matches!(e.kind, emitter::LATLONG | emitter::CUBEMAP);
    ensure(cfg!(feature = "environment") || !image, Problem::Needs)?;
    within(&e.radiance, 0.0, 1e30)?;
    within(&[e.density], 0.0, f32::MAX)?;
    coordinates(&e.position)?;
    ensure(e.reserved == [0; 5], Problem::Reserved)?;
    match e.kind {
        emitter::AREA => {
            let shape = scene.shape(e.shape).ok_or(Problem::Reference)?;
            ensure(shape.emitter as usize == index, Problem::Reference)
        }
        emitter::SPOT => {
            unit(&e.direction)?;
            within(&[e.cos_inner, e.cos_outer], -1.0, 1.0)?;
            ensure(e.cos_outer < e.cos_inner, Problem::Range)
        }
        emitter::DIRECTIONAL => unit(&e.direction),
        emitter::LATLONG | emitter::CUBEMAP => {
            e.to_local.iter().try_for_each(unit)?;
            let lat_long = e.kind == emitter::LATLONG;
            let rows = if lat_long {
                e.height.checked_sub(1)
            } else {
                Some(e.height)
            };
            let rows = rows.filter(|&r| r >= 1).ok_or(Problem::Range)?;
            ensure(
                lat_long || u64::from(e.height) == 6 * u64::from(e.width),
                Problem::Mismatch,
            )?;
            let words = texels_of(scene, e.texels, e.width, e.height, 3, texels)?;
            ensure(
                words
                    .iter()
                    .all(|w| (0.0..=1e30).contains(&f32::from_bits(*w))),
                Problem::Range,
            )?;
            let count = u64::from(e.width) * u64::from(rows);
            span(e.cells, count, scene.cells.len())?;
            *cells = cells.checked_sub(count).ok_or(Problem::Section)?;
            let first = e.cells as usize;
            let own = scene
                .cells
                .get(first..first + count as usize)
                .ok_or(Problem::Reference)?;
            ensure(
                own.iter().all(|c| u64::from(c.alias) < count),
                Problem::Reference,
            )
        }
        _ => Ok(()),
    }
}

fn check_choice(scene: &Scene<'_>, c: &Choice) -> Checked {
    within(&[c.keep], 0.0, 1.0)?;
    ensure((c.alias as usize) < scene.choices.len(), Problem::Reference)?;
    let emitter = scene.emitter(c.emitter).ok_or(Problem::Reference)?;
    if emitter.kind != emitter::AREA {
        return ensure(c.primitive == NONE, Problem::Reference);
    }
    let shape = match scene.triangle(c.primitive) {
        Some(t) => t.shape,
        None => scene.sphere(c.primitive).ok_or(Problem::Reference)?.shape,
    };
    ensure(shape == emitter.shape, Problem::Reference)
}
