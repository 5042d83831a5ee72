//! Blob v2, byte for byte: enough to write one from any language.
//!
//! A blob is one run of bytes, little-endian, to be placed at an address that is a multiple of 16:
//!
//! ```text
//! 0        Header                                64 bytes
//! 64       Toc × header.section_count            32 bytes each
//! …        sections, each at a multiple of 64, in any order, not overlapping; gaps are zero
//! length   end of the blob (header.length)
//! ```
//!
//! A section is an array of one record type below; its `Toc` entry says which ([`section`]), where
//! it starts, how many records it has and how large one is (`stride`, which must be the size of the
//! record, so that a reader of another version notices). Every section of [`section::ALL`] stands in
//! the table exactly once, empty ones with `count` 0; unknown ones are refused.
//!
//! Numbers are IEEE single precision and finite unless said otherwise; ids are `u32` indices into
//! the section they name, [`NONE`] where there is nothing. Units: lengths in scene units, radiance in
//! W m⁻² sr⁻¹ per linear-sRGB channel. Directions are unit vectors to within 1e-4.
//!
//! # Primitives
//! Triangles live in [`Packet`]s of [`LANES`] (structure of arrays). Triangle *slot* `p·LANES + l` is
//! lane `l` of packet `p`, and the slot is the primitive's id; empty lanes have a triangle with
//! v₀ = v₁, bit by bit, which no ray meets, and an all-[`NONE`] [`Triangle`]. (Take v₀ ≠ v₂: the edge
//! functions of such a triangle differ in sign for nearly all rays, so the test drops it early.)
//! Sphere `i` has id `world.sphere_base + i`, where `sphere_base = packets·LANES`. The geometric normal of a triangle is (v₁−v₀)×(v₂−v₀), outwards.
//!
//! # Tree
//! Eight-wide nodes; node 0 is the root. A child is a box and a *reference* ([`child`]): empty, a node,
//! a run of packets or a run of spheres. Each node but the root names its parent and is its child exactly once;
//! levels count from the root, and none is above `world.depth`, at most [`MAX_DEPTH`]. Children's boxes contain what they hold. An empty slot's box is (+∞, −∞).

mod media;

pub use media::{Grid, Lobe, Medium, medium};

use bytemuck::{Pod, Zeroable};

/// The first eight bytes.
pub const MAGIC: [u8; 8] = *b"ETENDUE\0";
/// The version this module describes.
pub const VERSION: u32 = 2;
/// "No such thing", wherever an id is optional.
pub const NONE: u32 = u32::MAX;
/// Triangles per packet.
pub const LANES: usize = 4;
/// Children per node.
pub const WIDTH: usize = 8;
/// The deepest tree that is accepted: it bounds the traversal's stack ([`crate::shape`]).
pub const MAX_DEPTH: u32 = 32;
/// Every section starts at a multiple of this.
pub const SECTION_ALIGN: u64 = 64;

/// What the scene holds: bits of [`Header::needs`]. A kernel refuses needs that it doesn't know.
pub mod needs {
    /// At least one sphere.
    pub const SPHERES: u32 = 1 << 0;
    /// At least one shape with an opacity mask.
    pub const MASKS: u32 = 1 << 1;
    /// At least one null boundary.
    pub const NULL: u32 = 1 << 2;
    /// At least one texture.
    pub const TEXTURES: u32 = 1 << 3;
    /// At least one emitter at infinity (directional, constant, environment).
    pub const DISTANT: u32 = 1 << 4;
    /// At least one Dirac lobe.
    pub const DIRAC: u32 = 1 << 5;
    /// At least one shape with interpolated normals.
    pub const SMOOTH_NORMALS: u32 = 1 << 6;
    /// At least one surface that transmits.
    pub const TRANSMISSION: u32 = 1 << 7;
    /// At least one medium, and boundaries that name it.
    pub const MEDIA: u32 = 1 << 8;
    /// At least one medium that is a grid.
    pub const GRIDS: u32 = 1 << 9;
    /// At least one medium that emits.
    pub const GLOWING: u32 = 1 << 10;
    /// At least one material with glossy lobes (neither diffuse nor Dirac), or a blend.
    pub const GLOSSY: u32 = 1 << 11;
    /// At least one light that is small for the scene, among media: distances to it are worth sampling (equiangular).
    pub const SMALL_LIGHTS: u32 = 1 << 12;
    /// At least one surface that treats channels differently: a dispersing dielectric.
    pub const DISPERSION: u32 = 1 << 13;
    /// Paths carry wavelengths rather than red, green and blue.
    pub const SPECTRAL: u32 = 1 << 14;
    /// All that this version knows.
    pub const KNOWN: u32 = (1 << 15) - 1;
}

