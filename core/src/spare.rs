//! Memory that is no longer needed for what it holds.

use crate::{Estimates, Record};

/// Histories and a record to be overwritten: to be given fresh pages by the system costs more than to fill them.
#[derive(Default)]
pub(crate) struct Spare {
    record: Option<Record>,
    estimates: Vec<Estimates>,
}

impl Spare {
    /// A record, if there is one.
    pub(crate) fn record(&mut self) -> Option<Record> {
        self.record.take()
    }

    /// A history, if there is one.
    pub(crate) fn estimates(&mut self) -> Option<Estimates> {
        self.estimates.pop()
    }

    /// Keeps these.
    pub(crate) fn take(&mut self, (record, mut estimates): (Option<Record>, Vec<Estimates>)) {
        self.record = record.or(self.record.take());
        // The first is asked for first: filters seldom change places.
        estimates.reverse();
        self.estimates.extend(estimates);
    }

    /// Gives one piece of memory back to the system; returns whether there was one.
    pub(crate) fn free_one(&mut self) -> bool {
        self.estimates.pop().is_some() || self.record.take().is_some()
    }

    /// The number of samples that it has held.
    pub(crate) fn len(&self) -> usize {
        self.estimates.iter().map(Estimates::len).sum()
    }
}
