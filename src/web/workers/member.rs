//! One worker of the page.

use std::cell::RefCell;
use std::rc::Rc;

use js_sys::{Array, Reflect};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{Event, MessageEvent, Worker, WorkerOptions, WorkerType};

use super::portions::Portions;

/// The program of a worker.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Program {
    /// The page's own program, which the browser has loaded and compiled.
    Page,
    /// The program for the graphics processor. The browser loads it with the first map.
    Graphics,
}

/// A worker with what it has been given.
pub(super) struct Member {
    number: u32,
    worker: Worker,
    is_ready: bool,
    is_over: bool,
    /// The job that it has the ensemble of.
    job: Option<u32>,
    /// Cells that it has.
    portions: Portions,
    _hear: Closure<dyn FnMut(MessageEvent)>,
    _fail: Closure<dyn FnMut(Event)>,
}

impl Member {
    /// Starts a worker. The listener receives its messages, or the reason why it failed.
    ///
    /// # Errors
    /// The reason in words if the browser has no workers.
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
        let portions = Portions::new();
        Ok(Self { number, worker, is_ready: false, is_over: false, job: None, portions, _hear: hear, _fail: fail })
    }

    /// Its number; no other worker has the same.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// Notes that the worker listens.
    pub(super) fn set_ready(&mut self) {
        self.is_ready = true;
    }

    /// Whether it listens.
    pub(super) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Whether it has been busy with one portion for long.
    pub(super) fn is_stuck(&self) -> bool {
        self.portions.is_stuck()
    }

    /// Whether it has no cells.
    pub(super) fn is_free(&self) -> bool {
        self.portions.is_empty()
    }

    /// Whether it should be given more cells.
    pub(super) fn wants_more(&self) -> bool {
        self.is_ready && self.portions.want_more()
    }

    /// Whether it has the ensemble of a job.
    pub(super) fn knows(&self, job: u32) -> bool {
        self.job == Some(job)
    }

    /// Notes that the worker has the ensemble of `job`, and the number of cells to give it first.
    pub(super) fn learn(&mut self, job: u32, first: usize) {
        self.job = Some(job);
        self.portions.begin_with(first);
    }

    /// The number of cells to give it at once.
    pub(super) fn portion(&self) -> usize {
        self.portions.size()
    }

    /// Ends the worker. Its listener calls this instead of dropping the worker, which would drop the listener while it
    /// runs.
    pub(super) fn end(&mut self) {
        self.worker.terminate();
        (self.is_ready, self.is_over) = (false, true);
    }

    /// Whether it has been ended.
    pub(super) fn is_over(&self) -> bool {
        self.is_over
    }

    /// Sends a message.
    pub(super) fn tell(&self, message: &Array) {
        if let Err(error) = self.worker.post_message(message) {
            log::warn!("A message to a worker was lost: {error:?}");
        }
    }

    /// Sends cells.
    pub(super) fn give(&mut self, message: &Array) {
        self.tell(message);
        self.portions.give();
    }

    /// Notes that it has sent the rows of a portion, and fits the next one to the time that it took it \[ms\].
    pub(super) fn take_back(&mut self, taken: f64) {
        self.portions.take_back(taken);
    }
}

impl Drop for Member {
    fn drop(&mut self) {
        self.worker.set_onmessage(None);
        self.worker.set_onerror(None);
        self.worker.terminate();
    }
}

/// A worker that starts its program. The scripts' names have no hash, so the page's version is in each address.
fn start(program: Program) -> Result<Worker, JsValue> {
    let document = web_sys::window().and_then(|window| window.document());
    let meta = document.and_then(|document| document.query_selector("meta[name=version]").ok().flatten());
    let version = meta.and_then(|meta| meta.get_attribute("content")).unwrap_or_default();
    if program == Program::Graphics {
        return Worker::new(&format!("./graphics-worker.js?v={version}"));
    }
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let worker = Worker::new_with_options(&format!("./worker.js?program={version}"), &options)?;
    worker.post_message(&wasm_bindgen::module())?;
    Ok(worker)
}
