//! The worker's side of the conversation.

use js_sys::{Array, Float64Array, Uint32Array};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{DedicatedWorkerGlobalScope, MessageEvent};

/// The words of a message from the page.
pub struct Words(Array);

impl Words {
    /// The word at a place; undefined after the last one.
    pub fn get(&self, at: u32) -> JsValue {
        self.0.get(at)
    }

    /// The text at a place; empty where there is none.
    pub fn text(&self, at: u32) -> String {
        self.get(at).as_string().unwrap_or_default()
    }

    /// The job that the message belongs to, or NaN.
    pub fn job(&self) -> f64 {
        self.get(1).as_f64().unwrap_or(f64::NAN)
    }
}

/// Tells the page that the worker is ready, and calls `listener` with each message of the page. A panic is sent to the
/// page as a message.
pub fn hear(mut listener: impl FnMut(&Words) + 'static) {
    std::panic::set_hook(Box::new(|panic| {
        tell(&Array::of3(&"failed".into(), &JsValue::NULL, &panic.to_string().into()));
    }));
    let hear = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        if let Ok(words) = event.data().dyn_into::<Array>() {
            listener(&Words(words));
        }
    });
    scope().set_onmessage(Some(hear.as_ref().unchecked_ref()));
    hear.forget();
    tell(&Array::of1(&"ready".into()));
}

/// Measures the time that a message takes.
pub struct Watch(f64);

impl Watch {
    /// Begins now.
    pub fn start() -> Self {
        Self(now())
    }

    /// The time since its begin \[ms\].
    pub(crate) fn time(&self) -> f64 {
        now() - self.0
    }
}

/// The time of the worker's clock \[ms\].
fn now() -> f64 {
    scope().performance().map_or(0.0, |clock| clock.now())
}

/// Sends the rows of some cells.
pub fn answer(job: f64, cells: &[usize], rows: &[f64], watch: &Watch) {
    let rows = Float64Array::from(rows);
    let cells: Vec<u32> = cells.iter().map(|&cell| cell as u32).collect();
    let cells = Uint32Array::from(cells.as_slice());
    let message = Array::of5(&"rows".into(), &job.into(), &cells, &rows, &watch.time().into());
    send(&message, &Array::of1(&rows.buffer()));
}

/// Sends a message, and hands over buffers in it.
pub(crate) fn send(message: &Array, handed_over: &Array) {
    // A closed page needs no numbers.
    let _ = scope().post_message_with_transfer(message, handed_over);
}

/// Sends a message.
pub fn tell(message: &Array) {
    let _ = scope().post_message(message);
}

fn scope() -> DedicatedWorkerGlobalScope {
    js_sys::global().unchecked_into()
}
