//! Linear images to files and back: OpenEXR and Radiance HDR as they are, PNG through a tone curve; contact sheets.

mod distance;
mod file;
mod lettering;
mod sheet;
mod tone;

pub use distance::{Distance, distance};
pub use file::{
    Format, ImageError, Linear, Output, check_writable, encode, read, write, write_files,
};
pub use lettering::{ADVANCE, can_write, dots};
pub use sheet::{Picture, sheet};
pub use tone::{AS_IT_IS, Curve, Tone};
