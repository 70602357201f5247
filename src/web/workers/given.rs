//! A task that workers have been given.

use std::sync::Arc;

use egui::Context;
use js_sys::Array;
use kalmanscope::laboratory::Pace;
use kalmanscope::team::Cells;
use kalmanscope_worker::{cells, portion_of, rows_part};
use wasm_bindgen::{JsCast as _, JsValue};
use web_time::{Duration, Instant};

use super::portions::Portions;
use super::worker::Worker;

/// The size of the first portion of a task for one worker.
const FIRST: usize = 4;

/// The cells that the page computes at once while it waits for its workers, and the limit of their time \[s\].
const SIDE_BY_SIDE: usize = 8;
const LIGHT: f64 = 0.05;

/// The time for which it does so between two events.
const PORTION: Duration = Duration::from_millis(8);

/// A task that one worker does, or all of them, and the parts that have come.
pub(super) struct Given {
    number: u32,
    /// The message that begins it.
    message: Array,
    is_for_all: bool,
    left: Left,
    shares: Vec<Share>,
    /// Parts that have come, as the workers have sent them.
    come: Array,
    is_over: bool,
    ctx: Context,
}

/// The parts that the page has not asked for yet.
pub(super) enum Left {
    /// This many samples.
    Samples(usize),
    /// The outcome: the page asks for more until it comes.
    Outcome,
    /// Cells, for all workers, from a place in their order on; each worker gets `first` at first.
    Cells { cells: Box<Cells>, next: usize, pace: Pace, first: usize },
}

/// A worker's share of a task.
struct Share {
    /// The worker's number.
    worker: u32,
    /// Whether the worker has heard of the task.
    is_told: bool,
    portions: Portions,
}

impl Share {
    fn new(worker: u32, first: usize) -> Self {
        Self { worker, is_told: false, portions: Portions::new(first) }
    }
}

impl Left {
    /// All of some cells, for this many workers.
    pub(super) fn cells(cells: Cells, workers: usize) -> Self {
        let pace = Pace::new(cells.order.len());
        let first = Portions::first(cells.runner.time_of_cell(), pace.first(), workers);
        Self::Cells { cells: Box::new(cells), next: 0, pace, first }
    }

    /// Whether all workers do it.
    pub(super) fn is_for_all(&self) -> bool {
        matches!(self, Self::Cells { .. })
    }

    /// Takes out the next portion, of this size at most.
    fn take(&mut self, size: usize) -> Option<JsValue> {
        match self {
            Self::Samples(left) => {
                let count = size.min(*left);
                *left -= count;
                (count > 0).then(|| (count as u32).into())
            }
            Self::Outcome => Some((size as u32).into()),
            Self::Cells { cells, next, .. } => {
                let begin = *next;
                *next = (begin + size).min(cells.order.len());
                (*next > begin).then(|| portion_of(&cells.order[begin..*next]))
            }
        }
    }
}

impl Given {
    /// A task that is begun by a message, for the worker of this number or for all.
    pub(super) fn new(number: u32, message: Array, left: Left, worker: Option<u32>, ctx: &Context) -> Self {
        let is_for_all = left.is_for_all();
        let shares = worker.map(|worker| Share::new(worker, FIRST)).into_iter().collect();
        let (come, ctx) = (Array::new(), ctx.clone());
        Self { number, message, is_for_all, left, shares, come, is_over: false, ctx }
    }

    /// Its number; no other task has the same.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// Whether all workers do it.
    pub(super) fn is_for_all(&self) -> bool {
        self.is_for_all
    }

    /// Whether one worker does it.
    pub(super) fn is_for_one(&self) -> bool {
        !self.is_for_all && !self.is_over
    }

    /// Whether it is not wanted any more.
    pub(super) fn is_over(&self) -> bool {
        self.is_over
    }

    /// Whether it is over, and no worker has a portion of it.
    pub(super) fn is_done_with(&self) -> bool {
        self.is_over && self.shares.iter().all(|share| share.portions.is_empty())
    }

    /// Whether a worker has a share of it.
    pub(super) fn is_of(&self, worker: &Worker) -> bool {
        self.share(worker).is_some()
    }

    /// Whether a worker has portions of it.
    pub(super) fn is_at(&self, worker: &Worker) -> bool {
        self.share(worker).is_some_and(|share| !share.portions.is_empty())
    }

