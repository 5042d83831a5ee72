//! Bytes as choices that build a scene.

use super::estimates;
use super::source::Source;
use arbitrary::{Arbitrary, Result, Unstructured};
use etendue::Scene;
use etendue_host::compile::compile;
use etendue_host::description::{
    Carry, ColorSource, Description, Distribution, Emitter, EmitterKind, Facets, Filter, Geometry,
    Grid, GridValues, Grids, Image, Index, Lobe, Masking, Material, Medium, Mesh, Model, Pattern,
    Phase, Place, Projection, Sensor, Shape, Spectrum, Texels, Texture, Tracking, Wrap,
};

/// What may be wrong with a scene whose numbers all are in their ranges.
const REASONS: [&str; 21] = [
    "a light needs an area",
    "a background already",
    // Media.
    "overlaps with",
    "it meets itself",
    "the space outside all objects",
    "doesn't absorb",
    "the size and filter",
    "asks for extinction of one channel",
    "sigma_t must be",
    "emission must be in",
    "albedo must be in",
    "the transform of its grids",
    "from a volume of at least",
    "that emits must lie within",
    "the weights of phase functions",
    "an index must be",
    "a spectrum must have",
    "an emitter's spectrum must",
    "the spectrum of",
    "spectra and grids",
    "emits what can't be seen",
];

/// **Property:** every description compiles to a blob that opens, or is refused with a reason; one whose numbers keep
/// to their documented ranges is refused only for a reason that no number alone has. What opens makes finite
/// light ≥ 0 in bounded steps, with the same bits on every instruction set.
pub fn scene(bytes: &[u8]) {
    let mut unstructured = Unstructured::new(bytes);
    let Ok(wildness) = u8::arbitrary(&mut unstructured) else {
        return;
    };
    let mut source = Source {
        bytes: unstructured,
        tame: wildness % 4 != 0,
    };
    let Ok(description) = description(&mut source) else {
        return;
    };
    match compile(&description) {
        Ok(compiled) => {
            let scene = Scene::open(compiled.blob.bytes()).expect("a blob that opens");
            estimates(&scene, u64::from(wildness));
        }
        Err(e) => {
            assert!(!e.name.is_empty() && !e.reason.is_empty());
            let known = REASONS.iter().any(|r| e.reason.contains(r));
            assert!(known || !source.tame, "{e}: {description:?}");
        }
    }
}

fn description(s: &mut Source<'_>) -> Result<Description> {
    let mut d = Description {
        sensor: sensor(s)?,
        ..Description::default()
    };
    for i in 0..s.below(3)? {
        let texture = texture(s, i)?;
        d.textures.push(texture);
    }
    for i in 0..=s.below(4)? {
        let name = format!("material {i}");
        let model = model(s, i, d.textures.len())?;
        d.materials.push(Material { name, model });
    }
    for i in 0..s.below(6)? {
        let shape = shape(s, i, &d)?;
        d.shapes.push(shape);
    }
    for i in 0..s.below(4)? {
        let name = format!("light {i}");
        let kind = light(s)?;
        d.emitters.push(Emitter {
            spectrum: None,
            name,
            place: Place::default(),
            kind,
            medium: None,
        });
    }
    media(s, &mut d)?;
    let all = [Carry::AsNeeded, Carry::Rgb, Carry::Wavelengths];
    d.carry = *s.bytes.choose(&all)?;
    Ok(d)
}

/// Media, and what stands in them.
fn media(s: &mut Source<'_>, d: &mut Description) -> Result<()> {
    let count = s.below(3)?;
    for i in 0..count {
        let medium = medium(s, i)?;
        d.media.push(medium);
    }
    if count == 0 {
        return Ok(());
    }
    let any = |s: &mut Source<'_>| {
        let m = s.below(2 * count)?;
        Ok((m < count).then_some(m))
    };
    for shape in &mut d.shapes {
        (shape.interior, shape.exterior) = (any(s)?, any(s)?);
    }
    d.sensor.medium = any(s)?;
    for e in &mut d.emitters {
        e.medium = any(s)?;
    }
    if s.below(4)? == 0 {
        d.exterior = any(s)?;
    }
    Ok(())
}

