//! Linear images to files and back: OpenEXR and Radiance HDR as they are, PNG through a tone curve.

mod file;
mod tone;

pub use file::{Format, ImageError, Linear, Output, check_writable, read, write, write_files};
pub use tone::{AS_IT_IS, Curve, Tone};
