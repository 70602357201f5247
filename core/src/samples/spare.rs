//! Memory for reuse.

use crate::samples::waste::Piecewise as _;
use crate::{Estimates, Record};

/// Old histories and a record to overwrite. Fresh pages from the system cost more than filling them.
#[derive(Default)]
pub(crate) struct Spare {
    pub(super) record: Option<Record>,
    pub(super) estimates: Vec<Estimates>,
}

impl Spare {
    pub(crate) fn take(&mut self, (record, mut estimates): (Option<Record>, Vec<Estimates>)) {
        self.record = record.or(self.record.take());
        // Reversed, because the last is taken first and filters seldom change places.
        estimates.reverse();
        self.estimates.extend(estimates);
    }

    pub(crate) fn free_one(&mut self) -> bool {
        if let Some(last) = self.estimates.last_mut() {
            if !last.free_piece() {
                self.estimates.pop();
            }
            return true;
        }
        self.record.take().is_some()
    }

    pub(crate) fn len(&self) -> usize {
        self.estimates.iter().map(Estimates::len).sum()
    }
}
