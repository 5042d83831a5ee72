//! Bytes as a C program.

mod builder;
mod chain;
mod describe;
mod estimate;
mod hooks;
mod memory;
mod scene;

use super::source::Source;
use arbitrary::{Arbitrary, Result, Unstructured};
use builder::Builder;
use etendue::capi::status::*;
use hooks::Recorder;
use memory::Room;
use std::ffi::CStr;

/// Calls of one program.
const MOST_CALLS: usize = 48;

/// **Property:** any sequence of calls, with arguments that are wrong in any way that a library can find out, returns
/// statuses that the header lists and never `ETD_E_PANIC`; an argument that must be refused is refused; nothing is
/// written beyond the stated sizes, or into memory for a scene that is refused; light is finite and ≥ 0; the caller's
/// floating-point control word is left as it was; and the same program gives the same statuses and bits again.
pub fn capi(bytes: &[u8]) {
    let first = Program::run(bytes);
    assert_eq!(first, Program::run(bytes), "not the same again");
}

/// A call: its name, its status, and what it wrote.
type Entry = (&'static str, EtdStatus, u64);

/// A C program that uses the library, as far as it has got.
struct Program<'a> {
    s: Source<'a>,
    scenes: [scene::Slot; 2],
    scratches: [scene::Scratch; 2],
    blobs: Vec<scene::Blob>,
    builder: Builder,
    control: u32,
    log: Vec<Entry>,
}

impl Program<'_> {
    fn run(bytes: &[u8]) -> Vec<Entry> {
        let mut program = Program {
            s: Source {
                bytes: Unstructured::new(bytes),
                tame: true,
            },
            scenes: [scene::Slot::new(), scene::Slot::new()],
            scratches: [scene::Scratch::new(), scene::Scratch::new()],
            blobs: scene::fixtures(),
            builder: Builder::new(),
            control: DEFAULT,
            log: Vec::new(),
        };
        // A program that ends early, for want of bytes, is one too.
        let _ = program.calls();
        program.end();
        program.log
    }

    fn calls(&mut self) -> Result<()> {
        for _ in 0..MOST_CALLS {
            if self.s.bytes.is_empty() {
                break;
            }
            let kind = u8::arbitrary(&mut self.s.bytes)?;
            // Which control word the program has, and whether its numbers make sense.
            let manners = u8::arbitrary(&mut self.s.bytes)?;
            self.control = WORDS[usize::from(manners) % WORDS.len()];
            self.s.tame = manners < 224;
            match kind % 24 {
                0 | 1 => self.open()?,
                2 => self.inspect()?,
                3 => self.triangles()?,
                4 => self.spheres()?,
                5 => self.init()?,
                6 => self.counters()?,
                7 => self.pixel()?,
                8 => self.probe(true)?,
                9 => self.probe(false)?,
                10 => self.tile()?,
                11 => self.film()?,
                12 => self.pilot()?,
                // Of what texts had before chains, half: older inputs mean the same.
                13 if kind % 48 == 37 => self.chain()?,
                13 => self.texts()?,
                14 => self.create()?,
                15 => self.camera()?,
                16 => self.material()?,
                17 => self.texture()?,
                18 => self.mesh()?,
                19 => self.sphere()?,
                20 => self.light()?,
                21 => self.transform()?,
                22 => self.build()?,
                _ => self.host_render()?,
            }
        }
        Ok(())
    }

    /// Makes a call. `good` is false where an argument must be refused.
    fn call(
        &mut self,
        name: &'static str,
        good: bool,
        call: impl FnOnce() -> EtdStatus,
    ) -> EtdStatus {
        let status = with_control(self.control, call);
        assert!(known(status), "{name}: status {status}");
        assert!(good || status != ETD_OK, "{name}: a mistake not found");
        self.log.push((name, status, 0));
        status
    }

    /// Remembers what the last call wrote.
    fn wrote(&mut self, bytes: &[u8]) {
        if let Some((_, _, hash)) = self.log.last_mut() {
            for &b in bytes {
                *hash = (*hash ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }

    /// Remembers light: a room of `floats` numbers that may have been filled.
    fn light_in(&mut self, room: &Room, floats: usize, status: EtdStatus) {
        room.check();
        match status {
            ETD_OK => room.fine(floats),
            ETD_E_CANCELLED => (),
            _ => room.untouched(),
        }
        self.wrote(room.bytes());
    }

    /// Remembers what hooks were told.
    fn told(&mut self, recorder: &Recorder) {
        assert_eq!(recorder.wrong, None);
        let hash = recorder.heard.to_ne_bytes();
        self.wrote(&hash);
    }

    /// Versions and texts; statuses have texts of their own.
    fn texts(&mut self) -> Result<()> {
        let status = i32::arbitrary(&mut self.s.bytes)?;
        assert_eq!(etd_abi_version(), ETD_ABI_VERSION);
        // SAFETY: never null, valid forever.
        let text = unsafe { CStr::from_ptr(etd_error_string(status)) };
        assert!(!text.is_empty());
        self.wrote(text.to_bytes());
        Ok(())
    }

    /// Frees what is the program's to free: builders before blobs, blobs after scenes.
    fn end(&mut self) {
        self.control = DEFAULT;
        self.drop_builder();
        let blobs = std::mem::take(&mut self.blobs);
        for blob in blobs {
            blob.free();
        }
        self.builder.all_released();
    }
}

fn known(status: EtdStatus) -> bool {
    matches!(
        status,
        ETD_OK..=ETD_E_SPLAT | ETD_E_BLOB_MISALIGNED..=ETD_E_BLOB_MISMATCH | ETD_E_IO..=ETD_E_JOBS
    ) && status != ETD_E_PANIC
}

/// MXCSR: all exceptions masked, to nearest.
const DEFAULT: u32 = 0x1f80;
/// The default more often than not; flush-to-zero with denormals-are-zero; upwards; towards zero.
const WORDS: [u32; 8] = [
    DEFAULT,
    DEFAULT,
    DEFAULT,
    DEFAULT,
    DEFAULT,
    DEFAULT | 0x8040,
    DEFAULT | 0x4000,
    DEFAULT | 0x6000,
];

/// Runs `call` as a program would whose control word is `word`.
#[cfg(target_arch = "x86_64")]
fn with_control(word: u32, call: impl FnOnce() -> EtdStatus) -> EtdStatus {
    use std::arch::asm;
    let (mut after, default) = (0u32, DEFAULT);
    // SAFETY: a word without reserved bits, and back to Rust's own.
    unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word) };
    let status = call();
    // SAFETY: as above.
    unsafe {
        asm!("stmxcsr [{}]", in(reg) &raw mut after);
        asm!("ldmxcsr [{}]", in(reg) &raw const default);
    }
    // The six lowest bits tell of exceptions that have happened.
    assert_eq!(after & !0x3f, word, "the control word");
    status
}

#[cfg(not(target_arch = "x86_64"))]
fn with_control(_: u32, call: impl FnOnce() -> EtdStatus) -> EtdStatus {
    call()
}
