//! Work that is done in slices of time.

/// Work with an outcome that is done in slices. The core has no clock: the caller decides when the time of a slice is up.
pub trait InSlices {
    /// The result of the work.
    type Outcome;

    /// The share that is done, from 0 to 1.
    fn progress(&self) -> f64;

    /// Goes on until `while_time` returns false, which is called about every millisecond. Returns whether all is done.
    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool;

    /// The outcome, once all is done.
    fn finish(self) -> Self::Outcome;
}
