//! A scene as loaded: what every loader makes and the compiler reads. World space, meshes indexed,
//! names kept for messages.

mod media;
mod spectrum;

pub use media::{Grid, GridValues, Grids, Lobe, Medium, Phase, Tracking};
pub use spectrum::{Carry, Index, Spectrum, is_spectrum};

use std::path::PathBuf;

/// Linear sRGB.
pub type Color = [f32; 3];

/// Where in a scene file something was said.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Line from 1; 0 where lines mean nothing (binary files).
    pub line: u32,
}

/// A whole scene.
#[derive(Clone, Debug, Default)]
pub struct Description {
    /// The camera and its film.
    pub sensor: Sensor,
    /// Objects.
    pub shapes: Vec<Shape>,
    /// Local models that shapes refer to by index.
    pub materials: Vec<Material>,
    /// Textures that materials refer to by index.
    pub textures: Vec<Texture>,
    /// Lights that aren't shapes.
    pub emitters: Vec<Emitter>,
    /// What fills scattering volumes; shapes, the sensor and lights refer to it by index.
    pub media: Vec<Medium>,
    /// Medium of the space outside all objects; `None`: what the objects say that it is met from, vacuum if they say nothing.
    pub exterior: Option<usize>,
    /// What paths carry.
    pub carry: Carry,
    /// Advice of the file to the renderer.
    pub advice: Advice,
}

impl Description {
    /// Whether paths carry wavelengths.
    pub fn spectral(&self) -> bool {
        let by_wavelength = |m: &Material| match &m.model {
            Model::Conductor { spectra, .. } | Model::RoughConductor { spectra, .. } => {
                spectra.is_some()
            }
            model => matches!(model, Model::Dispersive { .. }),
        };
        match self.carry {
            Carry::AsNeeded => {
                self.materials.iter().any(by_wavelength)
                    || self
                        .textures
                        .iter()
                        .any(|t| matches!(t.pattern, Pattern::Spectrum(_)))
                    || self.shapes.iter().any(|s| s.spectrum.is_some())
                    || self.emitters.iter().any(|e| e.spectrum.is_some())
                    || self
                        .media
                        .iter()
                        .any(|m| m.spectra.iter().any(Option::is_some))
            }
            Carry::Rgb => false,
            Carry::Wavelengths => true,
        }
    }
}

/// What a scene file says about how to render it. The command line has the last word.
#[derive(Clone, Copy, Debug, Default)]
pub struct Advice {
    /// Most edges of a path as Mitsuba counts them; `None` is unlimited.
    pub max_depth: Option<u32>,
    /// Samples per pixel.
    pub samples: Option<u32>,
}

/// The camera.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// Kind and field of view.
    pub projection: Projection,
    /// Centre of projection.
    pub origin: [f32; 3],
    /// Towards larger column numbers, unit.
    pub right: [f32; 3],
    /// Towards larger row numbers (down in the picture), unit.
    pub down: [f32; 3],
    /// The optical axis, into the scene, unit.
    pub forward: [f32; 3],
    /// Nearest and farthest depth along the axis (panorama: distance).
    pub clip: [f32; 2],
    /// Offset of the principal point in units of image width and height: a point (x, y) of the film
    /// looks where (x, y) + `principal` would without it.
    pub principal: [f32; 2],
    /// Columns and rows of the full image.
    pub resolution: [u32; 2],
    /// Crop window: first column, first row, columns, rows.
    pub crop: Option<[u32; 4]>,
    /// Pixel filter.
    pub filter: Filter,
    /// Medium it stands in; `None`: found from the objects around it.
    pub medium: Option<usize>,
}

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Pinhole (`aperture` 0) or thin lens.
    Perspective {
        /// Tangents of the half-angles in x and y.
        half_tangent: [f32; 2],
        /// Radius of the lens.
        aperture: f32,
        /// Distance to the plane in focus.
        focus: f32,
    },
    /// Parallel rays.
    Orthographic {
        /// Half-extents in x and y.
        half_extent: [f32; 2],
    },
    /// All directions around the origin, lat-long: forward in the middle.
    Panorama,
}

