//! A team of threads, which do tasks by priority.

use std::collections::BTreeMap;
use std::collections::btree_map::OccupiedEntry;
use std::io;
use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use kalmanscope_core::Task;

use crate::{Runner, Slice};

const PORTION: Duration = Duration::from_millis(25);

/// The urgency of a task. A team does tasks of the first kind before the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Priority {
    /// The user's last edit, or file.
    Hand,
    /// The cells of a map.
    Map,
    /// Runs with many seeds.
    Seeds,
    /// Causes of a bad verdict.
    Causes,
}

/// The result of a portion of work.
pub enum WorkStep<T> {
    /// A part; there is more to do.
    Part(T),
    /// The last part.
    Last(T),
    /// Nothing: all is done.
    End,
    /// The work cannot be done.
    Failed,
}

/// A message of a task under way.
#[derive(Clone, Debug, PartialEq)]
pub enum Report<L, O> {
    /// The state of the task, such as the share that is done.
    Look(L),
    /// The outcome.
    Done(O),
}

/// Work has failed, and no more of it will come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost;

/// The threads that do all tasks of a program.
pub struct Threads {
    queue: Arc<Queue>,
    /// The number of threads for all tasks.
    pub count: usize,
    threads: Vec<JoinHandle<()>>,
}

/// Whether work is still wanted.
pub struct WorkToken(Arc<ThreadState>);

/// The parts of work on threads. It ends when this is dropped: no portion begins after that.
pub struct WorkParts<T> {
    parts: Receiver<T>,
    state: Arc<ThreadState>,
}

/// A panic, or the end of the team, leaves work unfinished; its user gets a report.
struct Unfinished<T> {
    sender: Sender<T>,
    state: Arc<ThreadState>,
    wake: Arc<dyn Fn(bool) + Send + Sync>,
    is_finished: bool,
}

#[derive(Default)]
struct ThreadState {
    is_unwanted: AtomicBool,
    is_lost: AtomicBool,
}

type Portion = Box<dyn FnMut() -> bool + Send>;

#[derive(Default)]
struct Queue {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Default)]
struct Waiting {
    portions: BTreeMap<(Priority, u64), Portion>,
    last: u64,
    is_over: bool,
}

impl Threads {
    /// A team of `count` threads, 0 for one a processor, and of some for the user's hand alone, which waits for no map.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn new(count: usize, for_hand: usize) -> io::Result<Self> {
        let count = if count == 0 { processors() } else { count };
        let mut team = Self { queue: Arc::default(), count, threads: Vec::new() };
        for nth in 0..count + for_hand {
            let (queue, lowest) =
                (Arc::clone(&team.queue), if nth < count { Priority::Causes } else { Priority::Hand });
            let thread = thread::Builder::new().name(format!("worker {nth}"));
            team.threads.push(thread.spawn(move || queue.serve(lowest))?);
        }
        Ok(team)
    }

    /// Ends the team, and waits until it has ended.
    pub fn end(mut self) {
        let threads = std::mem::take(&mut self.threads);
        drop(self);
        threads.into_iter().for_each(|thread| _ = thread.join());
    }

    /// Begins work that some steps do side by side. `wake` is called after each part, and with true at an end.
    pub fn begin<T: Send + 'static, S: FnMut(WorkToken) -> WorkStep<T> + Send + 'static>(
        &self,
        priority: Priority,
        steps: impl IntoIterator<Item = S>,
        wake: impl Fn(bool) + Send + Sync + 'static,
    ) -> WorkParts<T> {
        let (sender, parts) = mpsc::channel();
        let state = Arc::<ThreadState>::default();
        let wake: Arc<dyn Fn(bool) + Send + Sync> = Arc::new(wake);
        for mut step in steps {
            let (sender, state, wake) = (sender.clone(), Arc::clone(&state), Arc::clone(&wake));
            let mut work = Unfinished { sender, state, wake, is_finished: false };
            let portion = move || {
                let wanted = WorkToken(Arc::clone(&work.state));
                if !wanted.is_so() {
                    return false;
                }
                let (part, goes_on) = match step(wanted) {
                    WorkStep::Part(part) => (Some(part), true),
                    WorkStep::Last(part) => (Some(part), false),
                    WorkStep::End => (None, false),
                    WorkStep::Failed => return false,
                };
                work.is_finished = !goes_on;
                let is_wanted = part.is_none_or(|part| work.sender.send(part).is_ok());
                (work.wake)(!goes_on);
                goes_on && is_wanted
            };
            self.queue.lock().put(priority, Box::new(portion));
        }
        self.queue.changed.notify_all();
        WorkParts { parts, state }
    }

    /// Begins a task. After each portion it sends what `look` sees of it, and its outcome at the end.
    pub fn task<T: Task<Outcome: Send> + Send + 'static, L: Send + 'static>(
        &self,
        priority: Priority,
        task: T,
        look: fn(&T) -> L,
        wake: impl Fn(bool) + Send + Sync + 'static,
    ) -> WorkParts<Report<L, T::Outcome>> {
        let (mut task, mut is_done) = (Some(task), false);
        let step = move |wanted: WorkToken| {
            if is_done {
                return task.take().map_or(WorkStep::End, |task| WorkStep::Last(Report::Done(task.finish())));
            }
            let Some(task) = &mut task else { return WorkStep::End };
            let begin = Instant::now();
            is_done = task.advance(&mut || begin.elapsed() < PORTION && wanted.is_so());
            WorkStep::Part(Report::Look(look(task)))
        };
        self.begin(priority, [step], wake)
    }

    /// Begins to run cells in the given order.
    pub fn rows(
        &self,
        priority: Priority,
        runner: &Arc<Runner>,
        order: Vec<usize>,
        wake: impl Fn(bool) + Send + Sync + 'static,
    ) -> WorkParts<Slice> {
        let portion = order.first().map_or(1, |cell| runner.at_once(*cell));
        let order = Arc::new((order, AtomicUsize::new(0)));
        let step = |_| {
            let (runner, order) = (Arc::clone(runner), Arc::clone(&order));
            move |_| {
                let (order, next) = &*order;
                let from = next.fetch_add(portion, Ordering::Relaxed);
                let Some(cells) = order.get(from..(from + portion).min(order.len())).filter(|c| !c.is_empty()) else {
                    return WorkStep::End;
                };
                WorkStep::Part(Slice { cells: cells.to_vec(), rows: runner.rows(cells) })
            }
        };
        self.begin(priority, (0..self.count).map(step), wake)
    }
}

