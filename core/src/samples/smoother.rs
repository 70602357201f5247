//! Smoothed estimates: each sample in the light of later ones, of all or of the next few.

pub(crate) mod forward;
pub(crate) mod interval;
pub(crate) mod lag;

use crate::samples::waste::Piecewise;
use crate::{Estimates, Record};

/// A smoother in progress. If its filter stops, it ends with the last sample before.
pub(crate) trait Smoother: Piecewise {
    /// Goes on for at most `steps` steps over the first `samples` samples of a record, which are all that will come if it
    /// `is_whole`. Appends to `estimates` what is ready. Returns whether all is done that can be done.
    fn advance(
        &mut self,
        record: &Record,
        samples: usize,
        is_whole: bool,
        steps: usize,
        estimates: &mut Estimates,
    ) -> bool;

    /// The share that is done, from 0 to 1.
    fn progress(&self, samples: usize) -> f64;

    /// Whether it takes in more samples later; else it needs the last one.
    fn goes_along(&self) -> bool;
}

impl Piecewise for Box<dyn Smoother> {
    fn free_piece(&mut self) -> bool {
        (**self).free_piece()
    }
}