/// A pixel filter; radii in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant.
    Box {
        /// Half-width.
        radius: f32,
    },
    /// Linear falloff.
    Tent {
        /// Half-width.
        radius: f32,
    },
    /// Gaussian, cut where it is shifted to 0.
    Gaussian {
        /// σ.
        sigma: f32,
        /// Half-width.
        radius: f32,
    },
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            projection: Projection::Perspective {
                half_tangent: [1.0, 1.0],
                aperture: 0.0,
                focus: 1.0,
            },
            origin: [0.0; 3],
            right: [-1.0, 0.0, 0.0],
            down: [0.0, -1.0, 0.0],
            forward: [0.0, 0.0, 1.0],
            clip: [1e-2, 1e4],
            principal: [0.0; 2],
            resolution: [768, 576],
            crop: None,
            filter: Filter::Box { radius: 0.5 },
            medium: None,
        }
    }
}

/// An object.
#[derive(Clone, Debug)]
pub struct Shape {
    /// What messages call it: its id, or "sphere at file:line".
    pub name: String,
    /// Where it was said.
    pub place: Place,
    /// Its surface, in world space.
    pub geometry: Geometry,
    /// Material on the side of the normal; `None` is black.
    pub front: Option<usize>,
    /// Material on the other side; `None` is black.
    pub back: Option<usize>,
    /// Radiance emitted on the side of the normal.
    pub emission: Option<Color>,
    /// Its spectrum, if that is known: `emission` is what it stands for where paths carry no wavelengths.
    pub spectrum: Option<Spectrum>,
    /// Opacity: the texture's first channel, or a constant.
    pub opacity: Option<ColorSource>,
    /// Medium behind the normal; `None`: vacuum. Where `interior` and `exterior` are both `None`, the object doesn't part media:
    /// the same one is on both of its sides, whichever it is.
    pub interior: Option<usize>,
    /// Medium in front of the normal.
    pub exterior: Option<usize>,
}

/// A surface.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// Triangles.
    Mesh(Mesh),
    /// An exact sphere.
    Sphere {
        /// Centre.
        center: [f32; 3],
        /// Radius.
        radius: f32,
        /// Whether the normal points inwards.
        flipped: bool,
    },
}

/// Triangles over shared vertices. The front of a triangle is where its vertices run counter-clockwise.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions.
    pub positions: Vec<[f32; 3]>,
    /// Normals, one per position, or none: flat.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Texture coordinates, one per position, or none.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Where a triangle's vertices are; `None` if there is no such vertex.
    pub fn vertices(&self, triangle: &[u32; 3]) -> Option<[[f32; 3]; 3]> {
        let [a, b, c] = triangle.map(|v| self.positions.get(v as usize).copied());
        Some([a?, b?, c?])
    }

    /// The same in double precision.
    pub(crate) fn corners(&self, triangle: &[u32; 3]) -> Option<[glam::DVec3; 3]> {
        Some(self.vertices(triangle)?.map(|p| p.map(f64::from).into()))
    }
}

/// A constant colour or a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorSource {
    /// The same everywhere.
    Constant(Color),
    /// Index of a [`Texture`].
    Texture(usize),
}

/// A local model.
#[derive(Clone, Debug)]
pub struct Material {
    /// What messages call it.
    pub name: String,
    /// Which.
    pub model: Model,
}

