//! The null boundary: light goes on as if nothing were there. Walks and connections pass it without a vertex
//! ([`crate::path::Trace`]); this is what it says if it is asked all the same.

use super::{Local, Mode, Scatter};
use crate::real::{Real, Vec3};
use crate::spectrum::Spectrum;

/// Nothing but a change of medium.
#[derive(Clone, Copy, Debug)]
pub struct Null;

impl<S: Spectrum> Local<S> for Null {
    #[inline(always)]
    fn sample(&self, w: Vec3, _: Mode, _: Real, _: [Real; 2]) -> Option<Scatter<S>> {
        Some(Scatter {
            transmitted: true,
            ..Scatter::dirac(-w, S::WHITE, 1.0)
        })
    }

    #[inline(always)]
    fn dirac_lobe(&self, w: Vec3, mode: Mode, index: u32) -> Option<Scatter<S>> {
        (index == 0).then(|| Local::<S>::sample(self, w, mode, 0.0, [0.0; 2]))?
    }
}
