//! A team does tasks beside the frames: the threads of the desktop, or the workers of a page. The frames do
//! the rest.

mod dispatch;
mod running;

use std::fmt;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use egui::Context;
use kalmanscope_core::import::Loaded;
use kalmanscope_core::suggest::Suggestion;
use kalmanscope_core::{Pass, Record, Scenario, Tape, Task as _};
use kalmanscope_lab::{Runner, Threads, WorkParts, WorkStep, WorkToken, cell_task};
use serde::{Deserialize, Serialize};
use web_time::Instant;

pub use dispatch::Dispatch;
pub use kalmanscope_lab::{Lost, Priority, Report};
pub use running::RunningTask;

pub const BETWEEN: Duration = Duration::from_millis(100);

const PORTION: usize = 64;

pub trait Team {
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

    fn load(&self, _bytes: &[u8]) -> Option<Handle<Report<f64, Result<Loaded, String>>>> {
        None
    }

    fn suggest(&self, _scenario: &Scenario, _record: &Record) -> Option<Handle<Report<f64, Suggestion>>> {
        None
    }

    fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>> {
        let (threads, _) = self.threads()?;
        let (by, ctx) = (Computer::Threads(threads.count), ctx.clone());
        let CellBatch { runner, order, priority, .. } = cells.clone();
        let parts = threads.rows(priority, &runner, order, move |_| ctx.request_repaint());
        Some(Handle::new(move || {
            let slice = parts.take()?;
            Ok(slice.map(|slice| CellRows { cells: slice.cells, numbers: slice.rows, by: by.clone() }))
        }))
    }

    fn graphics(&self) -> Option<Rc<dyn Graphics>> {
        None
    }

    fn usual_count(&self) -> usize {
        if self.threads().is_some() { 64 } else { 32 }
    }
}

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

impl<T: 'static> From<WorkParts<T>> for Handle<T> {
    fn from(parts: WorkParts<T>) -> Self {
        Self::new(move || parts.take())
    }
}

fn waking(ctx: &Context) -> impl Fn(bool) + Send + Sync + 'static {
    let ctx = ctx.clone();
    // The end is shown at once, progress ten times a second: frames take time from the threads.
    move |is_over| if is_over { ctx.request_repaint() } else { ctx.request_repaint_after(BETWEEN) }
}

fn filter_steps(scenario: Scenario, place: usize, record: Record) -> impl FnMut(WorkToken) -> WorkStep<Tape> + Send {
    let mut pass = None;
    move |_| {
        if pass.is_none() {
            pass = Pass::new(&scenario, place, &record).ok();
        }
        let Some(pass) = &mut pass else { return WorkStep::Failed };
        let mut tape = Tape::default();
        pass.follow(&record, pass.done() + PORTION, &mut tape);
        let is_over = pass.done() >= record.len() || pass.stop.is_some();
        if is_over { WorkStep::Last(tape) } else { WorkStep::Part(tape) }
    }
}

#[derive(Clone)]
pub struct CellBatch {
    pub runner: Arc<Runner>,
    pub order: Vec<usize>,
    pub precision: Precision,
    pub priority: Priority,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    #[default]
    Fastest,
    Double,
}

impl Precision {
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct CellRows {
    pub cells: Vec<usize>,
    pub numbers: Vec<f64>,
    pub by: Computer,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Computer {
    Frames,
    Threads(usize),
    Workers(usize),
    Graphics(Arc<str>),
}

impl fmt::Display for Computer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let several = |n: usize| if n == 1 { "" } else { "s" };
        match self {
            Self::Frames => write!(f, "by this program between frames"),
            Self::Threads(n) => write!(f, "by {n} thread{}", several(*n)),
            Self::Workers(n) => write!(f, "by {n} worker{}", several(*n)),
            Self::Graphics(name) => write!(f, "in single precision by {name}"),
        }
    }
}

pub trait Graphics {
    fn find(&self, ctx: &Context) -> Finding;

    fn found(&self) -> Finding;

    fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>>;
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    Searching,
    Ready,
    Absent(String),
    Lost(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    Unlimited,
    Time(Duration),
    Pieces(usize),
}

impl Budget {
    /// A frame computes for at most 12 ms, and draws charts again for at most 12 ms, so that it takes no more than 50
    /// ms in all.
    pub const FRAME: Self = Self::Time(Duration::from_millis(12));

    pub(crate) fn allows(self, spent: Duration) -> bool {
        match self {
            Self::Time(time) => spent < time,
            Self::Unlimited | Self::Pieces(_) => true,
        }
    }

    pub(crate) fn slice(self) -> impl FnMut() -> bool {
        let begin = Instant::now();
        let mut pieces = 0;
        move || match self {
            Self::Unlimited => true,
            Self::Time(time) => begin.elapsed() < time,
            Self::Pieces(most) => {
                pieces += 1;
                pieces < most
            }
        }
    }
}

pub struct Frames(pub Budget);

impl Frames {
    /// The slice of a frame that leaves time to draw it.
    pub const FRAME: Self = Self(Budget::Time(Duration::from_millis(8)));
}

impl Team for Frames {
    fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>> {
        let Self(budget) = *self;
        let (CellBatch { runner, order, .. }, ctx) = (cells.clone(), ctx.clone());
        // The place of the next cell in the order, and that cell if it is under way.
        let (mut next, mut under_way) = (0, None);
        let mut is_over = false;
        Some(Handle::new(move || {
            // After the rows of a slice comes nothing until the next frame.
            if std::mem::take(&mut is_over) {
                return Ok(None);
            }
            let begin = next;
            let mut while_time = budget.slice();
            let mut numbers = Vec::new();
            while let Some(&cell) = order.get(next) {
                let mut task = under_way.take().unwrap_or_else(|| cell_task(Arc::clone(&runner), cell));
                if !task.advance(&mut while_time) {
                    under_way = Some(task);
                    break;
                }
                numbers.extend(task.finish());
                next += 1;
                if !while_time() {
                    break;
                }
            }
            if next < order.len() {
                ctx.request_repaint();
            }
            is_over = next > begin;
            Ok(is_over.then(|| CellRows { cells: order[begin..next].to_vec(), numbers, by: Computer::Frames }))
        }))
    }
}
