//! The worker's side of the conversation, and its tasks, in portions that the page asks for.

use js_sys::{Array, Float64Array};
use kalmanscope_core::Task;
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

    /// The number of the task that the message belongs to, or NaN.
    pub fn number(&self) -> f64 {
        self.get(1).as_f64().unwrap_or(f64::NAN)
    }
}

/// Reports that the worker is ready, and calls `listener` with each message of the page. A panic is sent as a message.
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

/// Sends a part of a task. The browser does not copy buffers in `handed_over`.
pub fn answer(number: f64, part: &JsValue, handed_over: &Array) {
    let message = Array::of3(&"part".into(), &number.into(), part);
    // A closed page needs no numbers.
    let _ = scope().post_message_with_transfer(&message, handed_over);
}

/// Tells the page why a task cannot be done.
pub fn fail(number: f64, reason: &str) {
    tell(&Array::of3(&"failed".into(), &number.into(), &reason.into()));
}

/// Sends a message.
pub fn tell(message: &Array) {
    let _ = scope().post_message(message);
}

fn scope() -> DedicatedWorkerGlobalScope {
    js_sys::global().unchecked_into()
}

/// Does a portion of a task, and returns the part to send. The browser does not copy buffers in the array.
pub(crate) type Portions = Box<dyn FnMut(&JsValue, &Array) -> JsValue>;

/// A task in portions of some pieces of work, whose parts are the shares that are done, and in the end a message of the outcome.
pub(crate) fn in_portions<T: Task + 'static>(task: T, message: fn(&T::Outcome, &Array) -> JsValue) -> Portions {
    let mut task = Some(task);
    Box::new(move |portion, handed_over| {
        let Some(own) = &mut task else { return JsValue::NULL };
        let mut left = count(portion);
        let is_done = own.advance(&mut || {
            left = left.saturating_sub(1);
            left > 0
        });
        if !is_done {
            return own.progress().into();
        }
        task.take().map_or(JsValue::NULL, |task| message(&task.finish(), handed_over))
    })
}

pub(crate) fn count(portion: &JsValue) -> usize {
    portion.as_f64().unwrap_or(0.0) as usize
}

/// Numbers for a message. Their buffer is handed over, not copied.
pub(crate) fn numbers(values: &[f64], handed_over: &Array) -> JsValue {
    let values = Float64Array::from(values);
    handed_over.push(&values.buffer());
    values.into()
}
