//! Scenes and scratches: opened, inspected, listed, counted.

use super::Program;
use super::memory::{Room, Struct, pointer, seldom, zeros};
use crate::fuzz::source::Source;
use arbitrary::{Arbitrary, Result};
use etendue::capi::scene::*;
use etendue::capi::scratch::*;
use etendue::capi::status::*;
use etendue_host_capi::blob::{EtdBlob, etd_blob_free};
use std::ptr::null_mut;

/// A blob that the program holds until it ends, or has freed.
pub(super) enum Blob {
    /// Its bytes, and 16 more for those who look one byte further; and whether it may be refused.
    Own {
        memory: Vec<u128>,
        size: usize,
        broken: bool,
    },
    /// A builder's.
    Built(Box<EtdBlob>),
}

impl Blob {
    fn copy(bytes: &[u8], broken: bool) -> Self {
        let mut memory = vec![0u128; bytes.len().div_ceil(16) + 1];
        bytemuck::cast_slice_mut(&mut memory)[..bytes.len()].copy_from_slice(bytes);
        Self::Own {
            memory,
            size: bytes.len(),
            broken,
        }
    }

    fn start(&self) -> (*mut u8, usize) {
        match self {
            Self::Own { memory, size, .. } => (memory.as_ptr().cast_mut().cast(), *size),
            Self::Built(blob) => (blob.data, blob.size),
        }
    }

    fn bytes(&self) -> &[u8] {
        match self {
            Self::Own { memory, size, .. } => &bytemuck::cast_slice(memory)[..*size],
            // SAFETY: the library's memory, not yet freed.
            Self::Built(blob) => unsafe { std::slice::from_raw_parts(blob.data, blob.size) },
        }
    }

    /// No scene uses it any more.
    pub fn free(self) {
        if let Self::Built(mut blob) = self {
            // SAFETY: as it was built; again does nothing.
            unsafe {
                assert_eq!(etd_blob_free(&raw mut *blob), ETD_OK);
                assert_eq!(etd_blob_free(&raw mut *blob), ETD_OK);
            }
            assert!(blob.data.is_null() && blob.size == 0);
        }
    }
}

/// Between them, everything that a scene can hold.
pub(super) fn fixtures() -> Vec<Blob> {
    [
        include_bytes!("../../../data/bits/matter.etd").as_slice(),
        include_bytes!("../../../data/bits/open_air.etd"),
        include_bytes!("../../../data/bits/plan.etd"),
        include_bytes!("../../../data/bits/prism.etd"),
    ]
    .map(|bytes| Blob::copy(bytes, false))
    .into()
}

/// Memory for a scene.
pub(super) struct Slot {
    room: Room,
    /// Columns and rows, once it holds a scene.
    pub size: Option<[u32; 2]>,
}

impl Slot {
    pub fn new() -> Self {
        Self {
            room: Room::new(ETD_SCENE_SIZE),
            size: None,
        }
    }
}

/// Memory for a scratch.
pub(super) struct Scratch {
    room: Room,
    made: bool,
}

impl Scratch {
    pub fn new() -> Self {
        Self {
            room: Room::new(0),
            made: false,
        }
    }
}

/// A handle to try: what the library gets, and whether it must be refused.
pub(super) struct Handle<T> {
    pub at: *mut T,
    pub good: bool,
    /// Of a scene's image; [0, 0] if there is none.
    pub size: [u32; 2],
}

