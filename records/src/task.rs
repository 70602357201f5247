//! Long work that continues while there is time.

use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context, Poll, Waker};

/// Long work that continues while there is time, and then has an outcome. The core has no clock: the caller decides when
/// the time is up. The outcome has the same bits however the work is divided.
pub trait Task {
    /// The result of the work.
    type Outcome;

    /// The share that is done, from 0 to 1.
    fn progress(&self) -> f64;

    /// Continues until `while_time` returns false, which is called about every millisecond. Returns whether all is done.
    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool;

    /// The outcome, once all is done.
    fn finish(self) -> Self::Outcome;

    /// All of it in one go.
    fn run(mut self) -> Self::Outcome
    where
        Self: Sized,
    {
        while !self.advance(&mut || true) {}
        self.finish()
    }
}

/// A task that an async function does, which leaves its work at each [`pause`].
// The compiler makes the machine of stages that would stand here otherwise, in the order of the work.
pub struct Work<T> {
    rest: Pin<Box<dyn Future<Output = T> + Send>>,
    progress: Progress,
    outcome: Option<T>,
}

impl<T> Work<T> {
    /// Work of which nothing is done yet.
    pub fn new<F: Future<Output = T> + Send + 'static>(work: impl FnOnce(Progress) -> F) -> Self {
        let progress = Progress::default();
        Self { rest: Box::pin(work(progress.clone())), progress, outcome: None }
    }
}

impl<T: Send + 'static> Work<T> {
    /// The same work with another outcome.
    pub fn map<U>(self, change: impl FnOnce(T) -> U + Send + 'static) -> Work<U> {
        let progress = self.progress.clone();
        let rest = Box::pin(async move { change(if let Some(done) = self.outcome { done } else { self.rest.await }) });
        Work { rest, progress, outcome: None }
    }
}

impl<T> Task for Work<T> {
    type Outcome = T;

    fn progress(&self) -> f64 {
        if self.outcome.is_some() { 1.0 } else { f64::from_bits(self.progress.0.load(Ordering::Relaxed)) }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.outcome.is_none() {
            match self.rest.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
                Poll::Ready(outcome) => self.outcome = Some(outcome),
                Poll::Pending if while_time() => {}
                Poll::Pending => break,
            }
        }
        self.outcome.is_some()
    }

    fn finish(self) -> T {
        self.outcome.unwrap_or_else(|| at_once(self.rest))
    }
}

/// Does work without a pause.
pub fn at_once<T>(work: impl Future<Output = T>) -> T {
    let mut work = pin!(work);
    loop {
        if let Poll::Ready(outcome) = work.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return outcome;
        }
    }
}

/// The share of some work that is done.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<AtomicU64>);

impl Progress {
    /// From 0 to 1.
    pub fn set(&self, share: f64) {
        self.0.store(share.to_bits(), Ordering::Relaxed);
    }
}

/// Leaves the work here, until the task continues.
pub async fn pause() {
    let mut has_left = false;
    poll_fn(|_| if std::mem::replace(&mut has_left, true) { Poll::Ready(()) } else { Poll::Pending }).await;
}
