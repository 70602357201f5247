//! The worker's side of the conversation.

use std::rc::Rc;

use js_sys::{Array, Float64Array, Uint32Array};
use kalmanscope_lab::Runner;
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{DedicatedWorkerGlobalScope, MessageEvent};

use crate::graphics::Graphics;
use crate::message::{cells, runner};

/// Answers messages for as long as the worker lives.
pub(crate) fn serve() {
    std::panic::set_hook(Box::new(|panic| {
        tell(&Array::of3(&"failed".into(), &JsValue::NULL, &panic.to_string().into()));
    }));
    let mut present: Option<(f64, Rc<Runner>)> = None;
    let graphics = Graphics::default();
    let hear = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let Ok(words) = event.data().dyn_into::<Array>() else { return };
        let text = |at: u32| words.get(at).as_string().unwrap_or_default();
        let job = words.get(1).as_f64().unwrap_or(f64::NAN);
        match text(0).as_str() {
            "ensemble" => {
                present = match runner(&text(2), &words.get(3)) {
                    Ok(runner) => {
                        graphics.begin(job);
                        Some((job, Rc::new(runner)))
                    }
                    Err(reason) => {
                        tell(&Array::of3(&"failed".into(), &job.into(), &reason.into()));
                        None
                    }
                };
            }
            "cells" => {
                if let Some((own, runner)) = &present
                    && *own == job
                {
                    let cells = cells(words.get(2));
                    if !graphics.take(job, &cells, runner) {
                        answer(job, &cells, &runner.rows(&cells));
                    }
                }
            }
            "graphics" => graphics.find(words.get(1).is_truthy()),
            _ => {}
        }
    });
    scope().set_onmessage(Some(hear.as_ref().unchecked_ref()));
    hear.forget();
    tell(&Array::of1(&"ready".into()));
}

/// Sends the rows of some cells.
pub(crate) fn answer(job: f64, cells: &[usize], rows: &[f64]) {
    let rows = Float64Array::from(rows);
    let cells: Vec<u32> = cells.iter().map(|&cell| cell as u32).collect();
    let cells = Uint32Array::from(cells.as_slice());
    let message = Array::of4(&"rows".into(), &job.into(), &cells, &rows);
    // A page that has gone needs no rows.
    let _ = scope().post_message_with_transfer(&message, &Array::of1(&rows.buffer()));
}

pub(crate) fn tell(message: &Array) {
    let _ = scope().post_message(message);
}

fn scope() -> DedicatedWorkerGlobalScope {
    js_sys::global().unchecked_into()
}
