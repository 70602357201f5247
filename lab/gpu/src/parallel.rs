//! Work on the processor beside that of the graphics processor, by all of its cores.

/// The least that is worth a thread.
#[cfg(not(target_arch = "wasm32"))]
const LEAST: usize = 256;

/// Does some work on all items and returns its results in their order. Each core takes a part of the items.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn in_parts<T: Sync, R: Send>(items: &[T], work: impl Fn(&[T]) -> Vec<R> + Sync) -> Vec<R> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let part = items.len().div_ceil(cores).max(LEAST);
    if items.len() <= part {
        return work(items);
    }
    let work = &work;
    std::thread::scope(|scope| {
        let threads: Vec<_> = items.chunks(part).map(|items| scope.spawn(move || work(items))).collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, Vec<R>>| {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        threads.into_iter().flat_map(join).collect()
    })
}

/// A worker of a page has one thread.
#[cfg(target_arch = "wasm32")]
pub(crate) fn in_parts<T, R>(items: &[T], work: impl Fn(&[T]) -> Vec<R>) -> Vec<R> {
    work(items)
}
