//! Pointers from C become references here, or a status. Null, misaligned and too small are found out; that a
//! pointer which is none of these points to live memory is the caller's promise.

use super::status::{ETD_E_MISALIGNED, ETD_E_NULL, ETD_E_SIZE, EtdStatus};

/// A struct of the header: plain numbers and function pointers that may be null, the first of them `struct_size`.
///
/// # Safety
/// `repr(C)`, a `u32` size first, and any value that C can put there is a valid one.
pub(super) unsafe trait Sized32: Copy {}

fn check<T>(pointer: *const T) -> Result<(), EtdStatus> {
    if pointer.is_null() {
        return Err(ETD_E_NULL);
    }
    if !pointer.is_aligned() {
        return Err(ETD_E_MISALIGNED);
    }
    Ok(())
}

/// A struct that the caller filled in.
pub(super) fn input<T: Sized32>(pointer: *const T) -> Result<T, EtdStatus> {
    check(pointer)?;
    // SAFETY: not null and aligned; the caller promises a struct whose first member is its size (`Sized32`).
    let size = unsafe { pointer.cast::<u32>().read() };
    if size as usize != size_of::<T>() {
        return Err(ETD_E_SIZE);
    }
    // SAFETY: the caller says that all of it is there, and any value is valid.
    Ok(unsafe { pointer.read() })
}

/// The same, or `None` for null.
pub(super) fn optional<T: Sized32>(pointer: *const T) -> Result<Option<T>, EtdStatus> {
    if pointer.is_null() {
        return Ok(None);
    }
    input(pointer).map(Some)
}

/// Where a struct is to be written whose `struct_size` the caller has set.
pub(super) fn output<'a, T: Sized32>(pointer: *mut T) -> Result<&'a mut T, EtdStatus> {
    input(pointer.cast_const())?;
    // SAFETY: not null, aligned, of the right size by the caller's word, and nobody else's during the call.
    Ok(unsafe { &mut *pointer })
}

/// One value of any type without invalid values.
#[allow(dead_code)] // unused without the caller's functions
pub(super) fn place<'a, T: bytemuck::Pod>(pointer: *mut T) -> Result<&'a mut T, EtdStatus> {
    check(pointer.cast_const())?;
    // SAFETY: not null, aligned; live and nobody else's by the caller's word.
    Ok(unsafe { &mut *pointer })
}

/// `count` values to read. Null is allowed for none.
pub(super) fn slice<'a, T: bytemuck::Pod>(
    pointer: *const T,
    count: usize,
) -> Result<&'a [T], EtdStatus> {
    if count == 0 && pointer.is_null() {
        return Ok(&[]);
    }
    check(pointer)?;
    bounded::<T>(count)?;
    // SAFETY: not null, aligned, no larger than a slice may be; live by the caller's word.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// `count` values to write. Null is allowed for none.
pub(super) fn slice_mut<'a, T: bytemuck::Pod>(
    pointer: *mut T,
    count: usize,
) -> Result<&'a mut [T], EtdStatus> {
    if count == 0 && pointer.is_null() {
        return Ok(&mut []);
    }
    check(pointer.cast_const())?;
    bounded::<T>(count)?;
    // SAFETY: not null, aligned, no larger than a slice may be; live and nobody else's by the caller's word.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, count) })
}

/// A slice is never larger than `isize::MAX` bytes.
fn bounded<T>(count: usize) -> Result<(), EtdStatus> {
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(ETD_E_SIZE),
    }
}

/// Like [`output`], or `None` for null.
pub(super) fn optional_out<'a, T: Sized32>(
    pointer: *mut T,
) -> Result<Option<&'a mut T>, EtdStatus> {
    if pointer.is_null() {
        return Ok(None);
    }
    output(pointer).map(Some)
}
