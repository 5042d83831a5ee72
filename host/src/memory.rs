//! Memory that isn't there. Where one large block is asked for, whoever asks can be told ([`attempt`]). Everywhere else
//! the standard library would end the process with a signal: the program's [`Allocator`] ends it as any other failure
//! does, with one line and exit code 1. Files appear whole or not at all ([`crate::develop::write_files`]), so nothing is
//! left half-written.
#![allow(unsafe_code)] // an allocator is unsafe to implement

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::TryReserveError;
use std::io::Write;
use std::path::Path;
use std::sync::OnceLock;

thread_local! {
    static ATTEMPT: Cell<bool> = const { Cell::new(false) };
}

/// What the line is about.
static SUBJECT: OnceLock<String> = OnceLock::new();

/// Names the file that the program is at work on, once.
pub fn about(file: &Path) {
    SUBJECT.get_or_init(|| file.display().to_string());
}

/// Room for `count` values.
///
/// # Errors
/// If there is not so much memory.
pub fn attempt<T>(count: usize) -> Result<Vec<T>, TryReserveError> {
    let mut values = Vec::new();
    ATTEMPT.set(true);
    let reserved = values.try_reserve_exact(count);
    ATTEMPT.set(false);
    reserved.map(|()| values)
}

/// Stack of a thread, in bytes.
pub(crate) const STACK: usize = 2 << 20;
/// What else a thread takes as it starts, in bytes, and a few times that: guard pages, a stack for signals, its name and its queue.
const BESIDE: usize = 256 << 10;

/// Makes sure that there is memory for `count` threads before the first one starts: one that starts where there is too little of it
/// panics in the standard library, at a place where nobody can be told.
///
/// # Errors
/// If there is not so much memory.
pub(crate) fn room_for_threads(count: usize) -> Result<(), TryReserveError> {
    attempt::<u8>(count.saturating_mul(STACK + BESIDE)).map(drop)
}

/// The system's allocator; ends the program where that would return nothing, but for [`attempt`].
#[derive(Debug)]
pub struct Allocator;

// SAFETY: every request goes to `System`, and what it returns is returned as it is.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are `System`'s.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are `System`'s.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promises are `System`'s.
        checked(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are `System`'s.
        unsafe { System.dealloc(memory, layout) }
    }
}

fn checked(memory: *mut u8, size: usize) -> *mut u8 {
    if memory.is_null() && !ATTEMPT.get() {
        let mut error = std::io::stderr();
        // Standard error has no buffer, and nothing here allocates. If it can't be written, nothing can be said.
        let _ = match SUBJECT.get() {
            Some(file) => writeln!(
                error,
                "error: {file}: not enough memory for {size} bytes more"
            ),
            None => writeln!(error, "error: not enough memory for {size} bytes more"),
        };
        std::process::exit(1);
    }
    memory
}
