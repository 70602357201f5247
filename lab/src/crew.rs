//! Work on an ensemble in the background, on several threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::{Runner, Slice};

/// Limits the time between two portions of rows from one thread, unless the cells that it computes at once take longer.
const PORTION: Duration = Duration::from_millis(25);

/// The cells of the first portions: as many as run side by side, at most.
const FIRST: usize = 8;

/// The threads that serve all ensembles of a program.
pub struct Crew {
    pool: ThreadPool,
}

/// The work on one ensemble. It ends when it is dropped: no cell begins after that.
pub struct Work {
    slices: Receiver<Slice>,
    is_wanted: Arc<AtomicBool>,
}

impl Crew {
    /// A crew of this many threads; 0 for one a processor.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn new(threads: usize) -> Result<Self, ThreadPoolBuildError> {
        let name = |nth| format!("laboratory {nth}");
        Ok(Self { pool: ThreadPoolBuilder::new().num_threads(threads).thread_name(name).build()? })
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Begins to run cells in the given order, and calls `wake` after each portion.
    pub fn start(&self, runner: &Arc<Runner>, order: Vec<usize>, wake: impl Fn() + Send + Sync + 'static) -> Work {
        let (sender, slices) = mpsc::channel();
        let is_wanted = Arc::new(AtomicBool::new(true));
        let queue = Arc::new(Queue { order, next: AtomicUsize::new(0), is_wanted: Arc::clone(&is_wanted) });
        let wake = Arc::new(wake);
        for _ in 0..self.threads() {
            let (runner, queue, sender, wake) =
                (Arc::clone(runner), Arc::clone(&queue), sender.clone(), Arc::clone(&wake));
            self.pool.spawn(move || queue.serve(&runner, &sender, &*wake));
        }
        Work { slices, is_wanted }
    }
}

impl Work {
    /// The rows that have been computed since the last call.
    pub fn poll(&self) -> impl Iterator<Item = Slice> {
        self.slices.try_iter()
    }

    /// Waits for the next rows; `None` after the last ones.
    pub fn wait(&self) -> Option<Slice> {
        self.slices.recv().ok()
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        self.is_wanted.store(false, Ordering::Relaxed);
    }
}

struct Queue {
    order: Vec<usize>,
    next: AtomicUsize,
    is_wanted: Arc<AtomicBool>,
}

impl Queue {
    fn serve(&self, runner: &Runner, sender: &Sender<Slice>, wake: &dyn Fn()) {
        let (mut portion, mut at_once) = (FIRST, None);
        while self.is_wanted.load(Ordering::Relaxed) {
            let from = self.next.fetch_add(portion, Ordering::Relaxed);
            let Some(cells) = self.order.get(from..(from + portion).min(self.order.len())).filter(|c| !c.is_empty())
            else {
                break;
            };
            let begin = Instant::now();
            let rows = runner.rows(cells);
            if sender.send(Slice { cells: cells.to_vec(), rows }).is_err() {
                break;
            }
            wake();
            let taken = begin.elapsed();
            if taken < PORTION / 2 {
                portion *= 2;
            } else if taken > PORTION * 2 && portion > 1 {
                let at_once = *at_once.get_or_insert_with(|| cells.first().map_or(1, |&cell| runner.at_once(cell)));
                portion = (portion / 2).max(at_once);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ensemble, Measure, Plan, Sheet};
    use kalmanscope_core::{Axis, Scenario, Source};

    fn runner() -> Arc<Runner> {
        let scenario = Scenario { duration: 3.0, ..Scenario::default() };
        let axes = vec![
            Axis::parse("seed=1:3:3").unwrap(),
            Axis::parse("filters.EKF.initial_mean.natural_frequency=2:20:40").unwrap(),
        ];
        let plan =
            Plan { filters: vec![0], measures: vec![Measure::Nis, Measure::LogLikelihood], axes, ..Plan::default() };
        Arc::new(Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap())
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let runner = runner();
        let cells: Vec<usize> = (0..runner.ensemble().cells()).collect();
        let expected = runner.rows(&cells);
        for threads in [1, 2, 5] {
            let work = Crew::new(threads).unwrap().start(&runner, runner.ensemble().coarse_to_fine(), || {});
            let mut sheet = Sheet::new(runner.ensemble());
            while let Some(Slice { cells, rows }) = work.wait() {
                sheet.fill(&cells, &rows);
            }
            assert!(sheet.is_complete());
            let rows: Vec<f64> = cells.iter().flat_map(|&cell| sheet.row(cell).unwrap().to_vec()).collect();
            assert_eq!(rows, expected);
        }
    }

    #[test]
    fn dropped_work_ends() {
        let crew = Crew::new(1).unwrap();
        let runner = runner();
        let order: Vec<usize> = (0..120).cycle().take(2_000_000).collect();
        let work = crew.start(&runner, order, || {});
        assert!(work.wait().is_some());
        drop(work);
        // The only thread is free again for the next work.
        let next = crew.start(&runner, vec![5], || {});
        assert_eq!(next.wait().unwrap(), Slice { cells: vec![5], rows: runner.rows(&[5]) });
        assert!(next.wait().is_none());
    }
}
