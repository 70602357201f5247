//! The portions of work that a worker has been given.

use kalmanscope_lab::fitted;
use web_time::{Duration, Instant};

/// The time of a portion: short, so that rows come often and the worker soon sees other messages.
const PORTION: Duration = Duration::from_millis(10);

/// A worker that takes longer for a portion is stuck, and may be replaced.
const LONG: Duration = Duration::from_millis(250);

/// Portions that a worker has at once, at least and at most, so that it has something to do while the page draws a frame.
const AT_ONCE: [usize; 2] = [2, 6];

/// Limits the time of all portions that a worker has, beyond the least number of them.
const AHEAD: Duration = Duration::from_millis(60);

/// Limits the size of a portion.
const MOST: usize = 4096;

/// The portions that a worker has, of cells or samples, and the size of the next one.
pub(super) struct Portions {
    /// When each portion was begun.
    given: Vec<Instant>,
    size: usize,
    /// The time that the last one took.
    last: Duration,
}

impl Portions {
    /// Nothing is given yet. The first portion has this size.
    pub(super) fn new(first: usize) -> Self {
        Self { given: Vec::new(), size: first, last: PORTION }
    }

    /// The size of a first portion where one unit takes this time \[s\] by estimate, so that each worker gets a share
    /// of the first units.
    pub(super) fn first(time: f64, units: usize, workers: usize) -> usize {
        let soon = (PORTION.as_secs_f64() / time) as usize;
        soon.min(units / (AT_ONCE[1] * workers)).clamp(1, MOST)
    }

    /// Whether the first portion has taken longer than [`LONG`].
    pub(super) fn is_stuck(&self) -> bool {
        self.given.first().is_some_and(|begin| begin.elapsed() > LONG)
    }

    /// Whether the worker has none.
    pub(super) fn is_empty(&self) -> bool {
        self.given.is_empty()
    }

    /// Whether there should be more.
    pub(super) fn want_more(&self) -> bool {
        let [least, most] = AT_ONCE;
        let count = self.given.len();
        count < least || (count < most && self.last * (count as u32 + 1) <= AHEAD)
    }

    /// The size of the next one.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Notes that one has been given.
    pub(super) fn give(&mut self) {
        self.given.push(Instant::now());
    }

    /// Notes that the first one is done, and fits the next one to the time that it took the worker \[ms\].
    pub(super) fn take_back(&mut self, taken: f64) {
        if self.given.is_empty() {
            return;
        }
        self.given.remove(0);
        // The next portion begins only now.
        if let Some(next) = self.given.first_mut() {
            *next = Instant::now();
        }
        self.last = Duration::try_from_secs_f64(1e-3 * taken).unwrap_or(PORTION);
        self.size = fitted(self.size, self.last, PORTION, [1, MOST]);
    }
}
