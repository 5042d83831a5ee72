//! Lights: their records, the alias table by power among emitting primitives, and the importance of
//! environments. Power decides how often a light is chosen; its density goes into every weight.

use super::alias;
use super::media::Glowing;
use crate::description::{Color, EmitterKind};
use crate::spectra::append;
use bytemuck::Zeroable;
use etendue::blob::format::{Cell, Choice, Emitter, NONE, emitter};
use std::f64::consts::PI;

/// A primitive that emits: (emitter, primitive, area).
pub(super) struct Emitting {
    pub emitter: u32,
    pub primitive: u32,
    pub area: f64,
}

#[derive(Default)]
pub(super) struct Emitters {
    pub emitters: Vec<Emitter>,
    pub choices: Vec<Choice>,
    pub cells: Vec<Cell>,
    pub background: Option<u32>,
    /// The largest radiance, or what radiance corresponds to: for the film's step.
    pub scale: f64,
    /// Mean radiance over directions per emitter at infinity.
    power: Vec<f64>,
    /// Volumes from which emitters are drawn; 1 where they aren't.
    volume: Vec<f64>,
}

fn mean(c: Color) -> f64 {
    c.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0
}

impl Emitters {
    /// Adds the light of a shape and returns its id.
    pub fn area(&mut self, shape: u32, radiance: Color, spectrum: [u32; 2]) -> u32 {
        self.scale = self.scale.max(mean(radiance));
        let e = Emitter {
            kind: emitter::AREA,
            shape,
            radiance,
            spectrum,
            ..blank()
        };
        self.push(e, PI * mean(radiance), 1.0)
    }

    /// Adds a medium that emits.
    pub fn volume(&mut self, glowing: &Glowing) -> u32 {
        self.scale = self.scale.max(glowing.radiance);
        let e = Emitter {
            kind: emitter::VOLUME,
            shape: NONE,
            medium: glowing.medium,
            position: glowing.corner,
            to_local: glowing.edges,
            ..blank()
        };
        let power = 4.0 * PI * glowing.mean * glowing.volume;
        self.push(e, power, glowing.volume)
    }

    fn push(&mut self, e: Emitter, power: f64, volume: f64) -> u32 {
        self.emitters.push(e);
        self.power.push(power);
        self.volume.push(volume);
        self.emitters.len() as u32 - 1
    }

    /// Adds a light that isn't a shape and stands in `medium`. `radius` is that of the scene's bounding sphere.
    ///
    /// # Errors
    /// In words, if there is a background already.
    pub fn add(
        &mut self,
        kind: &EmitterKind,
        medium: Option<usize>,
        spectrum: Option<&[[f32; 2]]>,
        radius: f64,
        texels: &mut Vec<u32>,
    ) -> Result<(), String> {
        let disc = PI * radius * radius;
        let id = self.emitters.len() as u32;
        let mut e = Emitter {
            shape: NONE,
            medium: medium.map_or(NONE, |m| m as u32),
            spectrum: spectrum.map_or([0; 2], |rows| append(texels, rows)),
            ..blank()
        };
        let mut background = false;
        let (power, scale) = match kind {
            EmitterKind::Point {
                position,
                intensity,
            } => {
                (e.kind, e.position, e.radiance) = (emitter::POINT, *position, *intensity);
                (
                    4.0 * PI * mean(*intensity),
                    mean(*intensity) / (radius * radius),
                )
            }
            EmitterKind::Spot {
                position,
                direction,
                intensity,
                cutoff,
                beam_width,
            } => {
                (e.kind, e.position, e.direction, e.radiance) =
                    (emitter::SPOT, *position, *direction, *intensity);
                e.cos_outer = cutoff.cos();
                // A beam as wide as the cone still needs two different cosines.
                e.cos_inner = beam_width.min(*cutoff).cos().max(e.cos_outer.next_up());
                let solid_angle = 2.0 * PI * (1.0 - f64::from((0.5 * (cutoff + beam_width)).cos()));
                (
                    solid_angle * mean(*intensity),
                    mean(*intensity) / (radius * radius),
                )
            }
            EmitterKind::Directional {
                direction,
                irradiance,
            } => {
                (e.kind, e.direction, e.radiance) = (emitter::DIRECTIONAL, *direction, *irradiance);
                (disc * mean(*irradiance), mean(*irradiance))
            }
            EmitterKind::Constant { radiance } => {
                background = true;
                (e.kind, e.radiance) = (emitter::CONSTANT, *radiance);
                (disc * 4.0 * PI * mean(*radiance), mean(*radiance))
            }
            EmitterKind::LatLong {
                width,
                height,
                texels: image,
                scale,
                to_local,
            } => {
                background = true;
                e.kind = emitter::LATLONG;
                (e.width, e.height, e.to_local) = (*width, *height, *to_local);
                let weights = lat_long_weights(*width, *height, image);
                let total = self.environment(&mut e, &weights, image, *scale, texels);
                (disc * total, total / (4.0 * PI))
            }
            EmitterKind::CubeMap {
                width,
                texels: image,
                scale,
                to_local,
            } => {
                background = true;
                e.kind = emitter::CUBEMAP;
                (e.width, e.height, e.to_local) = (*width, 6 * *width, *to_local);
                let weights = cube_weights(*width, image);
                let total = self.environment(&mut e, &weights, image, *scale, texels);
                (disc * total, total / (4.0 * PI))
            }
        };
        if background {
            if self.background.is_some() {
                return Err(
                    "the scene has a background already: one constant, envmap or cubemap".into(),
                );
            }
            self.background = Some(id);
        }
        self.scale = self.scale.max(scale);
        self.push(e, power, 1.0);
        Ok(())
    }

