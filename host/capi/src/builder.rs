//! A scene that C describes, piece by piece.

use crate::arguments::{Sized32, optional_out, output, slice, slice_mut};
use crate::blob::EtdBlob;
use crate::boundary::{Trouble, guarded, write_text};
use crate::control::Control;
use crate::described::{Described, Object};
use crate::hooks::{ETD_LOG_ERROR, ETD_LOG_INFO, ETD_LOG_WARNING, EtdHost};
use etendue::capi::status::{
    ETD_ABI_VERSION, ETD_E_ABI, ETD_E_ARGUMENT, ETD_E_HANDLE, ETD_E_MISALIGNED, ETD_E_NULL,
    ETD_E_SCENE, ETD_E_UNSUPPORTED, EtdStatus,
};
use etendue_host::compile::{Compiled, bvh::Tree, compile, recompile};
use glam::{DMat3, DMat4, DVec3};
use std::ffi::c_char;

/// "No such thing", wherever an id is optional.
pub const ETD_NONE: u32 = u32::MAX;

/// A scene that is being described: made by `etd_builder_create`, freed by `etd_builder_free`. It copies what it is given; arrays stay the
/// caller's and may go when the call returns. One thread at a time; different builders are independent.
pub struct EtdBuilder {
    magic: u64,
    host: EtdHost,
    pub(crate) scene: Described,
    /// The shape of the last tree.
    tree: Option<Tree>,
    message: String,
}

const MAGIC: u64 = 0x6c69_7542_5364_7445; // "EtdSBuil"

/// What a build made.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdBuilt {
    /// sizeof(EtdBuilt), set by the caller.
    pub struct_size: u32,
    /// 1 if the last tree was refitted, 0 if one was built.
    pub refitted: u32,
    /// Nodes of the tree.
    pub nodes: u32,
    /// Levels below its root.
    pub depth: u32,
    /// What a ray that meets the scene's box is expected to cost, in visits of nodes (surface area heuristic): when refitting has made it
    /// much larger than building did, build again.
    pub cost: f64,
}

// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdBuilt {}

fn check(builder: *const EtdBuilder) -> Result<(), EtdStatus> {
    if builder.is_null() {
        return Err(ETD_E_NULL);
    }
    if !builder.is_aligned() {
        return Err(ETD_E_MISALIGNED);
    }
    // SAFETY: not null and aligned; a builder's memory is live by the caller's word.
    if unsafe { (&raw const (*builder).magic).read() } != MAGIC {
        return Err(ETD_E_HANDLE);
    }
    Ok(())
}

fn get<'a>(builder: *mut EtdBuilder) -> Result<&'a mut EtdBuilder, EtdStatus> {
    check(builder)?;
    // SAFETY: only `etd_builder_create` writes that number; one thread at a time uses it, by the caller's word.
    Ok(unsafe { &mut *builder })
}

/// A change of what a builder describes: all of it or, with a message, nothing.
pub(crate) fn edit(
    builder: *mut EtdBuilder,
    change: impl FnOnce(&mut Described) -> Result<(), Trouble>,
) -> EtdStatus {
    guarded(|| {
        let builder = get(builder)?;
        let _control = Control::set();
        let changed = change(&mut builder.scene);
        builder.report(changed)
    })
}

impl EtdBuilder {
    /// Keeps what is to be said of a failure, and says it.
    fn report(&mut self, result: Result<(), Trouble>) -> Result<(), EtdStatus> {
        self.message.clear();
        result.map_err(|trouble| {
            self.host.log(ETD_LOG_ERROR, &trouble.message);
            self.message = trouble.message;
            trouble.status
        })
    }

    fn build(&mut self, refit: bool, blob: &mut EtdBlob) -> Result<EtdBuilt, Trouble> {
        let Described { rest, objects } = &mut self.scene;
        rest.shapes = objects.iter().map(Object::in_world).collect();
        let tree = self.tree.as_ref().filter(|_| refit);
        let compiled = self.host.work(|| match tree {
            Some(tree) => recompile(rest, tree),
            None => compile(rest),
        });
        // What is in the world can be made again; what is kept is small.
        rest.shapes = Vec::new();
        let compiled = compiled?
            .map_err(|e| Trouble::new(ETD_E_SCENE, format!("{}: {}", e.name, e.reason)))?;
        let Compiled {
            blob: made,
            quality,
            tree,
            refitted,
            warnings,
        } = compiled;
        for text in &warnings {
            self.host.log(ETD_LOG_WARNING, text);
        }
        blob.fill(made.bytes(), &self.host)?;
        let built = EtdBuilt {
            struct_size: size_of::<EtdBuilt>() as u32,
            refitted: u32::from(refitted),
            nodes: quality.node_count as u32,
            depth: tree.depth,
            cost: quality.sah_cost,
        };
        self.tree = Some(tree);
        let how = if refitted { "refitted" } else { "built" };
        self.host.log(
            ETD_LOG_INFO,
            &format!("{how} a tree of {} nodes", quality.node_count),
        );
        Ok(built)
    }
}

