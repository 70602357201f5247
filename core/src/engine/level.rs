//! The instructions that a step is compiled for.

/// A set of instructions. A program that knows of better ones while it runs brings a set of its own.
pub trait Level: Copy {
    /// Does some work in a function of its own, compiled for these instructions: so that a step is some functions of moderate
    /// size, each once in the program.
    fn apart<R>(self, work: impl FnOnce() -> R) -> R;

    /// n, which the compiler may know.
    #[inline(always)]
    fn size(self, any: usize) -> usize {
        any
    }

    /// The number of components that move, which the compiler may know.
    #[inline(always)]
    fn moving(self, any: usize) -> usize {
        any
    }
}

/// Instructions for filters of N components, M of which move: loops of known lengths are straight lines of code.
#[derive(Clone, Copy, Debug)]
pub struct Known<L, const N: usize, const M: usize>(pub L);

impl<L: Level, const N: usize, const M: usize> Level for Known<L, N, M> {
    #[inline(always)]
    fn apart<R>(self, work: impl FnOnce() -> R) -> R {
        self.0.apart(work)
    }

    #[inline(always)]
    fn size(self, _: usize) -> usize {
        N
    }

    #[inline(always)]
    fn moving(self, _: usize) -> usize {
        M
    }
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
