//! The evidence of a run's filters over time.

use super::{Subject, is_known};
use crate::Evidence;

/// Limits the samples taken in between two checks of the time: about 0.5 ms.
const CHUNK: usize = 10_000;

/// The evidence of each filter, in the order of the filters.
#[derive(Default)]
pub(super) struct Evidences {
    all: Vec<Evidence>,
    is_complete: bool,
}

impl Evidences {
    /// That of each filter; empty until all are complete.
    pub(super) fn all(&self) -> &[Evidence] {
        if self.is_complete { &self.all } else { &[] }
    }

    /// Takes in new samples. Returns whether all are in.
    pub(super) fn follow(&mut self, subject: &Subject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Subject { bank, known, .. } = subject;
        self.is_complete = false;
        self.all.resize_with(bank.estimates.len(), Evidence::default);
        for (place, estimates) in bank.estimates.iter().enumerate().filter(|(place, _)| !is_known(known, *place)) {
            let evidence = &mut self.all[place];
            loop {
                evidence.follow_to(evidence.len() + CHUNK, estimates);
                if evidence.len() >= estimates.len() {
                    break;
                }
                if !while_time() {
                    return false;
                }
            }
        }
        self.is_complete = true;
        true
    }

    /// Forgets the samples before one, counted from the run's beginning.
    pub(super) fn forget_before(&mut self, sample: usize) {
        self.all.iter_mut().for_each(|evidence| evidence.forget_before(sample));
    }
}
