//! Which medium is where: what a description leaves open is found from the objects that part media, and what they contradict
//! each other in is refused.
//!
//! Lines in fixed pseudo-random directions do both. Along a line the medium is known from what was crossed last, until something
//! opaque comes: behind it anything may be.

use super::lines::{Crossing, Line, Tree};
use super::objects::{along, blocks, each_point, is_open, sides};
use crate::compile::CompileError;
use crate::description::{Description, EmitterKind, Geometry, Shape};
use glam::DVec3;
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

/// A medium, or vacuum.
pub type Matter = Option<usize>;

/// Lines through a point of which the medium is asked.
const LINES_PER_POINT: u32 = 24;
/// Lines through the scene.
const LINES: u32 = 4096;

/// What has been found.
pub struct Found {
    pub exterior: Matter,
    pub sensor: Matter,
    /// Of each of the description's emitters.
    pub emitters: Vec<Matter>,
    /// What the reader should know.
    pub warnings: Vec<String>,
}

impl Found {
    /// Of a scene without media, where nothing should name one.
    pub fn vacuum(d: &Description) -> Self {
        Self {
            exterior: d.exterior,
            sensor: d.sensor.medium,
            emitters: d.emitters.iter().map(|e| e.medium).collect(),
            warnings: Vec::new(),
        }
    }
}

/// Finds the medium of everything that stands in one.
///
/// # Errors
/// Objects that overlap, or light that can't arrive; with the names of both.
pub fn find(
    d: &Description,
    tree: &Tree,
    center: [f32; 3],
    radius: f32,
) -> Result<Found, CompileError> {
    let center = DVec3::from(center.map(f64::from));
    let size = f64::from(radius) + center.abs().max_element();
    let mut space = Space {
        d,
        tree,
        center,
        radius: f64::from(radius),
        tolerance: 4.0 * f64::from(f32::EPSILON) * size,
        random: 1,
        warnings: Vec::new(),
    };
    if d.shapes.iter().all(|s| sides(s).is_none()) {
        return space.open();
    }
    let lines = space.lines();
    let exterior = space.exterior(&lines);
    space.agree(&lines, exterior)?;
    space.arrives(exterior)?;
    let sensor = {
        let at = DVec3::from(d.sensor.origin.map(f64::from));
        space.rests("the sensor", at);
        space.stands("the sensor", d.sensor.medium, at, exterior)
    };
    let mut emitters = Vec::new();
    for e in &d.emitters {
        emitters.push(match e.kind {
            EmitterKind::Point { position, .. } | EmitterKind::Spot { position, .. } => {
                let at = DVec3::from(position.map(f64::from));
                space.rests(&e.name, at);
                space.stands(&e.name, e.medium, at, exterior)
            }
            _ => None,
        });
    }
    Ok(Found {
        exterior,
        sensor,
        emitters,
        warnings: space.warnings,
    })
}

struct Space<'a> {
    d: &'a Description,
    tree: &'a Tree<'a>,
    center: DVec3,
    radius: f64,
    tolerance: f64,
    random: u64,
    warnings: Vec<String>,
}

/// A contradiction: what is behind one object, and what the next says.
struct Clash {
    /// Whose word the medium is, if it isn't the space outside of everything.
    first: Option<usize>,
    behind: Matter,
    second: Option<usize>,
    facing: Matter,
}

