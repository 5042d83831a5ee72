//! One change each.

use crate::draft::{
    BALL, BLEND, BLENDS, Draft, FLOATS, FOG, GLASS, GLOW, GROUND, IMAGES, LAMP, METAL, PHONG,
    PLASTIC, SMOOTH, WORDS,
};
use crate::media::{grids, media};
use etendue::blob::Rule;
use etendue::blob::format::{
    Cell, Choice, Emitter, LANES, Material, NONE, Node, Packet, Sensor, Shape, Sphere, Texture,
    Toc, Triangle, World, child, emitter, material, needs, section, texture,
};
use etendue_host::blob::AlignedBlob;

/// A change, and what it must be refused with.
pub struct Break {
    pub rule: Rule,
    pub section: u32,
    pub index: u32,
    pub change: Box<dyn Fn(&mut Draft)>,
}

pub fn broken(
    rule: Rule,
    section: u32,
    index: usize,
    change: impl Fn(&mut Draft) + 'static,
) -> Break {
    let (index, change) = (index as u32, Box::new(change));
    Break {
        rule,
        section,
        index,
        change,
    }
}

/// A change of one record.
pub fn record<T: bytemuck::Pod>(
    rule: Rule,
    section: u32,
    index: usize,
    change: impl Fn(&mut T) + 'static,
) -> Break {
    broken(rule, section, index, move |d| {
        change(d.record(section, index));
    })
}

