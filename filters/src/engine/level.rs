//! The instructions that a step is compiled for.

/// A set of instructions. A program that detects better ones at run time implements its own set.
pub trait Level: Copy {
    const IS_KNOWN: bool = false;

    /// Whether filters with sigma points are compiled for it. Known sizes of large plants are for linearised ones only: they gain more.
    const HAS_POINTS: bool = true;

    type Plain: Level;

    fn plain(self) -> Self::Plain;

    /// Does some work in a separate function, compiled for these instructions, so that functions have moderate sizes. `work` must ask for
    /// sizes inside: the compiler does not know the values of captured variables.
    fn apart<R>(self, work: impl FnOnce() -> R) -> R;

    #[inline(always)]
    fn size(self, any: usize) -> usize {
        any
    }

    #[inline(always)]
    fn moving(self, any: usize) -> usize {
        any
    }

    /// Does some work for each number from the first to below the end: straight code if the sizes are known, which nested loops are not.
    #[inline(always)]
    fn each(self, first: usize, end: usize, mut work: impl FnMut(usize)) {
        for i in first..end {
            work(i);
        }
    }
}

/// Instructions for filters of N components, M of which move: loops of known lengths are straight lines of code.
#[derive(Clone, Copy, Debug)]
pub struct Known<L, const N: usize, const M: usize>(pub L);

impl<L: Level, const N: usize, const M: usize> Level for Known<L, N, M> {
    const IS_KNOWN: bool = true;
    const HAS_POINTS: bool = M <= 3;

    type Plain = L::Plain;

    #[inline(always)]
    fn plain(self) -> Self::Plain {
        self.0.plain()
    }

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

    #[inline(always)]
    fn each(self, first: usize, end: usize, mut work: impl FnMut(usize)) {
        macro_rules! one_by_one {
            ($($i:literal)*) => { $(if first <= $i && $i < end { work($i); })* };
        }
        one_by_one!(0 1 2 3 4 5 6 7);
        for i in first.max(8)..end {
            work(i);
        }
    }
}

/// The instructions that every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Baseline;

impl Level for Baseline {
    type Plain = Self;

    #[inline(always)]
    fn plain(self) -> Self {
        self
    }

    #[inline(never)]
    fn apart<R>(self, work: impl FnOnce() -> R) -> R {
        work()
    }
}

/// [`Level::apart`] with work that is inlined there.
macro_rules! apart {
    ($level:expr, $work:expr) => {
        $level.apart(
            #[inline(always)]
            || $work,
        )
    };
}

/// [`Level::each`] with a closure that is inlined there.
macro_rules! each {
    ($level:expr, $first:expr, $end:expr, $work:expr) => {
        $level.each(
            $first,
            $end,
            #[inline(always)]
            $work,
        )
    };
}

pub(super) use {apart, each};

pub(crate) trait Count: Copy {
    fn number(self) -> usize;
}

impl Count for usize {
    #[inline(always)]
    fn number(self) -> usize {
        self
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Exactly<const M: usize>;

impl<const M: usize> Count for Exactly<M> {
    #[inline(always)]
    fn number(self) -> usize {
        M
    }
}
