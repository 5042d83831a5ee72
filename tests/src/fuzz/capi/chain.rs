//! Chains: samples to start from, a start, steps.

use super::Program;
use super::estimate::Of;
use super::memory::{Room, pointer, seldom};
use crate::fuzz::source::Source;
use arbitrary::{Arbitrary, Result};
use etendue::capi::chain::*;
use etendue::capi::settings::EtdSettings;
use etendue::capi::status::*;
use std::ptr::null_mut;

/// How chains move, and whether that is in order.
pub(super) fn mutations(s: &mut Source<'_>, with: &mut EtdSettings) -> Result<bool> {
    with.large_steps = s.number(0.0, 1.0)?;
    with.view_steps = s.number(0.0, 1.0)?;
    with.step_size = s.number(1e-6, 0.5)?;
    with.above = s.number(0.0, 1e6)?;
    let share = 0.0..=1.0;
    Ok(share.contains(&with.large_steps)
        && share.contains(&with.view_steps)
        && with.step_size > 0.0
        && with.step_size <= 0.5
        && with.above >= 0.0
        && with.above.is_finite())
}

impl Program<'_> {
    /// A chain from its samples to its steps, whatever became of the call before.
    pub fn chain(&mut self) -> Result<()> {
        let c = self.common(Of::Chains)?;
        // Of what all three calls take.
        let sound = c.scene.good && c.settings.good && c.scratch.good;
        let hooks = c.hooks.get();
        // Chains trace for themselves, and their numbers are their own.
        let own = c.hooks.at.is_null()
            || (c.hooks.good && hooks.closest.is_none() && hooks.random.is_none());
        let takes = !c.hooks.at.is_null() && hooks.splat.is_some();
        let s = &mut self.s;
        let first = u64::arbitrary(&mut s.bytes)?;
        let count = s.below(5)?;
        let mut estimates = Room::new(4 * count);
        let (out, good_out) = pointer::<f32>(s, estimates.start().cast())?;
        let good_out = good_out || (out.is_null() && count == 0);
        let takes_rest = takes || c.settings.get().above <= 0.0;
        // SAFETY: handles of this program, structs of the stated size, hooks that keep to their contract, room for so many numbers.
        let status = self.call(
            "bootstrap",
            sound && own && takes_rest && good_out,
            || unsafe {
                etd_chain_bootstrap(
                    c.scene.at,
                    c.settings.at,
                    c.hooks.at,
                    c.scratch.at,
                    first,
                    count,
                    out,
                )
            },
        );
        self.light_in(&estimates, count, status);

        let s = &mut self.s;
        let mut room = Room::new(etd_chain_size());
        let (memory, good_memory) = pointer(s, room.start())?;
        let short = usize::from(seldom(s)?);
        let mut handle: *mut EtdChain = null_mut();
        let (to, good_to) = pointer(s, &raw mut handle)?;
        let id = u64::from(u8::arbitrary(&mut s.bytes)?);
        // SAFETY: as above, and memory of the stated size.
        let status = self.call(
            "start",
            sound && good_memory && short == 0 && good_to,
            || unsafe {
                etd_chain_start(
                    c.scene.at,
                    c.settings.at,
                    c.scratch.at,
                    id,
                    first,
                    memory.cast(),
                    etd_chain_size() - short,
                    to,
                )
            },
        );
        room.check();
        assert_eq!(handle.is_null(), status != ETD_OK, "a handle to nothing");

        let s = &mut self.s;
        let started = status == ETD_OK;
        let (handle, good_handle) = pointer(s, room.start().cast::<EtdChain>())?;
        let scale = s.number(0.0, 1e6)?;
        let steps = s.below(20)? as u32;
        let good_scale = scale >= 0.0 && scale * steps.max(1) as f32 <= 1e28;
        let good = sound && own && takes && started && good_handle && good_scale;
        // SAFETY: as above; memory that was a chain's, or painted.
        self.call("advance", good, || unsafe {
            etd_chain_advance(
                c.scene.at,
                c.settings.at,
                c.hooks.at,
                c.scratch.at,
                handle,
                scale,
                steps,
            )
        });
        let mut share = -1.0;
        // SAFETY: as above, and room for a number.
        let status = self.call("accepted", started && good_handle, || unsafe {
            etd_chain_accepted(handle, &raw mut share)
        });
        assert!(status != ETD_OK || (0.0..=1.0).contains(&share), "{share}");
        room.check();
        self.wrote(&share.to_ne_bytes());
        self.told(&c.recorder);
        Ok(())
    }
}