fn medium(s: &mut Source<'_>, i: usize) -> Result<Medium> {
    let phase = |s: &mut Source<'_>| {
        Ok(Lobe {
            phase: match s.below(4)? {
                0 => Phase::Isotropic,
                1 => Phase::HenyeyGreenstein {
                    g: s.number(-0.999, 0.999)?,
                },
                2 => Phase::Rayleigh,
                _ => Phase::Forward,
            },
            weight: s.number(0.0, 1.0)?,
        })
    };
    let phase = (0..=s.below(4)?).map(|_| phase(s)).collect::<Result<_>>()?;
    let coefficients = [s.numbers(0.0, 1e12)?, s.numbers(0.0, 1.0)?];
    let emission = if s.coin()? {
        s.numbers(0.0, 1e30)?
    } else {
        [0.0; 3]
    };
    let grids = if s.coin()? { Some(grids(s)?) } else { None };
    let mut spectra = [const { None }; 3];
    for (rows_of, most) in spectra.iter_mut().zip([1e12, 1.0, 1e30]) {
        if s.below(8)? == 0 {
            *rows_of = Some(rows(s, most)?);
        }
    }
    Ok(Medium {
        name: format!("medium {i}"),
        place: Place::default(),
        sigma_t: coefficients[0],
        albedo: coefficients[1],
        emission,
        phase,
        spectra,
        grids,
    })
}

fn grids(s: &mut Source<'_>) -> Result<Grids> {
    let grid = |s: &mut Source<'_>, most: f32| {
        let size = [1 + s.below(5)?, 1 + s.below(5)?, 1 + s.below(9)?];
        let count: usize = size.iter().product();
        Ok(Grid {
            size: size.map(|n| n as u32),
            values: if s.coin()? {
                GridValues::Gray(
                    (0..count)
                        .map(|_| s.number(0.0, most))
                        .collect::<Result<_>>()?,
                )
            } else {
                GridValues::Rgb(
                    (0..count)
                        .map(|_| s.numbers(0.0, most))
                        .collect::<Result<_>>()?,
                )
            },
            nearest: s.coin()?,
        })
    };
    let mut to_grid = [[0.0; 4]; 3];
    for (i, row) in to_grid.iter_mut().enumerate() {
        if s.coin()? {
            *row = s.numbers(-1e6, 1e6)?;
        } else {
            (row[i], row[3]) = (s.number(1e-6, 1e6)?, s.number(-1e6, 1e6)?);
        }
    }
    Ok(Grids {
        extinction: grid(s, 1e12)?,
        albedo: if s.coin()? { Some(grid(s, 1.0)?) } else { None },
        emission: if s.coin()? { Some(grid(s, 1.0)?) } else { None },
        to_grid,
        tracking: match s.below(3)? {
            0 => Tracking::Woodcock,
            1 => Tracking::Residual,
            _ => Tracking::Regular,
        },
    })
}

fn sensor(s: &mut Source<'_>) -> Result<Sensor> {
    let side = |s: &mut Source<'_>| Ok(1 + s.below(if s.tame { 64 } else { 70_000 })? as u32);
    let resolution = [side(s)?, side(s)?];
    let default = Sensor::default();
    let projection = match s.below(3)? {
        0 => Projection::Orthographic {
            half_extent: s.numbers(1e-3, 1e12)?,
        },
        1 => Projection::Perspective {
            half_tangent: s.numbers(1e-3, 1e3)?,
            aperture: if s.coin()? { 0.0 } else { s.number(0.0, 1e12)? },
            focus: s.number(1e-3, 1e12)?,
        },
        _ => Projection::Panorama,
    };
    let filter = match s.below(3)? {
        0 => Filter::Box {
            radius: s.number(1e-3, 8.0)?,
        },
        1 => Filter::Tent {
            radius: s.number(1e-3, 8.0)?,
        },
        _ => Filter::Gaussian {
            sigma: s.number(1e-3, 8.0)?,
            radius: s.number(1e-3, 8.0)?,
        },
    };
    let crop = if s.coin()? {
        None
    } else {
        let [w, h] = resolution.map(|n| n as usize);
        let corner = [s.below(w)?, s.below(h)?];
        let size = [1 + s.below(w - corner[0])?, 1 + s.below(h - corner[1])?];
        Some([corner[0], corner[1], size[0], size[1]].map(|n| n as u32))
    };
    let near = s.number(0.0, 1e6)?;
    let frame = glam::Quat::from_array(s.numbers(-1.0, 1.0)?);
    let turn = if frame.length() > 1e-3 && frame.is_finite() {
        frame.normalize()
    } else {
        glam::Quat::IDENTITY
    };
    let axis = |v: [f32; 3]| (turn * glam::Vec3::from(v)).to_array();
    Ok(Sensor {
        projection,
        origin: s.numbers(-1e12, 1e12)?,
        right: axis(default.right),
        down: axis(default.down),
        forward: axis(default.forward),
        clip: [near, if s.coin()? { 1e8 } else { s.number(2e6, 1e12)? }],
        principal: if s.coin()? {
            [0.0; 2]
        } else {
            s.numbers(-1e3, 1e3)?
        },
        resolution,
        crop,
        filter,
        medium: None,
    })
}

fn color(s: &mut Source<'_>, textures: usize) -> Result<ColorSource> {
    Ok(if textures > 0 && s.coin()? {
        ColorSource::Texture(s.below(textures)?)
    } else {
        ColorSource::Constant(s.numbers(0.0, 1.0)?)
    })
}