/// Section kinds.
pub mod section {
    /// One [`super::World`].
    pub const WORLD: u32 = 1;
    /// One [`super::Sensor`].
    pub const SENSOR: u32 = 2;
    /// [`super::Node`]s.
    pub const NODES: u32 = 3;
    /// [`super::Packet`]s.
    pub const PACKETS: u32 = 4;
    /// [`super::Triangle`]s, one per slot.
    pub const TRIANGLES: u32 = 5;
    /// [`super::Sphere`]s.
    pub const SPHERES: u32 = 6;
    /// Vertex normals, `[f32; 3]`, unit.
    pub const NORMALS: u32 = 7;
    /// Vertex texture coordinates, `[f32; 2]`.
    pub const UVS: u32 = 8;
    /// [`super::Shape`]s.
    pub const SHAPES: u32 = 9;
    /// [`super::Material`]s.
    pub const MATERIALS: u32 = 10;
    /// [`super::Texture`]s.
    pub const TEXTURES: u32 = 11;
    /// Texels, `u32` words; a texture says how to read its own.
    pub const TEXELS: u32 = 12;
    /// [`super::Emitter`]s.
    pub const EMITTERS: u32 = 13;
    /// [`super::Choice`]: the alias table over emitting primitives.
    pub const CHOICES: u32 = 14;
    /// [`super::Cell`]: alias tables over the cells of environment images.
    pub const CELLS: u32 = 15;
    /// [`super::Medium`]s.
    pub const MEDIA: u32 = 16;
    /// [`super::Grid`]s.
    pub const GRIDS: u32 = 17;
    /// Every kind, in the order in which our compiler writes them.
    pub const ALL: [u32; 17] = [
        WORLD, SENSOR, NODES, PACKETS, TRIANGLES, SPHERES, NORMALS, UVS, SHAPES, MATERIALS,
        TEXTURES, TEXELS, EMITTERS, CHOICES, CELLS, MEDIA, GRIDS,
    ];
}

/// The first 64 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    /// [`MAGIC`].
    pub magic: [u8; 8],
    /// [`VERSION`].
    pub version: u32,
    /// Entries in the table of contents.
    pub section_count: u32,
    /// Bytes of the whole blob.
    pub length: u64,
    /// What the scene holds ([`needs`]).
    pub needs: u32,
    /// The film's step is 2^(film_exponent − 64); in [−64, 64].
    pub film_exponent: i32,
    /// Zero.
    pub reserved: [u32; 8],
}

/// An entry of the table of contents.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Toc {
    /// Which section ([`section`]).
    pub kind: u32,
    /// Bytes per record.
    pub stride: u32,
    /// Where it starts, from the blob's first byte; a multiple of [`SECTION_ALIGN`].
    pub offset: u64,
    /// Records.
    pub count: u64,
    /// Zero.
    pub reserved: u64,
}

