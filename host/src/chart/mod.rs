//! Speed against accuracy: variants of a render, measured on a ladder of budgets against a reference, and what is drawn of it.

pub mod equal;
mod measure;
pub mod plot;
mod reference;
mod report;

pub use measure::{Measured, Plan, Reference, Rung, Shown, Subject, Tail, Trial, measure};
pub use plot::{Plot, SIZE, Series, png, svg};
pub use reference::{noise, reference};
pub use report::{Facts, html, json, plots};