fn texture(s: &mut Source<'_>, i: usize) -> Result<Texture> {
    let pattern = if s.below(8)? == 0 {
        Pattern::Spectrum(rows(s, 1.0)?)
    } else if s.coin()? {
        Pattern::Checkerboard {
            colors: [s.numbers(0.0, 1.0)?, s.numbers(0.0, 1.0)?],
        }
    } else {
        let (width, height) = (1 + s.below(4)?, 1 + s.below(4)?);
        let count = width * height;
        let bytes = |s: &mut Source<'_>| {
            (0..count)
                .map(|_| <[u8; 4]>::arbitrary(&mut s.bytes))
                .collect::<Result<Vec<_>>>()
        };
        let texels = match s.below(3)? {
            0 => Texels::Srgb8(bytes(s)?),
            1 => Texels::Linear8(bytes(s)?),
            _ => Texels::Float(
                (0..count)
                    .map(|_| s.numbers(0.0, 1.0))
                    .collect::<Result<_>>()?,
            ),
        };
        Pattern::Bitmap {
            image: Image {
                width: width as u32,
                height: height as u32,
                texels,
            },
            nearest: s.coin()?,
            wrap: *s.bytes.choose(&[Wrap::Repeat, Wrap::Clamp, Wrap::Mirror])?,
            alpha: s.coin()?,
        }
    };
    Ok(Texture {
        name: format!("texture {i}"),
        pattern,
        to_uv: [
            s.numbers(-f32::MAX, f32::MAX)?,
            s.numbers(-f32::MAX, f32::MAX)?,
        ],
    })
}

fn facets(s: &mut Source<'_>) -> Result<Facets> {
    Ok(Facets {
        alpha: s.numbers(1e-4, 10.0)?,
        distribution: *s
            .bytes
            .choose(&[Distribution::Ggx, Distribution::Beckmann])?,
        masking: *s
            .bytes
            .choose(&[Masking::Correlated, Masking::Separable, Masking::Cavities])?,
        compensated: s.coin()?,
    })
}

/// Rows by rising wavelength, if the source is tame.
fn rows(s: &mut Source<'_>, most: f32) -> Result<Spectrum> {
    let mut nm = 0.0;
    let mut row = |s: &mut Source<'_>| {
        let step: f32 = s.number(1.0, 1e3)?;
        nm = if s.tame { nm + step } else { step };
        Ok([nm, s.number(0.0, most)?])
    };
    (0..=s.below(5)?).map(|_| row(s)).collect()
}

/// A conductor's.
fn spectra(s: &mut Source<'_>) -> Result<Option<[Spectrum; 2]>> {
    if s.below(8)? > 0 {
        return Ok(None);
    }
    Ok(Some([rows(s, 1e6)?, rows(s, 1e6)?]))
}

fn index(s: &mut Source<'_>) -> Result<Index> {
    Ok(match s.below(3)? {
        0 => Index::Cauchy(s.numbers(0.0, 1e3)?),
        1 => Index::Sellmeier {
            b: s.numbers(0.0, 1e3)?,
            c: s.numbers(0.0, 1e3)?,
        },
        _ => Index::Table(rows(s, 100.0)?),
    })
}

/// The model of material `own`; its parts come before it.
fn model(s: &mut Source<'_>, own: usize, textures: usize) -> Result<Model> {
    Ok(match s.below(12)? {
        0 => Model::Diffuse {
            reflectance: color(s, textures)?,
            transmittance: color(s, textures)?,
        },
        1 => Model::Mirror {
            reflectance: color(s, textures)?,
        },
        2 => Model::Conductor {
            spectra: spectra(s)?,
            eta: s.numbers(0.0, 1e6)?,
            k: s.numbers(0.0, 1e6)?,
            reflectance: color(s, textures)?,
        },
        3 => Model::Dielectric {
            ior: s.number(1e-3, 1e3)?,
            reflectance: color(s, textures)?,
            transmittance: color(s, textures)?,
            schlick: s.coin()?,
        },
        4 => Model::Null,
        11 => Model::Dispersive {
            index: index(s)?,
            outside: s.number(0.5, 2.0)?,
            reflectance: color(s, textures)?,
            transmittance: color(s, textures)?,
            schlick: s.coin()?,
        },
        6 => Model::Phong {
            diffuse_reflectance: color(s, textures)?,
            reflectance: color(s, textures)?,
            transmittance: color(s, textures)?,
            diffuse_transmittance: color(s, textures)?,
            exponent: s.number(0.0, 1e5)?,
            modified: s.coin()?,
            ior: s.number(1e-3, 1e3)?,
            fresnel: s.coin()?,
        },
        7 => Model::RoughConductor {
            spectra: spectra(s)?,
            eta: s.numbers(0.0, 1e6)?,
            k: s.numbers(0.0, 1e6)?,
            reflectance: color(s, textures)?,
            facets: facets(s)?,
        },
        8 => {
            let facets = Facets {
                masking: Masking::Separable,
                ..facets(s)?
            };
            let ior = s.number(1e-3, 1e3)?;
            Model::RoughDielectric {
                ior: if (ior - 1.0).abs() < 0.01 { 1.01 } else { ior },
                reflectance: color(s, textures)?,
                transmittance: color(s, textures)?,
                facets,
            }
        }
        9 => Model::Plastic {
            ior: s.number(1e-3, 1e3)?,
            diffuse_reflectance: color(s, textures)?,
            reflectance: color(s, textures)?,
            nonlinear: s.coin()?,
            facets: if s.coin()? { Some(facets(s)?) } else { None },
        },
        10 if own > 0 => Model::Blend {
            parts: [s.below(own)?, s.below(own)?],
            weight: color(s, textures)?,
        },
        _ => Model::Sheet {
            specular_reflectance: color(s, textures)?,
            specular_transmittance: color(s, textures)?,
            diffuse_reflectance: color(s, textures)?,
            diffuse_transmittance: color(s, textures)?,
        },
    })
}

