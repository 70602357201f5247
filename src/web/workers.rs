//! The team of a page: its workers, one a processor, and the browser's graphics processor.

mod graphics;
mod worker;

use std::cell::RefCell;
use std::rc::Rc;

use egui::Context;
use js_sys::Array;
use kalmanscope::team::{CellBatch, CellRows, Computer, Graphics, Handle, Lost, Report, Team};
use kalmanscope_core::import::Loaded;
use kalmanscope_core::suggest::Suggestion;
use kalmanscope_core::{Record, Scenario, Tape};
use kalmanscope_worker::{
    cells_message, file_message, filter_message, loaded, rows, suggest_message, suggestion, tape,
};
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::MessageEvent;

use worker::{AT_ONCE, Program, RemainingWork, Worker, WorkerTask};

const MOST: usize = 8;

struct Workers {
    state: Rc<RefCell<PoolState>>,
    processor: Rc<graphics::WorkerProcessor>,
    ctx: Context,
}

#[derive(Default)]
struct PoolState {
    workers: Vec<Worker>,
    tasks: Vec<WorkerTask>,
    last: u32,
    broken: Option<String>,
}

pub(super) fn team(software: bool, ctx: &Context) -> Rc<dyn Team> {
    let processor = Rc::new(graphics::WorkerProcessor::new(software));
    Rc::new(Workers { state: Rc::default(), processor, ctx: ctx.clone() })
}

impl Team for Workers {
    fn is_beside(&self) -> bool {
        true
    }

    fn filter(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<Handle<Tape>> {
        let message = |number| filter_message(number, scenario, place, record);
        self.begin(RemainingWork::Samples(record.len()), &message, |part, _| tape(part))
    }

    fn load(&self, bytes: &[u8]) -> Option<Handle<Report<f64, Result<Loaded, String>>>> {
        self.begin(RemainingWork::Outcome, &|number| file_message(number, bytes), |part, _| report(part, loaded))
    }

    fn suggest(&self, scenario: &Scenario, record: &Record) -> Option<Handle<Report<f64, Suggestion>>> {
        let message = |number| suggest_message(number, scenario, record);
        self.begin(RemainingWork::Outcome, &message, |part, _| report(part, suggestion))
    }

    fn cells(&self, cells: &CellBatch, _: &Context) -> Option<Handle<CellRows>> {
        let message = |number| cells_message(number, &cells.runner);
        self.begin(RemainingWork::cells(cells.clone(), full()), &message, |part, workers| {
            rows(part).map(|(cells, numbers)| CellRows { cells, numbers, by: Computer::Workers(workers) })
        })
    }

    fn graphics(&self) -> Option<Rc<dyn Graphics>> {
        Some(Rc::<graphics::WorkerProcessor>::clone(&self.processor))
    }

    fn usual_count(&self) -> usize {
        if processors() > 2 { 64 } else { 48 }
    }
}

impl Workers {
    /// Gives cells to all workers, else a task to one. `message` makes its first message; `read` reads a part.
    fn begin<T: 'static>(
        &self,
        left: RemainingWork,
        message: &dyn Fn(u32) -> Array,
        read: impl Fn(&JsValue, usize) -> Option<T> + 'static,
    ) -> Option<Handle<T>> {
        let number = self.give(left, message)?;
        let task = PoolTask { state: Rc::clone(&self.state), number };
        Some(Handle::new(move || {
            let Some((part, workers)) = task.take()? else { return Ok(None) };
            read(&part, workers).map(Some).ok_or(Lost)
        }))
    }

    fn give(&self, left: RemainingWork, message: &dyn Fn(u32) -> Array) -> Option<u32> {
        let mut present = self.state.borrow_mut();
        let is_for_all = matches!(left, RemainingWork::Cells { .. });
        if is_for_all {
            // The workers have one map at a time.
            present.end(WorkerTask::is_for_all);
        }
        let count = 1 + present.tasks.iter().filter(|task| !task.is_for_all()).count();
        muster(&self.state, &mut present, if is_for_all { MOST } else { count });
        if present.broken.is_some() {
            return None;
        }
        let PoolState { workers, tasks, last, .. } = &mut *present;
        let load = |worker: &&Worker| {
            (tasks.iter().filter(|task| task.is_of(worker)).count(), tasks.iter().any(|task| task.is_at(worker)))
        };
        let worker = if is_for_all { None } else { Some(workers.iter().min_by_key(load)?.number) };
        *last += 1;
        let number = *last;
        tasks.push(WorkerTask::new(number, message(number), left, (worker, AT_ONCE), &self.ctx));
        (0..workers.len()).for_each(|place| present.feed(place));
        Some(number)
    }
}

fn report<T>(part: &JsValue, outcome: impl FnOnce(&JsValue) -> Option<T>) -> Option<Report<f64, T>> {
    part.as_f64().map(Report::Look).or_else(|| outcome(part).map(Report::Done))
}

