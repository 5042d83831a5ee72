//! The hosted functions: builders made, built, refitted, freed; renders.

use super::Program;
use super::estimate::{MOST_PIXELS, Of, settings};
use super::memory::{Room, Struct, pointer, seldom, zeros};
use super::scene::Blob;
use arbitrary::{Arbitrary, Result};
use etendue::capi::status::*;
use etendue_host_capi::blob::EtdBlob;
use etendue_host_capi::builder::*;
use etendue_host_capi::hooks::EtdHost;
use etendue_host_capi::render::*;
use std::alloc::{Layout, alloc, dealloc};
use std::ffi::{CStr, c_char, c_void};
use std::ptr::null_mut;

/// A builder, if there is one, and how often its allocator was asked.
pub(super) struct Builder {
    at: *mut EtdBuilder,
    host: Box<Allocator>,
    pub textures: u32,
    pub materials: u32,
    pub objects: u32,
    pub lights: u32,
    pub media: u32,
}

/// Counts what it has given; gives nothing, or something misaligned, now and then.
struct Allocator {
    held: usize,
    noise: u32,
}

impl Builder {
    pub fn new() -> Self {
        Self {
            at: null_mut(),
            host: Box::new(Allocator { held: 0, noise: 1 }),
            textures: 0,
            materials: 0,
            objects: 0,
            lights: 0,
            media: 0,
        }
    }

    /// # Panics
    /// If blobs that are freed still hold memory.
    pub fn all_released(&self) {
        assert_eq!(self.host.held, 0, "memory not released");
    }
}

impl Program<'_> {
    /// A builder's handle: made first if there is none.
    pub fn builder(&mut self) -> Result<(*mut EtdBuilder, bool)> {
        if self.builder.at.is_null() && !seldom(&mut self.s)? {
            self.create()?;
        }
        let none = self.builder.at.is_null();
        let (at, good) = pointer(&mut self.s, self.builder.at)?;
        // One byte further than null is no pointer at all.
        Ok(if none {
            (null_mut(), false)
        } else {
            (at, good)
        })
    }

    /// What the builder says of its last call, cut to any length.
    pub fn message(&mut self, status: EtdStatus) -> Result<()> {
        let size = usize::from(u8::arbitrary(&mut self.s.bytes)?);
        let mut text = Room::new(size);
        let at = text.start();
        let builder = self.builder.at;
        if builder.is_null() {
            return Ok(());
        }
        // SAFETY: a builder of this program, room for the text.
        let said = self.call("message", true, || unsafe {
            etd_builder_message(builder, at.cast(), size)
        });
        assert_eq!(said, ETD_OK);
        text.check();
        if size > 0 {
            let text = CStr::from_bytes_until_nul(text.bytes()).expect("an end");
            let text = text.to_str().expect("UTF-8");
            assert!(status != ETD_OK || text.is_empty(), "{text}");
        }
        self.wrote(text.bytes());
        Ok(())
    }

    pub fn create(&mut self) -> Result<()> {
        self.drop_builder();
        let s = &mut self.s;
        let which = u8::arbitrary(&mut s.bytes)?;
        self.builder.host.noise = u32::from(which) | 1;
        let host = EtdHost {
            threads: 1,
            user: (&raw mut *self.builder.host).cast(),
            allocate: (which & 1 != 0).then_some(allocate),
            release: ((which & 1 != 0) ^ (which >= 248)).then_some(release),
            log: (which & 2 != 0).then_some(log),
            ..zeros()
        };
        let host = Struct::new(s, host)?;
        // Null would do, but then building starts a thread for each core.
        let good_host = host.good && which < 248;
        let version = if seldom(s)? { 0 } else { ETD_ABI_VERSION };
        let mut at: *mut EtdBuilder = null_mut();
        let (out, good_out) = pointer(s, &raw mut at)?;
        let good = (good_host || host.at.is_null()) && version == ETD_ABI_VERSION && good_out;
        // SAFETY: structs of the stated size, functions that keep to their contract.
        let status = self.call("create", good, || unsafe {
            etd_builder_create(version, host.at, out)
        });
        assert_eq!(status == ETD_OK, !at.is_null());
        self.builder.at = at;
        Ok(())
    }

    /// Frees the builder; without one, null is freed.
    pub fn drop_builder(&mut self) {
        let b = &mut self.builder;
        let at = std::mem::replace(&mut b.at, null_mut());
        (b.textures, b.materials, b.objects) = (0, 0, 0);
        (b.lights, b.media) = (0, 0);
        // SAFETY: a builder of this program, used no more.
        let status = self.call("free", true, || unsafe { etd_builder_free(at) });
        assert_eq!(status, ETD_OK);
    }

    /// Calls a function that adds one thing; returns how many there are then.
    pub fn adds(
        &mut self,
        name: &'static str,
        good: bool,
        count: u32,
        add: impl FnOnce(*mut EtdBuilder, *mut u32) -> EtdStatus,
    ) -> Result<u32> {
        let (builder, good_builder) = self.builder()?;
        let mut new = Box::new(u32::MAX);
        let (to, good_id) = pointer(&mut self.s, &raw mut *new)?;
        // A builder made just now begins anew.
        let fresh = self.log.last().is_some_and(|l| l.0 == "create");
        let count = if fresh { 0 } else { count };
        let status = self.call(name, good && good_builder && good_id, || add(builder, to));
        assert_eq!(*new, if status == ETD_OK { count } else { u32::MAX });
        self.message(status)?;
        Ok(count + u32::from(status == ETD_OK))
    }

    /// Builds or refits.
    pub fn build(&mut self) -> Result<()> {
        let (builder, good_builder) = self.builder()?;
        let refit = bool::arbitrary(&mut self.s.bytes)?;
        let mut blob: EtdBlob = zeros();
        blob.struct_size = size_of::<EtdBlob>() as u32;
        let mut blob = Box::new(blob);
        let (to, good_blob) = pointer(&mut self.s, &raw mut *blob)?;
        let built = Struct::optional(&mut self.s, zeros::<EtdBuilt>())?;
        let good = good_builder && good_blob && built.good;
        let finish = if refit {
            etd_builder_refit
        } else {
            etd_builder_build
        };
        // SAFETY: as above.
        let status = self.call("build", good, || unsafe { finish(builder, to, built.at) });
        self.message(status)?;
        if status == ETD_OK {
            assert!(!blob.data.is_null() && blob.size > 0);
            // SAFETY: as long as it says.
            let bytes = unsafe { std::slice::from_raw_parts(blob.data, blob.size) };
            self.wrote(bytes);
            self.blobs.push(Blob::Built(blob));
        } else {
            assert!(blob.data.is_null() && blob.size == 0, "half a blob");
        }
        Ok(())
    }

    pub fn host_render(&mut self) -> Result<()> {
        let scene = self.scene()?;
        let settings = settings(&mut self.s, Of::Others)?;
        let s = &mut self.s;
        let right = 3 * scene.size[0] as usize * scene.size[1] as usize;
        let small = right <= 3 * MOST_PIXELS;
        let floats = if seldom(s)? || !small {
            s.below(64)?
        } else {
            right
        };
        let which = u8::arbitrary(&mut s.bytes)?;
        let mut state = Box::new(u32::from(which) | 1);
        let how = EtdRender {
            threads: 1,
            samples: u64::from(which % 3),
            seconds: if which >= 252 { f64::NAN } else { -1.0 },
            user: (&raw mut *state).cast(),
            run: (which & 8 != 0).then_some(run),
            progress: (which & 16 != 0).then_some(progress),
            ..zeros()
        };
        let sound = how.samples > 0;
        let how = Struct::new(s, how)?;
        let rendered = Struct::optional(s, zeros::<EtdRendered>())?;
        let mut rgb = Room::new(4 * floats);
        let (out, good_out) = pointer(s, rgb.start().cast())?;
        let good = scene.good
            && settings.good
            && how.good
            && sound
            && rendered.good
            && floats == right
            && good_out;
        // SAFETY: a handle of this program, structs of the stated size, functions that keep to their contract or leave jobs out,
        // room for the stated number of floats.
        let status = self.call("host_render", good, || unsafe {
            etd_host_render(scene.at, settings.at, how.at, out, floats, rendered.at)
        });
        if status == ETD_E_CANCELLED {
            rgb.check();
            rgb.fine(floats);
        }
        self.light_in(&rgb, floats, status);
        Ok(())
    }
}

