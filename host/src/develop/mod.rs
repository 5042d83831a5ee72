//! Linear images to files and back: OpenEXR and Radiance HDR as they are, PNG through a tone curve; contact sheets.

mod file;
mod lettering;
mod sheet;
mod tone;

pub use file::{Format, ImageError, Linear, Output, check_writable, read, write, write_files};
pub use lettering::can_write;
pub use sheet::{Picture, sheet};
pub use tone::{AS_IT_IS, Curve, Tone};