/// Facts about the scene as a whole.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct World {
    /// Centre of a sphere that holds all primitives.
    pub center: [f32; 3],
    /// Its radius, > 0: what light from infinity covers, πR².
    pub radius: f32,
    /// The largest level of a node; the root has level 0.
    pub depth: u32,
    /// Primitive id of sphere 0: packets · [`LANES`].
    pub sphere_base: u32,
    /// Index of the emitter that rays leaving the scene meet (constant or environment), or [`NONE`].
    pub background: u32,
    /// Medium that holds the space outside all objects; [`NONE`]: vacuum. Where it is one that takes light away,
    /// there are no emitters at infinity: nothing would arrive from them.
    pub exterior: u32,
    /// Zero.
    pub reserved: [u32; 8],
}

/// Child references of a [`Node`].
pub mod child {
    /// No child.
    pub const EMPTY: u32 = u32::MAX;
    /// Set on leaves.
    pub const LEAF: u32 = 1 << 31;
    /// Set on leaves that hold spheres.
    pub const SPHERES: u32 = 1 << 30;
    /// A leaf's count minus one stands in bits 26..30: 1 to 16 packets or spheres.
    pub const COUNT_SHIFT: u32 = 26;
    /// A leaf's first packet or sphere: bits 0..26.
    pub const START_MASK: u32 = (1 << 26) - 1;
}

/// An eight-wide node, 256 bytes: boxes as structure of arrays, then references.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// `[x, y, z]` of the lower corners: `low[axis][child]`.
    pub low: [[f32; WIDTH]; 3],
    /// The upper corners.
    pub high: [[f32; WIDTH]; 3],
    /// What each child is ([`child`]); a node is its index.
    pub children: [u32; WIDTH],
    /// The node whose child this is; [`NONE`] for node 0. It lets a reader prove in one pass that the nodes form a tree.
    pub parent: u32,
    /// Distance from the root: the parent's plus 1, 0 for node 0.
    pub level: u32,
    /// Zero.
    pub reserved: [u32; 6],
}

/// [`LANES`] triangles: `v[vertex][axis][lane]`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Packet {
    /// Coordinates.
    pub v: [[[f32; LANES]; 3]; 3],
}

/// What a triangle slot needs when it is hit.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Triangle {
    /// Vertex indices, relative to the shape's `normals` and `uvs` bases.
    pub index: [u32; 3],
    /// The shape it belongs to.
    pub shape: u32,
}

/// An exact sphere.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    /// Centre.
    pub center: [f32; 3],
    /// Radius, > 0.
    pub radius: f32,
    /// The shape it belongs to.
    pub shape: u32,
    /// 1 if its normal points inwards, else 0.
    pub flipped: u32,
    /// Zero.
    pub reserved: [u32; 2],
}

/// What triangles and spheres of one object share.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Shape {
    /// Material seen from the side the normal points to; [`NONE`] is black.
    pub front: u32,
    /// Material seen from the other side; [`NONE`] is black.
    pub back: u32,
    /// Medium behind the normal; [`NONE`]: vacuum. Where `interior` and `exterior` are both [`NONE`], the shape doesn't
    /// part media: the same one is on both of its sides, whichever it is (a wall that stands in fog).
    pub interior: u32,
    /// Medium in front of the normal.
    pub exterior: u32,
    /// Its area emitter, or [`NONE`]. Emits on the normal's side.
    pub emitter: u32,
    /// Opacity mask: a texture whose first channel is α ∈ [0, 1], or [`NONE`] (opaque).
    pub opacity: u32,
    /// First of its vertex normals, or [`NONE`]: then the geometric normal shades.
    pub normals: u32,
    /// First of its texture coordinates, or [`NONE`]: then (u, v) of the hit.
    pub uvs: u32,
    /// Vertices that `normals` and `uvs` have from their bases on.
    pub vertices: u32,
    /// Zero.
    pub reserved: [u32; 7],
}

