//! Blobs that C owns.

use crate::arguments::{Sized32, output};
use crate::boundary::guarded;
use crate::hooks::EtdHost;
use etendue::capi::status::{ETD_E_MEMORY, ETD_E_MISALIGNED, EtdStatus};
use std::alloc::{Layout, alloc, dealloc};
use std::ffi::c_void;

/// What a blob of this library is aligned to: a cache line.
pub const ETD_BLOB_LINE: usize = 64;

/// A compiled scene: `etd_scene_open(ETD_ABI_VERSION, blob.data, blob.size, …)` opens it. It belongs to the caller and knows nothing of
/// the builder it came from; it may be stored and read back. Free it with `etd_blob_free`, after the last use of scenes opened on it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdBlob {
    /// sizeof(EtdBlob), set by the caller. What else is in a struct that is handed in to be filled is not looked at, nor freed.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// Its bytes, aligned to `ETD_BLOB_LINE`; null after `etd_blob_free`.
    pub data: *mut u8,
    /// How many.
    pub size: usize,
    /// For the library.
    pub user: *mut c_void,
    /// For the library: the caller's `release`, or null for its own.
    pub release: Option<
        unsafe extern "C" fn(user: *mut c_void, memory: *mut c_void, size: usize, alignment: usize),
    >,
}

// SAFETY: repr(C), the size first, numbers and nullable pointers only.
unsafe impl Sized32 for EtdBlob {}

impl EtdBlob {
    /// A copy of `bytes` in memory of `host`.
    pub(crate) fn fill(&mut self, bytes: &[u8], host: &EtdHost) -> Result<(), EtdStatus> {
        let size = bytes.len();
        let layout = Layout::from_size_align(size, ETD_BLOB_LINE).map_err(|_| ETD_E_MEMORY)?;
        let data: *mut u8 = match host.allocate {
            // SAFETY: the caller's function, called as it is documented.
            Some(allocate) => unsafe { allocate(host.user, size, ETD_BLOB_LINE) }.cast(),
            // SAFETY: no blob is empty, so neither is the layout.
            None => unsafe { alloc(layout) },
        };
        if data.is_null() {
            return Err(ETD_E_MEMORY);
        }
        let blob = Self {
            data,
            size,
            user: host.user,
            release: host.release,
            ..*self
        };
        if data.align_offset(ETD_BLOB_LINE) != 0 {
            blob.release_memory();
            return Err(ETD_E_MISALIGNED);
        }
        // SAFETY: `size` bytes of fresh memory, which nothing else refers to.
        unsafe { data.copy_from_nonoverlapping(bytes.as_ptr(), size) };
        *self = blob;
        Ok(())
    }

    fn release_memory(&self) {
        match self.release {
            // SAFETY: the caller's function, called once with what its `allocate` gave.
            Some(release) => unsafe {
                release(self.user, self.data.cast(), self.size, ETD_BLOB_LINE);
            },
            None => {
                // SAFETY: `fill` allocated it with this layout, by the caller's word that the struct is as it was filled.
                unsafe {
                    dealloc(
                        self.data,
                        Layout::from_size_align_unchecked(self.size, ETD_BLOB_LINE),
                    );
                }
            }
        }
    }
}

/// Frees a blob's memory and clears the struct, so that freeing it again does nothing. Scenes opened on it are no longer used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_blob_free(blob: *mut EtdBlob) -> EtdStatus {
    guarded(|| {
        let blob = output(blob)?;
        if !blob.data.is_null() {
            blob.release_memory();
        }
        (blob.data, blob.size) = (std::ptr::null_mut(), 0);
        Ok(())
    })
}