impl Program<'_> {
    /// A scene, opened or not.
    pub fn scene(&mut self) -> Result<Handle<EtdScene>> {
        let i = usize::from(bool::arbitrary(&mut self.s.bytes)?);
        // The one that is open, if one is.
        let i = if self.scenes[i].size.is_none() && !seldom(&mut self.s)? {
            1 - i
        } else {
            i
        };
        let slot = &mut self.scenes[i];
        let (at, good) = pointer(&mut self.s, slot.room.start().cast())?;
        Ok(Handle {
            at,
            good: good && slot.size.is_some(),
            size: slot.size.unwrap_or_default(),
        })
    }

    /// A scratch, made or not.
    pub fn scratch(&mut self) -> Result<Handle<EtdScratch>> {
        let i = usize::from(bool::arbitrary(&mut self.s.bytes)?);
        if !self.scratches.iter().any(|s| s.made) {
            self.init()?;
        }
        let i = if self.scratches[i].made || seldom(&mut self.s)? {
            i
        } else {
            1 - i
        };
        let slot = &mut self.scratches[i];
        // Memory that nobody has made a scratch of must hold its magic number at least.
        if slot.room.bytes().len() < 16 {
            slot.room = Room::new(16);
        }
        let (at, good) = pointer(&mut self.s, slot.room.start().cast())?;
        Ok(Handle {
            at,
            good: good && slot.made,
            size: [0; 2],
        })
    }

    pub fn open(&mut self) -> Result<()> {
        let s = &mut self.s;
        let i = s.below(self.blobs.len())?;
        let broken = broken(s, self.blobs[i].bytes())?;
        let i = match broken {
            Some(blob) => {
                self.blobs.push(blob);
                self.blobs.len() - 1
            }
            None => i,
        };
        let is_broken = matches!(self.blobs[i], Blob::Own { broken: true, .. });
        let (start, size) = self.blobs[i].start();
        let (blob, good_blob) = pointer(s, start)?;
        let stated = if seldom(s)? {
            s.below(size)?
        } else if good_blob {
            size
        } else {
            // One byte further on, there is one byte less.
            size - 1
        };
        let version = if seldom(s)? {
            u32::arbitrary(&mut s.bytes)?
        } else {
            ETD_ABI_VERSION
        };
        let slot = &mut self.scenes[usize::from(bool::arbitrary(&mut s.bytes)?)];
        let before = slot.room.bytes().to_vec();
        let (memory, good_memory) = pointer(s, slot.room.start())?;
        let memory_size = if seldom(s)? {
            s.below(ETD_SCENE_SIZE)?
        } else {
            ETD_SCENE_SIZE
        };
        let mut handle: *const EtdScene = null_mut();
        let (out, good_out) = pointer(s, &raw mut handle)?;
        let error = Struct::optional(s, zeros::<EtdBlobError>())?;
        let good = version == ETD_ABI_VERSION
            && good_blob
            && stated == size
            && good_memory
            && memory_size == ETD_SCENE_SIZE
            && good_out
            && error.good;
        // SAFETY: live memory of at least the stated sizes.
        let status = self.call("open", good, || unsafe {
            etd_scene_open(
                version,
                blob,
                stated,
                memory.cast(),
                memory_size,
                out,
                error.at,
            )
        });
        let slot = if self.scenes[0].room.start() == memory {
            &mut self.scenes[0]
        } else {
            &mut self.scenes[1]
        };
        slot.room.check();
        if status == ETD_OK {
            assert_eq!(handle.cast::<u8>(), memory.cast_const());
            let mut info = EtdSceneInfo {
                struct_size: size_of::<EtdSceneInfo>() as u32,
                ..zeros()
            };
            // SAFETY: a scene that has just been opened.
            assert_eq!(unsafe { etd_scene_inspect(handle, &raw mut info) }, ETD_OK);
            slot.size = Some([info.width, info.height]);
        } else {
            assert!(handle.is_null(), "a handle to nothing");
            assert!(is_broken || !good, "a good blob is refused: {status}");
            if good_memory {
                assert!(slot.room.bytes() == before, "half a scene");
            }
        }
        let error = error.get();
        self.wrote(&[error.section, error.index].map(u32::to_ne_bytes).concat());
        Ok(())
    }

    pub fn inspect(&mut self) -> Result<()> {
        let scene = self.scene()?;
        let info = Struct::new(&mut self.s, zeros::<EtdSceneInfo>())?;
        // SAFETY: a handle of this program, a struct of the stated size.
        let status = self.call("inspect", scene.good && info.good, || unsafe {
            etd_scene_inspect(scene.at, info.at)
        });
        let info = info.get();
        if status == ETD_OK {
            assert_eq!([info.width, info.height], scene.size);
            assert!(info.radius > 0.0 && info.radius.is_finite());
        }
        let words = [info.needs, info.triangles, info.spheres, info.depth];
        self.wrote(bytemuck::cast_slice(&words));
        Ok(())
    }

    pub fn triangles(&mut self) -> Result<()> {
        self.list("triangles", 9, etd_scene_triangles)
    }

    pub fn spheres(&mut self) -> Result<()> {
        self.list("spheres", 4, etd_scene_spheres)
    }

    fn list(
        &mut self,
        name: &'static str,
        floats: usize,
        list: unsafe extern "C" fn(
            *const EtdScene,
            *mut f32,
            *mut u32,
            usize,
            *mut usize,
        ) -> EtdStatus,
    ) -> Result<()> {
        let scene = self.scene()?;
        let s = &mut self.s;
        let capacity = s.below(40)?;
        // More than any memory is: found out before it is written.
        let huge = seldom(s)?;
        let stated = if huge { usize::MAX / 5 } else { capacity };
        let mut numbers = Room::new(capacity * floats * 4);
        let mut ids = Room::new(capacity * 4);
        let (to_numbers, good_numbers) = pointer::<f32>(s, numbers.start().cast())?;
        let (to_ids, good_ids) = pointer::<u32>(s, ids.start().cast())?;
        let mut count = Box::new(usize::MAX);
        let (to_count, good_count) = pointer(s, &raw mut *count)?;
        let absent = |good: bool, at: bool| good || (at && capacity == 0 && !huge);
        let good = scene.good
            && absent(good_numbers, to_numbers.is_null())
            && absent(good_ids, to_ids.is_null())
            && good_count
            && !huge;
        // SAFETY: a handle of this program, rooms of the stated size.
        let status = self.call(name, good, || unsafe {
            list(scene.at, to_numbers, to_ids, stated, to_count)
        });
        numbers.check();
        ids.check();
        if status == ETD_OK {
            let written = capacity.min(*count);
            let values = numbers.values::<f32>(written * floats);
            assert!(values.iter().all(|x| x.is_finite()), "{values:?}");
        }
        let bytes = [numbers.bytes(), ids.bytes(), &count.to_ne_bytes()].concat();
        self.wrote(&bytes);
        Ok(())
    }

    /// Makes a scratch.
    pub fn init(&mut self) -> Result<()> {
        let s = &mut self.s;
        let capacity = match u8::arbitrary(&mut s.bytes)? {
            0..=99 => 8,
            100..=179 => 32,
            180..=243 => 128,
            _ => u32::arbitrary(&mut s.bytes)?,
        };
        let size = etd_scratch_size(capacity);
        assert_eq!(size > 0, [8, 32, 128].contains(&capacity));
        let slot = &mut self.scratches[usize::from(bool::arbitrary(&mut s.bytes)?)];
        let mut room = Room::new(size.max(16));
        let (memory, good_memory) = pointer(s, room.start())?;
        let stated = if seldom(s)? { s.below(size)? } else { size };
        let mut handle: *mut EtdScratch = null_mut();
        let (out, good_out) = pointer(s, &raw mut handle)?;
        let good = size > 0 && good_memory && stated == size && good_out;
        *slot = Scratch { room, made: good };
        // SAFETY: live memory of at least the stated size.
        let status = self.call("init", good, || unsafe {
            etd_scratch_init(memory.cast(), stated, capacity, out)
        });
        assert_eq!(status == ETD_OK, good);
        assert_eq!(handle.is_null(), !good);
        for slot in &self.scratches {
            slot.room.check();
        }
        Ok(())
    }

    pub fn counters(&mut self) -> Result<()> {
        let scratch = self.scratch()?;
        let counters = Struct::new(&mut self.s, zeros::<EtdCounters>())?;
        let clear = i32::from(bool::arbitrary(&mut self.s.bytes)?);
        // SAFETY: a handle of this program, a struct of the stated size.
        self.call("counters", scratch.good && counters.good, || unsafe {
            etd_scratch_counters(scratch.at, counters.at, clear)
        });
        let c = counters.get();
        let words = [c.closest_rays, c.shadow_rays, c.light_walks, c.rejected];
        self.wrote(bytemuck::cast_slice(&words));
        Ok(())
    }
}

/// Now and then, a copy with a few other bytes.
fn broken(s: &mut Source<'_>, bytes: &[u8]) -> Result<Option<Blob>> {
    if u8::arbitrary(&mut s.bytes)? < 200 {
        return Ok(None);
    }
    let mut bytes = bytes.to_vec();
    for _ in 0..=s.below(4)? {
        let at = s.below(bytes.len() / 4)? * 4;
        let word = u32::arbitrary(&mut s.bytes)?;
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    }
    Ok(Some(Blob::copy(&bytes, true)))
}
