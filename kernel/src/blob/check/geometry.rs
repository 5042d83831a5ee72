//! The tree, what it holds, and the shapes that own it.

use super::rules::{Checked, MAX_COORDINATE, coordinates, ensure, optional, span, within, zeros};
use crate::blob::format::{
    LANES, MAX_DEPTH, NONE, Node, Packet, Shape, Sphere, Triangle, WIDTH, World, child, emitter,
};
use crate::blob::rule::Rule;
use crate::blob::scene::Scene;

pub(super) fn world(scene: &Scene<'_>) -> Checked {
    let w: &World = scene.world;
    coordinates(&w.center, Rule::WorldCenter)?;
    let largest = 4.0 * MAX_COORDINATE;
    within(&[w.radius], f32::MIN_POSITIVE, largest, Rule::WorldRadius)?;
    ensure(w.depth <= MAX_DEPTH, Rule::WorldDepth)?;
    let base = w.sphere_base as usize;
    let slots = scene.packets.len().checked_mul(LANES);
    ensure(slots == Some(base), Rule::WorldSphereBase)?;
    ensure(scene.triangles.len() == base, Rule::WorldSlots)?;
    let ids = base.checked_add(scene.spheres.len());
    let ids = ids.is_some_and(|n| n <= NONE as usize);
    ensure(ids, Rule::WorldPrimitives)?;
    optional(w.background, scene.emitters.len(), Rule::WorldBackground)?;
    if let Some(e) = scene.emitter(w.background) {
        let distant = [emitter::CONSTANT, emitter::LATLONG, emitter::CUBEMAP];
        ensure(distant.contains(&e.kind), Rule::WorldBackgroundKind)?;
    }
    optional(w.exterior, scene.media.len(), Rule::WorldExterior)?;
    zeros(&w.reserved, Rule::WorldReserved)
}

pub(super) fn node(scene: &Scene<'_>, index: usize, n: &Node) -> Checked {
    if index == 0 {
        ensure(n.level == 0 && n.parent == NONE, Rule::NodeRoot)?;
    }
    ensure(n.level <= scene.world.depth, Rule::NodeLevel)?;
    zeros(&n.reserved, Rule::NodeReserved)?;
    for corners in [&n.low, &n.high] {
        // Empty places have infinite ones.
        let sides = corners.as_flattened();
        within(sides, f32::NEG_INFINITY, f32::INFINITY, Rule::NodeBox)?;
    }
    (0..WIDTH).try_for_each(|place| child(scene, index, n, place))
}

/// A child node names its parent and its parent's level plus one. As no two children of one node are the
/// same, no node is reached twice: the nodes that traversal can reach form a tree of bounded depth. (The root is
/// nobody's child, because it has no parent.)
#[inline(never)]
fn child(scene: &Scene<'_>, index: usize, n: &Node, place: usize) -> Checked {
    let reference = n.children.get(place).copied().unwrap_or(child::EMPTY);
    if reference == child::EMPTY {
        return Ok(());
    }
    if reference & child::LEAF == 0 {
        let below = scene.nodes.get(reference as usize);
        let below = below.ok_or(Rule::NodeChild)?;
        ensure(below.parent as usize == index, Rule::NodeParent)?;
        ensure(below.level == n.level + 1, Rule::NodeBelow)?;
        let mut before = n.children.iter().take(place);
        return ensure(before.all(|&c| c != reference), Rule::NodeTwice);
    }
    let start = reference & child::START_MASK;
    let count = u64::from((reference >> child::COUNT_SHIFT) & 15) + 1;
    if reference & child::SPHERES != 0 {
        span(scene.spheres, start, count, Rule::NodeSpheres).map(drop)
    } else {
        span(scene.packets, start, count, Rule::NodePackets).map(drop)
    }
}

pub(super) fn packet(p: &Packet) -> Checked {
    coordinates(p.v.as_flattened().as_flattened(), Rule::PacketVertex)
}

pub(super) fn triangle(scene: &Scene<'_>, t: &Triangle) -> Checked {
    if t.shape == NONE {
        return Ok(());
    }
    let shape = scene.shape(t.shape).ok_or(Rule::TriangleShape)?;
    let indexed = shape.normals != NONE || shape.uvs != NONE;
    let inside = t.index.iter().all(|&i| i < shape.vertices);
    ensure(!indexed || inside, Rule::TriangleVertex)
}

pub(super) fn sphere(scene: &Scene<'_>, s: &Sphere) -> Checked {
    coordinates(&s.center, Rule::SphereCenter)?;
    within(
        &[s.radius],
        f32::MIN_POSITIVE,
        MAX_COORDINATE,
        Rule::SphereRadius,
    )?;
    ensure((s.shape as usize) < scene.shapes.len(), Rule::SphereShape)?;
    ensure(s.flipped <= 1, Rule::SphereFlipped)?;
    zeros(&s.reserved, Rule::SphereReserved)
}

pub(super) fn shape(scene: &Scene<'_>, index: usize, s: &Shape) -> Checked {
    optional(s.front, scene.materials.len(), Rule::ShapeFront)?;
    optional(s.back, scene.materials.len(), Rule::ShapeBack)?;
    optional(s.interior, scene.media.len(), Rule::ShapeMedium)?;
    optional(s.exterior, scene.media.len(), Rule::ShapeMedium)?;
    optional(s.opacity, scene.textures.len(), Rule::ShapeOpacity)?;
    optional(s.emitter, scene.emitters.len(), Rule::ShapeEmitter)?;
    if let Some(e) = scene.emitter(s.emitter) {
        let own = e.kind == emitter::AREA && e.shape as usize == index;
        ensure(own, Rule::ShapeEmitterOwn)?;
    }
    let vertices = u64::from(s.vertices);
    if s.normals != NONE {
        span(scene.normals, s.normals, vertices, Rule::ShapeNormals)?;
    }
    if s.uvs != NONE {
        span(scene.uvs, s.uvs, vertices, Rule::ShapeUvs)?;
    }
    zeros(&s.reserved, Rule::ShapeReserved)
}
