//! Estimates, tiles, films.

use super::Program;
use super::hooks::{Recorder, hooks};
use super::memory::{Array, Room, Struct, pointer, seldom};
use super::scene::Handle;
use crate::fuzz::source::Source;
use arbitrary::{Arbitrary, Result};
use etendue::capi::estimate::*;
use etendue::capi::film::*;
use etendue::capi::hooks::EtdHooks;
use etendue::capi::pilot::*;
use etendue::capi::scene::EtdScene;
use etendue::capi::scratch::EtdScratch;
use etendue::capi::settings::*;
use etendue::capi::status::*;
use std::ptr::null_mut;

/// Largest image that films are made of here.
pub(super) const MOST_PIXELS: usize = 1024;

/// What is estimated.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Of {
    /// Pixels, by samples that may add to others.
    Pixels,
    /// What is a place, a ray, or a film.
    Others,
    /// Pixels, by chains.
    Chains,
}

/// What all estimating calls take.
pub(super) struct Common {
    pub scene: Handle<EtdScene>,
    pub settings: Struct<EtdSettings>,
    pub recorder: Box<Recorder>,
    pub hooks: Struct<EtdHooks>,
    pub scratch: Handle<EtdScratch>,
}

impl Common {
    pub fn good(&self) -> bool {
        self.scene.good && self.settings.good && self.hooks.good && self.scratch.good
    }

    /// Whether samples add to other pixels.
    fn splats(&self) -> bool {
        [ETD_LIGHT, ETD_BIDIRECTIONAL].contains(&self.settings.get().estimator)
    }
}

/// Settings that may ask for what there isn't.
pub(super) fn settings(s: &mut Source<'_>, of: Of) -> Result<Struct<EtdSettings>> {
    let mut value = super::memory::zeros::<EtdSettings>();
    // SAFETY: memory for one.
    unsafe {
        assert_eq!(etd_settings_default(&raw mut value), ETD_OK);
        assert_eq!(etd_settings_default(null_mut()), ETD_E_NULL);
    }
    let wild = seldom(s)?;
    let number = |s: &mut Source<'_>, below: usize| -> Result<u32> {
        if wild {
            u32::arbitrary(&mut s.bytes)
        } else {
            Ok(s.below(below)? as u32)
        }
    };
    const ALWAYS: [u32; 5] = [
        ETD_PATH,
        ETD_LIGHT,
        ETD_BIDIRECTIONAL,
        ETD_DISTRIBUTED,
        ETD_QUADRATURE_AND_PATH,
    ];
    let which = number(s, ALWAYS.len())?;
    value.estimator = match ALWAYS.get(which as usize) {
        Some(&known) => known,
        // It depends on the scene whether that one answers.
        None if [ETD_QUADRATURE, ETD_METROPOLIS].contains(&which) => u32::MAX,
        None => which,
    };
    value.heuristic = number(s, 4)?;
    value.max_edges = match number(s, 10)? {
        n if wild => n as i32,
        n => n as i32 - 1,
    };
    value.seed = u64::from(u16::arbitrary(&mut s.bytes)?);
    // Of its bits, so that older inputs mean the same.
    value.sequence = (value.seed >> 15) as u32;
    if value.estimator >= ETD_DISTRIBUTED {
        value.branching = [s.below(4)? as u8, s.below(3)? as u8, 1, 0, 0, 0, 0, 0];
        value.light_samples = number(s, 3)?.max(1);
        value.quadrature = number(s, 8)?.max(1);
        value.steps = number(s, 20)?.max(1);
        value.shift = number(s, 2)?;
    }
    let sound = (1..=255).contains(&value.light_samples)
        && (1..=8).contains(&value.quadrature)
        && (1..=65535).contains(&value.steps)
        && value.heuristic <= ETD_MAXIMUM
        && value.max_edges >= -1;
    let sound = if of == Of::Chains {
        value.estimator = if seldom(s)? { ETD_PATH } else { ETD_METROPOLIS };
        sound && value.estimator == ETD_METROPOLIS && super::chain::mutations(s, &mut value)?
    } else {
        sound && ALWAYS.contains(&value.estimator)
    };
    // Paths of no limit are for scenes that are known to end them.
    if value.max_edges > 9 {
        value.max_edges = 9;
    }
    let mut out = Struct::new(s, value)?;
    out.good &= sound;
    Ok(out)
}

fn sums(room: &mut Room) -> *mut EtdSum {
    room.start().cast()
}

