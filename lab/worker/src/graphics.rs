//! The worker's graphics processor, if the page has asked for it.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use js_sys::Array;
use kalmanscope_gpu::{Gpu, GpuError, Software};
use kalmanscope_lab::Runner;
use wasm_bindgen_futures::spawn_local;

use crate::serve::{answer, tell};

/// The processor, once it has been found, and the last job.
#[derive(Clone, Default)]
pub(crate) struct Graphics {
    gpu: Rc<RefCell<Option<Rc<Gpu>>>>,
    job: Rc<Cell<f64>>,
}

impl Graphics {
    /// Looks for a processor, or a program in its place where that will do, and tells the page.
    pub(crate) fn find(&self, software: bool) {
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

    /// Notes a new job: the cells of those before are not wanted any more.
    pub(crate) fn begin(&self, job: f64) {
        self.job.set(job);
    }

    /// Runs some cells, and answers when they are done. Returns whether there is a processor.
    pub(crate) fn take(&self, job: f64, cells: &[usize], runner: &Rc<Runner>) -> bool {
        let Some(gpu) = self.gpu.borrow().clone() else { return false };
        let (present, cells, runner) = (Rc::clone(&self.job), cells.to_vec(), Rc::clone(runner));
        spawn_local(async move {
            if !Gpu::serves(&runner) {
                return tell(&Array::of2(&"refused".into(), &job.into()));
            }
            match gpu.rows(&runner, &cells, &|| present.get() == job).await {
                Ok(rows) => answer(job, &cells, &rows),
                Err(GpuError::Unwanted) => {}
                Err(error) => tell(&Array::of3(&"lost".into(), &job.into(), &error.to_string().into())),
            }
        });
        true
    }
}
