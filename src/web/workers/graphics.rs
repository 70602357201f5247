//! The page's graphics processor, in its own worker.

use std::cell::RefCell;
use std::rc::{Rc, Weak};
use std::sync::Arc;

use egui::Context;
use js_sys::Array;
use kalmanscope::team::{CellBatch, CellRows, Computer, Finding, Graphics, Handle, Lost};
use kalmanscope_worker::{cells_message, rows};
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::spawn_local;
use web_sys::MessageEvent;

use super::super::object::{awaited, call, get};

use super::worker::{Program, RemainingWork, Worker, WorkerTask};

/// The worker computes this many cells at once.
const PORTION: usize = 1024;

/// The graphics processor. The search begins with the first map.
pub(super) struct WorkerProcessor {
    software: bool,
    state: Rc<RefCell<ProcessorState>>,
}

struct ProcessorState {
    is_asked: bool,
    finding: Finding,
    worker: Option<Worker>,
    name: Arc<str>,
    number: u32,
    task: Option<WorkerTask>,
    ctx: Context,
}

impl WorkerProcessor {
    pub(super) fn new(software: bool) -> Self {
        let state = ProcessorState {
            is_asked: false,
            finding: Finding::Searching,
            worker: None,
            name: Arc::from(""),
            number: 0,
            task: None,
            ctx: Context::default(),
        };
        Self { software, state: Rc::new(RefCell::new(state)) }
    }
}

impl Graphics for WorkerProcessor {
    fn find(&self, ctx: &Context) -> Finding {
        let mut state = self.state.borrow_mut();
        state.ctx = ctx.clone();
        if !std::mem::replace(&mut state.is_asked, true) {
            spawn_local(start(Rc::clone(&self.state), self.software));
        }
        state.finding.clone()
    }

    fn found(&self) -> Finding {
        self.state.borrow().finding.clone()
    }

    fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>> {
        let mut state = self.state.borrow_mut();
        state.ctx = ctx.clone();
        state.number += 1;
        let number = state.number;
        let left = RemainingWork::Cells { cells: Box::new(cells.clone()), next: 0, size: PORTION };
        let mut task = WorkerTask::new(number, cells_message(number, &cells.runner), left, (None, 1), ctx);
        task.feed(state.worker.as_ref()?);
        state.task = Some(task);
        let working = Working { state: Rc::clone(&self.state), number };
        Some(Handle::new(move || working.take()))
    }
}

struct Working {
    state: Rc<RefCell<ProcessorState>>,
    number: u32,
}

impl Working {
    fn take(&self) -> Result<Option<CellRows>, Lost> {
        let state = self.state.borrow();
        let task = state.task.as_ref().filter(|task| task.number == self.number).ok_or(Lost)?;
        match task.next() {
            Some(part) => {
                let (cells, numbers) = rows(&part).ok_or(Lost)?;
                Ok(Some(CellRows { cells, numbers, by: Computer::Graphics(Arc::clone(&state.name)) }))
            }
            // The team does the cells that were not served.
            None if task.rests() => Err(Lost),
            None => Ok(None),
        }
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        let mut state = self.state.borrow_mut();
        if state.number == self.number {
            state.task = None;
        }
    }
}

impl ProcessorState {
    fn miss(&mut self, reason: String) {
        log::info!("Maps are computed by workers: {reason}");
        self.finding = Finding::Absent(reason);
        self.ctx.request_repaint();
    }

    fn lose(&mut self, reason: String) {
        log::warn!("The graphics processor is not used: {reason}");
        // Before it was ready, nothing has been lost.
        self.finding = match self.finding {
            Finding::Ready => Finding::Lost(reason),
            _ => Finding::Absent(reason),
        };
        self.task = None;
    }
}

async fn ask(software: bool) -> Result<(), String> {
    let navigator = web_sys::window().map(|window| JsValue::from(window.navigator())).unwrap_or_default();
    let gpu = get(&navigator, "gpu").filter(JsValue::is_object).ok_or("this browser has no WebGPU")?;
    let adapter = awaited(call(&gpu, "requestAdapter", &[])).await.ok().filter(JsValue::is_object);
    let adapter = adapter.ok_or("this browser's WebGPU finds no graphics processor")?;
    let info = get(&adapter, "info").unwrap_or_default();
    let is_software = get(&info, "isFallbackAdapter").is_some_and(|is| is.is_truthy());
    if is_software && !software {
        return Err("this browser's WebGPU has a program in place of a graphics processor".to_owned());
    }
    Ok(())
}

/// Starts the worker, if the browser offers a processor. Without one, this saves most of the work of a start.
async fn start(state: Rc<RefCell<ProcessorState>>, software: bool) {
    let offer = ask(software).await;
    let mut present = state.borrow_mut();
    match offer.and_then(|()| Worker::new(0, Program::Graphics, listener(&state, software))) {
        Ok(worker) => present.worker = Some(worker),
        Err(reason) => present.miss(reason),
    }
}

fn listener(state: &Rc<RefCell<ProcessorState>>, software: bool) -> impl FnMut(Result<MessageEvent, String>) + 'static {
    let state: Weak<RefCell<ProcessorState>> = Rc::downgrade(state);
    move |event| {
        let Some(state) = state.upgrade() else { return };
        let mut state = state.borrow_mut();
        let words: Array = match event {
            Ok(event) => event.data().unchecked_into(),
            Err(reason) => {
                state.lose(reason);
                return state.ctx.request_repaint();
            }
        };
        let text = |at: u32| words.get(at).as_string().unwrap_or_default();
        let is_present = words.get(1).as_f64() == Some(f64::from(state.number));
        match text(0).as_str() {
            "ready" => {
                if let Some(worker) = &mut state.worker {
                    worker.is_ready = true;
                    worker.tell(&Array::of2(&"graphics".into(), &software.into()));
                }
            }
            "graphics" => {
                state.name = Arc::from(text(1));
                state.finding = Finding::Ready;
            }
            "no graphics" => {
                state.miss(text(1));
                if let Some(worker) = &mut state.worker {
                    worker.end();
                }
            }
            "part" if is_present => {
                if let ProcessorState { worker: Some(worker), task: Some(task), .. } = &mut *state {
                    task.take(&words.get(2), worker);
                    task.feed(worker);
                }
            }
            // An ensemble that is not served, or cannot be used.
            "refused" | "failed" if is_present => state.task = None,
            "part" | "refused" => {}
            // A device that is lost, a panic.
            _ => state.lose(text(2)),
        }
        state.ctx.request_repaint();
    }
}
