//! Long filters, large files and start values on threads of this machine, beside the frames.

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
use kalmanscope_core::{InSlices, Pass, Record, Scenario, Tape};

/// The time of a portion: parts come soon, and work that is given up ends soon.
const PORTION: Duration = Duration::from_millis(10);

/// Limits the parts that wait to be taken: a thread that is ahead of the frames waits.
const WAITING: usize = 64;

/// Limits the samples of a portion.
const MOST: usize = 4096;

/// Threads for long work, one an errand; as many at once as there are processors beside that of the frames.
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
    /// Begins work on a thread; none where the system gives no thread. The work returns false where it cannot be done.
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
            // The frame that takes the last part, or notices that there is none.
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
    fn begin_slices<S: InSlices + Send + 'static, T: Send + 'static>(
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

/// The way of parts from a thread to the frames. After the last one comes `None`.
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
mod tests {
    use kalmanscope::session::{Budget, Mode, Session};
    use kalmanscope_core::{FilterKind, FilterSettings, Run};

    use super::*;

    /// Limits the time until work is done, on a slow machine.
    const PATIENCE: Duration = Duration::from_secs(120);

    /// A whole record of a cheap filter and of particle filters, which take long.
    fn scenario() -> Scenario {
        let mut scenario = Scenario { duration: 40.0, ..Scenario::default() };
        scenario.filters.truncate(1);
        for size in [1000, 1500] {
            let name = format!("PF {size}");
            let filter = FilterSettings {
                id: 0,
                name,
                kind: FilterKind::PF,
                ensemble_size: size,
                ..scenario.filters[0].clone()
            };
            scenario.filters.push(filter);
        }
        scenario.number_filters();
        scenario
    }

    fn session(scenario: Scenario) -> Session {
        let mut session = Session::new(scenario).expect("it can be run");
        session.pause();
        session.set_budget(Budget::FRAME);
        session.compute_elsewhere(errands(&Context::default()));
        session.set_mode(Mode::Whole);
        session
    }

    /// Lets frames pass until all is computed; returns the shares that they show.
    fn wait(session: &mut Session) -> Vec<f64> {
        let (begin, mut shares) = (Instant::now(), Vec::new());
        while let Some(share) = session.progress() {
            shares.push(share);
            session.advance(0.1);
            thread::sleep(Duration::from_millis(2));
            assert!(begin.elapsed() < PATIENCE, "{shares:?}");
        }
        shares
    }

    fn assert_right(session: &Session) {
        let mut at_once = Session::new(session.scenario().clone()).expect("it can be run");
        at_once.set_mode(Mode::Whole);
        assert!(!session.behind() && session.run().scenario() == session.scenario());
        assert_eq!(session.run().checksum(), at_once.run().checksum());
    }

    #[test]
    fn long_filters_on_threads_have_the_bits_of_those_in_the_frames() {
        let mut session = session(scenario());
        let shares = wait(&mut session);
        assert!(shares.len() > 3 && shares.is_sorted(), "{shares:?}");
        assert_right(&session);
        // An edit while a thread is busy gives that work up.
        session.set_scenario(Scenario { seed: 7, ..session.scenario().clone() });
        session.advance(0.1);
        session.set_scenario(Scenario { seed: 8, ..session.scenario().clone() });
        wait(&mut session);
        assert_right(&session);
        // Esc keeps the picture before.
        session.set_scenario(Scenario { seed: 9, ..session.scenario().clone() });
        session.advance(0.1);
        assert!(session.cancel());
        assert_eq!(session.run().scenario().seed, 8);
    }

    #[test]
    fn files_and_start_values_come_from_threads_as_from_the_frames() {
        let errands = errands(&Context::default());
        let mut text = "t,force,displacement\n".to_owned();
        let scenario = Scenario { duration: 200.0, ..Scenario::default() };
        let record = record(&scenario);
        for k in 0..record.len() {
            text.push_str(&format!("{},{},{}\n", record.time(k), record.force(k), record.measured(0)[k]));
        }
        let mut shares = Vec::new();
        let loaded = outcome(errands.loading(text.as_bytes()).expect("there is a thread"), &mut shares);
        let here = finished(Loading::new(text.clone().into_bytes())).map_err(|error| error.to_string());
        assert_eq!(loaded, here);
        assert!(shares.is_sorted() && shares.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
        let bad = outcome(errands.loading(b"").expect("there is a thread"), &mut shares);
        assert_eq!(bad, finished(Loading::new(Vec::new())).map_err(|error| error.to_string()));
        assert!(bad.is_err());

        let suggest = errands.suggest(&scenario, &record).expect("there is a thread");
        let suggestion = outcome(suggest, &mut shares);
        assert_eq!(suggestion, finished(Suggest::new(&scenario, record.clone())));
    }

    #[test]
    fn work_that_cannot_be_done_is_lost_and_a_thread_that_is_given_up_ends() {
        let errands = Errands {
            desks: Arc::new(Desks { free: Mutex::new(1), given_back: Condvar::new() }),
            ctx: Context::default(),
        };
        let record = record(&Scenario { duration: 1.0, ..Scenario::default() });
        let mut none = errands.filter(&Scenario::default(), 99, &record).expect("there is a thread");
        let begin = Instant::now();
        while none.next() != Err(Lost) {
            assert!(begin.elapsed() < PATIENCE);
        }
        // Endless work, given up, makes room for the next.
        let endless = errands.begin("endless", |parts: &Parts<u8>| {
            while parts.put(1) {}
            false
        });
        drop(endless);
        let mut next = errands.begin("next", |parts: &Parts<u8>| parts.put(2)).expect("there is a thread");
        while next.next() != Ok(Some(2)) {
            assert!(begin.elapsed() < PATIENCE);
            thread::sleep(Duration::from_millis(1));
        }
        while Arc::strong_count(&errands.desks) > 1 {
            assert!(begin.elapsed() < PATIENCE);
            thread::sleep(Duration::from_millis(1));
        }
        assert_eq!((next.next(), next.next()), (Ok(None), Ok(None)), "the end is no loss");
    }

    fn record(scenario: &Scenario) -> Record {
        let mut run = Run::new(scenario).expect("it can be run");
        run.finish();
        run.record().clone()
    }

    fn finished<S: InSlices>(mut work: S) -> S::Outcome {
        while !work.advance(&mut || true) {}
        work.finish()
    }

    fn outcome<T>(mut work: Box<dyn Work<Report<T>>>, shares: &mut Vec<f64>) -> T {
        shares.clear();
        let begin = Instant::now();
        loop {
            match work.next() {
                Ok(Some(Report::Done(outcome))) => return outcome,
                Ok(Some(Report::Share(share))) => shares.push(share),
                Ok(None) => thread::sleep(Duration::from_millis(1)),
                Err(Lost) => panic!("it is lost"),
            }
            assert!(begin.elapsed() < PATIENCE);
        }
    }
}
