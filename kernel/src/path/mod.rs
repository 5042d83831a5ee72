//! Paths: their vertices, the walks that make them, the connections that join them and the weights
//! by which all ways of making one path share it.

mod boundary;
mod equiangular;
mod history;
mod passage;
mod trace;
mod vertex;
mod walk;
mod weight;

pub use equiangular::Equiangular;
pub use history::{History, HistoryView, Link};
pub use passage::{Leg, Passage};
pub use trace::{Counters, MAX_STEPS, Meeting, Sight, Trace};
pub use vertex::{Joint, Step, Vertex};
pub use walk::{Arrival, Walk, connect_first, emission_terms, joined, source_facing};
pub use weight::{CUTOFF, Heuristic, Junction, Mis, Terms};