/// The local models.
#[derive(Clone, Debug)]
pub enum Model {
    /// Diffuse reflection and transmission.
    Diffuse {
        /// k_d of reflection.
        reflectance: ColorSource,
        /// k_d of transmission.
        transmittance: ColorSource,
    },
    /// Perfect mirror.
    Mirror {
        /// k_s.
        reflectance: ColorSource,
    },
    /// Smooth conductor.
    Conductor {
        /// Real part of the index relative to outside.
        eta: Color,
        /// Imaginary part.
        k: Color,
        /// Both by wavelength, if that is known: `eta` and `k` are what they stand for where paths carry no wavelengths.
        spectra: Option<[Spectrum; 2]>,
        /// Scale.
        reflectance: ColorSource,
    },
    /// Smooth dielectric.
    Dielectric {
        /// Index inside over index outside.
        ior: f32,
        /// Scale of reflection.
        reflectance: ColorSource,
        /// Scale of transmission.
        transmittance: ColorSource,
        /// Schlick's approximation instead of Fresnel's equations.
        schlick: bool,
    },
    /// Smooth dielectric whose index depends on wavelength.
    Dispersive {
        /// Index inside by wavelength.
        index: Index,
        /// Index outside.
        outside: f32,
        /// Scale of reflection.
        reflectance: ColorSource,
        /// Scale of transmission.
        transmittance: ColorSource,
        /// Schlick's approximation instead of Fresnel's equations.
        schlick: bool,
    },
    /// Light passes.
    Null,
    /// Thin sheet.
    Sheet {
        /// Mirror-like part.
        specular_reflectance: ColorSource,
        /// Straight transmission.
        specular_transmittance: ColorSource,
        /// Diffuse reflection.
        diffuse_reflectance: ColorSource,
        /// Diffuse transmission.
        diffuse_transmittance: ColorSource,
    },
    /// Phong lobes over a diffuse base.
    Phong {
        /// Diffuse reflection.
        diffuse_reflectance: ColorSource,
        /// The lobe about the mirror direction.
        reflectance: ColorSource,
        /// The lobe about the refracted direction.
        transmittance: ColorSource,
        /// Diffuse transmission.
        diffuse_transmittance: ColorSource,
        /// n, from 0 to 10⁵.
        exponent: f32,
        /// The modified model's normalisation (n + 2)/2π, by which k is an albedo; else (n + 1)/2π.
        modified: bool,
        /// Index inside over index outside, for refraction; 1 is a thin sheet.
        ior: f32,
        /// Whether the lobes have Fresnel's shares.
        fresnel: bool,
    },
    /// Conducting microfacets.
    RoughConductor {
        /// Real part of the index relative to outside; 0 with k = 1 reflects everything.
        eta: Color,
        /// Imaginary part.
        k: Color,
        /// Both by wavelength, if that is known: `eta` and `k` are what they stand for where paths carry no wavelengths.
        spectra: Option<[Spectrum; 2]>,
        /// Scale.
        reflectance: ColorSource,
        /// The facets.
        facets: Facets,
    },
    /// Dielectric microfacets between two media.
    RoughDielectric {
        /// Index inside over index outside; not 1.
        ior: f32,
        /// Scale of reflection.
        reflectance: ColorSource,
        /// Scale of transmission.
        transmittance: ColorSource,
        /// The facets.
        facets: Facets,
    },
    /// A diffuse base under a dielectric coat.
    Plastic {
        /// Index of the coat over index outside.
        ior: f32,
        /// k_d of the base.
        diffuse_reflectance: ColorSource,
        /// Scale of the coat's reflection.
        reflectance: ColorSource,
        /// Whether light that the coat sends back takes the base's colour each time.
        nonlinear: bool,
        /// The coat's facets; `None` is smooth.
        facets: Option<Facets>,
    },
    /// At each point one of two materials, at random.
    Blend {
        /// Indices of both.
        parts: [usize; 2],
        /// Probability of the second: the first channel.
        weight: ColorSource,
    },
}

impl Model {
    /// Its colours; a blend's parts have their own.
    pub fn colors(&self) -> Vec<ColorSource> {
        match *self {
            Model::Diffuse {
                reflectance,
                transmittance,
            }
            | Model::Dielectric {
                reflectance,
                transmittance,
                ..
            }
            | Model::Dispersive {
                reflectance,
                transmittance,
                ..
            }
            | Model::RoughDielectric {
                reflectance,
                transmittance,
                ..
            } => vec![reflectance, transmittance],
            Model::Mirror { reflectance }
            | Model::Conductor { reflectance, .. }
            | Model::RoughConductor { reflectance, .. } => vec![reflectance],
            Model::Null => vec![],
            Model::Sheet {
                specular_reflectance,
                specular_transmittance,
                diffuse_reflectance,
                diffuse_transmittance,
            } => vec![
                specular_reflectance,
                specular_transmittance,
                diffuse_reflectance,
                diffuse_transmittance,
            ],
            Model::Phong {
                diffuse_reflectance,
                reflectance,
                transmittance,
                diffuse_transmittance,
                ..
            } => vec![
                diffuse_reflectance,
                reflectance,
                transmittance,
                diffuse_transmittance,
            ],
            Model::Plastic {
                diffuse_reflectance,
                reflectance,
                ..
            } => vec![diffuse_reflectance, reflectance],
            Model::Blend { weight, .. } => vec![weight],
        }
    }
}

