//! One worker of the page.

use std::cell::RefCell;
use std::rc::Rc;

use js_sys::{Array, Reflect};
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
    number: u32,
    worker: web_sys::Worker,
    is_ready: bool,
    is_over: bool,
    _hear: Closure<dyn FnMut(MessageEvent)>,
    _fail: Closure<dyn FnMut(Event)>,
}

impl Worker {
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
        Ok(Self { number, worker, is_ready: false, is_over: false, _hear: hear, _fail: fail })
    }

    pub(super) fn number(&self) -> u32 {
        self.number
    }

    pub(super) fn set_ready(&mut self) {
        self.is_ready = true;
    }

    pub(super) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Ends the worker. Its listener calls this instead of dropping the worker, which would drop the listener while it
    /// runs.
    pub(super) fn end(&mut self) {
        self.worker.terminate();
        (self.is_ready, self.is_over) = (false, true);
    }

    pub(super) fn is_over(&self) -> bool {
        self.is_over
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
