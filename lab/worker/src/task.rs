//! Tasks in a worker, in portions that the page asks for.

use js_sys::{Array, Float64Array};
use kalmanscope_core::Task;
use wasm_bindgen::JsValue;

pub(crate) trait Portioned {
    /// Does a portion, and returns the part to send. The browser does not copy buffers in `handed_over`.
    fn go_on(&mut self, portion: &JsValue, handed_over: &Array) -> JsValue;
}

/// A task that sends the share that is done, then its outcome.
pub(crate) struct Whole<T: Task> {
    task: Option<T>,
    message: fn(&T::Outcome, &Array) -> JsValue,
}

impl<T: Task> Whole<T> {
    pub(crate) fn new(task: T, message: fn(&T::Outcome, &Array) -> JsValue) -> Self {
        Self { task: Some(task), message }
    }
}

impl<T: Task> Portioned for Whole<T> {
    fn go_on(&mut self, portion: &JsValue, handed_over: &Array) -> JsValue {
        let Some(task) = &mut self.task else { return JsValue::NULL };
        let mut left = count(portion);
        let is_done = task.advance(&mut || {
            left = left.saturating_sub(1);
            left > 0
        });
        if !is_done {
            return task.progress().into();
        }
        self.task.take().map_or(JsValue::NULL, |task| (self.message)(&task.finish(), handed_over))
    }
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
