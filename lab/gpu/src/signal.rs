//! A value that a callback sets and a task waits for.

use std::future::poll_fn;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};

/// A value that comes later.
pub(crate) struct Signal<T>(Arc<Mutex<(Option<T>, Option<Waker>)>>);

impl<T> Signal<T> {
    pub(crate) fn new() -> Self {
        Self(Arc::new(Mutex::new((None, None))))
    }

    /// Sets the value.
    pub(crate) fn set(&self, value: T) {
        let waker = {
            let mut both = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            both.0 = Some(value);
            both.1.take()
        };
        if let Some(waker) = waker {
            waker.wake();
        }
    }

    /// Waits for the value.
    pub(crate) async fn get(self) -> T {
        poll_fn(|context| {
            let mut both = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            match both.0.take() {
                Some(value) => Poll::Ready(value),
                None => {
                    both.1 = Some(context.waker().clone());
                    Poll::Pending
                }
            }
        })
        .await
    }
}

impl<T> Clone for Signal<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}
