//! The motion of a model with all its parameters known, sample by sample.

use super::Identified;
use crate::Record;
use crate::mathematics::model::Hold;
use crate::samples::simulate::response::Response;

/// The samples between two checks of the clock: at most about a millisecond.
pub(super) const CHUNK: usize = 64;

/// A motion under way.
pub(super) struct Course {
    response: Response,
    /// Whether the motion can still be integrated.
    goes_on: bool,
}

impl Course {
    /// The motion from a state: the values of the first channels.
    pub(super) fn new(identified: &Identified, motion: &[f64]) -> Self {
        let mut values = identified.values.clone();
        values[..motion.len()].copy_from_slice(motion);
        let (state, _) = identified.model.to_state(&values);
        Self { response: Response::new(state.iter().copied()), goes_on: true }
    }

    /// The state, as long as it is finite.
    pub(super) fn state(&self) -> Option<&[f64]> {
        let state = self.response.state();
        (self.goes_on && state.iter().all(|value| value.is_finite())).then_some(state)
    }

    /// The number of times that steps have been halved so far: a measure of the motion's computing time.
    pub(super) fn halved(&self) -> u64 {
        self.response.halved
    }

    /// Moves on from sample `k` to the next, and halves steps at most `most` times. Returns whether it has arrived; if
    /// not, the next call goes on.
    pub(super) fn advance(&mut self, identified: &Identified, record: &Record, k: usize, most: u64) -> bool {
        let force = |k: usize| record.delayed_force(k, identified.input_delay);
        let end = match record.hold() {
            Hold::Zero => k,
            Hold::First => k + 1,
        };
        let moved = self.response.advance(&identified.model, [force(k), force(end)], 0.0, record.dt(), most);
        self.goes_on = moved.is_ok();
        moved != Ok(false)
    }
}
