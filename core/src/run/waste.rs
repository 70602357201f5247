//! Memory that is free: it is used again, or returned to the system in pieces, since all of it at once takes longer than a frame.

use kalmanscope_records::Record;

use crate::Estimates;

/// Memory that is returned to the system in pieces.
pub trait Piecewise: Send {
    /// Returns one piece of the memory to the system, in a millisecond or so. Returns whether there was one; small memory has none.
    fn free_piece(&mut self) -> bool {
        false
    }
}

/// Memory to return to the system.
#[derive(Default)]
pub struct Waste(Vec<Box<dyn Piecewise>>);

impl Waste {
    /// Adds more of it.
    pub fn extend<T: Piecewise + 'static>(&mut self, unused: impl IntoIterator<Item = T>) {
        self.0.extend(unused.into_iter().map(|one| Box::new(one) as Box<dyn Piecewise>));
    }

    /// Takes all of another.
    pub fn append(&mut self, other: &mut Self) {
        self.0.append(&mut other.0);
    }

    /// Returns one piece to the system. Returns whether there was one.
    pub fn free_one(&mut self) -> bool {
        let Some(last) = self.0.last_mut() else { return false };
        if !last.free_piece() {
            self.0.pop();
        }
        true
    }
}

/// Old histories and a record to overwrite. Fresh pages from the system cost more than filling them.
#[derive(Default)]
pub struct Spare {
    pub(super) record: Option<Record>,
    pub(super) estimates: Vec<Estimates>,
}

impl Spare {
    /// Keeps the memory of a run.
    pub fn take(&mut self, (record, mut estimates): (Option<Record>, Vec<Estimates>)) {
        self.record = record.or(self.record.take());
        // Reversed, because the last is taken first and filters seldom change places.
        estimates.reverse();
        self.estimates.extend(estimates);
    }

    /// Returns one piece to the system. Returns whether there was one.
    pub fn free_one(&mut self) -> bool {
        if let Some(last) = self.estimates.last_mut() {
            if !last.free_piece() {
                self.estimates.pop();
            }
            return true;
        }
        self.record.take().is_some()
    }

    /// The samples whose memory it has.
    pub fn samples(&self) -> usize {
        self.estimates.iter().map(Estimates::len).sum()
    }
}