struct PoolTask {
    state: Rc<RefCell<PoolState>>,
    number: u32,
}

impl PoolTask {
    fn take(&self) -> Result<Option<(JsValue, usize)>, Lost> {
        let state = self.state.borrow();
        let task = state.tasks.iter().find(|task| task.number == self.number).ok_or(Lost)?;
        match task.next() {
            None if state.broken.is_some() => Err(Lost),
            part => Ok(part.map(|part| (part, state.workers.len()))),
        }
    }
}

impl Drop for PoolTask {
    fn drop(&mut self) {
        self.state.borrow_mut().give_up(self.number);
    }
}

impl PoolState {
    fn feed(&mut self, place: usize) {
        let Self { workers, tasks, .. } = self;
        let Some(worker) = workers.get(place) else { return };
        let has_own = tasks.iter().any(|task| task.is_of(worker));
        tasks.iter_mut().filter(|task| task.is_for_all() != has_own).for_each(|task| task.feed(worker));
    }

    fn end(&mut self, which: impl Fn(&WorkerTask) -> bool) {
        let Self { workers, tasks, .. } = self;
        tasks.iter_mut().filter(|task| which(task)).for_each(|task| task.end(workers));
        self.sweep();
    }

    fn sweep(&mut self) {
        let Self { workers, tasks, .. } = self;
        tasks.iter_mut().for_each(|task| task.forget_all_but(workers));
        tasks.retain(|task| !(task.is_over && task.rests()));
    }

    /// Ends the task, and a worker that does it alone and nothing else: another one starts when there is work.
    fn give_up(&mut self, number: u32) {
        let Some(task) = self.tasks.iter().position(|task| task.number == number) else { return };
        self.tasks[task].end(&self.workers);
        let Self { workers, tasks, .. } = &mut *self;
        let (task, others) = (&tasks[task], tasks.iter().filter(|task| task.number != number));
        let has_other = |worker: &Worker| others.clone().any(|task| task.is_at(worker) || task.is_of(worker));
        if !task.is_for_all() {
            workers.retain(|worker| !task.is_at(worker) || has_other(worker));
        }
        self.sweep();
        (0..self.workers.len()).for_each(|place| self.feed(place));
    }

    /// Ends a worker that has failed, by its place. Its own tasks are lost, and others continue. A worker that has cells of a
    /// map, or never was ready, ends the use of all workers: another one might fail at the same cells.
    fn lose(&mut self, place: usize, reason: String) {
        log::warn!("A worker of the page has failed: {reason}");
        let Self { workers, tasks, broken, .. } = self;
        let worker = &mut workers[place];
        let is_its = |task: &WorkerTask| task.is_of(worker);
        let has_cells = tasks.iter().any(|task| task.is_for_all() && task.is_at(worker));
        if !(tasks.iter().any(is_its) && worker.is_ready && !has_cells) {
            *broken = Some(reason);
        }
        // The next frame notices the loss.
        tasks.iter().for_each(WorkerTask::wake);
        tasks.retain(|task| !is_its(task));
        worker.end();
    }
}

fn muster(state: &Rc<RefCell<PoolState>>, present: &mut PoolState, count: usize) {
    let PoolState { workers, broken, .. } = present;
    if broken.is_some() {
        return;
    }
    workers.retain(|worker| !worker.is_over);
    while workers.len() < full().min(count) {
        let number = workers.iter().map(|worker| worker.number).max().map_or(0, |number| number + 1);
        match Worker::new(number, Program::Page, listener(state, number)) {
            Ok(worker) => workers.push(worker),
            Err(reason) => {
                *broken = Some(reason);
                break;
            }
        }
    }
    present.sweep();
}

fn listener(state: &Rc<RefCell<PoolState>>, number: u32) -> impl FnMut(Result<MessageEvent, String>) + 'static {
    let state = Rc::downgrade(state);
    move |event| {
        let Some(state) = state.upgrade() else { return };
        let mut state = state.borrow_mut();
        let PoolState { workers, tasks, .. } = &mut *state;
        let is_it = |worker: &Worker| worker.number == number && !worker.is_over;
        let Some(place) = workers.iter().position(is_it) else { return };
        let worker = &mut workers[place];
        let words: Array = match event {
            Ok(event) => event.data().unchecked_into(),
            Err(reason) => return state.lose(place, reason),
        };
        match words.get(0).as_string().as_deref() {
            Some("ready") => worker.is_ready = true,
            Some("part") => {
                let of = words.get(1).as_f64();
                if let Some(task) = tasks.iter_mut().find(|task| of == Some(f64::from(task.number))) {
                    task.take(&words.get(2), worker);
                }
                state.sweep();
            }
            _ => return state.lose(place, words.get(2).as_string().unwrap_or_default()),
        }
        state.feed(place);
    }
}

fn full() -> usize {
    processors().min(MOST)
}

fn processors() -> usize {
    web_sys::window().map_or(1, |window| window.navigator().hardware_concurrency() as usize).max(1)
}