/// Material kinds.
pub mod material {
    /// Diffuse: `color[0]` reflectance, `color[1]` transmittance; each on its own side of wo.
    pub const DIFFUSE: u32 = 0;
    /// Perfect mirror: `color[0]` reflectance.
    pub const MIRROR: u32 = 1;
    /// Smooth conductor: `eta` + i`k` relative to outside, `color[0]` scales. `texture[2]` and `texture[3]` are multiplied to `eta` and
    /// `k`: what they are by wavelength, over the largest.
    pub const CONDUCTOR: u32 = 2;
    /// Smooth dielectric: `ior` (inside over outside), `color[0]` scales reflection, `color[1]` transmission.
    pub const DIELECTRIC: u32 = 3;
    /// Null boundary: light passes.
    pub const NULL: u32 = 4;
    /// Thin sheet: `color[0]` specular reflection, `color[1]` specular (straight) transmission,
    /// `color[2]` diffuse reflection, `color[3]` diffuse transmission; per channel their sum ≤ 1.
    pub const SHEET: u32 = 5;
    /// Phong lobes: `color[0]` diffuse reflection, `color[1]` a lobe about the mirror direction, `color[2]` a lobe about the
    /// refracted direction (`ior`), `color[3]` diffuse transmission; `gloss` is exponent and normalisation.
    pub const PHONG: u32 = 6;
    /// Rough conductor: as [`CONDUCTOR`], over microfacets of roughness `gloss`. [`COMPENSATED`]: `color[1]` is the mean of
    /// Fresnel's reflectance over the hemisphere, `link[0]` a curve.
    pub const ROUGH_CONDUCTOR: u32 = 7;
    /// Rough dielectric: as [`DIELECTRIC`], over microfacets of roughness `gloss`. [`COMPENSATED`]: `link` are the curves of
    /// what is lost of light from outside and from inside.
    pub const ROUGH_DIELECTRIC: u32 = 8;
    /// Diffuse `color[0]` under a smooth coat of index `ior`, `color[1]` scales the coat's reflection; `internal`.
    pub const PLASTIC: u32 = 9;
    /// The same under a coat of microfacets of roughness `gloss`; `link[0]` is the curve of what the coat lets in.
    pub const ROUGH_PLASTIC: u32 = 10;
    /// One of two materials, `link`: the second with probability `color[0]`'s first channel.
    pub const BLEND: u32 = 11;
    /// Dielectric whose index depends on wavelength: `ior` times what its [`FORMULA`] says (λ in µm). Colours as [`DIELECTRIC`].
    pub const DISPERSIVE: u32 = 12;
    /// Flags on [`DISPERSIVE`], which formula.
    pub const FORMULA: u32 = 6;
    /// n = `eta[0]` + `eta[1]`/λ² + `eta[2]`/λ⁴.
    pub const CAUCHY: u32 = 0;
    /// n² = 1 + Σᵢ `eta[i]`·λ²/(λ² − `k[i]`).
    pub const SELLMEIER: u32 = 2;
    /// n is linear between rows of (nm, n): `link[1]` pairs of words of [`section::TEXELS`](super::section::TEXELS), from word `link[0]` on.
    pub const TABLE: u32 = 4;
    /// Flag on a dielectric: Schlick's approximation in place of Fresnel's equations.
    pub const SCHLICK: u32 = 1;
    /// Flag on [`PHONG`]: the lobes have Fresnel's shares of the light, by the angle at which it comes.
    pub const FRESNEL: u32 = 1;
    /// Flag on microfacets: Beckmann's distribution rather than GGX (Trowbridge & Reitz).
    pub const BECKMANN: u32 = 1;
    /// Flag on microfacets: Smith's masking of both directions independently, rather than correlated by height.
    pub const SEPARABLE: u32 = 2;
    /// Flag on [`ROUGH_CONDUCTOR`] and [`ROUGH_PLASTIC`]: masking by V-shaped cavities (Cook & Torrance 1982).
    pub const CAVITIES: u32 = 4;
    /// Flag on [`ROUGH_CONDUCTOR`] and [`ROUGH_DIELECTRIC`]: what single scattering loses is given back.
    pub const COMPENSATED: u32 = 8;
    /// Flag on plastics: light that the coat sends back takes the base's colour again each time.
    pub const NONLINEAR: u32 = 16;
    /// Numbers of a curve, a byte each from 0 to 1, four to a word of [`section::TEXELS`](super::section::TEXELS), the first
    /// lowest: a function of cos θ at (i/15)², linear in √cos θ between.
    pub const CURVE: usize = 16;
    /// The highest `level` of a blend.
    pub const MAX_LEVEL: u32 = 8;
}

