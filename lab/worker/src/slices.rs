//! Work with an outcome in a worker. It sends the share that is done, then the outcome.

use js_sys::Array;
use kalmanscope_core::Task;
use wasm_bindgen::JsValue;

use crate::work::Work;

/// Work with an outcome, until that has been sent.
pub(crate) struct Slices<S: Task> {
    work: Option<S>,
    message: fn(&S::Outcome, &Array) -> JsValue,
}

impl<S: Task> Slices<S> {
    /// Work and the function that makes a message of its outcome.
    pub(crate) fn new(work: S, message: fn(&S::Outcome, &Array) -> JsValue) -> Self {
        Self { work: Some(work), message }
    }
}

impl<S: Task> Work for Slices<S> {
    fn go_on(&mut self, count: usize, handed_over: &Array) -> JsValue {
        let Some(work) = &mut self.work else { return JsValue::NULL };
        let mut left = count;
        let is_done = work.advance(&mut || {
            left = left.saturating_sub(1);
            left > 0
        });
        if !is_done {
            return work.progress().into();
        }
        self.work.take().map_or(JsValue::NULL, |work| (self.message)(&work.finish(), handed_over))
    }
}
