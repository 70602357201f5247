//! The worker's graphics processor.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use js_sys::Array;
use kalmanscope_gpu::{Gpu, GpuError, Software};
use kalmanscope_lab::Runner;
use kalmanscope_worker::{Words, answer, cells, fail, hear, rows_part, runner, tell};
use wasm_bindgen_futures::spawn_local;

#[derive(Default)]
struct GraphicsWorker {
    gpu: Rc<RefCell<Option<Rc<Gpu>>>>,
    task: Rc<Cell<f64>>,
    runner: RefCell<Option<Rc<Runner>>>,
}

pub(crate) fn serve() {
    let graphics = GraphicsWorker::default();
    hear(move |words| match words.text(0).as_str() {
        "graphics" => graphics.find(words.get(1).is_truthy()),
        "cells" => graphics.begin(words),
        "more" => graphics.take(words.number(), cells(&words.get(2))),
        _ => {}
    });
}

impl GraphicsWorker {
    fn find(&self, software: bool) {
        let gpu = Rc::clone(&self.gpu);
        let software = if software { Software::Allowed } else { Software::Refused };
        spawn_local(async move {
            match Gpu::find(software).await {
                Ok(found) => {
                    tell(&Array::of2(&"graphics".into(), &found.name.as_str().into()));
                    *gpu.borrow_mut() = Some(Rc::new(found));
                }
                Err(error) => tell(&Array::of2(&"no graphics".into(), &error.to_string().into())),
            }
        });
    }

    fn begin(&self, words: &Words) {
        self.task.set(words.number());
        let runner = runner(words).map_err(|reason| fail(words.number(), &reason));
        *self.runner.borrow_mut() = runner.ok().map(Rc::new);
    }

    fn take(&self, number: f64, cells: Vec<usize>) {
        let (Some(gpu), Some(runner)) = (self.gpu.borrow().clone(), self.runner.borrow().clone()) else { return };
        let present = Rc::clone(&self.task);
        if present.get() != number {
            return;
        }
        if !Gpu::serves(&runner) {
            return tell(&Array::of2(&"refused".into(), &number.into()));
        }
        spawn_local(async move {
            match gpu.rows(&runner, &cells, &|| present.get() == number).await {
                Ok((served, rows)) => {
                    let handed_over = Array::new();
                    answer(number, &rows_part(&served, &rows, &handed_over), &handed_over);
                }
                Err(GpuError::Unwanted) => {}
                Err(error) => tell(&Array::of3(&"lost".into(), &number.into(), &error.to_string().into())),
            }
        });
    }
}
