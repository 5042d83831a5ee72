//! The caller's allocator and log.

use crate::arguments::{Sized32, optional};
use crate::boundary::Trouble;
use etendue::capi::status::{ETD_E_ARGUMENT, ETD_E_THREADS, EtdStatus};
use etendue_host::render::on_threads;
use std::ffi::{CString, c_char, c_void};

/// Something went wrong; the call returns an error.
pub const ETD_LOG_ERROR: u32 = 0;
/// The result may differ from what was meant.
pub const ETD_LOG_WARNING: u32 = 1;
/// What was done.
pub const ETD_LOG_INFO: u32 = 2;

/// What the library may use of the caller's. All zero but the size: the library's own means. Functions run on the thread that called the
/// library and must return.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdHost {
    /// sizeof(EtdHost).
    pub struct_size: u32,
    /// Threads that building and loading may use besides the calling one; 0: one per core. They end before the call returns.
    pub threads: u32,
    /// Handed to every function.
    pub user: *mut c_void,
    /// Memory for a blob: `size` bytes at a multiple of `alignment` (a power of two), or null if there is none. Working memory that the library frees before
    /// it returns, and a builder's own, doesn't come from here. Given together with `release`, or not at all.
    pub allocate: Option<
        unsafe extern "C" fn(user: *mut c_void, size: usize, alignment: usize) -> *mut c_void,
    >,
    /// Takes back what `allocate` gave, on the thread that calls `etd_blob_free`.
    pub release: Option<
        unsafe extern "C" fn(user: *mut c_void, memory: *mut c_void, size: usize, alignment: usize),
    >,
    /// One message, UTF-8, without a line's end, valid during the call; `severity` is `ETD_LOG_…`.
    pub log: Option<unsafe extern "C" fn(user: *mut c_void, severity: u32, message: *const c_char)>,
}

// SAFETY: repr(C), the size first, numbers and nullable pointers only.
unsafe impl Sized32 for EtdHost {}

impl EtdHost {
    const NONE: Self = Self {
        struct_size: size_of::<Self>() as u32,
        threads: 0,
        user: std::ptr::null_mut(),
        allocate: None,
        release: None,
        log: None,
    };

    /// The caller's, or nothing for null.
    pub(crate) fn read(pointer: *const Self) -> Result<Self, EtdStatus> {
        let host = optional(pointer)?.unwrap_or(Self::NONE);
        if host.allocate.is_some() != host.release.is_some() {
            return Err(ETD_E_ARGUMENT);
        }
        Ok(host)
    }

    /// Tells the caller.
    pub(crate) fn log(&self, severity: u32, message: &str) {
        let Some(log) = self.log else { return };
        let message: Vec<u8> = message
            .bytes()
            .map(|b| if b == 0 { b' ' } else { b })
            .collect();
        if let Ok(text) = CString::new(message) {
            // SAFETY: the caller's function, called as it is documented.
            unsafe { log(self.user, severity, text.as_ptr()) };
        }
    }

    /// Runs `work`, whose parallel parts stay on threads of this call: the global pool is never started.
    pub(crate) fn work<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R, Trouble> {
        on_threads(self.threads as usize, work)
            .map_err(|e| Trouble::new(ETD_E_THREADS, format!("can't start threads: {e}")))
    }
}
