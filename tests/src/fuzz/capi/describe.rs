//! Scenes described piece by piece.

use super::Program;
use super::memory::{Array, Struct, seldom, zeros};
use crate::fuzz::source::Source;
use arbitrary::{Arbitrary, Result};
use etendue::capi::status::*;
use etendue_host_capi::builder::*;
use etendue_host_capi::camera::*;
use etendue_host_capi::light::*;
use etendue_host_capi::medium::*;
use etendue_host_capi::object::*;
use etendue_host_capi::surface::*;
use std::ptr::null_mut;

/// Objects of one scene: what a refit of them costs grows with each.
const MOST_OBJECTS: u32 = 12;

/// A struct as its function fills it in.
fn made<T>(default: unsafe extern "C" fn(*mut T) -> EtdStatus) -> T {
    let mut value = zeros::<T>();
    // SAFETY: memory for one, and null.
    unsafe {
        assert_eq!(default(&raw mut value), ETD_OK);
        assert_eq!(default(null_mut()), ETD_E_NULL);
    }
    value
}

/// The id of one of `count` things; now and then of none, or of what isn't there.
fn id(s: &mut Source<'_>, count: u32) -> Result<u32> {
    Ok(match u8::arbitrary(&mut s.bytes)? {
        0..=31 => ETD_NONE,
        32..=39 => u32::arbitrary(&mut s.bytes)?,
        _ if count == 0 => ETD_NONE,
        x => u32::from(x) % count,
    })
}

