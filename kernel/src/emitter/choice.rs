//! Drawing from alias tables (Walker 1977, Vose 1991): O(1) whatever the number of entries.

#[cfg(feature = "environment")]
use crate::blob::format::Cell;
use crate::blob::format::Choice;
use crate::real::Real;

/// ⌊ξ·n⌋ and the fraction left over, from two numbers: with one, the fraction of a large table would
/// have too few bits to tell `keep` apart.
#[inline(always)]
fn entry(count: usize, xi: [Real; 2]) -> (usize, Real) {
    const BITS: Real = 16_777_216.0; // 2²⁴
    let entries = |x: Real| (x * BITS) as u64 * count as u64;
    let (coarse, fine) = (entries(xi[0]), entries(xi[1]));
    // 48 digits of ξ times n, without the lowest 24: n < 2³² leaves no room for all of them in 64.
    let scaled = coarse + (fine >> 24);
    let fraction = scaled & ((1 << 24) - 1);
    ((scaled >> 24) as usize, fraction as Real / BITS)
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

#[cfg(feature = "environment")]
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

#[cfg(test)]
mod tests {
    use super::entry;
    use crate::real::ONE_MINUS;

    /// What it did before: tables of more than 2¹⁶ entries gave only the first 2¹⁶.
    #[test]
    fn every_entry_of_a_large_table_can_be_drawn() {
        for count in [
            1,
            2,
            3,
            1000,
            1 << 16,
            (1 << 16) + 1,
            3 << 20,
            u32::MAX as usize,
        ] {
            assert_eq!(entry(count, [0.0, 0.0]), (0, 0.0));
            assert_eq!(entry(count, [ONE_MINUS; 2]).0, count - 1);
            assert_eq!(entry(count, [0.5, 0.0]).0, count / 2);
        }
        assert_eq!(entry(3 << 20, [0.25, 0.0]), (3 << 18, 0.0));
    }
}
