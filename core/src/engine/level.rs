//! The instructions that a step is compiled for.

/// A set of instructions. A program that knows of better ones while it runs brings a set of its own.
pub trait Level: Copy {
    /// Does some work in a function of its own, compiled for these instructions: so that a step is some functions of moderate
    /// size, each once in the program.
    fn apart<R>(self, work: impl FnOnce() -> R) -> R;
}

/// The instructions that every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Baseline;

impl Level for Baseline {
    #[inline(never)]
    fn apart<R>(self, work: impl FnOnce() -> R) -> R {
        work()
    }
}
