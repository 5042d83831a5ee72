//! Scene files to blobs.

use crate::arguments::{Sized32, optional_out, output, slice, slice_mut};
use crate::blob::EtdBlob;
use crate::boundary::{Trouble, guarded, write_text};
use crate::control::Control;
use crate::hooks::{ETD_LOG_ERROR, ETD_LOG_WARNING, EtdHost};
use etendue::Scene;
use etendue::capi::status::{
    ETD_ABI_VERSION, ETD_E_ABI, ETD_E_ARGUMENT, ETD_E_IO, ETD_E_MISALIGNED, ETD_E_NULL,
    ETD_E_PARSE, ETD_E_SCENE, ETD_E_UNSUPPORTED, EtdStatus,
};
use etendue_host::blob::AlignedBlob;
use etendue_host::compile::compile;
use etendue_host::description::Advice;
use etendue_host::load::{Problem, load};
use etendue_host::scene::is_blob;
use std::ffi::{CStr, c_char};
use std::path::Path;

/// What a scene file says about how to render it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdAdvice {
    /// sizeof(EtdAdvice), set by the caller.
    pub struct_size: u32,
    /// For `EtdSettings`; −1: no limit.
    pub max_edges: i32,
    /// Samples per pixel; 0: it doesn't say.
    pub samples: u32,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdAdvice {}

/// Loads a scene file (Mitsuba 3, named *.xml) and the files that it names, and builds it into `*blob`; or reads a blob (*.etd) and checks it.
///
/// `abi_version` is `ETD_ABI_VERSION`. `path` is UTF-8 with a 0 at its end. `defines` are `define_count` texts NAME=VALUE: values for `$NAME` in the file. `host`
/// (allocator, log) may be null, and so may `advice`. What is wrong, with file and line, goes to the log and into `message`, UTF-8 with a 0 at its end, cut to
/// `message_size` bytes; it may be null if that is 0. `ETD_E_IO`: a file can't be read; `ETD_E_PARSE`: one isn't understood; `ETD_E_UNSUPPORTED`: it asks for
/// something that isn't there yet; `ETD_E_SCENE`: what it describes can't be built. Any thread may call it, any number at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_load_file(
    abi_version: u32,
    path: *const c_char,
    defines: *const *const c_char,
    define_count: usize,
    host: *const EtdHost,
    blob: *mut EtdBlob,
    advice: *mut EtdAdvice,
    message: *mut c_char,
    message_size: usize,
) -> EtdStatus {
    guarded(|| {
        if abi_version != ETD_ABI_VERSION {
            return Err(ETD_E_ABI);
        }
        let host = EtdHost::read(host)?;
        let blob = output(blob)?;
        let out = optional_out(advice)?;
        let message = slice_mut(message.cast::<u8>(), message_size)?;
        write_text("", message);
        let _control = Control::set();
        let loaded = read(path, defines, define_count, &host, blob);
        match loaded {
            Ok(advice) => {
                if let Some(out) = out {
                    out.max_edges = advice
                        .max_depth
                        .map_or(-1, |n| i32::try_from(n).unwrap_or(-1));
                    out.samples = advice.samples.unwrap_or(0);
                }
                Ok(())
            }
            Err(trouble) => {
                write_text(&trouble.message, message);
                host.log(ETD_LOG_ERROR, &trouble.message);
                Err(trouble.status)
            }
        }
    })
}

/// A text of C's.
fn text<'a>(pointer: *const c_char) -> Result<&'a str, Trouble> {
    if pointer.is_null() {
        return Err(ETD_E_NULL.into());
    }
    // SAFETY: not null; a text with a 0 at its end by the caller's word.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str()
        .map_err(|_| Trouble::new(ETD_E_ARGUMENT, "a path or define is not UTF-8"))
}

fn read(
    path: *const c_char,
    defines: *const *const c_char,
    define_count: usize,
    host: &EtdHost,
    blob: &mut EtdBlob,
) -> Result<Advice, Trouble> {
    let path = Path::new(text(path)?);
    if define_count > 0 && !defines.is_aligned() {
        return Err(ETD_E_MISALIGNED.into());
    }
    // Pointers are read as numbers, which have no invalid values.
    let defines = slice(defines.cast::<usize>(), define_count)?
        .iter()
        .map(|&define| {
            let define = text(std::ptr::with_exposed_provenance(define))?;
            let (name, value) = define.split_once('=').ok_or_else(|| {
                Trouble::new(ETD_E_ARGUMENT, format!("{define}: expected NAME=VALUE"))
            })?;
            Ok((name.to_owned(), value.to_owned()))
        })
        .collect::<Result<Vec<_>, Trouble>>()?;
    let place = path.display();
    if is_blob(path) {
        if !defines.is_empty() {
            let reason = format!("{place}: a compiled scene has its values in it");
            return Err(Trouble::new(ETD_E_ARGUMENT, reason));
        }
        let read =
            AlignedBlob::read(path).map_err(|e| Trouble::new(ETD_E_IO, format!("{place}: {e}")))?;
        Scene::open(read.bytes())
            .map_err(|e| Trouble::new(ETD_E_PARSE, format!("{place}: {e}")))?;
        blob.fill(read.bytes(), host)?;
        return Ok(Advice::default());
    }
    let loaded = host.work(|| load(path, &defines))?.map_err(|e| {
        let status = match *e.problem {
            Problem::Unreadable(_) => ETD_E_IO,
            Problem::Unsupported { .. } => ETD_E_UNSUPPORTED,
            _ => ETD_E_PARSE,
        };
        Trouble::new(status, e.to_string())
    })?;
    for warning in &loaded.warnings {
        host.log(ETD_LOG_WARNING, warning);
    }
    let compiled = host
        .work(|| compile(&loaded.description))?
        .map_err(|e| Trouble::new(ETD_E_SCENE, e.in_file(path).to_string()))?;
    for warning in &compiled.warnings {
        host.log(ETD_LOG_WARNING, warning);
    }
    blob.fill(compiled.blob.bytes(), host)?;
    Ok(loaded.description.advice)
}
