//! The scenes that estimators have to agree on.

pub mod everything;
pub mod media;
pub mod panes;
pub mod scenes;

/// What can make all light of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Complete {
    /// Path and bidirectional.
    FromSensor,
    /// Light tracing as well: no Dirac surface is seen.
    FromLight,
}

/// A scene, what it is called, and what can make all of its light.
pub type Named = (
    &'static str,
    etendue_host::description::Description,
    Complete,
);
