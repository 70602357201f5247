//! One worker of the page, and the tasks that workers have been given: they pull portions of one size.

use std::cell::RefCell;
use std::rc::Rc;

use egui::Context;
use js_sys::{Array, Reflect};
use kalmanscope::team::{BETWEEN, CellBatch};
use kalmanscope_worker::portion_of;
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{Event, MessageEvent, WorkerOptions, WorkerType};

use crate::web::object::version;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Program {
    Page,
    Graphics,
}

pub(super) struct Worker {
    pub(super) number: u32,
    worker: web_sys::Worker,
    pub(super) is_ready: bool,
    pub(super) is_over: bool,
    _hear: Closure<dyn FnMut(MessageEvent)>,
    _fail: Closure<dyn FnMut(Event)>,
}

impl Worker {
    pub(super) fn new(
        number: u32,
        program: Program,
        listener: impl FnMut(Result<MessageEvent, String>) + 'static,
    ) -> Result<Self, String> {
        let worker = start(program).map_err(|error| format!("{error:?}"))?;
        let listener = Rc::new(RefCell::new(listener));
        let other = Rc::clone(&listener);
        let hear = Closure::<dyn FnMut(MessageEvent)>::new(move |event| (listener.borrow_mut())(Ok(event)));
        // A script that cannot be loaded sends an event without a message.
        let fail = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            let message = Reflect::get(&event, &"message".into()).ok().and_then(|message| message.as_string());
            (other.borrow_mut())(Err(message.unwrap_or_else(|| "its program cannot be loaded".to_owned())));
        });
        worker.set_onmessage(Some(hear.as_ref().unchecked_ref()));
        worker.set_onerror(Some(fail.as_ref().unchecked_ref()));
        Ok(Self { number, worker, is_ready: false, is_over: false, _hear: hear, _fail: fail })
    }

    /// The listener calls this instead of dropping the worker, which would drop the listener while it runs.
    pub(super) fn end(&mut self) {
        self.worker.terminate();
        (self.is_ready, self.is_over) = (false, true);
    }

    pub(super) fn tell(&self, message: &Array) {
        if let Err(error) = self.worker.post_message(message) {
            log::warn!("A message to a worker was lost: {error:?}");
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.worker.set_onmessage(None);
        self.worker.set_onerror(None);
        self.worker.terminate();
    }
}

fn start(program: Program) -> Result<web_sys::Worker, JsValue> {
    let version = version();
    if program == Program::Graphics {
        return web_sys::Worker::new(&format!("./graphics-worker.js?v={version}"));
    }
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let worker = web_sys::Worker::new_with_options(&format!("./worker.js?program={version}"), &options)?;
    worker.post_message(&wasm_bindgen::module())?;
    Ok(worker)
}

/// The portions that a worker has at once, so that it has something to do while the page draws a frame.
pub(super) const AT_ONCE: usize = 4;

/// The size of a portion of samples, and of pieces of other work.
const SAMPLES: usize = 64;
const PIECES: usize = 8;

/// The time of a portion of cells, by estimate \[s\], and the limit of its cells.
const PORTION: f64 = 0.01;
const MOST: usize = 512;

pub(super) struct WorkerTask {
    pub(super) number: u32,
    message: Array,
    left: RemainingWork,
    /// The workers that know the task, by number, each with the portions that it has.
    shares: Vec<(u32, usize)>,
    worker: Option<u32>,
    at_once: usize,
    come: Array,
    pub(super) is_over: bool,
    ctx: Context,
}

pub(super) enum RemainingWork {
    Samples(usize),
    Outcome,
    /// Cells from a place in their order on, in portions of a size.
    Cells {
        cells: Box<CellBatch>,
        next: usize,
        size: usize,
    },
}

impl RemainingWork {
    pub(super) fn cells(cells: CellBatch, workers: usize) -> Self {
        let soon = (PORTION / cells.runner.time_of_cell()) as usize;
        let size = soon.min(cells.order.len() / (AT_ONCE * workers)).clamp(1, MOST);
        Self::Cells { cells: Box::new(cells), next: 0, size }
    }

    fn take(&mut self) -> Option<JsValue> {
        match self {
            Self::Samples(left) => {
                let count = SAMPLES.min(*left);
                *left -= count;
                (count > 0).then(|| (count as u32).into())
            }
            Self::Outcome => Some((PIECES as u32).into()),
            Self::Cells { cells, next, size } => {
                let begin = *next;
                *next = (begin + *size).min(cells.order.len());
                (*next > begin).then(|| portion_of(&cells.order[begin..*next]))
            }
        }
    }
}

impl WorkerTask {
    pub(super) fn new(
        number: u32,
        message: Array,
        left: RemainingWork,
        (worker, at_once): (Option<u32>, usize),
        ctx: &Context,
    ) -> Self {
        let (shares, come, ctx) = (Vec::new(), Array::new(), ctx.clone());
        Self { number, message, left, shares, worker, at_once, come, is_over: false, ctx }
    }

    pub(super) fn is_for_all(&self) -> bool {
        self.worker.is_none()
    }

    pub(super) fn rests(&self) -> bool {
        self.shares.iter().all(|(_, portions)| *portions == 0)
    }

    pub(super) fn is_of(&self, worker: &Worker) -> bool {
        self.worker == Some(worker.number) && !self.is_over
    }

    pub(super) fn is_at(&self, worker: &Worker) -> bool {
        self.shares.iter().any(|(number, portions)| *number == worker.number && *portions > 0)
    }

    pub(super) fn next(&self) -> Option<JsValue> {
        Some(self.come.shift()).filter(|part| !part.is_undefined())
    }

    pub(super) fn wake(&self) {
        self.ctx.request_repaint();
    }

    pub(super) fn feed(&mut self, worker: &Worker) {
        let number = worker.number;
        if self.is_over || !worker.is_ready || self.worker.is_some_and(|own| own != number) {
            return;
        }
        let at = self.shares.iter().position(|(other, _)| *other == number).unwrap_or_else(|| {
            worker.tell(&self.message);
            self.shares.push((number, 0));
            self.shares.len() - 1
        });
        while self.shares[at].1 < self.at_once {
            let Some(portion) = self.left.take() else { break };
            worker.tell(&Array::of3(&"more".into(), &self.number.into(), &portion));
            self.shares[at].1 += 1;
        }
    }

    pub(super) fn take(&mut self, part: &JsValue, worker: &Worker) {
        let Some((_, portions)) = self.shares.iter_mut().find(|(number, _)| *number == worker.number) else { return };
        *portions = portions.saturating_sub(1);
        if self.is_over {
            return;
        }
        self.come.push(part);
        if matches!(self.left, RemainingWork::Outcome) && part.as_f64().is_none() {
            self.left = RemainingWork::Samples(0);
        }
        if !self.is_for_all() {
            self.feed(worker);
        }
        // The last part is shown at once, progress a few times a second.
        if self.is_at(worker) { self.ctx.request_repaint_after(BETWEEN) } else { self.wake() }
    }

    pub(super) fn end(&mut self, workers: &[Worker]) {
        if std::mem::replace(&mut self.is_over, true) {
            return;
        }
        for worker in workers.iter().filter(|worker| self.shares.iter().any(|(number, _)| *number == worker.number)) {
            worker.tell(&Array::of2(&"forget".into(), &self.number.into()));
        }
        (self.left, self.come) = (RemainingWork::Samples(0), Array::new());
    }

    pub(super) fn forget_all_but(&mut self, workers: &[Worker]) {
        self.shares.retain(|(number, _)| workers.iter().any(|worker| worker.number == *number && !worker.is_over));
    }
}
