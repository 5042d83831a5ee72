//! The program's own functions: splats are checked, cancelling is counted down, rays and random numbers are noise.

use super::memory::{Struct, zeros};
use crate::fuzz::source::Source;
use arbitrary::{Arbitrary, Result};
use etendue::capi::hooks::{EtdHit, EtdHooks, EtdRay};
use std::ffi::c_void;

/// What `user` points to.
pub(super) struct Recorder {
    /// Of the image, if it is known.
    pub size: [u32; 2],
    /// Calls until `cancelled` says yes.
    pub patience: u32,
    /// State of the noise.
    pub noise: u32,
    /// A hash of what was told.
    pub heard: u64,
    /// What was told that made no sense.
    pub wrong: Option<&'static str>,
}

impl Recorder {
    pub fn new(s: &mut Source<'_>, size: [u32; 2]) -> Result<Box<Self>> {
        Ok(Box::new(Self {
            size,
            patience: u32::from(u8::arbitrary(&mut s.bytes)?),
            noise: u32::arbitrary(&mut s.bytes)? | 1,
            heard: 0,
            wrong: None,
        }))
    }

    fn expect(&mut self, sound: bool, what: &'static str) {
        if !sound {
            self.wrong = Some(what);
        }
    }

    fn hear(&mut self, word: u32) {
        self.heard = (self.heard ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    /// Xorshift.
    fn next(&mut self) -> u32 {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        self.noise
    }

    /// A number between 0 and 1 or, one time in eight, of any bits.
    fn float(&mut self) -> f32 {
        match self.next() {
            x if x % 8 == 0 => f32::from_bits(self.next()),
            x => (x >> 8) as f32 / (1u32 << 24) as f32,
        }
    }
}

/// Hooks that tell `recorder`; `splats` where there must be a function for them.
pub(super) fn hooks(
    s: &mut Source<'_>,
    recorder: &mut Recorder,
    splats: bool,
) -> Result<Struct<EtdHooks>> {
    let which = u16::arbitrary(&mut s.bytes)?;
    let has = |bit: u16| which & (1 << bit) != 0;
    // Mostly both or neither of the ray tracer's.
    let (closest, occluded) = (
        has(0),
        if has(1) && has(2) && has(3) {
            has(4)
        } else {
            has(0)
        },
    );
    let splat = has(5) || has(6);
    let reserved = u32::from(which >> 8 == 0xff);
    let value = EtdHooks {
        reserved,
        user: (&raw mut *recorder).cast(),
        splat: splat.then_some(self::splat),
        cancelled: has(7).then_some(cancelled),
        closest: closest.then_some(self::closest),
        occluded: occluded.then_some(self::occluded),
        random: (which >> 8 & 3 == 3).then_some(random),
        ..zeros()
    };
    let mut out = Struct::optional(s, value)?;
    let sound = closest == occluded && reserved == 0;
    let takes = splat && !out.at.is_null();
    out.good &= (sound || out.at.is_null()) && (takes || !splats);
    Ok(out)
}

/// # Safety
/// `user` is the recorder of the call under way, which nothing else refers to.
unsafe fn of<'a>(user: *mut c_void) -> &'a mut Recorder {
    // SAFETY: as the caller says.
    unsafe { &mut *user.cast() }
}

unsafe extern "C" fn splat(user: *mut c_void, x: u32, y: u32, rgb: *const f32) {
    // SAFETY: what `hooks` gave, and three numbers.
    let (recorder, rgb) = unsafe { (of(user), std::slice::from_raw_parts(rgb, 3)) };
    let inside = x < recorder.size[0] && y < recorder.size[1];
    // Single wavelengths are beyond the gamut: signs say nothing.
    let good = rgb.iter().all(|c| c.is_finite());
    recorder.expect(inside, "a splat outside the image");
    recorder.expect(good, "a splat that isn't finite");
    recorder.hear(x);
    recorder.hear(y);
    for c in rgb {
        recorder.hear(c.to_bits());
    }
}

unsafe extern "C" fn cancelled(user: *mut c_void) -> i32 {
    // SAFETY: what `hooks` gave.
    let recorder = unsafe { of(user) };
    recorder.patience = recorder.patience.saturating_sub(1);
    i32::from(recorder.patience == 0)
}

unsafe extern "C" fn closest(user: *mut c_void, ray: *const EtdRay, hit: *mut EtdHit) -> i32 {
    // SAFETY: what `hooks` gave, a ray and a hit.
    let (recorder, ray, hit) = unsafe { (of(user), &*ray, &mut *hit) };
    let far = if ray.t_max < 100.0 { ray.t_max } else { 100.0 };
    let sized = ray.struct_size as usize == size_of::<EtdRay>()
        && hit.struct_size as usize == size_of::<EtdHit>();
    recorder.expect(sized, "a struct of another size");
    let mut numbers = ray.origin.iter().chain(&ray.direction);
    recorder.expect(numbers.all(|x| x.is_finite()), "a ray that isn't finite");
    hit.primitive = match recorder.next() {
        x if x % 16 == 0 => recorder.next(),
        x => x % 40,
    };
    hit.t = recorder.float() * far;
    hit.u = recorder.float();
    hit.v = recorder.float();
    (recorder.next() % 4) as i32
}

unsafe extern "C" fn occluded(user: *mut c_void, _ray: *const EtdRay) -> i32 {
    // SAFETY: what `hooks` gave.
    let recorder = unsafe { of(user) };
    (recorder.next() % 2) as i32
}

unsafe extern "C" fn random(user: *mut c_void, subpath: u32, vertex: u32, purpose: u32) -> f32 {
    // SAFETY: what `hooks` gave.
    let recorder = unsafe { of(user) };
    recorder.expect(
        subpath <= 2,
        "a number for a walk that the header doesn't know",
    );
    recorder.expect(
        purpose <= 11,
        "a number for a purpose that the header doesn't know",
    );
    recorder.hear(vertex);
    recorder.float()
}