impl Program<'_> {
    pub fn common(&mut self, of: Of) -> Result<Common> {
        let scene = self.scene()?;
        let scratch = self.scratch()?;
        let settings = settings(&mut self.s, of)?;
        let mut recorder = Recorder::new(&mut self.s, scene.size)?;
        let splats =
            of == Of::Pixels && [ETD_LIGHT, ETD_BIDIRECTIONAL].contains(&settings.get().estimator);
        let hooks = hooks(&mut self.s, &mut recorder, splats)?;
        Ok(Common {
            scene,
            settings,
            recorder,
            hooks,
            scratch,
        })
    }

    pub fn pixel(&mut self) -> Result<()> {
        let c = self.common(Of::Pixels)?;
        let s = &mut self.s;
        let [w, h] = c.scene.size;
        let outside = u32::from(seldom(s)?);
        let x = s.below(w as usize)? as u32 + outside * w;
        let y = s.below(h as usize)? as u32;
        let sample = u64::arbitrary(&mut s.bytes)?;
        let mut rgb = Room::new(12);
        let (out, good_out) = pointer(s, rgb.start().cast())?;
        let good = c.good() && outside == 0 && good_out;
        // SAFETY: handles of this program, structs of the stated size, hooks that keep to their contract, room for three numbers.
        let status = self.call("pixel", good, || unsafe {
            etd_estimate_pixel(
                c.scene.at,
                c.settings.at,
                c.hooks.at,
                c.scratch.at,
                x,
                y,
                sample,
                out,
            )
        });
        self.light_in(&rgb, 3, status);
        self.told(&c.recorder);
        Ok(())
    }

    /// What an estimator is worth.
    pub fn pilot(&mut self) -> Result<()> {
        let c = self.common(Of::Others)?;
        let s = &mut self.s;
        let sum = EtdPilot {
            struct_size: 0,
            bright: u32::arbitrary(&mut s.bytes)?,
            squared_error: f64::arbitrary(&mut s.bytes)?,
            samples: u64::arbitrary(&mut s.bytes)?,
            rays: u64::arbitrary(&mut s.bytes)?,
        };
        let sum = Struct::new(s, sum)?;
        let first = u64::arbitrary(&mut s.bytes)?;
        let count = s.below(5)? as u32;
        // SAFETY: handles of this program, structs of the stated size, hooks that keep to their contract.
        let status = self.call("pilot", c.good() && sum.good, || unsafe {
            etd_pilot(
                c.scene.at,
                c.settings.at,
                c.hooks.at,
                c.scratch.at,
                first,
                count,
                sum.at,
            )
        });
        let p = sum.get();
        if status == ETD_OK {
            assert!(p.bright <= 1);
        }
        self.wrote(bytemuck::cast_slice(&[
            p.squared_error.to_bits(),
            p.samples,
            p.rays,
        ]));
        self.told(&c.recorder);
        Ok(())
    }

    /// Rays, or points on surfaces.
    pub fn probe(&mut self, rays: bool) -> Result<()> {
        let c = self.common(Of::Others)?;
        let s = &mut self.s;
        let count = s.below(5)?;
        let numbers = |s: &mut Source<'_>, limit: f32| -> Result<Vec<f32>> {
            (0..3 * count).map(|_| s.number(-limit, limit)).collect()
        };
        let places = numbers(s, 1e12)?;
        let places = Array::new(s, places)?;
        let directions = numbers(s, 2.0)?;
        let directions = Array::new(s, directions)?;
        let samples = EtdSamples {
            struct_size: 0,
            samples: s.below(3)? as u32,
            first_sample: u64::arbitrary(&mut s.bytes)?,
            first_id: u64::arbitrary(&mut s.bytes)?,
        };
        let none = samples.samples == 0;
        let samples = Struct::new(s, samples)?;
        let huge = seldom(s)?;
        let stated = if huge { usize::MAX / 4 } else { count };
        let mut rgb = Room::new(12 * count);
        let (out, good_out) = pointer::<f32>(s, rgb.start().cast())?;
        let good_out = good_out || (out.is_null() && count == 0);
        let good = c.good()
            && places.good
            && directions.good
            && samples.good
            && !none
            && !huge
            && good_out;
        let estimate = if rays {
            etd_estimate_rays
        } else {
            etd_estimate_irradiance
        };
        // SAFETY: as above, and arrays of the stated length.
        let status = self.call("probe", good, || unsafe {
            estimate(
                c.scene.at,
                c.settings.at,
                c.hooks.at,
                c.scratch.at,
                places.at,
                directions.at,
                stated,
                samples.at,
                out,
            )
        });
        self.light_in(&rgb, places.len(), status);
        self.told(&c.recorder);
        Ok(())
    }

    /// A rectangle, mostly within the image.
    fn rectangle(&mut self, [w, h]: [u32; 2]) -> Result<(Struct<EtdTile>, bool)> {
        let s = &mut self.s;
        let most = |n: u32| (n as usize).clamp(1, 4);
        let mut tile = EtdTile {
            struct_size: 0,
            x: s.below(w as usize)? as u32,
            y: s.below(h as usize)? as u32,
            width: s.below(most(w) + 1)? as u32,
            height: s.below(most(h) + 1)? as u32,
            samples: s.below(3)? as u32,
            first_sample: u64::arbitrary(&mut s.bytes)?,
        };
        if seldom(s)? {
            tile.x = u32::arbitrary(&mut s.bytes)?;
        }
        let within = |first: u32, count: u32, size: u32| {
            count >= 1 && u64::from(first) + u64::from(count) <= u64::from(size)
        };
        let sound = within(tile.x, tile.width, w) && within(tile.y, tile.height, h);
        let good = sound && tile.samples > 0;
        Ok((Struct::new(s, tile)?, good))
    }

    pub fn tile(&mut self) -> Result<()> {
        let c = self.common(Of::Pixels)?;
        let (tile, inside) = self.rectangle(c.scene.size)?;
        let s = &mut self.s;
        let t = tile.get();
        let right = 3 * t.width as usize * t.height as usize;
        let floats = if seldom(s)? { s.below(64)? } else { right };
        let mut rgb = Room::new(4 * floats);
        let (out, good_out) = pointer(s, rgb.start().cast())?;
        let good = c.good() && tile.good && inside && floats == right && good_out;
        // SAFETY: as above, and room for the stated number of floats.
        let status = self.call("tile", good, || unsafe {
            etd_render_tile(
                c.scene.at,
                c.settings.at,
                c.hooks.at,
                c.scratch.at,
                tile.at,
                out,
                floats,
            )
        });
        self.light_in(&rgb, floats, status);
        self.told(&c.recorder);
        Ok(())
    }

    /// A tile into a film, merged with itself, resolved.
    pub fn film(&mut self) -> Result<()> {
        let mut c = self.common(Of::Others)?;
        let (tile, inside) = self.rectangle(c.scene.size)?;
        let s = &mut self.s;
        let [w, h] = c.scene.size.map(|n| n as usize);
        let right = w * h;
        let pixels = if seldom(s)? || right > MOST_PIXELS {
            s.below(64)?
        } else {
            right
        };
        let bytes = pixels * size_of::<EtdSum>();
        let mut films = [Room::new(bytes), Room::new(bytes), Room::new(bytes)];
        for room in &mut films {
            // SAFETY: its own memory. A film begins with zeros.
            unsafe { room.start().write_bytes(0, bytes) };
        }
        let [own, others, _] = &mut films;
        let (samples, good_samples) = pointer(s, sums(own))?;
        let absent = u8::arbitrary(&mut s.bytes)? % 4 == 0;
        let (splats, good_splats) = if absent {
            (null_mut(), !c.splats())
        } else if seldom(s)? {
            (samples, false)
        } else {
            let (splats, good) = pointer(s, sums(others))?;
            (splats, good || (splats.is_null() && !c.splats()))
        };
        let good =
            c.good() && tile.good && inside && pixels == right && good_samples && good_splats;
        // SAFETY: as above, and room for the stated number of pixels.
        let status = self.call("film", good, || unsafe {
            etd_render_film(
                c.scene.at,
                c.settings.at,
                c.hooks.at,
                c.scratch.at,
                tile.at,
                samples,
                splats,
                pixels,
            )
        });
        let [own, others, merged_room] = &films;
        own.check();
        others.check();
        if ![ETD_OK, ETD_E_CANCELLED].contains(&status) {
            let empty = |room: &Room| room.bytes().iter().all(|&b| b == 0);
            assert!(empty(own) && empty(others) && empty(merged_room), "written");
        }
        let all = [own.bytes(), others.bytes()].concat();
        self.wrote(&all);
        // Splats go to the film, not to the hook.
        c.recorder.heard = 0;
        self.told(&c.recorder);
        self.merge_and_resolve(&c.scene, films, pixels, right)
    }

    fn merge_and_resolve(
        &mut self,
        scene: &Handle<EtdScene>,
        films: [Room; 3],
        pixels: usize,
        right: usize,
    ) -> Result<()> {
        let [mut own, mut others, mut merged] = films;
        let s = &mut self.s;
        let (to, good_to) = pointer(s, sums(&mut merged))?;
        let (from, good_from) = pointer(s, sums(&mut own))?;
        let huge = seldom(s)?;
        let stated = if huge { usize::MAX / 3 } else { pixels };
        let empty = |p: *mut EtdSum| p.is_null() && stated == 0;
        let good = (good_to || empty(to)) && (good_from || empty(from)) && !huge;
        // SAFETY: rooms of the stated number of pixels, which don't overlap.
        let status = self.call("merge", good, || unsafe {
            etd_film_merge(to, from, stated)
        });
        merged.check();
        if status == ETD_OK && pixels > 0 {
            assert!(merged.bytes() == own.bytes(), "nothing and a film");
        }
        let s = &mut self.s;
        let (samples, good_samples) = pointer(s, sums(&mut merged))?;
        let (splats, good_splats) = pointer(s, sums(&mut others))?;
        let per_pixel = u64::from(u8::arbitrary(&mut s.bytes)? % 16);
        let mut rgb = Room::new(12 * pixels);
        let (out, good_out) = pointer(s, rgb.start().cast())?;
        let good = scene.good
            && pixels == right
            && good_samples
            && (good_splats || splats.is_null())
            && good_out
            && per_pixel > 0;
        // SAFETY: a handle of this program, rooms of the stated number of pixels.
        let status = self.call("resolve", good, || unsafe {
            etd_film_resolve(scene.at, samples, splats, pixels, per_pixel, out)
        });
        self.light_in(&rgb, 3 * pixels, status);
        Ok(())
    }
}
