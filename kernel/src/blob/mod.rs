//! The scene as bytes: the format, the gate that checks it, and the view that the rest reads.

mod check;
mod error;
pub mod format;
mod possible;
mod rule;
mod scene;
mod view;

pub use check::MAX_COORDINATE;
pub use error::BlobError;
pub use possible::Possible;
pub use rule::{Problem, Rule};
pub use scene::Scene;
pub use view::View;