fn shape(s: &mut Source<'_>, i: usize, d: &Description) -> Result<Shape> {
    let geometry = if s.coin()? {
        Geometry::Sphere {
            center: s.numbers(-1e12, 1e12)?,
            radius: s.number(f32::MIN_POSITIVE, 1e12)?,
            flipped: s.coin()?,
        }
    } else {
        let vertices = 3 + s.below(6)?;
        let mut mesh = Mesh::default();
        for _ in 0..vertices {
            mesh.positions.push(s.numbers(-1e12, 1e12)?);
        }
        if s.coin()? {
            let normals = (0..vertices).map(|_| s.direction());
            mesh.normals = Some(normals.collect::<Result<_>>()?);
        }
        if s.coin()? {
            let uvs = (0..vertices).map(|_| s.numbers(-f32::MAX, f32::MAX));
            mesh.uvs = Some(uvs.collect::<Result<_>>()?);
        }
        for _ in 0..=s.below(12)? {
            let mut corner = || Ok(s.below(vertices)? as u32);
            mesh.triangles.push([corner()?, corner()?, corner()?]);
        }
        Geometry::Mesh(mesh)
    };
    let material = |s: &mut Source<'_>| {
        let m = s.below(d.materials.len() + 1)?;
        Ok((m < d.materials.len()).then_some(m))
    };
    let maybe = |s: &mut Source<'_>| Ok(s.below(3)? == 0);
    Ok(Shape {
        name: format!("shape {i}"),
        place: Place::default(),
        geometry,
        front: material(s)?,
        back: material(s)?,
        emission: if maybe(s)? {
            Some(s.numbers(0.0, 1e30)?)
        } else {
            None
        },
        spectrum: if s.below(8)? == 0 {
            Some(rows(s, 1e30)?)
        } else {
            None
        },
        opacity: if maybe(s)? {
            Some(color(s, d.textures.len())?)
        } else {
            None
        },
        interior: None,
        exterior: None,
    })
}

fn light(s: &mut Source<'_>) -> Result<EmitterKind> {
    let bright = |s: &mut Source<'_>| s.numbers(0.0, 1e30);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Ok(match s.below(6)? {
        0 => EmitterKind::Point {
            position: s.numbers(-1e12, 1e12)?,
            intensity: bright(s)?,
        },
        1 => {
            let cutoff = s.number(1e-3, std::f32::consts::PI)?;
            EmitterKind::Spot {
                position: s.numbers(-1e12, 1e12)?,
                direction: s.direction()?,
                intensity: bright(s)?,
                cutoff,
                beam_width: cutoff * s.number(0.0, 1.0)?,
            }
        }
        2 => EmitterKind::Directional {
            direction: s.direction()?,
            irradiance: bright(s)?,
        },
        3 => EmitterKind::Constant {
            radiance: bright(s)?,
        },
        4 => {
            let (width, height) = (1 + s.below(4)? as u32, 2 + s.below(4)? as u32);
            let height = if s.tame { height } else { height - 1 };
            let texels = (0..width * height).map(|_| bright(s));
            EmitterKind::LatLong {
                width,
                height,
                texels: texels.collect::<Result<_>>()?,
                scale: s.number(0.0, 1e6)?,
                to_local: axes,
            }
        }
        _ => {
            let width = 1 + s.below(3)? as u32;
            let texels = (0..6 * width * width).map(|_| bright(s));
            EmitterKind::CubeMap {
                width,
                texels: texels.collect::<Result<_>>()?,
                scale: s.number(0.0, 1e6)?,
                to_local: axes,
            }
        }
    })
}
