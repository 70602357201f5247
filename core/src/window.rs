//! The last samples of a filter that runs for as long as it likes.

use crate::sink::{Sample, Sink};
use crate::{Estimates, Stop};

/// A history that forgets its first samples by itself, and so stays in the same memory.
#[derive(Clone, Debug)]
pub struct Window {
    estimates: Estimates,
    most: usize,
}

impl Window {
    /// A window over estimates that keeps at most `most` samples and at least half as many, 1 at least.
    pub fn new(estimates: Estimates, most: usize) -> Self {
        Self { estimates, most: most.max(2) }
    }

    /// The samples that are kept.
    pub fn estimates(&self) -> &Estimates {
        &self.estimates
    }
}

impl Sink for Window {
    fn push(&mut self, sample: &Sample<'_>) {
        if self.estimates.len() >= self.most {
            // Half at once: to forget a sample moves all others.
            self.estimates.forget(self.most / 2);
        }
        self.estimates.append(sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.estimates.set_stop(stop);
    }
}
