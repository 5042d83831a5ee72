//! Shared by the truth, agreement and golden tests.

pub mod render;
pub mod scenes;
