//! The typed view of a blob that [`Scene::open`] accepted.
//!
//! Nothing here copies: a `Scene` is a handful of slices into the bytes. Lookups by id go through
//! `get`, so that an id of [`NONE`] and an id from a foreign [`crate::shape::Tracer`] are both simply "nothing".

use super::check;
use super::error::BlobError;
use super::format::{
    Cell, Choice, Emitter, Grid, Header, LANES, Material, Medium, NONE, Node, Packet, Sensor,
    Shape, Sphere, Texture, Triangle, World, needs,
};
use super::possible::Possible;
use crate::real::{Vec3, vec3};
use crate::sensor::Filter;
use crate::shape::{Bounds, Instructions, IsaKind};
use crate::surface::TextureView;

/// A scene, ready to be asked for light. Immutable; any number of threads may share it.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) header: &'a Header,
    pub(super) world: &'a World,
    pub(super) sensor: &'a Sensor,
    pub(super) nodes: &'a [Node],
    pub(super) packets: &'a [Packet],
    pub(super) triangles: &'a [Triangle],
    pub(super) spheres: &'a [Sphere],
    pub(super) normals: &'a [[f32; 3]],
    pub(super) uvs: &'a [[f32; 2]],
    pub(super) shapes: &'a [Shape],
    pub(super) materials: &'a [Material],
    pub(super) textures: &'a [Texture],
    pub(super) texels: &'a [u32],
    pub(super) emitters: &'a [Emitter],
    pub(super) choices: &'a [Choice],
    pub(super) cells: &'a [Cell],
    pub(super) media: &'a [Medium],
    pub(super) grids: &'a [Grid],
    pub(super) isa: Instructions,
    pub(super) possible: Possible,
    pub(super) filter: Filter,
    pub(super) bounds: Bounds,
}

impl<'a> Scene<'a> {
    /// Checks `bytes` and views them as a scene.
    ///
    /// Total (any bytes give a scene or an error) and linear in their number. `bytes` must start at
    /// an address that is a multiple of 16; the format stands in [`crate::blob::format`].
    ///
    /// # Errors
    /// What is wrong and where, as a [`BlobError`].
    pub fn open(bytes: &'a [u8]) -> Result<Self, BlobError> {
        check::open(bytes)
    }

    /// The blob.
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The same scene, traversed by another instruction set: for tests, the bits are the same. One that this machine
    /// lacks falls back to the best that it has.
    #[must_use]
    pub fn with_isa(mut self, isa: IsaKind) -> Self {
        self.isa = Instructions::select(isa);
        self
    }

    /// The instruction set that traversal uses.
    pub fn isa(&self) -> Instructions {
        self.isa
    }

    /// Columns and rows of the image: the crop window.
    pub fn size(&self) -> [u32; 2] {
        self.sensor.crop_size
    }

    /// The film's step is 2^(this − 64).
    pub fn film_exponent(&self) -> i32 {
        self.header.film_exponent
    }

    /// What the scene holds: bits of [`needs`].
    pub fn needs(&self) -> u32 {
        self.header.needs
    }

    /// Whether the scene holds any of `bits` ([`needs`]).
    #[inline(always)]
    pub fn has(&self, bits: u32) -> bool {
        self.header.needs & bits != 0
    }

    /// What light paths there may be at all.
    #[inline(always)]
    pub fn possible(&self) -> Possible {
        self.possible
    }

