//! The cells of a map that are to be run.

use egui::Context;
use js_sys::{Array, Uint32Array};
use kalmanscope::laboratory::{Computer, Pace, Rows, Task};
use kalmanscope_lab::{EnsembleError, Runner};
use kalmanscope_worker::in_message;
use wasm_bindgen::JsValue;
use web_time::{Duration, Instant};

use super::member::Member;
use super::portions::Portions;

/// The cells that the page computes at once while it waits for its workers, and the limit of their time \[s\].
const SIDE_BY_SIDE: usize = 8;
const LIGHT: f64 = 0.05;

/// The time for which it does so between two events.
const PORTION: Duration = Duration::from_millis(8);

/// The cells of a map that are to be run, and the rows of those that have been.
pub(super) struct Given {
    runner: Runner,
    ensemble: String,
    record: JsValue,
    order: Vec<usize>,
    next: usize,
    rows: Vec<Rows>,
    pace: Pace,
    ctx: Context,
}

impl Given {
    /// The cells of a task.
    ///
    /// # Errors
    /// [`EnsembleError`] where the ensemble cannot be run.
    pub(super) fn new(task: Task<'_>, ctx: &Context) -> Result<Self, EnsembleError> {
        let Task { ensemble, source, order, .. } = task;
        Ok(Self {
            runner: Runner::new(ensemble.clone(), source.clone())?,
            ensemble: ensemble.to_json(),
            record: in_message(source),
            pace: Pace::new(order.len()),
            order,
            next: 0,
            rows: Vec::new(),
            ctx: ctx.clone(),
        })
    }

    /// Whether some cells wait that take little time.
    pub(super) fn is_light(&self) -> bool {
        self.next < self.order.len() && SIDE_BY_SIDE as f64 * self.runner.time_of_cell() < LIGHT
    }

    /// Computes some cells on the page.
    pub(super) fn compute(&mut self) {
        let begun = Instant::now();
        while self.next < self.order.len() && begun.elapsed() < PORTION {
            let cells = self.take_next(SIDE_BY_SIDE);
            let numbers = self.runner.rows(&cells);
            self.put(Rows { cells, numbers, by: Computer::Frames });
        }
    }

    /// Gives a worker of a team of some its next cells, if it has none waiting.
    pub(super) fn feed(&mut self, member: &mut Member, job: u32, team: usize) {
        while self.next < self.order.len() && member.wants_more() {
            if !member.knows(job) {
                let Self { ensemble, record, .. } = self;
                member.tell(&Array::of4(&"ensemble".into(), &job.into(), &(&*ensemble).into(), record));
                member.learn(job, Portions::first(self.runner.time_of_cell(), self.pace.first(), team));
            }
            let cells: Vec<u32> = self.take_next(member.portion()).into_iter().map(|cell| cell as u32).collect();
            member.give(&Array::of3(&"cells".into(), &job.into(), &Uint32Array::from(cells.as_slice())));
        }
    }

    fn take_next(&mut self, count: usize) -> Vec<usize> {
        let end = (self.next + count).min(self.order.len());
        let cells = self.order[self.next..end].to_vec();
        self.next = end;
        cells
    }

    /// Adds rows that have come.
    pub(super) fn put(&mut self, rows: Rows) {
        self.pace.take(rows.cells.len(), &self.ctx);
        self.rows.push(rows);
    }

    /// Takes out the rows that have come.
    pub(super) fn take_rows(&mut self) -> Vec<Rows> {
        std::mem::take(&mut self.rows)
    }

    /// The rows that have come, all its cells, and the screen that shows them.
    pub(super) fn end(self) -> (Vec<Rows>, Vec<usize>, Context) {
        (self.rows, self.order, self.ctx)
    }

    /// Asks for a frame.
    pub(super) fn wake(&self) {
        self.ctx.request_repaint();
    }
}
