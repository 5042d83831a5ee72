//! Statuses: 0, or the number of what is wrong. Numbers are never reused.

use crate::blob::{BlobError, Problem, Rule};
use core::ffi::{CStr, c_char};

/// What a function returns: `ETD_OK`, or one of `ETD_E_…`.
pub type EtdStatus = i32;

/// All is well.
pub const ETD_OK: i32 = 0;
/// A pointer that must not be null is null.
pub const ETD_E_NULL: i32 = 1;
/// A pointer is not aligned for what it points to.
pub const ETD_E_MISALIGNED: i32 = 2;
/// A `struct_size` is not that of this version's struct, or memory is too small.
pub const ETD_E_SIZE: i32 = 3;
/// The header that the caller was compiled with is another version's.
pub const ETD_E_ABI: i32 = 4;
/// A number is outside its range.
pub const ETD_E_ARGUMENT: i32 = 5;
/// The caller's `cancelled` said so.
pub const ETD_E_CANCELLED: i32 = 6;
/// This build of the library, or this estimator, doesn't have it.
pub const ETD_E_UNSUPPORTED: i32 = 7;
/// A handle was not made by this library, or its memory has been overwritten.
pub const ETD_E_HANDLE: i32 = 8;
/// The estimator reports splats, and there is no `splat` to take them.
pub const ETD_E_SPLAT: i32 = 9;
/// The blob's address is not a multiple of 16.
pub const ETD_E_BLOB_MISALIGNED: i32 = 100;
/// The blob is shorter or longer than its header says.
pub const ETD_E_BLOB_TRUNCATED: i32 = 101;
/// Not an Étendue blob.
pub const ETD_E_BLOB_MAGIC: i32 = 102;
/// A blob of another version.
pub const ETD_E_BLOB_VERSION: i32 = 103;
/// The scene needs something that this build doesn't have.
pub const ETD_E_BLOB_NEEDS: i32 = 104;
/// The table of contents is damaged.
pub const ETD_E_BLOB_SECTION: i32 = 105;
/// A reserved field is not zero.
pub const ETD_E_BLOB_RESERVED: i32 = 106;
/// A number is not finite or out of range.
pub const ETD_E_BLOB_RANGE: i32 = 107;
/// An id points to nothing, or to the wrong thing.
pub const ETD_E_BLOB_REFERENCE: i32 = 108;
/// An unknown kind or flag.
pub const ETD_E_BLOB_KIND: i32 = 109;
/// The nodes are not a tree of the stated depth.
pub const ETD_E_BLOB_TREE: i32 = 110;
/// Two numbers that must agree don't.
pub const ETD_E_BLOB_MISMATCH: i32 = 111;

// Below here: of the hosted library alone (`etendue_host.h`). They stand here so that there is one table of numbers.

/// A file can't be read.
pub const ETD_E_IO: i32 = 200;
/// A file is not a scene: it says something that isn't known, or makes no sense.
pub const ETD_E_PARSE: i32 = 201;
/// The scene can't be built from what was given.
pub const ETD_E_SCENE: i32 = 202;
/// Not enough memory, or the caller's `allocate` said so.
pub const ETD_E_MEMORY: i32 = 203;
/// The library has a bug: it panicked, and stopped at its boundary. Free the handles that the call used.
pub const ETD_E_PANIC: i32 = 204;
/// The operating system gives no threads.
pub const ETD_E_THREADS: i32 = 205;
/// The caller's `run` returned before it had run every job.
pub const ETD_E_JOBS: i32 = 206;

/// The status of a refused blob.
pub(super) fn of_blob(e: &BlobError) -> EtdStatus {
    match e.rule.problem() {
        Problem::Misaligned => ETD_E_BLOB_MISALIGNED,
        Problem::Truncated => ETD_E_BLOB_TRUNCATED,
        Problem::Magic => ETD_E_BLOB_MAGIC,
        Problem::Version => ETD_E_BLOB_VERSION,
        Problem::Needs => ETD_E_BLOB_NEEDS,
        Problem::Section => ETD_E_BLOB_SECTION,
        Problem::Reserved => ETD_E_BLOB_RESERVED,
        Problem::Range => ETD_E_BLOB_RANGE,
        Problem::Reference => ETD_E_BLOB_REFERENCE,
        Problem::Kind => ETD_E_BLOB_KIND,
        Problem::Tree => ETD_E_BLOB_TREE,
        Problem::Mismatch => ETD_E_BLOB_MISMATCH,
    }
}