/// A local model: its kind, its colours (each a constant times an optional texture) and numbers.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Which model ([`material`]).
    pub kind: u32,
    /// Its flags.
    pub flags: u32,
    /// dielectrics, coats, Phong's refraction: relative index of refraction, inside over outside, > 0.
    pub ior: f32,
    /// Zero.
    pub reserved: u32,
    /// Constant factors by role; each in [0, 1].
    pub color: [[f32; 3]; 4],
    /// Textures multiplied to the colours, or [`NONE`].
    pub texture: [u32; 4],
    /// conductor: real part of the relative index, per channel, > 0.
    pub eta: [f32; 3],
    /// conductor: imaginary part, per channel, ≥ 0.
    pub k: [f32; 3],
    /// Microfacets: roughness α along both tangents. Phong: exponent n and normalisation, (n + 1)/2π or (n + 2)/2π.
    pub gloss: [f32; 2],
    /// plastics: how much of diffuse light the coat reflects back inside, < 1.
    pub internal: f32,
    /// blend: its two materials. Curves: their first word in [`section::TEXELS`].
    pub link: [u32; 2],
    /// blend: above the level of a blend that is a part of it, from 1 to [`material::MAX_LEVEL`]; otherwise 0.
    pub level: u32,
}

/// The rows of a table in the texels: none where they would be beyond.
#[inline(always)]
pub fn table(texels: &[u32], first: u32, rows: u32) -> &[[u32; 2]] {
    let words = texels.get(first as usize..).unwrap_or(&[]);
    let (all, _) = words.as_chunks();
    all.get(..rows as usize).unwrap_or(&[])
}

/// Texture kinds and flags.
pub mod texture {
    /// `color[0]` where ⌊u⌋ + ⌊v⌋ is even, else `color[1]`.
    pub const CHECKERBOARD: u32 = 0;
    /// Texels of four bytes RGBA, sRGB-coded (alpha linear).
    pub const SRGB8: u32 = 1;
    /// Texels of four bytes RGBA, linear.
    pub const LINEAR8: u32 = 2;
    /// Texels of three words, `f32` RGB, ≥ 0.
    pub const FLOAT: u32 = 3;
    /// The same everywhere: `width` rows of (nm, value), two words each, by rising wavelength, values ≥ 0; linear between. `color[0]` is what
    /// it stands for where paths carry no wavelengths.
    pub const SPECTRUM: u32 = 4;
    /// Flag: the nearest texel rather than bilinear.
    pub const NEAREST: u32 = 1;
    /// Flag: clamp coordinates rather than repeat.
    pub const CLAMP: u32 = 2;
    /// Flag: mirror coordinates rather than repeat.
    pub const MIRROR: u32 = 4;
    /// Flag: the value is the alpha channel (in every channel).
    pub const ALPHA: u32 = 8;
}

/// A colour over (u, v).
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Texture {
    /// Which kind ([`texture`]).
    pub kind: u32,
    /// Its flags.
    pub flags: u32,
    /// Texels per row, ≥ 1 for images.
    pub width: u32,
    /// Rows; row 0 is the top of the image, at v = 0.
    pub height: u32,
    /// First word in [`section::TEXELS`].
    pub texels: u32,
    /// Zero.
    pub reserved: u32,
    /// (u, v, 1) is multiplied by this 2×3 matrix, row by row, before the lookup.
    pub to_uv: [[f32; 3]; 2],
    /// checkerboard: the two colours. Images: `color[0]` scales.
    pub color: [[f32; 3]; 2],
    /// Zero.
    pub reserved2: [u32; 6],
}

