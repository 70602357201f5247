//! The reasons why a graphics processor computes nothing.

use thiserror::Error;

/// The reason why a graphics processor computes nothing, or no more.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GpuError {
    /// There is no graphics processor that programs can use.
    #[error("there is no graphics processor that programs can use: {0}")]
    None(String),
    /// The only adapter is a program on the processor, which is slower than the processor itself.
    #[error("{0} is a program and no graphics processor")]
    Software(String),
    /// The adapter has refused the program, or has been lost.
    #[error("the graphics processor has failed: {0}")]
    Failed(String),
    /// The results are not wanted any more.
    #[error("the work has been given up")]
    Unwanted,
}
