//! Long work that continues while there is time.

/// Long work that continues while there is time, and then has an outcome. The core has no clock: the caller decides when
/// the time is up. The outcome has the same bits however the work is divided.
pub trait Task {
    /// The result of the work.
    type Outcome;

    /// The share that is done, from 0 to 1.
    fn progress(&self) -> f64;

    /// Continues until `while_time` returns false, which is called about every millisecond. Returns whether all is done.
    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool;

    /// The outcome, once all is done.
    fn finish(self) -> Self::Outcome;

    /// All of it in one go.
    fn run(mut self) -> Self::Outcome
    where
        Self: Sized,
    {
        while !self.advance(&mut || true) {}
        self.finish()
    }
}
