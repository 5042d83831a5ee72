//! What a C program hands over: structs, arrays and rooms, right or wrong in the ways that the library finds out. What only
//! the caller can know (that memory lives, and is as long as said) always holds.

use crate::fuzz::source::Source;
use arbitrary::{Arbitrary, Result};
use bytemuck::Pod;

/// Now and then.
pub(super) fn seldom(s: &mut Source<'_>) -> Result<bool> {
    Ok(u8::arbitrary(&mut s.bytes)? >= 244)
}

/// A pointer to `right`; now and then null, or one byte further. And whether it is the right one.
pub(super) fn pointer<T>(s: &mut Source<'_>, right: *mut T) -> Result<(*mut T, bool)> {
    Ok(match u8::arbitrary(&mut s.bytes)? {
        0..=243 => (right, true),
        244..=249 => (std::ptr::null_mut(), false),
        _ => (right.cast::<u8>().wrapping_add(1).cast(), false),
    })
}

/// A struct of the header, its size perhaps another's, in memory of its own so that a sanitizer sees its ends.
pub(super) struct Struct<T> {
    value: Box<T>,
    /// Where the library is told it is.
    pub at: *mut T,
    /// Whether the pointer and the size are right.
    pub good: bool,
}

impl<T: Copy> Struct<T> {
    /// `value` with its size set.
    pub fn new(s: &mut Source<'_>, value: T) -> Result<Self> {
        let mut value = Box::new(value);
        let size = size_of::<T>() as u32;
        let lie = match u8::arbitrary(&mut s.bytes)? {
            0..=247 => size,
            248 => 0,
            249 => u32::MAX,
            _ => size.wrapping_add_signed(i32::from(i8::arbitrary(&mut s.bytes)?)),
        };
        let right: *mut T = &raw mut *value;
        // SAFETY: the first member of the header's structs is their size, a u32.
        unsafe { right.cast::<u32>().write(lie) };
        let (at, good) = pointer(s, right)?;
        Ok(Self {
            value,
            at,
            good: good && lie == size,
        })
    }

    /// The same, or null, which is as good.
    pub fn optional(s: &mut Source<'_>, value: T) -> Result<Self> {
        let mut out = Self::new(s, value)?;
        if bool::arbitrary(&mut s.bytes)? {
            out.at = std::ptr::null_mut();
        }
        out.good |= out.at.is_null();
        Ok(out)
    }

    /// What is in it now.
    pub fn get(&self) -> T {
        *self.value
    }
}

/// A struct all of zeros.
pub(super) fn zeros<T>() -> T {
    // SAFETY: called for structs of the header alone: numbers and nullable pointers.
    unsafe { std::mem::zeroed() }
}

/// An array to read, exactly as long as it is said to be.
pub(super) struct Array<T> {
    values: Vec<T>,
    pub at: *const T,
    pub good: bool,
}

impl<T: Pod> Array<T> {
    /// These values. Nothing may be null.
    pub fn new(s: &mut Source<'_>, values: Vec<T>) -> Result<Self> {
        let mut values = values.into_boxed_slice().into_vec();
        let (at, good) = pointer(s, values.as_mut_ptr())?;
        let good = good || (at.is_null() && values.is_empty());
        Ok(Self { values, at, good })
    }

    pub fn len(&self) -> usize {
        self.values.len()
    }
}

/// What no function writes.
const PAINT: u8 = 0xa5;
/// Painted bytes before and behind a room.
const MARGIN: usize = 64;

/// Memory to write into, aligned to 16, between margins that must stay as they are.
pub(super) struct Room {
    memory: Vec<u128>,
    size: usize,
}

impl Room {
    /// Room for `size` bytes.
    pub fn new(size: usize) -> Self {
        let words = (2 * MARGIN + size).div_ceil(16);
        Self {
            memory: vec![u128::from_ne_bytes([PAINT; 16]); words],
            size,
        }
    }

    pub fn start(&mut self) -> *mut u8 {
        bytemuck::cast_slice_mut::<u128, u8>(&mut self.memory)[MARGIN..].as_mut_ptr()
    }

    pub fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.memory)[MARGIN..MARGIN + self.size]
    }

    /// The first `count` values.
    pub fn values<T: Pod>(&self, count: usize) -> &[T] {
        bytemuck::cast_slice(&self.bytes()[..count * size_of::<T>()])
    }

    /// # Panics
    /// If anything was written outside.
    pub fn check(&self) {
        let all: &[u8] = bytemuck::cast_slice(&self.memory);
        let (before, behind) = (&all[..MARGIN], &all[MARGIN + self.size..]);
        assert!(
            before.iter().chain(behind).all(|&b| b == PAINT),
            "written outside"
        );
    }

    /// # Panics
    /// If anything was written at all.
    pub fn untouched(&self) {
        self.check();
        assert!(self.bytes().iter().all(|&b| b == PAINT), "written");
    }

    /// # Panics
    /// If the numbers are not finite. (Single wavelengths are beyond the gamut, and so have signs.)
    pub fn fine(&self, floats: usize) {
        let values: &[f32] = self.values(floats);
        assert!(values.iter().all(|x| x.is_finite()), "{values:?}");
    }
}
