//! Paths: their vertices, the walks that make them, the connections that join them and the weights
//! by which all ways of making one path share it.

mod history;
mod trace;
mod vertex;
mod walk;
mod weight;

pub use history::{History, HistoryView, Link};
pub use trace::{Counters, MAX_STEPS, Meeting, Trace, roulette};
pub use vertex::{Joint, Step, Vertex};
pub use walk::{Arrival, Walk, connect_first, emission_terms};
pub use weight::{CUTOFF, Heuristic, Junction, Mis, Terms};
