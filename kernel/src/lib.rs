//! Étendue: a light-transport kernel to embed.
#![no_std]
#![deny(unsafe_code)]

pub mod blob {
    //! The scene as bytes.
    pub mod format;
}
pub mod random;
pub mod real;
pub mod shape;
pub mod spectrum;
