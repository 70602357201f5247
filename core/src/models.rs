//! The plants, one a file.

pub mod bouc_wen;
pub mod duffing;
pub mod log_parameters;
pub mod sdof;
pub mod shear_chain;

#[cfg(test)]
mod tests;
