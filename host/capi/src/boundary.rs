//! The border to C: nothing unwinds across it, and what goes wrong is a status and a line of text.

use etendue::capi::status::{
    ETD_E_MEMORY, ETD_E_MISALIGNED, ETD_E_NULL, ETD_E_PANIC, ETD_OK, EtdStatus, etd_error_string,
};
use etendue_host::memory::attempt;
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs the body of a C function.
pub(crate) fn guarded(body: impl FnOnce() -> Result<(), EtdStatus>) -> EtdStatus {
    // What a body leaves half done after a panic is its handle, which the caller is told to free.
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => ETD_OK,
        Ok(Err(status)) => status,
        Err(payload) => {
            // Dropping it could panic again.
            std::mem::forget(payload);
            ETD_E_PANIC
        }
    }
}

/// A status and what there is to say about it.
#[derive(Clone, Debug)]
pub(crate) struct Trouble {
    pub status: EtdStatus,
    pub message: String,
}

impl Trouble {
    pub fn new(status: EtdStatus, message: impl Into<String>) -> Self {
        Self {
            status,
            message: message.into(),
        }
    }
}

impl From<EtdStatus> for Trouble {
    fn from(status: EtdStatus) -> Self {
        // SAFETY: it returns a text that lives forever.
        let text = unsafe { CStr::from_ptr(etd_error_string(status)) };
        Self::new(status, text.to_string_lossy())
    }
}

/// A copy of what C gave; too much of it is an error, not the end of the process.
pub(crate) fn copied<T: Copy>(values: &[T]) -> Result<Vec<T>, EtdStatus> {
    let mut copy = attempt(values.len()).map_err(|_| ETD_E_MEMORY)?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Writes as much of `text` into `buffer` as fits, whole characters, and a 0 behind it.
pub(crate) fn write_text(text: &str, buffer: &mut [u8]) {
    let Some(room) = buffer.len().checked_sub(1) else {
        return;
    };
    let length = text.floor_char_boundary(room);
    for (to, from) in buffer.iter_mut().zip(&text.as_bytes()[..length]) {
        // A 0 of its own would end the text.
        *to = if *from == 0 { b' ' } else { *from };
    }
    buffer[length] = 0;
}

/// Writes a struct's default values where C wants them.
pub(crate) fn fill<T: Copy>(pointer: *mut T, value: impl FnOnce() -> T) -> EtdStatus {
    guarded(|| {
        if pointer.is_null() {
            return Err(ETD_E_NULL);
        }
        if !pointer.is_aligned() {
            return Err(ETD_E_MISALIGNED);
        }
        // SAFETY: not null and aligned; live memory of the caller's, by the caller's word.
        unsafe { pointer.write(value()) };
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::{guarded, write_text};
    use etendue::capi::status::{ETD_E_PANIC, ETD_E_SCENE, ETD_OK};

    #[test]
    fn a_panic_is_a_status() {
        assert_eq!(guarded(|| panic!("this panic is a test")), ETD_E_PANIC);
        assert_eq!(guarded(|| Err(ETD_E_SCENE)), ETD_E_SCENE);
        assert_eq!(guarded(|| Ok(())), ETD_OK);
    }

    #[test]
    fn texts_are_cut_between_characters_and_end() {
        let cut = |size: usize| {
            let mut buffer = vec![0xff; size];
            write_text("a\0é", &mut buffer);
            buffer
        };
        assert_eq!(cut(0), b"");
        assert_eq!(cut(1), b"\0");
        assert_eq!(cut(4), b"a \0\xff");
        assert_eq!(cut(6), b"a \xc3\xa9\0\xff");
    }
}