    /// Facts about the scene as a whole.
    #[inline(always)]
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// The camera.
    #[inline(always)]
    pub fn sensor(&self) -> &'a Sensor {
        self.sensor
    }

    /// The camera's pixel filter.
    #[inline(always)]
    pub fn filter(&self) -> &Filter {
        &self.filter
    }

    /// A box around its objects, as its tree has it.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Its objects.
    pub fn shapes(&self) -> &'a [Shape] {
        self.shapes
    }

    /// Its local models.
    pub fn materials(&self) -> &'a [Material] {
        self.materials
    }

    /// Its textures.
    pub fn textures(&self) -> &'a [Texture] {
        self.textures
    }

    /// Its lights.
    #[inline(always)]
    pub fn emitters(&self) -> &'a [Emitter] {
        self.emitters
    }

    /// The alias table over emitting primitives.
    #[inline(always)]
    pub fn choices(&self) -> &'a [Choice] {
        self.choices
    }

    /// The alias tables over environment cells.
    #[inline(always)]
    pub fn cells(&self) -> &'a [Cell] {
        self.cells
    }

    /// What fills its scattering volumes.
    pub fn media(&self) -> &'a [Medium] {
        self.media
    }

    /// The grids of its media.
    #[inline(always)]
    pub fn grids(&self) -> &'a [Grid] {
        self.grids
    }

    /// All texels.
    #[inline(always)]
    pub fn texels(&self) -> &'a [u32] {
        self.texels
    }

    /// The tree's nodes.
    pub fn nodes(&self) -> &'a [Node] {
        self.nodes
    }

    /// The triangles' packets.
    pub fn packets(&self) -> &'a [Packet] {
        self.packets
    }

    /// The spheres' records.
    pub fn sphere_records(&self) -> &'a [Sphere] {
        self.spheres
    }

    /// Every triangle with its primitive id: what an engine builds its own [`crate::shape::Tracer`] over.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [[f32; 3]; 3])> + 'a {
        let triangles = self.triangles;
        self.packets
            .iter()
            .enumerate()
            .flat_map(move |(p, packet)| {
                (0..LANES).filter_map(move |lane| {
                    let slot = p * LANES + lane;
                    let used = triangles.get(slot).is_some_and(|t| t.shape != NONE);
                    let corner = |v: usize| {
                        packet.v.get(v).map_or([0.0; 3], |c| {
                            c.map(|axis| axis.get(lane).copied().unwrap_or(0.0))
                        })
                    };
                    used.then(|| (slot as u32, [corner(0), corner(1), corner(2)]))
                })
            })
    }

    /// Every sphere with its primitive id, centre and radius.
    pub fn spheres(&self) -> impl Iterator<Item = (u32, [f32; 3], f32)> + 'a {
        let base = self.world.sphere_base;
        self.spheres
            .iter()
            .zip(base..)
            .map(|(s, id)| (id, s.center, s.radius))
    }

    #[inline(always)]
    pub(crate) fn triangle(&self, slot: u32) -> Option<&'a Triangle> {
        self.triangles.get(slot as usize)
    }

    /// The corners of the triangle in `slot`.
    #[inline(always)]
    pub(crate) fn corners(&self, slot: u32) -> Option<[Vec3; 3]> {
        let packet = self.packets.get(slot as usize / LANES)?;
        let lane = slot as usize % LANES;
        let corner = |axes: &[[f32; LANES]; 3]| vec3([axes[0][lane], axes[1][lane], axes[2][lane]]);
        Some([
            corner(&packet.v[0]),
            corner(&packet.v[1]),
            corner(&packet.v[2]),
        ])
    }

    #[inline(always)]
    pub(crate) fn sphere(&self, primitive: u32) -> Option<&'a Sphere> {
        let index = primitive.checked_sub(self.world.sphere_base)?;
        self.spheres.get(index as usize)
    }

    #[inline(always)]
    pub(crate) fn shape(&self, id: u32) -> Option<&'a Shape> {
        self.shapes.get(id as usize)
    }

    #[inline(always)]
    pub(crate) fn material(&self, id: u32) -> Option<&'a Material> {
        self.materials.get(id as usize)
    }

    #[inline(always)]
    pub(crate) fn emitter(&self, id: u32) -> Option<&'a Emitter> {
        self.emitters.get(id as usize)
    }

    #[inline(always)]
    pub(crate) fn grid(&self, id: u32) -> Option<&'a Grid> {
        self.grids.get(id as usize)
    }

    #[inline(always)]
    pub(crate) fn medium(&self, id: u32) -> Option<&'a Medium> {
        self.media.get(id as usize)
    }

    /// The normal of vertex `index` of `shape`.
    #[inline(always)]
    pub(crate) fn normal(&self, shape: &Shape, index: u32) -> Option<Vec3> {
        if shape.normals == NONE {
            return None;
        }
        let at = (shape.normals as usize).checked_add(index as usize)?;
        self.normals.get(at).map(|&n| vec3(n))
    }

    /// The texture coordinates of vertex `index` of `shape`.
    #[inline(always)]
    pub(crate) fn uv(&self, shape: &Shape, index: u32) -> Option<[f32; 2]> {
        if shape.uvs == NONE {
            return None;
        }
        let at = (shape.uvs as usize).checked_add(index as usize)?;
        self.uvs.get(at).copied()
    }

    /// The textures, for resolving a material.
    #[inline(always)]
    pub fn texture_view(&self) -> TextureView<'a> {
        TextureView {
            textures: self.textures,
            texels: self.texels,
        }
    }

    /// Whether shadow rays may meet what lets light pass: masks or null boundaries.
    #[inline(always)]
    pub(crate) fn has_passable(&self) -> bool {
        self.has(needs::MASKS | needs::NULL)
    }
}
