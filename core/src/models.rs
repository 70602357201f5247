//! The plants, one a file.

pub mod sdof;
