//! Long filters, large files and start values on threads of this machine, outside the frames.

use std::num::NonZero;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender, TryRecvError};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use egui::Context;
use kalmanscope::elsewhere::{Elsewhere, FilterWork, LoadingWork, Lost, Report, SuggestWork, Work};
use kalmanscope_core::import::Loading;
use kalmanscope_core::suggest::Suggest;
use kalmanscope_core::{Pass, Record, Scenario, Tape, Task};

/// The time of a portion: parts come soon, and work that is given up ends soon.
const PORTION: Duration = Duration::from_millis(10);

/// Limits the parts that wait to be taken: a thread that is ahead of the frames waits.
const WAITING: usize = 64;

/// Limits the samples of a portion.
const MOST: usize = 4096;

/// Threads for long work, one an errand; at most one per processor, less the one for the frames.
struct Errands {
    desks: Arc<Desks>,
    ctx: Context,
}

/// The number of errands that may be under way at once.
struct Desks {
    free: Mutex<usize>,
    given_back: Condvar,
}

/// The place of one errand among them.
struct Desk(Arc<Desks>);

/// Threads for long filters and imports.
pub(super) fn errands(ctx: &Context) -> Rc<dyn Elsewhere> {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let free = Mutex::new(processors.saturating_sub(1).max(1));
    Rc::new(Errands { desks: Arc::new(Desks { free, given_back: Condvar::new() }), ctx: ctx.clone() })
}

impl Errands {
    /// Begins work on a thread. `None` if the system gives no thread. The work returns false if it cannot be done.
    fn begin<T: Send + 'static>(
        &self,
        name: &str,
        work: impl FnOnce(&Parts<T>) -> bool + Send + 'static,
    ) -> Option<Box<dyn Work<T>>> {
        let (sender, parts) = mpsc::sync_channel(WAITING);
        let is_wanted = Arc::new(AtomicBool::new(true));
        let out = Parts { sender, is_wanted: Arc::clone(&is_wanted), ctx: self.ctx.clone() };
        let desks = Arc::clone(&self.desks);
        let run = move || {
            let _desk = Desk::take(desks);
            if out.is_wanted() && work(&out) {
                out.sender.send(None).ok();
            }
            // Asks for the frame that takes the last part, or notices that there is none.
            out.ctx.request_repaint();
        };
        match thread::Builder::new().name(name.to_owned()).spawn(run) {
            Ok(_) => Some(Box::new(OnThread { parts, is_wanted, is_done: false })),
            Err(error) => {
                log::warn!("Long work stays in the frames: {error}");
                None
            }
        }
    }

    /// Begins work with an outcome.
    fn begin_slices<S: Task + Send + 'static, T: Send + 'static>(
        &self,
        name: &str,
        begin: impl FnOnce() -> S + Send + 'static,
        outcome: fn(S::Outcome) -> T,
    ) -> Option<Box<dyn Work<Report<T>>>> {
        self.begin(name, move |parts| {
            let mut work = begin();
            loop {
                let begin = Instant::now();
                if work.advance(&mut || begin.elapsed() < PORTION) {
                    return parts.put(Report::Done(outcome(work.finish())));
                }
                if !parts.put(Report::Share(work.progress())) {
                    return false;
                }
            }
        })
    }
}

impl Elsewhere for Errands {
    fn filter(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<FilterWork> {
        let (scenario, record) = (scenario.clone(), record.clone());
        self.begin("filter", move |parts| {
            let Ok(mut pass) = Pass::new(&scenario, place, &record) else { return false };
            let mut size = 16;
            while pass.done() < record.len() {
                let (begin, mut tape) = (Instant::now(), Tape::default());
                pass.follow(&record, pass.done() + size, &mut tape);
                if !parts.put(tape) {
                    return false;
                }
                if pass.stop().is_some() {
                    break;
                }
                let taken = begin.elapsed();
                if taken < PORTION / 2 {
                    size = (2 * size).min(MOST);
                } else if taken > 2 * PORTION {
                    size = (size / 2).max(1);
                }
            }
            true
        })
    }

    fn loading(&self, bytes: &[u8]) -> Option<LoadingWork> {
        let bytes = bytes.to_vec();
        self.begin_slices("file", || Loading::new(bytes), |loaded| loaded.map_err(|error| error.to_string()))
    }

    fn suggest(&self, scenario: &Scenario, record: &Record) -> Option<SuggestWork> {
        let (scenario, record) = (scenario.clone(), record.clone());
        self.begin_slices("start values", move || Suggest::new(&scenario, record), |suggestion| suggestion)
    }
}

impl Desk {
    /// Waits for a free one.
    fn take(desks: Arc<Desks>) -> Self {
        let mut free = desks.free.lock().unwrap_or_else(PoisonError::into_inner);
        while *free == 0 {
            free = desks.given_back.wait(free).unwrap_or_else(PoisonError::into_inner);
        }
        *free -= 1;
        drop(free);
        Self(desks)
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        *self.0.free.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.0.given_back.notify_one();
    }
}

/// The queue of parts from a thread to the frames. After the last one comes `None`.
struct Parts<T> {
    sender: SyncSender<Option<T>>,
    is_wanted: Arc<AtomicBool>,
    ctx: Context,
}

impl<T> Parts<T> {
    fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Relaxed)
    }

    /// Hands over a part. Returns whether the work is still wanted.
    fn put(&self, part: T) -> bool {
        self.is_wanted() && self.sender.send(Some(part)).is_ok()
    }
}

/// Work on a thread. It is given up when this is dropped.
struct OnThread<T> {
    parts: Receiver<Option<T>>,
    is_wanted: Arc<AtomicBool>,
    is_done: bool,
}

impl<T> Work<T> for OnThread<T> {
    fn next(&mut self) -> Result<Option<T>, Lost> {
        if self.is_done {
            return Ok(None);
        }
        match self.parts.try_recv() {
            Ok(Some(part)) => Ok(Some(part)),
            Ok(None) => {
                self.is_done = true;
                Ok(None)
            }
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(Lost),
        }
    }
}

impl<T> Drop for OnThread<T> {
    fn drop(&mut self) {
        self.is_wanted.store(false, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests;