impl Program<'_> {
    pub fn camera(&mut self) -> Result<()> {
        let (builder, good_builder) = self.builder()?;
        let s = &mut self.s;
        let mut c = made(etd_camera_default);
        let side = |s: &mut Source<'_>| {
            Ok(if s.tame {
                1 + s.below(12)? as u32
            } else {
                70_000
            })
        };
        (c.width, c.height) = (side(s)?, side(s)?);
        (c.projection, c.filter) = (s.below(3)? as u32, s.below(3)? as u32);
        c.origin = s.numbers(-1e12, 1e12)?;
        c.direction = s.numbers(-1.0, 1.0)?;
        c.field = s.number(1e-6, 3.0)?;
        c.filter_radius = s.number(1e-3, 8.0)?;
        c.filter_sigma = s.number(1e-3, 8.0)?;
        if bool::arbitrary(&mut s.bytes)? {
            c.aperture = s.number(0.0, 1e12)?;
            c.focus = s.number(1e-9, 1e12)?;
            c.clip = [s.number(0.0, 1e6)?, s.number(2e6, 1e12)?];
            c.principal = s.numbers(-1e3, 1e3)?;
            c.up = s.numbers(-1.0, 1.0)?;
            for x in &mut c.crop {
                *x = s.below(6)? as u32;
            }
        }
        let c = Struct::new(s, c)?;
        // SAFETY: a builder of this program, a struct of the stated size.
        let status = self.call("camera", good_builder && c.good, || unsafe {
            etd_builder_set_camera(builder, c.at)
        });
        self.message(status)
    }

    pub fn material(&mut self) -> Result<()> {
        let count = self.builder.textures;
        let s = &mut self.s;
        let mut m = made(etd_material_default);
        m.kind = s.below(7)? as u32;
        m.flags = s.below(2)? as u32;
        m.ior = s.number(1e-3, 1e3)?;
        for role in 0..4 {
            m.color[role] = s.numbers(0.0, 1.0)?;
            m.texture[role] = id(s, count)?;
        }
        m.eta = s.numbers(1e-6, 1e6)?;
        m.k = s.numbers(0.0, 1e6)?;
        let m = Struct::new(s, m)?;
        let materials = self.builder.materials;
        if materials > 0 && bool::arbitrary(&mut self.s.bytes)? {
            let (builder, good) = self.builder()?;
            let which = id(&mut self.s, self.builder.materials)?;
            // SAFETY: as above.
            let status = self.call("set_material", good && m.good, || unsafe {
                etd_builder_set_material(builder, which, m.at)
            });
            return self.message(status);
        }
        // SAFETY: as above.
        let add = |b, to| unsafe { etd_builder_add_material(b, m.at, to) };
        self.builder.materials = self.adds("material", m.good, materials, add)?;
        Ok(())
    }

    pub fn texture(&mut self) -> Result<()> {
        let s = &mut self.s;
        let mut t = made(etd_texture_default);
        t.kind = s.below(5)? as u32;
        t.flags = s.below(16)? as u32;
        let sides = [1 + s.below(4)?, 1 + s.below(4)?];
        [t.width, t.height] = sides.map(|n| n as u32);
        t.color = [s.numbers(0.0, 1.0)?, s.numbers(0.0, 1.0)?];
        t.to_uv = [s.numbers(-1e6, 1e6)?, s.numbers(-1e6, 1e6)?];
        let count = sides[0] * sides[1] * if t.kind == ETD_FLOAT { 3 } else { 1 };
        let texels = (0..count).map(|_| s.number(0.0, 1.0));
        let mut texels = texels.collect::<Result<Vec<f32>>>()?;
        t.bytes = 4 * count;
        // One number more, for who reads from one byte further on.
        texels.push(0.0);
        let texels = Array::new(s, texels)?;
        t.texels = texels.at.cast();
        if seldom(s)? {
            t.bytes = s.below(t.bytes + 1)?;
        }
        let t = Struct::new(s, t)?;
        let textures = self.builder.textures;
        // SAFETY: as above, and texels of the stated size.
        let add = |b, to| unsafe { etd_builder_add_texture(b, t.at, to) };
        self.builder.textures = self.adds("texture", t.good, textures, add)?;
        Ok(())
    }

    pub fn mesh(&mut self) -> Result<()> {
        let (objects, materials) = (self.builder.objects, self.builder.materials);
        if objects >= MOST_OBJECTS {
            return Ok(());
        }
        let textures = self.builder.textures;
        let s = &mut self.s;
        let mut m = made(etd_mesh_default);
        let (vertices, triangles) = (s.below(7)?, s.below(9)?);
        (m.vertices, m.triangles) = (vertices as u32, triangles as u32);
        let numbers = |s: &mut Source<'_>, n: usize, limit: f32| -> Result<Array<f32>> {
            let values = (0..n).map(|_| s.number(-limit, limit));
            let values = values.collect::<Result<Vec<f32>>>()?;
            Array::new(s, values)
        };
        let positions = numbers(s, 3 * vertices, 1e12)?;
        m.positions = positions.at;
        let has = u8::arbitrary(&mut s.bytes)?;
        let normals = numbers(s, if has & 1 != 0 { 3 * vertices } else { 0 }, 1.0)?;
        let uvs = numbers(s, if has & 2 != 0 { 2 * vertices } else { 0 }, 1e6)?;
        if has & 1 != 0 {
            m.normals = normals.at;
        }
        if has & 2 != 0 {
            m.uvs = uvs.at;
        }
        let indices = (0..3 * triangles).map(|_| Ok(s.below(vertices + 1)? as u32));
        let mut indices = indices.collect::<Result<Vec<u32>>>()?;
        if has & 0xf0 != 0 {
            // Mostly such as there are.
            indices
                .iter_mut()
                .for_each(|i| *i %= vertices.max(1) as u32);
        }
        let indices = Array::new(s, indices)?;
        m.indices = indices.at;
        (m.front, m.back) = (id(s, materials)?, id(s, materials)?);
        m.opacity = id(s, textures)?;
        if has & 4 != 0 {
            m.emission = s.numbers(0.0, 1e30)?;
        }
        // What may be left out may be null.
        let optional = |a: &Array<f32>, bit: u8| has & bit == 0 || a.good || a.at.is_null();
        let arrays = positions.good && indices.good && optional(&normals, 1) && optional(&uvs, 2);
        let m = Struct::new(s, m)?;
        let good = m.good && arrays && vertices > 0 && triangles > 0;
        // SAFETY: as above, and arrays of the stated lengths.
        let add = |b, to| unsafe { etd_builder_add_mesh(b, m.at, to) };
        self.builder.objects = self.adds("mesh", good, objects, add)?;
        Ok(())
    }

    pub fn sphere(&mut self) -> Result<()> {
        let (objects, materials) = (self.builder.objects, self.builder.materials);
        if objects >= MOST_OBJECTS {
            return Ok(());
        }
        let textures = self.builder.textures;
        let s = &mut self.s;
        let mut o = made(etd_sphere_default);
        o.center = s.numbers(-1e12, 1e12)?;
        o.radius = s.number(f32::MIN_POSITIVE, 1e12)?;
        (o.front, o.back) = (id(s, materials)?, id(s, materials)?);
        o.opacity = id(s, textures)?;
        o.flipped = s.below(3)? as u32;
        if bool::arbitrary(&mut s.bytes)? {
            o.emission = s.numbers(0.0, 1e30)?;
        }
        let o = Struct::new(s, o)?;
        // SAFETY: as above.
        let add = |b, to| unsafe { etd_builder_add_sphere(b, o.at, to) };
        self.builder.objects = self.adds("sphere", o.good, objects, add)?;
        Ok(())
    }

    pub fn light(&mut self) -> Result<()> {
        let s = &mut self.s;
        let mut l = made(etd_light_default);
        l.kind = s.below(7)? as u32;
        l.color = s.numbers(0.0, 1e30)?;
        l.position = s.numbers(-1e12, 1e12)?;
        l.direction = s.numbers(-1.0, 1.0)?;
        l.cutoff = s.number(1.1e-3, 3.1)?;
        l.beam_width = s.number(0.0, l.cutoff)?;
        l.scale = s.number(0.0, 1e30)?;
        let width = 1 + s.below(3)?;
        let height = match l.kind {
            ETD_LIGHT_CUBEMAP => 6 * width,
            _ => 1 + s.below(4)?,
        };
        (l.width, l.height) = (width as u32, height as u32);
        let image = [ETD_LIGHT_LATLONG, ETD_LIGHT_CUBEMAP].contains(&l.kind);
        let floats = if image { 3 * width * height } else { 0 };
        let texels = (0..floats).map(|_| s.number(0.0, 1e30));
        let texels = texels.collect::<Result<Vec<f32>>>()?;
        let texels = Array::new(s, texels)?;
        (l.texels, l.floats) = (texels.at, floats);
        let l = Struct::new(s, l)?;
        let good = l.good && (texels.good || !image);
        let lights = self.builder.lights;
        if lights > 0 && bool::arbitrary(&mut self.s.bytes)? {
            let (builder, good_builder) = self.builder()?;
            let which = id(&mut self.s, self.builder.lights)?;
            // SAFETY: as above.
            let status = self.call("set_light", good && good_builder, || unsafe {
                etd_builder_set_light(builder, which, l.at)
            });
            return self.message(status);
        }
        // SAFETY: as above, and texels of the stated number.
        let add = |b, to| unsafe { etd_builder_add_light(b, l.at, to) };
        self.builder.lights = self.adds("light", good, lights, add)?;
        Ok(())
    }

    /// Adds a medium, or says where one is.
    fn medium(&mut self) -> Result<()> {
        let (builder, good) = self.builder()?;
        let (media, objects) = (self.builder.media, self.builder.objects);
        let s = &mut self.s;
        if media > 0 && bool::arbitrary(&mut s.bytes)? {
            let [interior, exterior] = [id(s, media)?, id(s, media)?];
            let object = id(s, objects)?;
            let all = u8::arbitrary(&mut s.bytes)? < 32;
            // SAFETY: a builder of this program.
            let status = self.call("media", good, || unsafe {
                if all {
                    etd_builder_set_exterior(builder, exterior)
                } else {
                    etd_builder_set_media(builder, object, interior, exterior)
                }
            });
            return self.message(status);
        }
        let mut m = made(etd_medium_default);
        m.sigma_t = s.numbers(0.0, 1e12)?;
        m.albedo = s.numbers(0.0, 1.0)?;
        if bool::arbitrary(&mut s.bytes)? {
            m.emission = s.numbers(0.0, 1e30)?;
        }
        for lobe in &mut m.phase {
            lobe.kind = s.below(5)? as u32;
            lobe.g = s.number(-0.999, 0.999)?;
            lobe.weight = s.number(0.0, 1.0)?;
        }
        m.tracking = s.below(4)? as u32;
        for row in &mut m.to_grid {
            *row = s.numbers(-1e6, 1e6)?;
        }
        let mut arrays = Vec::new();
        for grid in [&mut m.extinction, &mut m.albedos, &mut m.emissions] {
            if s.below(3)? > 0 {
                continue;
            }
            let sides = [1 + s.below(3)?, 1 + s.below(3)?, 1 + s.below(3)?];
            grid.size = sides.map(|n| n as u32);
            grid.channels = s.below(4)? as u32;
            grid.nearest = s.below(3)? as u32;
            grid.floats = sides.iter().product::<usize>() * grid.channels as usize;
            let values = (0..grid.floats).map(|_| s.number(0.0, 1.0));
            let values = values.collect::<Result<Vec<f32>>>()?;
            let values = Array::new(s, values)?;
            grid.values = values.at;
            // No number and no place for one is no grid.
            let absent = values.at.is_null() && grid.floats == 0;
            arrays.push((values, absent));
        }
        let m = Struct::new(s, m)?;
        let good = m.good && arrays.iter().all(|(a, absent)| a.good || *absent);
        // SAFETY: as above, and arrays of the stated lengths.
        let add = |b, to| unsafe { etd_builder_add_medium(b, m.at, to) };
        self.builder.media = self.adds("medium", good, media, add)?;
        Ok(())
    }

    pub fn transform(&mut self) -> Result<()> {
        let (builder, good) = self.builder()?;
        let s = &mut self.s;
        let mut matrix = vec![1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.];
        for _ in 0..s.below(8)? {
            let i = s.below(12)?;
            matrix[i] = s.number(-1e12, 1e12)?;
        }
        let matrix = Array::new(s, matrix)?;
        let object = id(s, self.builder.objects)?;
        let reserved = u8::arbitrary(&mut s.bytes)?;
        if (8..16).contains(&reserved) {
            return self.medium();
        }
        let mut new = 0;
        // SAFETY: as above, and twelve numbers.
        let status = self.call(
            "transform",
            good && matrix.good && reserved >= 8,
            || unsafe {
                match reserved {
                    0..=7 => etd_builder_add_instance(builder, object, matrix.at, &raw mut new),
                    _ => etd_builder_set_transform(builder, object, matrix.at),
                }
            },
        );
        self.message(status)
    }
}