    /// Texels and cells of an environment; returns ∫L dω in the mean channel.
    fn environment(
        &mut self,
        e: &mut Emitter,
        weights: &[f64],
        image: &[Color],
        scale: f32,
        texels: &mut Vec<u32>,
    ) -> f64 {
        e.radiance = [scale; 3];
        e.texels = texels.len() as u32;
        e.cells = self.cells.len() as u32;
        texels.extend(image.as_flattened().iter().map(|x| x.to_bits()));
        let total: f64 = weights.iter().sum();
        if total > 0.0 {
            let cells = alias::table(weights).into_iter().zip(weights);
            self.cells.extend(cells.map(|((keep, alias), w)| Cell {
                keep,
                alias,
                probability: (w / total) as f32,
            }));
        } else {
            self.cells
                .extend((0..weights.len() as u32).map(|alias| Cell {
                    keep: 1.0,
                    alias,
                    probability: 0.0,
                }));
        }
        total * f64::from(scale)
    }

    /// The alias table over emitting primitives and other lights, and every emitter's density.
    pub fn choose(&mut self, emitting: &[Emitting]) {
        let mut entries: Vec<(u32, u32, f64)> = emitting
            .iter()
            .map(|p| {
                (
                    p.emitter,
                    p.primitive,
                    self.power[p.emitter as usize] * p.area,
                )
            })
            .collect();
        for (id, e) in self.emitters.iter().enumerate() {
            if e.kind != emitter::AREA {
                entries.push((id as u32, NONE, self.power[id]));
            }
        }
        entries.retain(|&(_, _, power)| power > 0.0);
        if entries.is_empty() {
            return;
        }
        let weights: Vec<f64> = entries.iter().map(|e| e.2).collect();
        let total: f64 = weights.iter().sum();
        let spread = self.power.iter().zip(&self.volume);
        for (e, (power, volume)) in self.emitters.iter_mut().zip(spread) {
            e.density = (power / total / volume) as f32;
        }
        let table = alias::table(&weights).into_iter().zip(&entries);
        self.choices = table
            .map(|((keep, alias), &(emitter, primitive, _))| Choice {
                keep,
                alias,
                emitter,
                primitive,
            })
            .collect();
    }
}

/// A record whose unused fields pass the check.
fn blank() -> Emitter {
    Emitter {
        direction: [0.0, 0.0, 1.0],
        to_local: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        medium: NONE,
        ..Emitter::zeroed()
    }
}

/// Mean radiance times solid angle of the cells between texel centres.
fn lat_long_weights(width: u32, height: u32, image: &[Color]) -> Vec<f64> {
    let (w, h) = (width as usize, height as usize);
    let step = PI / (h - 1) as f64;
    let texel = |x: usize, y: usize| mean(image[y * w + x % w]);
    let mut weights = Vec::with_capacity(w * (h - 1));
    for y in 0..h - 1 {
        let band = ((y as f64) * step).cos() - ((y + 1) as f64 * step).cos();
        let solid_angle = 2.0 * PI / w as f64 * band;
        for x in 0..w {
            let radiance = texel(x, y) + texel(x + 1, y) + texel(x, y + 1) + texel(x + 1, y + 1);
            weights.push(0.25 * radiance * solid_angle);
        }
    }
    weights
}

/// Radiance times solid angle of the texels.
fn cube_weights(width: u32, image: &[Color]) -> Vec<f64> {
    let w = width as usize;
    let place = |i: usize| (i as f64 + 0.5) * 2.0 / w as f64 - 1.0;
    image
        .iter()
        .enumerate()
        .map(|(i, &c)| {
            let (s, t) = (place(i % w), place(i / w % w));
            mean(c) * 4.0 / (w * w) as f64 * (1.0 + s * s + t * t).powf(-1.5)
        })
        .collect()
}
