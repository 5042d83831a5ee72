//! The words in which rules are checked.

use crate::blob::error::BlobError;
use crate::blob::format::NONE;
use crate::blob::rule::Rule;

/// The largest coordinate: products of three differences stay finite in single precision.
pub const MAX_COORDINATE: f32 = 1e12;

/// Fine, or the rule that is broken.
pub(super) type Checked = Result<(), Rule>;

pub(super) fn ensure(holds: bool, rule: Rule) -> Checked {
    if holds { Ok(()) } else { Err(rule) }
}

/// All of `values` in [low, high]; NaN never is.
pub(super) fn within(values: &[f32], low: f32, high: f32, rule: Rule) -> Checked {
    ensure(values.iter().all(|v| (low..=high).contains(v)), rule)
}

pub(super) fn finite(values: &[f32], rule: Rule) -> Checked {
    within(values, -f32::MAX, f32::MAX, rule)
}

pub(super) fn coordinates(values: &[f32], rule: Rule) -> Checked {
    within(values, -MAX_COORDINATE, MAX_COORDINATE, rule)
}

pub(super) fn unit(v: &[f32; 3], rule: Rule) -> Checked {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    within(&[square], 0.999, 1.001, rule)
}

/// An id that may be nothing.
pub(super) fn optional(id: u32, count: usize, rule: Rule) -> Checked {
    ensure(id == NONE || (id as usize) < count, rule)
}

/// `first .. first + count` of `records`.
pub(super) fn span<T>(records: &[T], first: u32, count: u64, rule: Rule) -> Result<&[T], Rule> {
    let range = || {
        let first = usize::try_from(first).ok()?;
        let end = first.checked_add(usize::try_from(count).ok()?)?;
        records.get(first..end)
    };
    range().ok_or(rule)
}

pub(super) fn zeros(words: &[u32], rule: Rule) -> Checked {
    ensure(words.iter().all(|&w| w == 0), rule)
}

/// Says where.
pub(super) fn at(section: u32) -> impl Fn(Rule) -> BlobError {
    move |rule| BlobError {
        rule,
        section,
        index: 0,
    }
}

/// Runs `check` over the records of a section, and says where it failed.
pub(super) fn each<T>(
    section: u32,
    records: &[T],
    mut check: impl FnMut(usize, &T) -> Checked,
) -> Result<(), BlobError> {
    for (i, record) in records.iter().enumerate() {
        check(i, record).map_err(|rule| BlobError {
            rule,
            section,
            index: i as u32,
        })?;
    }
    Ok(())
}