    /// Whether a worker has been busy with one portion of it for long.
    pub(super) fn is_stuck(&self, worker: &Worker) -> bool {
        self.share(worker).is_some_and(|share| share.portions.is_stuck())
    }

    fn share(&self, worker: &Worker) -> Option<&Share> {
        self.shares.iter().find(|share| share.worker == worker.number())
    }

    /// Takes out the first part that has come. None comes once it is over.
    pub(super) fn next(&self) -> Option<JsValue> {
        Some(self.come.shift()).filter(|part| !part.is_undefined())
    }

    /// Asks for a frame.
    pub(super) fn wake(&self) {
        self.ctx.request_repaint();
    }

    /// Asks a worker for more, if there is something to do.
    pub(super) fn feed(&mut self, worker: &Worker) {
        if self.is_over || !worker.is_ready() {
            return;
        }
        let Self { number, message, left, shares, .. } = self;
        if let Left::Cells { first, .. } = left
            && !shares.iter().any(|share| share.worker == worker.number())
        {
            shares.push(Share::new(worker.number(), *first));
        }
        let Some(share) = shares.iter_mut().find(|share| share.worker == worker.number()) else { return };
        while share.portions.want_more() {
            let Some(portion) = left.take(share.portions.size()) else { break };
            if !std::mem::replace(&mut share.is_told, true) {
                worker.tell(message);
            }
            worker.tell(&Array::of3(&"more".into(), &(*number).into(), &portion));
            share.portions.give();
        }
    }

    /// Takes in a part that has taken its worker this time \[ms\], and asks for more.
    pub(super) fn take(&mut self, part: &JsValue, taken: f64, worker: &Worker) {
        let Some(share) = self.shares.iter_mut().find(|share| share.worker == worker.number()) else { return };
        share.portions.take_back(taken);
        if self.is_over {
            return;
        }
        self.put(part);
        if self.is_for_all {
            return;
        }
        if matches!(self.left, Left::Outcome) && part.as_f64().is_none() {
            self.left = Left::Samples(0);
            self.wake();
        }
        self.feed(worker);
        if !self.is_at(worker) {
            self.wake();
        }
    }

    /// Ends it. Workers that have heard of it forget it.
    pub(super) fn end(&mut self, workers: &[Worker]) {
        if std::mem::replace(&mut self.is_over, true) {
            return;
        }
        for worker in workers.iter().filter(|worker| self.share(worker).is_some_and(|share| share.is_told)) {
            worker.tell(&Array::of2(&"forget".into(), &self.number.into()));
        }
        (self.left, self.come) = (Left::Samples(0), Array::new());
    }

    /// Forgets the shares of workers that are gone.
    pub(super) fn forget_all_but(&mut self, workers: &[Worker]) {
        self.shares.retain(|share| workers.iter().any(|worker| worker.number() == share.worker && !worker.is_over()));
    }

    /// Whether cells of it wait that take little time.
    pub(super) fn is_light(&self) -> bool {
        let Left::Cells { cells, next, .. } = &self.left else { return false };
        *next < cells.order.len() && SIDE_BY_SIDE as f64 * cells.runner.time_of_cell() < LIGHT
    }

    /// Computes some cells on the page.
    pub(super) fn compute(&mut self) {
        let begun = Instant::now();
        while let Left::Cells { cells: all, .. } = &self.left
            && begun.elapsed() < PORTION
        {
            let runner = Arc::clone(&all.runner);
            let Some(portion) = self.left.take(SIDE_BY_SIDE) else { return };
            let cells = cells(&portion);
            let part = rows_part(&cells, &runner.rows(&cells), &Array::new());
            part.unchecked_ref::<Array>().push(&JsValue::TRUE);
            self.put(&part);
        }
    }

    /// Adds a part with rows, or another one.
    fn put(&mut self, part: &JsValue) {
        self.come.push(part);
        if let Left::Cells { pace, .. } = &mut self.left {
            pace.take(cells(&part.unchecked_ref::<Array>().get(0)).len(), &self.ctx);
        }
    }
}

/// Whether the page has computed a part with rows: it has one word more.
pub(super) fn is_of_page(part: &JsValue) -> bool {
    part.dyn_ref::<Array>().is_some_and(|part| part.get(2).is_truthy())
}
