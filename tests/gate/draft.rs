//! A good blob, and the means to break one thing in it.

use bytemuck::{Pod, Zeroable};
use etendue::blob::format::{Emitter, Header, NONE, Toc, emitter, medium, section};
use etendue_host::blob::AlignedBlob;
use etendue_host::description::{
    ColorSource, Distribution, EmitterKind, Facets, Image, Masking, Model, Pattern, Texels,
    Texture, Wrap,
};
use etendue_tests::media::{Matter, homogeneous, lobes, records, replaced};
use etendue_tests::render::blob;
use etendue_tests::scenes::{Builder, room};

/// A blob that is being changed.
pub struct Draft(pub AlignedBlob);

impl Draft {
    pub fn header(&mut self) -> &mut Header {
        let (header, _) = self.0.bytes_mut().split_at_mut(size_of::<Header>());
        bytemuck::from_bytes_mut(header)
    }

    /// The table's entry of a section.
    pub fn toc(&mut self, section: u32) -> &mut Toc {
        let head = size_of::<Header>();
        let count = self.header().section_count as usize;
        let table = &mut self.0.bytes_mut()[head..head + count * size_of::<Toc>()];
        let table: &mut [Toc] = bytemuck::cast_slice_mut(table);
        table.iter_mut().find(|t| t.kind == section).unwrap()
    }

    /// A section's records.
    pub fn all<T: Pod>(&mut self, section: u32) -> &mut [T] {
        let toc = *self.toc(section);
        assert_eq!(toc.stride as usize, size_of::<T>());
        let start = toc.offset as usize;
        let end = start + toc.count as usize * size_of::<T>();
        bytemuck::cast_slice_mut(&mut self.0.bytes_mut()[start..end])
    }

    pub fn record<T: Pod>(&mut self, section: u32, index: usize) -> &mut T {
        &mut self.all(section)[index]
    }
}

/// Materials of the scene below, by their place in its blob.
pub const GLASS: usize = 3;
/// One of each kind that has numbers of its own.
pub const PHONG: usize = 4;
pub const METAL: usize = 5;
pub const GROUND: usize = 6;
pub const PLASTIC: usize = 7;
pub const BLEND: usize = 8;
pub const BLENDS: usize = 9;
/// Textures: a checkerboard, two small images, one of the same size as the sky.
pub const IMAGES: [usize; 2] = [1, 2];
pub const FLOATS: usize = 3;
/// The one shape with normals.
pub const SMOOTH: usize = 6;
/// The two spheres' shapes: one of glass, one that shines.
pub const BALL: usize = 7;
pub const LAMP: usize = 8;

/// Its media: a grid of three grids, and fog.
pub const CLOUD: usize = 0;
pub const FOG: usize = 1;
/// The light that the cloud is.
pub const GLOW: usize = 6;
/// The words that these media add to the texels: the extinction's, the albedo's, the emission's, the majorants.
pub const WORDS: [usize; 4] = [8, 6, 4, 2];

fn matter() -> Matter {
    let mut matter = Matter::default();
    let extinctions = matter.grid([2, 2, 2], false, |[x, ..]| [1.0 + x as f32]);
    let albedos = matter.grid([1, 2, 1], true, |_| [0.5, 1.0, 0.25]);
    let emissions = matter.grid([4, 1, 1], false, |[x, ..]| [x as f32]);
    let cloud = matter.gridded(extinctions, [0.5; 3], [1.0; 3], [2, 1, 1]);
    let cloud = &mut matter.media[cloud];
    (cloud.albedos, cloud.emissions, cloud.emission) = (albedos, emissions, [1.0; 3]);
    (cloud.flags, cloud.emitter) = (medium::REGULAR, GLOW as u32);
    let mut fog = homogeneous([0.5, 1.0, 0.0], [0.5; 3]);
    fog.emission = [1.0, 0.0, 0.0];
    fog.phase = lobes(&[
        (medium::HENYEY_GREENSTEIN, 0.5, 0.75),
        (medium::RAYLEIGH, 0.0, 0.25),
    ]);
    matter.media.push(fog);
    matter
}

/// With a light that is the cloud's glow.
fn glowing(blob: &AlignedBlob) -> AlignedBlob {
    let mut emitters: Vec<Emitter> = records(blob, section::EMITTERS);
    emitters.push(Emitter {
        kind: emitter::VOLUME,
        shape: NONE,
        density: 1.0,
        to_local: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        medium: CLOUD as u32,
        ..Emitter::zeroed()
    });
    replaced(blob, section::EMITTERS, &emitters)
}