/// Emitter kinds.
pub mod emitter {
    /// A shape's boundary: `radiance` on the side of the normal.
    pub const AREA: u32 = 0;
    /// A point at `position`: `radiance` is intensity, W sr⁻¹.
    pub const POINT: u32 = 1;
    /// A point with a cone about `direction`: full intensity inside `cos_inner`, none outside
    /// `cos_outer`, linear in the angle between.
    pub const SPOT: u32 = 2;
    /// From infinity along `direction` (where light travels): `radiance` is irradiance on a plane
    /// perpendicular to it, W m⁻².
    pub const DIRECTIONAL: u32 = 3;
    /// `radiance` from every direction.
    pub const CONSTANT: u32 = 4;
    /// A lat-long image: up is the frame's y, +x at u = 1/4, +z at u = 1/2, −z at u = 0; columns are
    /// texel-centred and wrap, rows align with the poles (θ = π·y/(height−1)); bilinear.
    pub const LATLONG: u32 = 5;
    /// Six square faces in the order +x −x +y −y +z −z, each `width`², stacked vertically. On face ±x the
    /// coordinates (s, t) ∈ [−1, 1]² are (y, z)/|x|, on ±y (z, x)/|y|, on ±z (x, y)/|z|;
    /// column ⌊(s+1)/2·width⌋, row ⌊(t+1)/2·width⌋; nearest texel.
    pub const CUBEMAP: u32 = 6;
    /// What `medium` emits, drawn uniformly from the box `position` + ξ·`to_local` (its rows are the box's edges), ξ ∈ [0, 1]³, that
    /// holds all of the medium; `density` is per unit of volume.
    pub const VOLUME: u32 = 7;
}

/// A light.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Emitter {
    /// Which kind ([`emitter`]).
    pub kind: u32,
    /// area: its shape.
    pub shape: u32,
    /// Radiance, intensity or irradiance; scales an environment's texels. ≥ 0.
    pub radiance: [f32; 3],
    /// The density with which choice-and-position lands here when emitters are chosen by power:
    /// area: per unit of area; otherwise: the probability of choosing this emitter. > 0.
    pub density: f32,
    /// point, spot: where.
    pub position: [f32; 3],
    /// spot: axis. directional: where light travels.
    pub direction: [f32; 3],
    /// spot: cosine of the angle at which the fall-off begins.
    pub cos_inner: f32,
    /// spot: cosine of the cut-off angle, < `cos_inner`.
    pub cos_outer: f32,
    /// Environments: rows are the image's x, y, z axes in the world: local = rows · world.
    pub to_local: [[f32; 3]; 3],
    /// Environments: first word in [`section::TEXELS`], three `f32` words a texel.
    pub texels: u32,
    /// Environments: columns.
    pub width: u32,
    /// Environments: rows (cube map: 6·width).
    pub height: u32,
    /// Environments: first of the [`section::CELLS`]: width·(height−1) for lat-long (a cell lies
    /// between texel centres), width·height for cube maps.
    pub cells: u32,
    /// point, spot: the medium it stands in. volume: the medium that emits. [`NONE`]: vacuum.
    pub medium: u32,
    /// Its spectrum: first word in [`section::TEXELS`] and number of rows (nm, value), two words each, by rising wavelength; linear
    /// between. With no rows it is that of light of the colour `radiance`, which stands in where paths carry no wavelengths.
    pub spectrum: [u32; 2],
    /// Zero.
    pub reserved: [u32; 2],
}

