//! The cells of a lattice over the unit cube which a line passes, in order (3-D DDA: Amanatides & Woo 1987).
//!
//! Where it leaves a cell is computed from the cell's own index each time: errors don't add up however many cells there are.

use crate::real::{Real, Vec3};

/// The part of a line that is within the unit cube: origin + t·direction, `start` < t < `end`. The direction need not
/// have unit length: t is what it is in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub origin: Vec3,
    pub direction: Vec3,
    pub start: Real,
    pub end: Real,
}

impl Line {
    /// The part of 0 < t < `t_max` that is within the cube, if any; finite.
    #[inline]
    pub fn clip(origin: Vec3, direction: Vec3, t_max: Real) -> Option<Self> {
        let (mut start, mut end) = (0.0, t_max);
        for (o, d) in origin.to_array().into_iter().zip(direction.to_array()) {
            let (a, b) = if d != 0.0 {
                (-o / d, (1.0 - o) / d)
            } else if (0.0..=1.0).contains(&o) {
                continue;
            } else {
                return None;
            };
            start = a.min(b).max(start);
            end = a.max(b).min(end);
        }
        (start < end && end < Real::INFINITY).then_some(Self {
            origin,
            direction,
            start,
            end,
        })
    }

    #[inline(always)]
    pub fn at(&self, t: Real) -> Vec3 {
        self.origin + self.direction * t
    }

    /// The cells of a lattice of `count` equal ones by axis.
    #[inline(always)]
    pub fn boxes(&self, count: [u32; 3]) -> Cells {
        self.cells(count, 0.0)
    }

    /// The cells between the centres of `size` texels by axis, those at the border half as wide.
    #[inline(always)]
    pub fn between(&self, size: [u32; 3]) -> Cells {
        self.cells(size, 0.5)
    }

    /// Plane j between two cells is at (j − `shift`)/`size`.
    #[inline(always)]
    fn cells(&self, size: [u32; 3], shift: Real) -> Cells {
        let [o, d, at] = [self.origin, self.direction, self.at(self.start)].map(|v| v.to_array());
        Cells {
            axes: [
                Axis::new(o[0], d[0], at[0], size[0], shift),
                Axis::new(o[1], d[1], at[1], size[1], shift),
                Axis::new(o[2], d[2], at[2], size[2], shift),
            ],
            t: self.start,
            end: self.end,
        }
    }
}

/// A cell, and the part of the line in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub index: [u32; 3],
    pub start: Real,
    pub end: Real,
}

/// The cells to come: at most as many as there are planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    axes: [Axis; 3],
    t: Real,
    end: Real,
}

#[derive(Clone, Copy, Debug)]
struct Axis {
    origin: Real,
    direction: Real,
    /// Which cell.
    index: u32,
    /// The last cell.
    last: u32,
    size: Real,
    shift: Real,
    /// Where the line leaves the cell.
    next: Real,
}

impl Axis {
    #[inline(always)]
    fn new(origin: Real, direction: Real, at: Real, size: u32, shift: Real) -> Self {
        let last = if shift > 0.0 {
            size
        } else {
            size.saturating_sub(1)
        };
        let size = size as Real;
        // Casts saturate.
        let index = ((at * size + shift) as u32).min(last);
        let mut axis = Self {
            origin,
            direction,
            index,
            last,
            size,
            shift,
            next: Real::INFINITY,
        };
        axis.aim();
        axis
    }

    /// Computes `next`.
    #[inline(always)]
    fn aim(&mut self) {
        if self.direction != 0.0 {
            let beyond = if self.direction > 0.0 { 1.0 } else { 0.0 };
            let plane = (self.index as Real + beyond - self.shift) / self.size;
            self.next = (plane - self.origin) / self.direction;
        }
    }

    /// To the next cell, if there is one.
    #[inline(always)]
    fn step(&mut self) -> bool {
        let index = if self.direction > 0.0 {
            self.index.checked_add(1).filter(|&i| i <= self.last)
        } else {
            self.index.checked_sub(1)
        };
        self.index = index.unwrap_or(self.index);
        self.aim();
        index.is_some()
    }
}

impl Iterator for Cells {
    type Item = Cell;

    #[inline]
    fn next(&mut self) -> Option<Cell> {
        if self.t >= self.end {
            return None;
        }
        let [x, y, z] = &mut self.axes;
        let index = [x.index, y.index, z.index];
        let nearest = if x.next <= y.next && x.next <= z.next {
            x
        } else if y.next <= z.next {
            y
        } else {
            z
        };
        let start = self.t;
        let next = nearest.next;
        self.t = if next < self.end && nearest.step() {
            // Rounding may have put the line into a cell that it is just leaving.
            next.max(start)
        } else {
            // The last one takes what rounding leaves.
            self.end
        };
        Some(Cell {
            index,
            start,
            end: self.t,
        })
    }
}