pub fn breaks() -> Vec<Break> {
    [
        header(),
        contents(),
        world(),
        sensor(),
        nodes(),
        geometry(),
        shapes(),
        materials(),
        glossy(),
        textures(),
        emitters(),
        environments(),
        choices(),
        media(),
        grids(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn header() -> Vec<Break> {
    let h = |rule, change: fn(&mut Draft)| broken(rule, 0, 0, change);
    let cut = |d: &mut Draft, length: usize| d.0 = AlignedBlob::copy_of(&d.0.bytes()[..length]);
    vec![
        broken(Rule::HeaderSize, 0, 0, move |d| cut(d, 63)),
        broken(Rule::HeaderSize, 0, 0, move |d| cut(d, 0)),
        h(Rule::HeaderMagic, |d| d.header().magic[6] = b'e'),
        h(Rule::HeaderVersion, |d| d.header().version = 1),
        broken(Rule::HeaderLength, 0, 0, move |d| cut(d, 10_000)),
        h(Rule::HeaderLength, |d| d.header().length += 1),
        h(Rule::HeaderNeeds, |d| d.header().needs |= 1 << 31),
        h(Rule::HeaderFilm, |d| d.header().film_exponent = 65),
        h(Rule::HeaderFilm, |d| d.header().film_exponent = -65),
        h(Rule::HeaderReserved, |d| d.header().reserved[7] = 1),
        h(Rule::HeaderSections, |d| d.header().section_count = 14),
        broken(Rule::TocSize, 0, 0, move |d| {
            d.header().length = 100;
            cut(d, 100);
        }),
    ]
}

/// The place of a section in the table that our compiler writes.
fn entry(section: u32) -> usize {
    section as usize - 1
}

fn contents() -> Vec<Break> {
    let toc = |rule, kind, change: fn(&mut Toc)| {
        broken(rule, 0, entry(kind), move |d| change(d.toc(kind)))
    };
    vec![
        toc(Rule::TocReserved, section::UVS, |t| t.reserved = 1),
        toc(Rule::TocCount, section::UVS, |t| {
            (t.count, t.stride) = (u64::from(NONE), 0);
        }),
        toc(Rule::TocAlign, section::CELLS, |t| t.offset -= 4),
        toc(Rule::TocStart, section::UVS, |t| t.offset = 64),
        toc(Rule::TocEnd, section::CELLS, |t| t.count += 1000),
        toc(Rule::TocEnd, section::CELLS, |t| t.offset = u64::MAX - 63),
        toc(Rule::TocTwice, section::CELLS, |t| {
            t.kind = section::CHOICES
        }),
        broken(Rule::TocOverlap, 0, entry(section::UVS), |d| {
            d.toc(section::UVS).offset = d.toc(section::NORMALS).offset;
        }),
        broken(Rule::SectionMissing, section::CELLS, 0, |d| {
            d.toc(section::CELLS).kind = 18;
        }),
        broken(Rule::SectionStride, section::NORMALS, 0, |d| {
            d.toc(section::NORMALS).stride = 8;
        }),
        broken(Rule::SectionSingle, section::SENSOR, 0, |d| {
            d.toc(section::SENSOR).count = 0;
        }),
    ]
}

fn world() -> Vec<Break> {
    let w = |rule, change: fn(&mut World)| record(rule, section::WORLD, 0, change);
    vec![
        w(Rule::WorldCenter, |w| w.center[2] = 1.1e12),
        w(Rule::WorldCenter, |w| w.center[0] = f32::NAN),
        w(Rule::WorldRadius, |w| w.radius = 0.0),
        w(Rule::WorldRadius, |w| w.radius = 4.1e12),
        w(Rule::WorldDepth, |w| w.depth = 33),
        w(Rule::WorldSphereBase, |w| w.sphere_base += LANES as u32),
        broken(Rule::WorldSlots, section::WORLD, 0, |d| {
            d.toc(section::TRIANGLES).count -= 1;
        }),
        w(Rule::WorldBackground, |w| w.background = 99),
        // The lamp.
        w(Rule::WorldBackgroundKind, |w| w.background = 0),
        w(Rule::WorldExterior, |w| w.exterior = 2),
        // There is a sun.
        w(Rule::WorldExteriorDistant, |w| w.exterior = FOG as u32),
        w(Rule::WorldReserved, |w| w.reserved[7] = 1),
    ]
}

fn sensor() -> Vec<Break> {
    let s = |rule, change: fn(&mut Sensor)| record(rule, section::SENSOR, 0, change);
    vec![
        s(Rule::SensorKind, |s| s.kind = 3),
        s(Rule::SensorFilter, |s| s.filter = 3),
        s(Rule::SensorFilterRadius, |s| s.filter_radius = 0.0),
        s(Rule::SensorFilterRadius, |s| s.filter_radius = 8.1),
        s(Rule::SensorFilterSigma, |s| s.filter_sigma = -1.0),
        s(Rule::SensorFilterSigma, |s| {
            (s.filter, s.filter_sigma) = (etendue::blob::format::sensor::GAUSSIAN, 0.0);
        }),
        s(Rule::SensorResolution, |s| s.resolution[0] = 65_537),
        s(Rule::SensorCrop, |s| s.crop_size[1] = 0),
        s(Rule::SensorCrop, |s| s.crop_offset[0] = 1),
        s(Rule::SensorCrop, |s| s.crop_offset[1] = u32::MAX),
        s(Rule::SensorExtent, |s| s.half_extent[1] = 0.0),
        s(Rule::SensorAperture, |s| s.aperture = -1.0),
        s(Rule::SensorFocus, |s| s.focus = 0.0),
        s(Rule::SensorClip, |s| s.clip[0] = -1.0),
        s(Rule::SensorClip, |s| s.clip[1] = f32::INFINITY),
        s(Rule::SensorClipOrder, |s| s.clip[0] = s.clip[1]),
        s(Rule::SensorOrigin, |s| s.origin[1] = -1.1e12),
        s(Rule::SensorPrincipal, |s| s.principal[0] = f32::NAN),
        s(Rule::SensorRight, |s| s.right = [0.0; 3]),
        s(Rule::SensorDown, |s| s.down = [1.0; 3]),
        s(Rule::SensorForward, |s| s.forward[0] = f32::NAN),
        s(Rule::SensorAxes, |s| {
            s.kind = etendue::blob::format::sensor::PANORAMA;
            s.right = s.forward;
        }),
        s(Rule::SensorMedium, |s| s.medium = 2),
        s(Rule::SensorReserved, |s| s.reserved[0] = 1),
    ]
}

/// Which children of a node are nodes.
fn inner(n: &Node) -> Vec<usize> {
    let is_node = |&i: &usize| n.children[i] & child::LEAF == 0;
    (0..8).filter(is_node).collect()
}

/// A leaf's place in the root, made if there is none.
fn leaf(d: &mut Draft, reference: u32) {
    let n: &mut Node = d.record(section::NODES, 0);
    let free = (0..8).find(|&i| n.children[i] & child::LEAF != 0);
    n.children[free.expect("a leaf or an empty place")] = child::LEAF | reference;
}

fn nodes() -> Vec<Break> {
    let n = |rule, change: fn(&mut Node)| record(rule, section::NODES, 0, change);
    vec![
        broken(Rule::NodeRoot, section::NODES, 0, |d| {
            d.toc(section::NODES).count = 0;
        }),
        n(Rule::NodeRoot, |n| n.parent = 1),
        n(Rule::NodeRoot, |n| n.level = 1),
        broken(Rule::NodeReserved, section::NODES, 1, |d| {
            d.record::<Node>(section::NODES, 1).reserved[5] = 1;
        }),
        n(Rule::NodeBox, |n| n.low[1][7] = f32::NAN),
        n(Rule::NodeBox, |n| n.high[2][0] = f32::NAN),
        n(Rule::NodeChild, |n| n.children[inner(n)[0]] = 9999),
        broken(Rule::NodeParent, section::NODES, 0, |d| {
            let root: &Node = d.record(section::NODES, 0);
            let below = root.children[inner(root)[0]] as usize;
            d.record::<Node>(section::NODES, below).parent = NONE;
        }),
        n(Rule::NodeParent, |n| n.children[inner(n)[0]] = 0),
        broken(Rule::NodeBelow, section::NODES, 0, |d| {
            let root: &Node = d.record(section::NODES, 0);
            let below = root.children[inner(root)[0]] as usize;
            d.record::<Node>(section::NODES, below).level = 0;
        }),
        n(Rule::NodeTwice, |n| {
            let inner = inner(n);
            n.children[inner[1]] = n.children[inner[0]];
        }),
        broken(Rule::NodePackets, section::NODES, 0, |d| {
            let count = d.toc(section::PACKETS).count as u32;
            // Two of them, from the last one on.
            leaf(d, 1 << child::COUNT_SHIFT | (count - 1));
        }),
        broken(Rule::NodeSpheres, section::NODES, 0, |d| {
            leaf(d, child::SPHERES | 2);
        }),
    ]
}

/// The first record of which `is` is true.
fn find<T: bytemuck::Pod>(d: &mut Draft, section: u32, is: impl Fn(&T) -> bool) -> usize {
    d.all::<T>(section).iter().position(is).unwrap()
}

fn geometry() -> Vec<Break> {
    let s = |rule, change: fn(&mut Sphere)| record(rule, section::SPHERES, 1, change);
    let first = find::<Triangle>(&mut crate::scene(), section::TRIANGLES, |t| {
        t.shape as usize == SMOOTH
    });
    let t = |rule, change: fn(&mut Triangle)| record(rule, section::TRIANGLES, first, change);
    let deepest = |d: &mut Draft| {
        let depth = d.record::<World>(section::WORLD, 0).depth;
        find::<Node>(d, section::NODES, |n| n.level == depth)
    };
    let index = deepest(&mut crate::scene());
    vec![
        broken(Rule::NodeLevel, section::NODES, index, |d| {
            d.record::<World>(section::WORLD, 0).depth -= 1;
        }),
        record(Rule::PacketVertex, section::PACKETS, 3, |p: &mut Packet| {
            p.v[2][1][3] = f32::NAN;
        }),
        record(Rule::PacketVertex, section::PACKETS, 0, |p: &mut Packet| {
            p.v[0][0][0] = 1.1e12;
        }),
        t(Rule::TriangleShape, |t| t.shape = 99),
        t(Rule::TriangleVertex, |t| t.index[2] = 60 * 24),
        s(Rule::SphereCenter, |s| s.center[0] = f32::INFINITY),
        s(Rule::SphereRadius, |s| s.radius = 0.0),
        s(Rule::SphereRadius, |s| s.radius = 1e-45),
        s(Rule::SphereShape, |s| s.shape = NONE),
        s(Rule::SphereFlipped, |s| s.flipped = 2),
        s(Rule::SphereReserved, |s| s.reserved[1] = 1),
        record(
            Rule::NormalLength,
            section::NORMALS,
            5,
            |n: &mut [f32; 3]| {
                *n = [0.0, 0.0, 1.001];
            },
        ),
        record(
            Rule::NormalLength,
            section::NORMALS,
            5,
            |n: &mut [f32; 3]| {
                *n = [0.0, 0.0, f32::NAN];
            },
        ),
        record(Rule::UvFinite, section::UVS, 5, |uv: &mut [f32; 2]| {
            uv[1] = f32::INFINITY;
        }),
    ]
}

fn shapes() -> Vec<Break> {
    let ball = |rule, change: fn(&mut Shape)| record(rule, section::SHAPES, BALL, change);
    let smooth = |rule, change: fn(&mut Shape)| record(rule, section::SHAPES, SMOOTH, change);
    vec![
        ball(Rule::ShapeFront, |s| s.front = 99),
        ball(Rule::ShapeBack, |s| s.back = 99),
        ball(Rule::ShapeMedium, |s| s.interior = 2),
        ball(Rule::ShapeMedium, |s| s.exterior = 2),
        ball(Rule::ShapeOpacity, |s| s.opacity = 99),
        ball(Rule::ShapeEmitter, |s| s.emitter = 99),
        // The lamp's, and the point light's.
        ball(Rule::ShapeEmitterOwn, |s| s.emitter = 0),
        ball(Rule::ShapeEmitterOwn, |s| s.emitter = 2),
        smooth(Rule::ShapeNormals, |s| s.normals += 1),
        smooth(Rule::ShapeUvs, |s| s.uvs = NONE - 1),
        ball(Rule::ShapeReserved, |s| s.reserved[6] = 1),
    ]
}

fn materials() -> Vec<Break> {
    let m = |rule, change: fn(&mut Material)| record(rule, section::MATERIALS, GLASS, change);
    vec![
        m(Rule::MaterialKind, |m| m.kind = 13),
        m(Rule::MaterialFlags, |m| m.flags = 2),
        record(
            Rule::MaterialFlags,
            section::MATERIALS,
            0,
            |m: &mut Material| {
                m.flags = 1;
            },
        ),
        m(Rule::MaterialColor, |m| m.color[3][2] = 1.1),
        m(Rule::MaterialColor, |m| m.color[0][0] = f32::NAN),
        m(Rule::MaterialTexture, |m| m.texture[3] = 99),
        m(Rule::MaterialIor, |m| m.ior = 0.0),
        m(Rule::MaterialIor, |m| m.ior = 1001.0),
        m(Rule::MaterialEta, |m| m.eta[0] = -1.0),
        m(Rule::MaterialK, |m| m.k[2] = 2e6),
        m(Rule::MaterialReserved, |m| m.reserved = 1),
        m(Rule::MaterialReserved, |m| m.gloss[1] = 0.5),
        m(Rule::MaterialReserved, |m| m.internal = 0.5),
        m(Rule::MaterialReserved, |m| m.link[1] = 1),
        m(Rule::MaterialReserved, |m| m.level = 1),
    ]
}

fn glossy() -> Vec<Break> {
    let m = |rule, at, change: fn(&mut Material)| record(rule, section::MATERIALS, at, change);
    vec![
        m(Rule::MaterialFlags, PHONG, |m| m.flags = 2),
        m(Rule::MaterialFlags, GROUND, |m| m.flags = 4),
        m(Rule::MaterialFlags, BLEND, |m| m.flags = 1),
        m(Rule::MaterialFlags, GLASS, |m| {
            (m.kind, m.flags) = (material::DISPERSIVE, material::FORMULA);
        }),
        m(Rule::MaterialNeeds, GLASS, |m| {
            (m.kind, m.eta[0]) = (material::DISPERSIVE, 1.5);
        }),
        broken(Rule::MaterialNeeds, section::MATERIALS, PHONG, |d| {
            d.header().needs &= !needs::GLOSSY;
        }),
        // Cauchy's, of nothing: an index of 0.
        m(Rule::MaterialDispersion, GLASS, |m| {
            m.kind = material::DISPERSIVE;
        }),
        m(Rule::MaterialDispersion, GLASS, |m| {
            (m.kind, m.eta[0]) = (material::DISPERSIVE, 101.0);
        }),
        // A pole at 500 nm.
        m(Rule::MaterialDispersion, GLASS, |m| {
            (m.kind, m.flags) = (material::DISPERSIVE, material::SELLMEIER);
            (m.eta[0], m.k[0]) = (1.0, 0.25);
        }),
        m(Rule::MaterialDispersion, GLASS, |m| {
            (m.kind, m.flags) = (material::DISPERSIVE, material::TABLE);
            m.link = [0, 257];
        }),
        // Two rows of one wavelength.
        m(Rule::MaterialDispersion, GLASS, |m| {
            (m.kind, m.flags) = (material::DISPERSIVE, material::TABLE);
            m.link = [0, 2];
        }),
        m(Rule::MaterialReserved, GLASS, |m| {
            (m.kind, m.eta[0], m.link[0]) = (material::DISPERSIVE, 1.5, 1);
        }),
        m(Rule::MaterialExponent, PHONG, |m| m.gloss[0] = 1.1e5),
        m(Rule::MaterialExponent, PHONG, |m| m.gloss[0] = f32::NAN),
        m(Rule::MaterialNormalization, PHONG, |m| m.gloss[1] *= 1.01),
        m(Rule::MaterialNormalization, PHONG, |m| m.gloss[1] = 0.0),
        m(Rule::MaterialRoughness, METAL, |m| m.gloss[0] = 0.0),
        m(Rule::MaterialRoughness, GROUND, |m| m.gloss[1] = f32::NAN),
        m(Rule::MaterialRoughness, PLASTIC, |m| m.gloss[1] = 11.0),
        m(Rule::MaterialRoughIor, GROUND, |m| m.ior = 1.005),
        m(Rule::MaterialInternal, PLASTIC, |m| m.internal = 1.0),
        m(Rule::MaterialInternal, PLASTIC, |m| m.internal = -0.1),
        m(Rule::MaterialCurve, METAL, |m| m.link[0] = NONE),
        m(Rule::MaterialCurve, GROUND, |m| m.link[1] = 1 << 20),
        m(Rule::MaterialCurve, PLASTIC, |m| m.link[0] = 1 << 20),
        m(Rule::MaterialReserved, METAL, |m| m.link[1] = 1),
        m(Rule::MaterialReserved, METAL, |m| m.flags = 0),
        m(Rule::MaterialReserved, METAL, |m| m.internal = 0.5),
        m(Rule::MaterialPart, BLEND, |m| m.link[0] = 99),
        m(Rule::MaterialPart, BLEND, |m| m.link[1] = NONE),
        m(Rule::MaterialLevel, BLEND, |m| m.level = 0),
        m(Rule::MaterialLevel, BLENDS, |m| m.level = 9),
        m(Rule::MaterialLevel, BLENDS, |m| m.level = 1),
        // Within itself.
        m(Rule::MaterialLevel, BLEND, |m| m.link[0] = BLEND as u32),
    ]
}

/// The rows of four texels that the grids' words would make.
pub fn grid_rows() -> u32 {
    WORDS.iter().sum::<usize>() as u32 / 4
}

fn textures() -> Vec<Break> {
    let first = |rule, change: fn(&mut Texture)| record(rule, section::TEXTURES, IMAGES[0], change);
    let floats = |rule, change: fn(&mut Texture)| record(rule, section::TEXTURES, FLOATS, change);
    vec![
        first(Rule::TextureKind, |t| t.kind = 5),
        // The image's texels are all the same.
        first(Rule::TextureRows, |t| t.kind = texture::SPECTRUM),
        first(Rule::TextureRows, |t| {
            (t.kind, t.width) = (texture::SPECTRUM, 0)
        }),
        first(Rule::TextureFlags, |t| t.flags = 16),
        first(Rule::TextureToUv, |t| t.to_uv[1][2] = f32::NAN),
        first(Rule::TextureColor, |t| t.color[0][1] = 1.1),
        first(Rule::TextureReserved, |t| t.reserved = 1),
        first(Rule::TextureReserved, |t| t.reserved2[0] = 1),
        first(Rule::TextureSize, |t| t.width = 0),
        first(Rule::TextureSize, |t| t.height = (1 << 18) + 1),
        first(Rule::TextureTexels, |t| t.height = 1 << 18),
        floats(Rule::TextureTexels, |t| t.texels = NONE),
        // The other image takes what is left for the floats.
        broken(Rule::TextureBudget, section::TEXTURES, FLOATS, |d| {
            d.record::<Texture>(section::TEXTURES, IMAGES[0]).height = 18 + grid_rows();
        }),
        broken(Rule::TextureFloat, section::TEXTURES, FLOATS, |d| {
            let at = d.record::<Texture>(section::TEXTURES, FLOATS).texels as usize;
            *d.record::<u32>(section::TEXELS, at + 35) = 1.5f32.to_bits();
        }),
    ]
}

/// The lights of the scene, in order.
const AREA: usize = 0;
const ROUND: usize = 1;
const POINT: usize = 2;
const SPOT: usize = 3;
const SUN: usize = 4;
const SKY: usize = 5;

fn emitters() -> Vec<Break> {
    let e = |rule, index, change: fn(&mut Emitter)| record(rule, section::EMITTERS, index, change);
    vec![
        e(Rule::EmitterKind, SUN, |e| e.kind = 8),
        e(Rule::EmitterRadiance, AREA, |e| e.radiance[1] = -1.0),
        e(Rule::EmitterRadiance, AREA, |e| e.radiance[1] = 1.1e30),
        e(Rule::EmitterDensity, ROUND, |e| e.density = f32::INFINITY),
        e(Rule::EmitterPosition, POINT, |e| e.position[0] = 1.1e12),
        e(Rule::EmitterReserved, SKY, |e| e.reserved[1] = 1),
        e(Rule::EmitterReserved, SUN, |e| e.spectrum[0] = 1),
        e(Rule::EmitterRows, SUN, |e| e.spectrum = [0, 2]),
        e(Rule::EmitterRows, SKY, |e| e.spectrum = [0, 1]),
        e(Rule::EmitterMedium, SUN, |e| e.medium = 2),
        e(Rule::VolumeMedium, GLOW, |e| e.medium = NONE),
        e(Rule::VolumeEdges, GLOW, |e| e.to_local[2][0] = 1.1e12),
        e(Rule::VolumeEdges, GLOW, |e| e.to_local[2][0] = f32::NAN),
        e(Rule::VolumeSize, GLOW, |e| e.to_local[1] = e.to_local[0]),
        // Lights that no shape has.
        e(Rule::AreaShape, POINT, |e| {
            (e.kind, e.shape) = (emitter::AREA, NONE)
        }),
        e(Rule::AreaShapeOwn, POINT, |e| {
            (e.kind, e.shape) = (emitter::AREA, BALL as u32)
        }),
        e(Rule::SpotDirection, SPOT, |e| e.direction = [0.0; 3]),
        e(Rule::SpotCosines, SPOT, |e| e.cos_inner = 1.1),
        e(Rule::SpotOrder, SPOT, |e| e.cos_inner = e.cos_outer),
        e(Rule::DirectionalDirection, SUN, |e| e.direction[2] = 2.0),
    ]
}

fn environments() -> Vec<Break> {
    let sky = |rule, change: fn(&mut Emitter)| record(rule, section::EMITTERS, SKY, change);
    let cell = |rule, change: fn(&mut Cell)| record(rule, section::CELLS, 7, change);
    vec![
        sky(Rule::EnvironmentFrame, |e| e.to_local[2][2] = 0.5),
        sky(Rule::EnvironmentHeight, |e| e.height = 1),
        sky(Rule::EnvironmentCube, |e| e.kind = emitter::CUBEMAP),
        sky(Rule::EnvironmentSize, |e| e.width = (1 << 16) + 1),
        sky(Rule::EnvironmentTexels, |e| e.texels += 1 + 4 * grid_rows()),
        // A texture takes what is left for the sky.
        broken(Rule::EnvironmentBudget, section::EMITTERS, SKY, |d| {
            d.record::<Texture>(section::TEXTURES, IMAGES[0]).height = 9 + grid_rows();
        }),
        broken(Rule::EnvironmentRadiance, section::EMITTERS, SKY, |d| {
            let at = d.record::<Emitter>(section::EMITTERS, SKY).texels as usize;
            *d.record::<u32>(section::TEXELS, at + 35) = f32::NAN.to_bits();
        }),
        sky(Rule::EnvironmentCells, |e| e.cells = 1),
        // The point light becomes a second sky, of the floats' texels and the sky's cells.
        broken(Rule::EnvironmentCellBudget, section::EMITTERS, SKY, |d| {
            let floats: &mut Texture = d.record(section::TEXTURES, FLOATS);
            floats.kind = texture::CHECKERBOARD;
            let texels = floats.texels;
            let sky = *d.record::<Emitter>(section::EMITTERS, SKY);
            *d.record(section::EMITTERS, POINT) = Emitter { texels, ..sky };
        }),
        broken(Rule::EnvironmentAlias, section::EMITTERS, SKY, |d| {
            d.record::<Cell>(section::CELLS, 7).alias = 8;
        }),
        cell(Rule::CellKeep, |c| c.keep = -0.1),
        cell(Rule::CellProbability, |c| c.probability = f32::NAN),
    ]
}

fn choices() -> Vec<Break> {
    let find = |kind: usize| {
        find::<Choice>(&mut crate::scene(), section::CHOICES, |c| {
            c.emitter as usize == kind
        })
    };
    let [lamp, point] = [ROUND, POINT].map(find);
    let c = |rule, index, change: fn(&mut Choice)| record(rule, section::CHOICES, index, change);
    vec![
        c(Rule::ChoiceKeep, lamp, |c| c.keep = 1.1),
        c(Rule::ChoiceAlias, lamp, |c| c.alias = 99),
        c(Rule::ChoiceEmitter, lamp, |c| c.emitter = NONE),
        c(Rule::ChoiceWhole, point, |c| c.primitive = 0),
        c(Rule::ChoicePrimitive, lamp, |c| c.primitive = NONE - 1),
        // The ball of glass.
        broken(Rule::ChoiceShape, section::CHOICES, lamp, move |d| {
            let spheres: &[Sphere] = d.all(section::SPHERES);
            let at = spheres
                .iter()
                .position(|s| s.shape as usize != LAMP)
                .unwrap();
            let base = d.record::<World>(section::WORLD, 0).sphere_base;
            d.record::<Choice>(section::CHOICES, lamp).primitive = base + at as u32;
        }),
    ]
}
