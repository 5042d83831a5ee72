//! Emitters, and the tables by which they are chosen.

use super::rules::{Checked, coordinates, ensure, optional, span, unit, within, zeros};
use super::surface::{size, spectrum};
use crate::blob::format::{Cell, Choice, Emitter, NONE, emitter};
use crate::blob::rule::Rule;
use crate::blob::scene::Scene;

pub(super) fn emitter(
    scene: &Scene<'_>,
    index: usize,
    e: &Emitter,
    texels: &mut u64,
    cells: &mut u64,
) -> Checked {
    ensure(e.kind <= emitter::VOLUME, Rule::EmitterKind)?;
    let image = matches!(e.kind, emitter::LATLONG | emitter::CUBEMAP);
    ensure(
        cfg!(feature = "environment") || !image,
        Rule::EmitterLeftOut,
    )?;
    within(&e.radiance, 0.0, 1e30, Rule::EmitterRadiance)?;
    within(&[e.density], 0.0, f32::MAX, Rule::EmitterDensity)?;
    coordinates(&e.position, Rule::EmitterPosition)?;
    let [first, rows] = e.spectrum;
    if rows > 0 {
        ensure(cfg!(feature = "spectral"), Rule::SpectraLeftOut)?;
        ensure(e.kind <= emitter::CONSTANT, Rule::EmitterRows)?;
        *texels = texels
            .checked_sub(2 * u64::from(rows))
            .ok_or(Rule::EnvironmentBudget)?;
        spectrum(scene, first, rows, 1e30, Rule::EmitterRows)?;
    } else {
        zeros(&[first], Rule::EmitterReserved)?;
    }
    optional(e.medium, scene.media.len(), Rule::EmitterMedium)?;
    zeros(&e.reserved, Rule::EmitterReserved)?;
    match e.kind {
        emitter::AREA => {
            let shape = scene.shape(e.shape).ok_or(Rule::AreaShape)?;
            ensure(shape.emitter as usize == index, Rule::AreaShapeOwn)
        }
        emitter::SPOT => {
            unit(&e.direction, Rule::SpotDirection)?;
            within(&[e.cos_inner, e.cos_outer], -1.0, 1.0, Rule::SpotCosines)?;
            ensure(e.cos_outer < e.cos_inner, Rule::SpotOrder)
        }
        emitter::DIRECTIONAL => unit(&e.direction, Rule::DirectionalDirection),
        emitter::LATLONG | emitter::CUBEMAP => environment(scene, e, texels, cells),
        emitter::VOLUME => volume(scene, e),
        _ => Ok(()),
    }
}

fn environment(scene: &Scene<'_>, e: &Emitter, texels: &mut u64, cells: &mut u64) -> Checked {
    for row in &e.to_local {
        unit(row, Rule::EnvironmentFrame)?;
    }
    let count = size(e.width, e.height).ok_or(Rule::EnvironmentSize)?;
    let words = span(scene.texels, e.texels, 3 * count, Rule::EnvironmentTexels)?;
    *texels = texels
        .checked_sub(3 * count)
        .ok_or(Rule::EnvironmentBudget)?;
    let bright = |w: &u32| (0.0..=1e30).contains(&f32::from_bits(*w));
    ensure(words.iter().all(bright), Rule::EnvironmentRadiance)?;
    let width = u64::from(e.width);
    let own = if e.kind == emitter::LATLONG {
        // A cell lies between the rows of texels.
        ensure(e.height >= 2, Rule::EnvironmentHeight)?;
        count - width
    } else {
        ensure(u64::from(e.height) == 6 * width, Rule::EnvironmentCube)?;
        count
    };
    let table = span(scene.cells, e.cells, own, Rule::EnvironmentCells)?;
    *cells = cells.checked_sub(own).ok_or(Rule::EnvironmentCellBudget)?;
    let inside = table.iter().all(|c| u64::from(c.alias) < own);
    ensure(inside, Rule::EnvironmentAlias)
}

fn volume(scene: &Scene<'_>, e: &Emitter) -> Checked {
    ensure((e.medium as usize) < scene.media.len(), Rule::VolumeMedium)?;
    coordinates(e.to_local.as_flattened(), Rule::VolumeEdges)?;
    let [a, b, c] = e.to_local.map(|edge| edge.map(f64::from));
    let volume = a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    // And not subnormal: densities are its inverse.
    let solid = volume.abs() >= f64::from(f32::MIN_POSITIVE);
    ensure(solid, Rule::VolumeSize)
}

pub(super) fn choice(scene: &Scene<'_>, c: &Choice) -> Checked {
    within(&[c.keep], 0.0, 1.0, Rule::ChoiceKeep)?;
    ensure((c.alias as usize) < scene.choices.len(), Rule::ChoiceAlias)?;
    let emitter = scene.emitter(c.emitter).ok_or(Rule::ChoiceEmitter)?;
    if emitter.kind != emitter::AREA {
        return ensure(c.primitive == NONE, Rule::ChoiceWhole);
    }
    let triangle = scene.triangle(c.primitive).map(|t| t.shape);
    let sphere = || scene.sphere(c.primitive).map(|s| s.shape);
    let shape = triangle.or_else(sphere).ok_or(Rule::ChoicePrimitive)?;
    ensure(shape == emitter.shape, Rule::ChoiceShape)
}

pub(super) fn cell(c: &Cell) -> Checked {
    within(&[c.keep], 0.0, 1.0, Rule::CellKeep)?;
    within(&[c.probability], 0.0, 1.0, Rule::CellProbability)
}