impl Space<'_> {
    /// A scene in which nothing parts media: the same is everywhere.
    fn open(mut self) -> Result<Found, CompileError> {
        let d = self.d;
        let given = |m: Matter, name: &str| m.map(|m| (m, name.to_owned()));
        let mut all: Vec<(usize, String)> = Vec::new();
        all.extend(given(d.exterior, "the space outside all objects"));
        all.extend(given(d.sensor.medium, "the sensor"));
        all.extend(d.emitters.iter().filter_map(|e| given(e.medium, &e.name)));
        let exterior = all.first().map(|(m, _)| *m);
        for (m, name) in &all {
            if Some(*m) != exterior {
                let text = format!(
                    "{name} stands in {}, but nothing parts it from {}, which holds {}",
                    self.name(Some(*m)),
                    all[0].1,
                    self.name(exterior)
                );
                self.warnings.push(text);
            }
        }
        self.arrives(exterior)?;
        Ok(Found {
            exterior,
            sensor: d.sensor.medium.or(exterior),
            emitters: d
                .emitters
                .iter()
                .map(|e| local(&e.kind).then(|| e.medium.or(exterior)).flatten())
                .collect(),
            warnings: self.warnings,
        })
    }

    fn name(&self, m: Matter) -> String {
        match m.and_then(|m| self.d.media.get(m)) {
            Some(m) => format!("medium {}", m.name),
            None => "vacuum".into(),
        }
    }

    /// In [0, 1), the same each time (SplitMix64).
    fn next(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.random ^ (self.random >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (sin, cos) = (TAU * self.next()).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    /// What lines through the scene cross, from outside to outside: half of them through points of the box around all that part
    /// media, the others through points of their surfaces, so that small ones are met too.
    fn lines(&mut self) -> Vec<Vec<Crossing>> {
        let d = self.d;
        let parting: Vec<&Shape> = d.shapes.iter().filter(|s| sides(s).is_some()).collect();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for s in &parting {
            each_point(&s.geometry, |p| {
                low = low.min(p);
                high = high.max(p);
            });
        }
        let mut through = Vec::new();
        for _ in 0..LINES / 2 {
            let xi = DVec3::new(self.next(), self.next(), self.next());
            through.push(low + (high - low) * xi);
        }
        let each = (LINES as usize / 2 / parting.len()).clamp(1, 256);
        for s in &parting {
            for _ in 0..each {
                through.extend(self.on(&s.geometry));
            }
        }
        let mut lines = Vec::new();
        for p in through {
            let direction = self.direction();
            let back = (p - self.center).length() + 2.0 * self.radius;
            lines.extend(self.tree.crossings(&Line {
                origin: p - direction * back,
                direction,
                tolerance: self.tolerance,
            }));
        }
        lines
    }

    /// A point of a surface.
    fn on(&mut self, geometry: &Geometry) -> Option<DVec3> {
        match geometry {
            Geometry::Mesh(mesh) => {
                let i = (self.next() * mesh.triangles.len() as f64) as usize;
                let [a, b, c] = mesh.corners(mesh.triangles.get(i)?)?;
                let (mut u, mut v) = (self.next(), self.next());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                Some(a + (b - a) * u + (c - a) * v)
            }
            Geometry::Sphere { center, radius, .. } => {
                let center = DVec3::from(center.map(f64::from));
                Some(center + self.direction() * f64::from(*radius))
            }
        }
    }

    /// What the outermost objects are met from, by the most lines.
    fn exterior(&self, lines: &[Vec<Crossing>]) -> Matter {
        if self.d.exterior.is_some() {
            return self.d.exterior;
        }
        let outermost = lines.iter().filter_map(|line| {
            let first = line.first()?;
            Some(along(self.d.shapes.get(first.shape as usize)?, first.front)?[0])
        });
        most(outermost).flatten()
    }

    /// Refuses what contradicts itself along the lines.
    fn agree(&mut self, lines: &[Vec<Crossing>], exterior: Matter) -> Result<(), CompileError> {
        let mut seen = HashSet::new();
        let mut open: HashMap<usize, bool> = HashMap::new();
        for line in lines {
            for clash in self.walk(line.clone(), exterior) {
                if !seen.insert((clash.first, clash.second)) {
                    continue;
                }
                let both = [clash.first, clash.second];
                let mut leaks = |s: usize| {
                    *open
                        .entry(s)
                        .or_insert_with(|| is_open(&self.d.shapes[s].geometry))
                };
                if let Some(leak) = both.into_iter().flatten().find(|&s| leaks(s)) {
                    let s = &self.d.shapes[leak];
                    let text = format!(
                        "{}parts media but isn't closed: {}",
                        super::super::describe(&s.place) + &s.name + " ",
                        self.explain(&clash)
                    );
                    self.warnings.push(text);
                    continue;
                }
                let at = clash.second.or(clash.first).map(|s| &self.d.shapes[s]);
                return Err(CompileError {
                    place: at.map(|s| s.place.clone()).unwrap_or_default(),
                    name: at.map_or_else(|| "scene".into(), |s| s.name.clone()),
                    reason: self.explain(&clash)
                        + "; expected objects that touch, nest or stand apart",
                });
            }
        }
        Ok(())
    }

    /// Warns of what rests on a boundary.
    fn rests(&mut self, name: &str, at: DVec3) {
        for _ in 0..LINES_PER_POINT {
            // From a little before the point on, so that what is met there is ahead; and past it, as on an edge of triangles nothing is met.
            let (direction, aside) = (self.direction(), self.direction());
            let back = 16.0 * self.tolerance;
            let line = Line {
                origin: at + (aside - direction) * back,
                direction,
                tolerance: self.tolerance,
            };
            let crossings = self.tree.crossings(&line).unwrap_or_default();
            let near = crossings.iter().take_while(|c| c.t <= 4.0 * back);
            let shape = near
                .filter_map(|c| self.d.shapes.get(c.shape as usize))
                .find(|s| sides(s).is_some());
            if let Some(shape) = shape {
                let text = format!(
                    "{name} stands in the boundary {}: whether it is inside is anybody's guess; move it off the boundary",
                    shape.name
                );
                self.warnings.push(text);
                return;
            }
        }
    }

    fn explain(&self, clash: &Clash) -> String {
        let name = |s: usize| &self.d.shapes[s].name;
        let (behind, facing) = (self.name(clash.behind), self.name(clash.facing));
        match (clash.first, clash.second) {
            (Some(a), Some(b)) if a == b => {
                format!(
                    "it meets itself: {behind} is behind it, and {facing} before it where it comes next"
                )
            }
            (Some(a), Some(b)) => format!(
                "overlaps with {}: {behind} is behind that, but {} is met in {facing}",
                name(a),
                name(b)
            ),
            (None, Some(b)) => format!(
                "{} is met in {facing}, but the space outside all objects holds {behind}",
                name(b)
            ),
            (Some(a), None) => format!(
                "{behind} is behind {}, but the space outside all objects holds {facing}",
                name(a)
            ),
            (None, None) => String::new(),
        }
    }

    /// Follows a line from outside to outside.
    fn walk(&self, mut line: Vec<Crossing>, exterior: Matter) -> Vec<Clash> {
        let mut clashes = Vec::new();
        // The medium and who says so; nothing is known behind opaque things.
        let mut state: Option<(Matter, Option<usize>)> = Some((exterior, None));
        for i in 0..line.len() {
            let facing = |c: &Crossing| {
                along(self.d.shapes.get(c.shape as usize)?, c.front).map(|[facing, _]| facing)
            };
            if let Some((matter, _)) = state
                && facing(&line[i]).is_some_and(|f| f != matter)
            {
                // Of several that touch, the one that fits comes first.
                let reach = line[i].t + line[i].slack;
                let touching = line[i..].iter().take_while(|c| c.t - c.slack <= reach);
                if let Some(j) = touching.into_iter().position(|c| facing(c) == Some(matter)) {
                    line[i..=i + j].rotate_right(1);
                }
            }
            let here = line[i];
            let id = here.shape as usize;
            let Some(shape) = self.d.shapes.get(id) else {
                continue;
            };
            let parts = along(shape, here.front);
            if let (Some((behind, first)), Some([facing, _])) = (state, parts)
                && behind != facing
            {
                clashes.push(Clash {
                    first,
                    behind,
                    second: Some(id),
                    facing,
                });
            }
            if let Some([_, behind]) = parts {
                state = Some((behind, Some(id)));
            } else if blocks(self.d, shape, here.front) {
                state = None;
            }
        }
        if let Some((behind, first)) = state
            && behind != exterior
        {
            clashes.push(Clash {
                first,
                behind,
                second: None,
                facing: exterior,
            });
        }
        clashes
    }

    /// The medium at a point, of which `given` is said.
    fn stands(&mut self, name: &str, given: Matter, at: DVec3, exterior: Matter) -> Matter {
        // Lines that meet something opaque first have less of a say: from a closed room they are all there are.
        let (mut clear, mut through) = (Vec::new(), Vec::new());
        for _ in 0..LINES_PER_POINT {
            let direction = self.direction();
            let line = Line {
                origin: at,
                direction,
                tolerance: self.tolerance,
            };
            let Some(crossings) = self.tree.crossings(&line) else {
                continue;
            };
            let mut blocked = false;
            let mut answer = None;
            for c in &crossings {
                let Some(shape) = self.d.shapes.get(c.shape as usize) else {
                    continue;
                };
                if let Some([facing, _]) = along(shape, c.front) {
                    answer = Some((facing, Some(c.shape as usize)));
                    break;
                }
                blocked |= blocks(self.d, shape, c.front);
            }
            match (blocked, answer) {
                (false, answer) => clear.push(answer.unwrap_or((exterior, None))),
                (true, answer) => through.extend(answer),
            }
        }
        let answers = if clear.is_empty() { through } else { clear };
        let Some(found) = most(answers.iter().map(|a| a.0)) else {
            return given.or(exterior);
        };
        let Some(given) = given else { return found };
        if Some(given) != found {
            let who = answers.iter().find(|a| a.0 == found).and_then(|a| a.1);
            let says = match who {
                Some(s) => format!(
                    "{} around it says {}",
                    self.d.shapes[s].name,
                    self.name(found)
                ),
                None => format!(
                    "nothing parts it from the space outside all objects, which holds {}",
                    self.name(found)
                ),
            };
            let text = format!(
                "{name} is said to stand in {}, but {says}",
                self.name(Some(given))
            );
            self.warnings.push(text);
        }
        Some(given)
    }

    /// Refuses light from infinity through a medium that fills all space, and light from all of space.
    fn arrives(&self, exterior: Matter) -> Result<(), CompileError> {
        let Some(m) = exterior.and_then(|m| self.d.media.get(m)) else {
            return Ok(());
        };
        if m.emission.iter().any(|&e| e > 0.0) {
            return Err(CompileError {
                place: m.place.clone(),
                name: m.name.clone(),
                reason: "emits and fills the space outside all objects, expected objects that enclose it".into(),
            });
        }
        if m.grids.is_some() || m.sigma_t.iter().all(|&s| s == 0.0) {
            return Ok(());
        }
        match self.d.emitters.iter().find(|e| !local(&e.kind)) {
            None => Ok(()),
            Some(e) => Err(CompileError {
                place: e.place.clone(),
                name: e.name.clone(),
                reason: format!(
                    "nothing would arrive from it through {}, which fills the space outside all objects; expected objects that enclose the medium",
                    self.name(exterior)
                ),
            }),
        }
    }
}

fn local(kind: &EmitterKind) -> bool {
    matches!(kind, EmitterKind::Point { .. } | EmitterKind::Spot { .. })
}

/// The answer given most often; of several, the one given first.
fn most(answers: impl Iterator<Item = Matter>) -> Option<Matter> {
    let mut counts: Vec<(Matter, usize)> = Vec::new();
    for a in answers {
        match counts.iter_mut().find(|c| c.0 == a) {
            Some(c) => c.1 += 1,
            None => counts.push((a, 1)),
        }
    }
    let top = counts.iter().map(|c| c.1).max()?;
    counts.iter().find(|c| c.1 == top).map(|c| c.0)
}
