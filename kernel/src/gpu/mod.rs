//! The kernel on a GPU (`kernel/ptx`): the entries, and sums that many threads add to.

#[cfg(all(target_arch = "nvptx64", feature = "gpu"))]
mod entries;
mod sums;

#[cfg(all(target_arch = "nvptx64", feature = "gpu"))]
pub use entries::{Job, etd_open, etd_render};