/// In words.
fn text(status: EtdStatus) -> &'static CStr {
    match status {
        ETD_OK => c"all is well",
        ETD_E_NULL => c"a pointer that must not be null is null",
        ETD_E_MISALIGNED => c"a pointer is not aligned for what it points to",
        ETD_E_SIZE => c"a struct_size is not this version's, or memory is too small",
        ETD_E_ABI => c"the caller was compiled with another version's header",
        ETD_E_ARGUMENT => c"a number is outside its range",
        ETD_E_CANCELLED => c"the caller cancelled it",
        ETD_E_UNSUPPORTED => c"this build of the library, or this estimator, doesn't have it",
        ETD_E_HANDLE => c"a handle was not made by this library, or was overwritten",
        ETD_E_SPLAT => c"the estimator reports splats, and there is no splat function",
        ETD_E_BLOB_MISALIGNED => c"the blob's address is not a multiple of 16",
        ETD_E_BLOB_TRUNCATED => c"the blob is shorter or longer than its header says",
        ETD_E_BLOB_MAGIC => c"not an Étendue blob",
        ETD_E_BLOB_VERSION => c"a blob of another version",
        ETD_E_BLOB_NEEDS => c"the scene needs something that this build doesn't have",
        ETD_E_BLOB_SECTION => c"the blob's table of contents is damaged",
        ETD_E_BLOB_RESERVED => c"a reserved field of the blob is not zero",
        ETD_E_BLOB_RANGE => c"a number in the blob is out of range",
        ETD_E_BLOB_REFERENCE => c"an id in the blob points to nothing",
        ETD_E_BLOB_KIND => c"an unknown kind or flag in the blob",
        ETD_E_BLOB_TREE => c"the blob's nodes are not a tree of the stated depth",
        ETD_E_BLOB_MISMATCH => c"two numbers in the blob that must agree don't",
        ETD_E_IO => c"a file can't be read",
        ETD_E_PARSE => c"a file is not a scene that is understood",
        ETD_E_SCENE => c"the scene can't be built from what was given",
        ETD_E_MEMORY => c"not enough memory",
        ETD_E_PANIC => c"a bug in the library, stopped at its boundary",
        ETD_E_THREADS => c"the operating system gives no threads",
        ETD_E_JOBS => c"the caller's run returned before it had run every job",
        _ => c"an unknown status",
    }
}

/// What a status means, in English, in UTF-8; never null, valid forever. Any thread may call it.
#[unsafe(no_mangle)]
pub extern "C" fn etd_error_string(status: EtdStatus) -> *const c_char {
    text(status).as_ptr()
}

/// What a rule of the blob's format demands (`EtdBlobError.rule`), in English, in UTF-8; never null, valid forever. Any thread may call it.
#[unsafe(no_mangle)]
pub extern "C" fn etd_rule_string(rule: u32) -> *const c_char {
    let rule = Rule::ALL.get(rule as usize);
    rule.map_or(c"an unknown rule", |rule| rule.c_text())
        .as_ptr()
}

/// The version of this library's functions and structs: what `etd_scene_open` compares with the caller's
/// `ETD_ABI_VERSION`. Any thread may call it.
#[unsafe(no_mangle)]
pub extern "C" fn etd_abi_version() -> u32 {
    ETD_ABI_VERSION
}

/// The version of the functions and structs in this header.
pub const ETD_ABI_VERSION: u32 = 1;

/// `?` for functions that return a status: [`Err`] carries it.
pub(super) fn status_of(result: Result<(), EtdStatus>) -> EtdStatus {
    match result {
        Ok(()) => ETD_OK,
        Err(status) => status,
    }
}