fn glossy(b: &mut Builder) {
    let grey = ColorSource::Constant([0.25; 3]);
    let facets = Facets {
        alpha: [0.3; 2],
        distribution: Distribution::Ggx,
        masking: Masking::Correlated,
        compensated: true,
    };
    let made = [
        Model::Phong {
            diffuse_reflectance: grey,
            reflectance: grey,
            transmittance: grey,
            diffuse_transmittance: grey,
            exponent: 1e5,
            modified: true,
            ior: 1.5,
            fresnel: false,
        },
        Model::RoughConductor {
            spectra: None,
            eta: [0.0; 3],
            k: [1.0; 3],
            reflectance: grey,
            facets,
        },
        Model::RoughDielectric {
            ior: 1.5,
            reflectance: grey,
            transmittance: grey,
            facets,
        },
        Model::Plastic {
            ior: 1.5,
            diffuse_reflectance: grey,
            reflectance: grey,
            nonlinear: true,
            facets: Some(facets),
        },
        Model::Blend {
            parts: [GLASS, PHONG],
            weight: grey,
        },
        Model::Blend {
            parts: [BLEND, METAL],
            weight: grey,
        },
    ]
    .map(|model| b.material(model));
    assert_eq!(made, [PHONG, METAL, GROUND, PLASTIC, BLEND, BLENDS]);
}

/// A scene in which no section is empty, and each kind of light but cube maps shines.
pub fn scene() -> Draft {
    let mut scene = room(|b| {
        let glass = Some(b.glass(1.5));
        glossy(b);
        // Enough triangles for a tree of three levels.
        b.cuboid([-0.5; 3], [0.5; 3], false, None);
        let quads = b.description.shapes.pop().unwrap();
        let etendue_host::description::Geometry::Mesh(mut many) = quads.geometry else {
            unreachable!()
        };
        let one = many.clone();
        for i in 1..60u8 {
            let shift = f32::from(i);
            let first = many.positions.len() as u32;
            let moved = one
                .positions
                .iter()
                .map(|p| [p[0] + 2.0 * shift, p[1], p[2]]);
            many.positions.extend(moved);
            let shifted = one.triangles.iter().map(|t| t.map(|v| v + first));
            many.triangles.extend(shifted);
        }
        many.normals = Some(vec![[0.0, 0.0, 1.0]; many.positions.len()]);
        many.uvs = Some(vec![[0.5, 0.5]; many.positions.len()]);
        b.shape(etendue_host::description::Geometry::Mesh(many), glass);
        b.sphere([0.45, 0.1, 0.35], 0.3, glass);
        b.sphere([-0.4, 0.1, 0.35], 0.3, None).emission = Some([1.0, 2.0, 3.0]);
        b.light(EmitterKind::Point {
            position: [0.0, 0.0, 1.0],
            intensity: [1.0; 3],
        });
        b.light(EmitterKind::Spot {
            position: [0.0, 0.0, 1.0],
            direction: [0.0, 0.0, -1.0],
            intensity: [1.0; 3],
            cutoff: 0.5,
            beam_width: 0.3,
        });
        b.light(EmitterKind::Directional {
            direction: [0.0, 0.0, -1.0],
            irradiance: [1.0; 3],
        });
        b.light(EmitterKind::LatLong {
            width: 4,
            height: 3,
            texels: vec![[1.0, 0.5, 0.25]; 12],
            scale: 1.0,
            to_local: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        });
    });
    let d = &mut scene.description;
    let image = |width, height, texels| Pattern::Bitmap {
        image: Image {
            width,
            height,
            texels,
        },
        nearest: false,
        wrap: Wrap::Repeat,
        alpha: false,
    };
    let checkers = Pattern::Checkerboard {
        colors: [[0.2; 3], [0.8; 3]],
    };
    let patterns = [
        checkers,
        image(4, 4, Texels::Srgb8(vec![[10, 20, 30, 255]; 16])),
        image(4, 4, Texels::Linear8(vec![[40, 50, 60, 255]; 16])),
        image(4, 3, Texels::Float(vec![[0.1, 0.2, 0.3]; 12])),
    ];
    for pattern in patterns {
        d.textures.push(Texture {
            name: String::new(),
            pattern,
            to_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        });
    }
    for (shape, texture) in d.shapes.iter_mut().zip(0..4) {
        shape.opacity = Some(ColorSource::Texture(texture));
    }
    Draft(glowing(&matter().put_into(&blob(d))))
}
