//! The portions of work that a worker has been given.

use web_time::{Duration, Instant};

/// Limits the time of a portion, so that other work is heard of soon.
const PORTION: Duration = Duration::from_millis(30);

/// A portion that takes longer is not waited for.
const LONG: Duration = Duration::from_millis(250);

/// Portions that a worker has at once, so that it need not wait for the page.
const AT_ONCE: usize = 2;

/// Limits the size of a portion.
const MOST: usize = 4096;

/// The portions that a worker has, of cells or samples, and the size of the next one.
pub(super) struct Portions {
    /// When each portion was begun.
    given: Vec<Instant>,
    size: usize,
}

impl Portions {
    /// Nothing is given yet.
    pub(super) fn new() -> Self {
        Self { given: Vec::with_capacity(AT_ONCE), size: 4 }
    }

    /// The size of a first portion where one unit takes this time \[s\] by estimate, so that each of some workers has its share of
    /// the first units.
    pub(super) fn first(time: f64, units: usize, workers: usize) -> usize {
        let soon = (0.7 * PORTION.as_secs_f64() / time) as usize;
        soon.min(units / (AT_ONCE * workers)).clamp(1, MOST)
    }

    /// Whether one has taken long.
    pub(super) fn is_stuck(&self) -> bool {
        self.given.first().is_some_and(|begin| begin.elapsed() > LONG)
    }

    /// Whether the worker has none.
    pub(super) fn is_empty(&self) -> bool {
        self.given.is_empty()
    }

    /// Whether there should be more.
    pub(super) fn want_more(&self) -> bool {
        self.given.len() < AT_ONCE
    }

    /// The size of the next one.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Begins with this size, for other work.
    pub(super) fn begin_with(&mut self, size: usize) {
        self.size = size;
    }

    /// Notes that one has been given.
    pub(super) fn give(&mut self) {
        self.given.push(Instant::now());
    }

    /// Notes that the first one is done, and fits the next one to the time that it took.
    pub(super) fn take_back(&mut self) {
        if self.given.is_empty() {
            return;
        }
        let taken = self.given.remove(0).elapsed();
        // The next one has waited for this one.
        if let Some(next) = self.given.first_mut() {
            *next = Instant::now();
        }
        if taken < PORTION / 2 {
            self.size = (self.size * 2).min(MOST);
        } else if taken > PORTION * 2 {
            self.size = (self.size / 2).max(1);
        }
    }
}