unsafe extern "C" fn allocate(user: *mut c_void, size: usize, alignment: usize) -> *mut c_void {
    // SAFETY: what `create` gave.
    let allocator = unsafe { &mut *user.cast::<Allocator>() };
    allocator.noise = allocator
        .noise
        .wrapping_mul(1_664_525)
        .wrapping_add(1_013_904_223);
    if allocator.noise >> 28 == 0 {
        return null_mut();
    }
    allocator.held += 1;
    let layout = Layout::from_size_align(size + alignment, alignment).expect("a layout");
    // SAFETY: not empty.
    let memory = unsafe { alloc(layout) };
    let off = usize::from(allocator.noise >> 28 == 1);
    memory.wrapping_add(off).cast()
}

unsafe extern "C" fn release(
    user: *mut c_void,
    memory: *mut c_void,
    size: usize,
    alignment: usize,
) {
    // SAFETY: what `create` gave, and what `allocate` did.
    unsafe {
        let allocator = &mut *user.cast::<Allocator>();
        allocator.held -= 1;
        let off = memory.addr() % alignment;
        let layout = Layout::from_size_align(size + alignment, alignment).expect("a layout");
        dealloc(memory.cast::<u8>().wrapping_sub(off), layout);
    }
}

unsafe extern "C" fn log(_user: *mut c_void, _severity: u32, message: *const c_char) {
    // SAFETY: a text, valid during the call.
    let text = unsafe { CStr::from_ptr(message) };
    assert!(text.to_str().is_ok_and(|t| !t.is_empty()));
}

/// Runs the jobs, last first; now and then not all of them.
unsafe extern "C" fn run(
    user: *mut c_void,
    jobs: u32,
    job: Option<unsafe extern "C" fn(context: *mut c_void, index: u32)>,
    context: *mut c_void,
) {
    // SAFETY: what `host_render` gave.
    let lazy = unsafe { *user.cast::<u32>() } >= 224;
    let job = job.expect("a job");
    for i in (u32::from(lazy)..jobs).rev() {
        // SAFETY: each once, with the context that came with it.
        unsafe { job(context, i) };
    }
}

unsafe extern "C" fn progress(user: *mut c_void, _samples: u64, share: f64) -> i32 {
    assert!((0.0..=1.0).contains(&share));
    // SAFETY: what `host_render` gave.
    let state = unsafe { *user.cast::<u32>() };
    i32::from(state & 32 != 0)
}
