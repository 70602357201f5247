//! Work on two processors.

use std::sync::atomic::{AtomicUsize, Ordering};

pub(crate) fn on_two_threads<T: Sync, R: Send>(jobs: &[T], outcome: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let work = || {
        let take = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|place| *place < jobs.len());
        std::iter::from_fn(take).map(|place| (place, outcome(&jobs[place]))).collect::<Vec<_>>()
    };
    let mut done: Vec<(usize, R)> = std::thread::scope(|scope| {
        let threads = [0, 1].map(|_| scope.spawn(work));
        threads.into_iter().flat_map(|thread| thread.join().expect("no thread panics")).collect()
    });
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, outcome)| outcome).collect()
}
