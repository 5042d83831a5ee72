//! The floating-point control word: an engine may have set flush-to-zero, another rounding or traps; every function
//! that computes saves it, sets what Rust assumes (nearest, denormals, no traps) and restores it.

/// The caller's control word, put back when this is dropped.
pub(super) struct Control(Word);

impl Control {
    /// Saves the caller's and sets the kernel's.
    #[inline(always)]
    pub(super) fn set() -> Self {
        let caller = read();
        write(DEFAULT);
        Self(caller)
    }
}

impl Drop for Control {
    #[inline(always)]
    fn drop(&mut self) {
        write(self.0);
    }
}

#[cfg(target_arch = "x86_64")]
mod word {
    use core::arch::asm;

    pub type Word = u32;
    /// All exceptions masked, round to nearest, neither flush-to-zero nor denormals-are-zero (Intel SDM vol. 1, §10.2.3).
    pub const DEFAULT: Word = 0x1f80;

    #[inline(always)]
    pub fn read() -> Word {
        let mut word: Word = 0;
        // SAFETY: stores MXCSR into the local that is pointed to.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack, preserves_flags)) };
        word
    }

    #[inline(always)]
    pub fn write(word: Word) {
        // SAFETY: the word is the default or one that was read, so no reserved bit is set.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack, preserves_flags)) };
    }
}

#[cfg(target_arch = "aarch64")]
mod word {
    use core::arch::asm;

    pub type Word = u64;
    /// Round to nearest, no flush to zero, no traps (Arm ARM, FPCR).
    pub const DEFAULT: Word = 0;

    #[inline(always)]
    pub fn read() -> Word {
        let word;
        // SAFETY: reads a register.
        unsafe { asm!("mrs {}, fpcr", out(reg) word, options(nostack, preserves_flags)) };
        word
    }

    #[inline(always)]
    pub fn write(word: Word) {
        // SAFETY: the word is the default or one that was read.
        unsafe { asm!("msr fpcr, {}", in(reg) word, options(nostack, preserves_flags)) };
    }
}

#[cfg(all(target_arch = "arm", target_feature = "vfp2"))]
mod word {
    use core::arch::asm;

    pub type Word = u32;
    /// Round to nearest, no flush to zero, no default NaN (Arm ARM, FPSCR).
    pub const DEFAULT: Word = 0;

    #[inline(always)]
    pub fn read() -> Word {
        let word;
        // SAFETY: reads a register.
        unsafe { asm!("vmrs {}, fpscr", out(reg) word, options(nostack, preserves_flags)) };
        word
    }

    #[inline(always)]
    pub fn write(word: Word) {
        // SAFETY: the word is the default or one that was read.
        unsafe { asm!("vmsr fpscr, {}", in(reg) word, options(nostack)) };
    }
}

#[cfg(not(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "arm", target_feature = "vfp2")
)))]
mod word {
    /// Targets without a control word: WebAssembly always rounds to nearest and keeps denormals.
    pub type Word = ();
    pub const DEFAULT: Word = ();
    #[inline(always)]
    pub fn read() -> Word {}
    #[inline(always)]
    pub fn write((): Word) {}
}

use word::{DEFAULT, Word, read, write};