/// An entry of the alias table over emitting primitives (Walker 1977, Vose 1991): stay with
/// probability `keep`, else take entry `alias`. One entry per emitting triangle or sphere, one per
/// emitter of other kinds.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Choice {
    /// Probability of staying, in [0, 1].
    pub keep: f32,
    /// Where to go otherwise.
    pub alias: u32,
    /// The emitter.
    pub emitter: u32,
    /// area: the primitive (a triangle slot or a sphere's id), else [`NONE`].
    pub primitive: u32,
}

/// An entry of the alias table over an environment's cells.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Cell {
    /// Probability of staying, in [0, 1].
    pub keep: f32,
    /// Where to go otherwise, relative to the emitter's first cell.
    pub alias: u32,
    /// Probability of this cell, ≥ 0; > 0 where any of its texels is.
    pub probability: f32,
}

/// Sensor and filter kinds.
pub mod sensor {
    /// Pinhole (`aperture` 0) or thin lens.
    pub const PERSPECTIVE: u32 = 0;
    /// Parallel rays.
    pub const ORTHOGRAPHIC: u32 = 1;
    /// All directions around a point, lat-long: forward in the middle, right at three quarters, up at the top row; columns are equal
    /// steps of longitude, rows equal steps of the angle from up. `right`, `down` and `forward` are perpendicular.
    pub const PANORAMA: u32 = 2;
    /// Filter: 1 within the pixel (times 2·radius).
    pub const BOX: u32 = 0;
    /// Filter: a pyramid of half-width `filter_radius`.
    pub const TENT: u32 = 1;
    /// Filter: exp(−x²/2σ²), cut at `filter_radius`, shifted to 0 there.
    pub const GAUSSIAN: u32 = 2;
}

/// The camera.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Sensor {
    /// Which kind ([`sensor`]).
    pub kind: u32,
    /// Pixel filter.
    pub filter: u32,
    /// Its half-width in pixels, in (0, 8].
    pub filter_radius: f32,
    /// Gaussian: σ in pixels.
    pub filter_sigma: f32,
    /// Full resolution.
    pub resolution: [u32; 2],
    /// Crop window within it: first column and row.
    pub crop_offset: [u32; 2],
    /// Crop window: columns and rows, ≥ 1: the image.
    pub crop_size: [u32; 2],
    /// Perspective: tangents of the half-angles of the full image in x and y. Orthographic: its half-extents. Panorama: not read.
    pub half_extent: [f32; 2],
    /// Thin lens: its radius.
    pub aperture: f32,
    /// Thin lens: distance to the plane in focus, along the axis.
    pub focus: f32,
    /// Nearest and farthest depth that the sensor sees: along the axis, by a panorama from its centre.
    pub clip: [f32; 2],
    /// Centre of projection.
    pub origin: [f32; 3],
    /// Towards larger column numbers, unit.
    pub right: [f32; 3],
    /// Towards larger row numbers (down in the picture), unit.
    pub down: [f32; 3],
    /// The optical axis, into the scene, unit.
    pub forward: [f32; 3],
    /// Medium it stands in; [`NONE`]: vacuum.
    pub medium: u32,
    /// Shift of the film in units of the full image's width and height: film point x looks where x + `principal`
    /// would without it. Panorama: not read.
    pub principal: [f32; 2],
    /// Zero.
    pub reserved: [u32; 1],
}

const _: () = assert!(
    (size_of::<Header>() == 64 && size_of::<Toc>() == 32 && size_of::<World>() == 64)
        && (size_of::<Node>() == 256 && size_of::<Packet>() == 144 && size_of::<Triangle>() == 16)
        && (size_of::<Sphere>() == 32 && size_of::<Shape>() == 64 && size_of::<Material>() == 128)
        && (size_of::<Texture>() == 96 && size_of::<Emitter>() == 128 && size_of::<Choice>() == 16)
        && (size_of::<Cell>() == 12 && size_of::<Sensor>() == 128)
        && (size_of::<Medium>() == 224 && size_of::<Grid>() == 32 && size_of::<Lobe>() == 16)
);