/// A rough surface's facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facets {
    /// Roughness α along the two tangents that the kernel lays at a normal, from 10⁻⁴ to 10.
    pub alpha: [f32; 2],
    /// How their normals are distributed.
    pub distribution: Distribution,
    /// How they hide each other.
    pub masking: Masking,
    /// Whether the light that single scattering loses is given back.
    pub compensated: bool,
}

/// How facets' normals are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Trowbridge and Reitz's, with long tails.
    Ggx,
    /// Beckmann's: normal slopes.
    Beckmann,
}

/// How facets hide each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// Smith's, correlated by height.
    Correlated,
    /// Smith's, each direction for itself.
    Separable,
    /// V-shaped cavities; not for dielectrics.
    Cavities,
}

/// A colour over (u, v).
#[derive(Clone, Debug)]
pub struct Texture {
    /// What messages call it.
    pub name: String,
    /// Texels or pattern.
    pub pattern: Pattern,
    /// 2×3 matrix from mesh (u, v) to texture coordinates.
    pub to_uv: [[f32; 3]; 2],
}

/// Where a texture's colours come from.
#[derive(Clone, Debug)]
pub enum Pattern {
    /// The same everywhere, by wavelength; values in [0, 1].
    Spectrum(Spectrum),
    /// A checkerboard of unit squares: the first colour where ⌊u⌋ + ⌊v⌋ is even.
    Checkerboard {
        /// Both colours.
        colors: [Color; 2],
    },
    /// An image.
    Bitmap {
        /// Its texels.
        image: Image,
        /// Nearest texel instead of bilinear.
        nearest: bool,
        /// What happens outside [0, 1]².
        wrap: Wrap,
        /// Take the alpha channel.
        alpha: bool,
    },
}

/// What happens outside [0, 1]².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// Starts over.
    Repeat,
    /// The border goes on.
    Clamp,
    /// Back and forth.
    Mirror,
}

/// Texels, row 0 at the top.
#[derive(Clone, Debug)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row.
    pub texels: Texels,
}

/// How texels are coded.
#[derive(Clone, Debug)]
pub enum Texels {
    /// RGBA, sRGB-coded (alpha linear).
    Srgb8(Vec<[u8; 4]>),
    /// RGBA, linear.
    Linear8(Vec<[u8; 4]>),
    /// Linear RGB.
    Float(Vec<Color>),
}

/// A light that isn't a shape.
#[derive(Clone, Debug)]
pub struct Emitter {
    /// What messages call it.
    pub name: String,
    /// Where it was said.
    pub place: Place,
    /// Which.
    pub kind: EmitterKind,
    /// Point and spot: the medium it stands in; `None`: found from the objects around it.
    pub medium: Option<usize>,
    /// The spectrum of what `kind` says in red, green and blue, if that is known. Not of environments.
    pub spectrum: Option<Spectrum>,
}

/// The lights.
#[derive(Clone, Debug)]
pub enum EmitterKind {
    /// Isotropic point.
    Point {
        /// Where.
        position: [f32; 3],
        /// W sr⁻¹.
        intensity: Color,
    },
    /// Point with a cone.
    Spot {
        /// Where.
        position: [f32; 3],
        /// Axis, unit.
        direction: [f32; 3],
        /// Intensity on the axis.
        intensity: Color,
        /// Angle of the cut-off, radians.
        cutoff: f32,
        /// Angle at which the fall-off begins, radians.
        beam_width: f32,
    },
    /// From infinity.
    Directional {
        /// Where light travels, unit.
        direction: [f32; 3],
        /// On a plane perpendicular to it.
        irradiance: Color,
    },
    /// The same radiance from everywhere.
    Constant {
        /// Radiance.
        radiance: Color,
    },
    /// A lat-long image.
    LatLong {
        /// Linear texels.
        width: u32,
        /// Rows.
        height: u32,
        /// Row by row from the top.
        texels: Vec<Color>,
        /// Factor.
        scale: f32,
        /// The image's axes in the world: rows.
        to_local: [[f32; 3]; 3],
    },
    /// Six square images in the order +x −x +y −y +z −z.
    CubeMap {
        /// Columns of a face.
        width: u32,
        /// 6·width rows.
        texels: Vec<Color>,
        /// Factor.
        scale: f32,
        /// The image's axes in the world: rows.
        to_local: [[f32; 3]; 3],
    },
}
