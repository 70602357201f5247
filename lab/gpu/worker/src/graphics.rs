//! The worker's graphics processor.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use js_sys::Array;
use kalmanscope_gpu::{Gpu, GpuError, Software};
use kalmanscope_lab::Runner;
use kalmanscope_worker::{Watch, Words, answer, cells, hear, runner, tell};
use wasm_bindgen_futures::spawn_local;

/// The processor, once it has been found, and the last job.
#[derive(Default)]
struct Graphics {
    gpu: Rc<RefCell<Option<Rc<Gpu>>>>,
    job: Rc<Cell<f64>>,
    runner: RefCell<Option<Rc<Runner>>>,
}

/// Answers messages for as long as the worker lives.
pub(crate) fn serve() {
    let graphics = Graphics::default();
    hear(move |words| match words.text(0).as_str() {
        "graphics" => graphics.find(words.get(1).is_truthy()),
        "ensemble" => graphics.begin(words),
        "cells" => graphics.take(words.job(), cells(words.get(2))),
        _ => {}
    });
}

impl Graphics {
    /// Looks for a processor, or a software adapter if that is accepted, and tells the page.
    fn find(&self, software: bool) {
        let gpu = Rc::clone(&self.gpu);
        let software = if software { Software::Allowed } else { Software::Refused };
        spawn_local(async move {
            match Gpu::find(software).await {
                Ok(found) => {
                    tell(&Array::of2(&"graphics".into(), &found.name().into()));
                    *gpu.borrow_mut() = Some(Rc::new(found));
                }
                Err(error) => tell(&Array::of2(&"no graphics".into(), &error.to_string().into())),
            }
        });
    }

    /// Takes a new job: the cells of those before are not wanted any more.
    fn begin(&self, words: &Words) {
        let job = words.job();
        self.job.set(job);
        *self.runner.borrow_mut() = match runner(&words.text(2), &words.get(3)) {
            Ok(runner) => Some(Rc::new(runner)),
            Err(reason) => {
                tell(&Array::of3(&"failed".into(), &job.into(), &reason.into()));
                None
            }
        };
    }

    /// Runs some cells of the present job, and answers when they are done.
    fn take(&self, job: f64, cells: Vec<usize>) {
        let (Some(gpu), Some(runner)) = (self.gpu.borrow().clone(), self.runner.borrow().clone()) else { return };
        let present = Rc::clone(&self.job);
        if present.get() != job {
            return;
        }
        if !Gpu::serves(&runner) {
            return tell(&Array::of2(&"refused".into(), &job.into()));
        }
        let watch = Watch::start();
        spawn_local(async move {
            match gpu.rows(&runner, &cells, &|| present.get() == job).await {
                Ok((served, rows)) => answer(job, &served, &rows, &watch),
                Err(GpuError::Unwanted) => {}
                Err(error) => tell(&Array::of3(&"lost".into(), &job.into(), &error.to_string().into())),
            }
        });
    }
}