/// Makes a builder of an empty scene. `abi_version` is `ETD_ABI_VERSION`. `host` may be null; it is copied, its functions must stay until
/// the builder and its blobs are freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_create(
    abi_version: u32,
    host: *const EtdHost,
    out: *mut *mut EtdBuilder,
) -> EtdStatus {
    guarded(|| {
        if abi_version != ETD_ABI_VERSION {
            return Err(ETD_E_ABI);
        }
        if out.is_null() {
            return Err(ETD_E_NULL);
        }
        if !out.is_aligned() {
            return Err(ETD_E_MISALIGNED);
        }
        let builder = Box::new(EtdBuilder {
            magic: MAGIC,
            host: EtdHost::read(host)?,
            scene: Described::default(),
            tree: None,
            message: String::new(),
        });
        // SAFETY: not null and aligned; the caller's to give.
        unsafe { out.write(Box::into_raw(builder)) };
        Ok(())
    })
}

/// Frees a builder; null is fine. Its blobs stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_free(builder: *mut EtdBuilder) -> EtdStatus {
    guarded(|| {
        if builder.is_null() {
            return Ok(());
        }
        // Found out if it is used again before the memory is.
        get(builder)?.magic = 0;
        // SAFETY: `etd_builder_create` made it of a box, and its number has just been taken away.
        drop(unsafe { Box::from_raw(builder) });
        Ok(())
    })
}

/// Writes what was wrong in the builder's last call into `buffer`, UTF-8 with a 0 at its end, cut to `size` bytes; empty if nothing was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_message(
    builder: *const EtdBuilder,
    buffer: *mut c_char,
    size: usize,
) -> EtdStatus {
    guarded(|| {
        check(builder)?;
        if buffer.is_null() {
            return Err(ETD_E_NULL);
        }
        // SAFETY: as in `get`, to read.
        let message = unsafe { &(*builder).message };
        write_text(message, slice_mut(buffer.cast::<u8>(), size)?);
        Ok(())
    })
}

/// Moves an object: `matrix` is 12 numbers, three rows of four, applied to its vertices as they were given (not to where it was before): the
/// fourth column is the translation, world units. It must be invertible, for a sphere a similarity. A mirroring one leaves the front outside.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_set_transform(
    builder: *mut EtdBuilder,
    object: u32,
    matrix: *const f32,
) -> EtdStatus {
    edit(builder, |scene| {
        let m = slice(matrix, 12)?;
        if !m.iter().all(|x| x.is_finite()) {
            return Err(Trouble::new(ETD_E_ARGUMENT, "matrix: not finite"));
        }
        let column = |i: usize| DVec3::new(m[i].into(), m[i + 4].into(), m[i + 8].into());
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        let sizes = [0, 1, 2].map(|i| linear.col(i).length());
        let determinant = linear.determinant().abs();
        // Not so flat that its inverse is noise.
        if determinant.is_nan() || determinant <= 1e-12 * sizes.iter().product::<f64>() {
            return Err(Trouble::new(ETD_E_ARGUMENT, "matrix: not invertible"));
        }
        let id = object as usize;
        let object = scene
            .objects
            .get_mut(id)
            .ok_or_else(|| Trouble::new(ETD_E_ARGUMENT, format!("object {id}: there is none")))?;
        let affine = DMat4::from_cols(
            linear.col(0).extend(0.0),
            linear.col(1).extend(0.0),
            linear.col(2).extend(0.0),
            column(3).extend(1.0),
        );
        object
            .place(affine)
            .map_err(|e| Trouble::new(ETD_E_ARGUMENT, e))
    })
}

/// Reserved: another copy of an object. `ETD_E_UNSUPPORTED`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_add_instance(
    builder: *mut EtdBuilder,
    object: u32,
    matrix: *const f32,
    id: *mut u32,
) -> EtdStatus {
    let _ = (object, matrix, id);
    edit(builder, |_| Err(ETD_E_UNSUPPORTED.into()))
}

fn finish(
    builder: *mut EtdBuilder,
    refit: bool,
    blob: *mut EtdBlob,
    built: *mut EtdBuilt,
) -> EtdStatus {
    guarded(|| {
        let builder = get(builder)?;
        let blob = output(blob)?;
        let out = optional_out(built)?;
        let _control = Control::set();
        let made = builder.build(refit, blob);
        builder.report(made.map(|made| {
            if let Some(out) = out {
                *out = made;
            }
        }))
    })
}

/// Builds the scene into `*blob`, a new blob of the caller's. The builder stays as it is and may be changed and built again. `built` may be null.
/// The same calls give the same bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_build(
    builder: *mut EtdBuilder,
    blob: *mut EtdBlob,
    built: *mut EtdBuilt,
) -> EtdStatus {
    finish(builder, false, blob, built)
}

/// The same, much faster, after objects were moved or materials, lights or the camera changed: the last build's tree keeps its shape and gets new
/// boxes. Images show the same scene; rays get slower the more objects have changed places (`built->cost`). Where that can't be done (nothing was built yet,
/// objects were added, or a triangle got or lost its area) it builds, and says so in `built->refitted`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_builder_refit(
    builder: *mut EtdBuilder,
    blob: *mut EtdBlob,
    built: *mut EtdBuilt,
) -> EtdStatus {
    finish(builder, true, blob, built)
}
