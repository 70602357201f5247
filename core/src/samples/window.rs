//! The last samples of a filter that runs without limit.

use crate::samples::sink::{Sample, Sink};
use crate::{Estimates, Stop};

/// A history that forgets its first samples by itself, in constant memory.
#[derive(Clone, Debug)]
pub struct Window {
    estimates: Estimates,
    most: usize,
}

impl Window {
    /// An empty window that keeps at most `most` samples, and at least half of them but never less than 1.
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
            // Half of the samples at once, because forgetting moves all others.
            self.estimates.forget(self.most / 2);
        }
        self.estimates.append(sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.estimates.set_stop(stop);
    }
}
