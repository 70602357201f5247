//! Work of an import: done elsewhere, or in slices of the frames.

use kalmanscope_core::InSlices;

use crate::elsewhere::{Report, Work};

/// Work with an outcome. It is done elsewhere as long as that goes well, and here from its beginning else.
pub(super) struct Task<H: InSlices, T> {
    here: Option<H>,
    /// The outcome in the form in which it comes from elsewhere.
    outcome: fn(H::Outcome) -> T,
    there: Option<Box<dyn Work<Report<T>>>>,
    share: f64,
}

impl<H: InSlices, T> Task<H, T> {
    /// Work that can be done here, and that may have been begun elsewhere.
    pub(super) fn new(here: H, outcome: fn(H::Outcome) -> T, there: Option<Box<dyn Work<Report<T>>>>) -> Self {
        Self { here: Some(here), outcome, there, share: 0.0 }
    }

    /// Whether frames only show how far it is.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.there.is_some()
    }

    /// The share that is done, from 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        self.share
    }

    /// Goes on until `while_time` returns false. Returns the outcome once.
    pub(super) fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Option<T> {
        while let Some(there) = &mut self.there {
            match there.next() {
                Ok(Some(Report::Share(share))) => self.share = share,
                Ok(Some(Report::Done(outcome))) => return Some(outcome),
                Ok(None) => return None,
                Err(_) => self.there = None,
            }
        }
        let here = self.here.as_mut()?;
        let is_done = here.advance(while_time);
        self.share = here.progress();
        if is_done { self.here.take().map(|here| (self.outcome)(here.finish())) } else { None }
    }
}
