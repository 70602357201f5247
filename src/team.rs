//! A team does tasks beside the frames: the threads of the desktop, or the workers of a page. The frames do
//! the rest.

mod cells;
mod frames;
mod relay;
mod running;

use std::rc::Rc;
use std::time::Duration;

use egui::Context;
use kalmanscope_core::import::Loaded;
use kalmanscope_core::suggest::Suggestion;
use kalmanscope_core::{Pass, Record, Scenario, Tape};
use kalmanscope_lab::posterior::Sampled;
use kalmanscope_lab::{Parts, Step, Threads, Wanted};

pub use cells::{Cells, Computer, Finding, Graphics, Precision, Rows};
pub use frames::Frames;
pub use kalmanscope_lab::{Lost, Priority, Report};
pub use relay::Relay;
pub use running::Running;

pub const BETWEEN: Duration = Duration::from_millis(100);

/// The samples of a portion of a filter.
const PORTION: usize = 64;

pub trait Team {
    /// The threads of this machine, which do any task, and the screen that they wake.
    fn threads(&self) -> Option<(&Threads, &Context)> {
        None
    }

    fn is_beside(&self) -> bool {
        self.threads().is_some()
    }

    fn filter(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<Handle<Tape>> {
        let (threads, ctx) = self.threads()?;
        let step = filter_steps(scenario.clone(), place, record.clone());
        Some(threads.begin(Priority::Hand, [step], waking(ctx)).into())
    }

    /// Begins to read the file with these bytes, where that is no task of a thread.
    fn load(&self, _bytes: &[u8]) -> Option<Handle<Report<f64, Result<Loaded, String>>>> {
        None
    }

    /// Begins to make start values for a scenario on a record, where that is no task of a thread.
    fn suggest(&self, _scenario: &Scenario, _record: &Record) -> Option<Handle<Report<f64, Suggestion>>> {
        None
    }

    /// Begins to search points of the posterior of a scenario's first filter, given a record, where that is no task of a thread.
    fn posterior(&self, _scenario: &Scenario, _record: &Record) -> Option<Handle<Report<f64, Option<Sampled>>>> {
        None
    }

    fn cells(&self, cells: &Cells, ctx: &Context) -> Option<Handle<Rows>> {
        let (threads, _) = self.threads()?;
        let (by, ctx) = (Computer::Threads(threads.count()), ctx.clone());
        let Cells { runner, order, priority, .. } = cells.clone();
        let parts = threads.rows(priority, &runner, order, move |_| ctx.request_repaint());
        Some(Handle::new(move || {
            let slice = parts.take()?;
            Ok(slice.map(|slice| Rows { cells: slice.cells, numbers: slice.rows, by: by.clone() }))
        }))
    }

    fn graphics(&self) -> Option<Rc<dyn Graphics>> {
        None
    }

    /// The number of values on each axis of a new map, so that it is complete soon.
    fn usual_count(&self) -> usize {
        if self.threads().is_some() { 64 } else { 32 }
    }
}

/// Work of a team, the parts of which come one after the other. It ends when this is dropped.
pub struct Handle<T>(Box<dyn FnMut() -> Result<Option<T>, Lost>>);

impl<T> Handle<T> {
    pub fn new(take: impl FnMut() -> Result<Option<T>, Lost> + 'static) -> Self {
        Self(Box::new(take))
    }

    /// Takes the next part, if one has come.
    ///
    /// # Errors
    /// [`Lost`] if no more will come. The parts so far must be dropped, unless they are rows of cells.
    pub fn take(&mut self) -> Result<Option<T>, Lost> {
        (self.0)()
    }
}

impl<T: 'static> From<Parts<T>> for Handle<T> {
    fn from(parts: Parts<T>) -> Self {
        Self::new(move || parts.take())
    }
}

/// Wakes the screen: soon for the progress of a task, at once for its end.
fn waking(ctx: &Context) -> impl Fn(bool) + Send + Sync + 'static {
    let ctx = ctx.clone();
    move |is_over| if is_over { ctx.request_repaint() } else { ctx.request_repaint_after(BETWEEN) }
}

fn filter_steps(scenario: Scenario, place: usize, record: Record) -> impl FnMut(Wanted) -> Step<Tape> + Send {
    let mut pass = None;
    move |_| {
        if pass.is_none() {
            pass = Pass::new(&scenario, place, &record).ok();
        }
        let Some(pass) = &mut pass else { return Step::Failed };
        let mut tape = Tape::default();
        pass.follow(&record, pass.done() + PORTION, &mut tape);
        let is_over = pass.done() >= record.len() || pass.stop().is_some();
        if is_over { Step::Last(tape) } else { Step::Part(tape) }
    }
}
