//! Drawing from alias tables (Walker 1977, Vose 1991): O(1) whatever the number of entries.

use crate::blob::format::{Cell, Choice};
use crate::real::Real;

/// ⌊ξ·n⌋ and the fraction left over, from two numbers: with one, the fraction of a large table would
/// have too few bits to tell `keep` apart.
#[inline(always)]
fn entry(count: usize, xi: [Real; 2]) -> (usize, Real) {
    const BITS: Real = 16_777_216.0; // 2²⁴
    let bits = ((xi[0] * BITS) as u64) << 24 | (xi[1] * BITS) as u64;
    let scaled = bits.wrapping_mul(count as u64);
    let fraction = scaled & ((1 << 48) - 1);
    ((scaled >> 48) as usize, (fraction >> 24) as Real / BITS)
}

/// Which emitting primitive; `None` if there are none.
#[inline(always)]
pub fn pick_choice(choices: &[Choice], xi: [Real; 2]) -> Option<&Choice> {
    let (index, fraction) = entry(choices.len(), xi);
    let first = choices.get(index)?;
    if fraction < Real::from(first.keep) {
        Some(first)
    } else {
        choices.get(first.alias as usize)
    }
}

/// Which cell of an environment's `cells`, with its index.
#[inline(always)]
pub fn pick_cell(cells: &[Cell], xi: [Real; 2]) -> Option<(usize, &Cell)> {
    let (index, fraction) = entry(cells.len(), xi);
    let first = cells.get(index)?;
    if fraction < Real::from(first.keep) {
        return Some((index, first));
    }
    let alias = first.alias as usize;
    Some((alias, cells.get(alias)?))
}