/// The number of processors; a browser has one.
pub fn processors() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// Does some work on all items, and returns its results in their order. Threads share the items, `least` or more each.
pub fn in_parts<T: Sync, R: Send>(
    items: &[T],
    threads: usize,
    least: usize,
    work: impl Fn(&[T]) -> Vec<R> + Sync,
) -> Vec<R> {
    let each = items.len().div_ceil(threads).max(least);
    let (own, others) = items.split_at(items.len().min(each));
    if others.is_empty() {
        return work(own);
    }
    let work = &work;
    thread::scope(|scope| {
        let begin = |part| thread::Builder::new().spawn_scoped(scope, move || work(part)).map_err(|_| part);
        let begun: Vec<_> = others.chunks(each).map(begin).collect();
        let mut all = work(own);
        for other in begun {
            all.extend(match other {
                Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
                Err(part) => work(part),
            });
        }
        all
    })
}

impl<T> Drop for Unfinished<T> {
    fn drop(&mut self) {
        if !self.is_finished {
            self.state.is_lost.store(true, Ordering::Release);
            (self.wake)(true);
        }
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        let mut waiting = self.queue.lock();
        waiting.is_over = true;
        let unfinished = std::mem::take(&mut waiting.portions);
        drop(waiting);
        drop(unfinished);
        self.queue.changed.notify_all();
    }
}

impl WorkToken {
    /// Whether it is.
    pub fn is_so(&self) -> bool {
        !self.0.is_unwanted.load(Ordering::Relaxed)
    }
}

impl<T> WorkParts<T> {
    /// The next part, if one has come.
    ///
    /// # Errors
    /// [`Lost`] if no more will come because the work has failed.
    pub fn take(&self) -> Result<Option<T>, Lost> {
        match self.parts.try_recv() {
            Ok(part) => Ok(Some(part)),
            Err(_) if self.state.is_lost.load(Ordering::Acquire) => Err(Lost),
            Err(_) => Ok(None),
        }
    }

    /// Waits for the next part; `None` after the last one.
    pub fn wait(&self) -> Option<T> {
        self.parts.recv().ok()
    }
}

impl<T> Drop for WorkParts<T> {
    fn drop(&mut self) {
        self.state.is_unwanted.store(true, Ordering::Relaxed);
    }
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn serve(&self, lowest: Priority) {
        let mut waiting = self.lock();
        while !waiting.is_over {
            let next = waiting.portions.first_entry().filter(|next| next.key().0 <= lowest);
            let Some(((priority, _), mut portion)) = next.map(OccupiedEntry::remove_entry) else {
                waiting = self.changed.wait(waiting).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            drop(waiting);
            // A panic is the end of this work alone.
            let goes_on = catch_unwind(AssertUnwindSafe(&mut portion)).unwrap_or(false);
            // Work that has ended frees its memory before the queue is locked.
            let rest = goes_on.then_some(portion);
            waiting = self.lock();
            // A team that is over has nobody for the rest, which is dropped and so reported.
            if let Some(portion) = rest.filter(|_| !waiting.is_over) {
                waiting.put(priority, portion);
            }
        }
    }
}

impl Waiting {
    fn put(&mut self, priority: Priority, portion: Portion) {
        self.last += 1;
        self.portions.insert((priority, self.last), portion);
    }
}
