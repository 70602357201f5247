//! Kalmanscope for Python: scenarios, records, runs, filters that follow samples as they come, tuning and sweeps.

mod arrays;
mod lab;
mod online;
mod record;
mod results;
mod scenario;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use kalmanscope_core::Task;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(
    kalmanscope,
    Error,
    PyValueError,
    "What is wrong with a scenario, a record or a call, in a sentence."
);

fn error(reason: impl ToString) -> PyErr {
    Error::new_err(reason.to_string())
}

/// Whether a call is still wanted: Ctrl-C ends it.
struct Wanted(AtomicBool);

impl Wanted {
    fn is_so(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// The outcome of a task; `None` where it is no longer wanted.
    fn finish<T: Task>(&self, mut task: T) -> Option<T::Outcome> {
        while self.is_so() {
            if task.advance(&mut || self.is_so()) {
                return Some(task.finish());
            }
        }
        None
    }
}

/// Works in a thread of its own without the GIL, and looks for Ctrl-C meanwhile: Python's signals come to its main thread alone,
/// which would hear them only after the work.
fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Wanted) -> T + Send) -> PyResult<T> {
    const PATIENCE: Duration = Duration::from_millis(20);
    let wanted = Wanted(AtomicBool::new(true));
    py.detach(|| {
        std::thread::scope(|scope| {
            let (working, ended) = channel::<()>();
            let wanted = &wanted;
            let worker = scope.spawn(move || {
                let _working = working;
                work(wanted)
            });
            let mut heard = Ok(());
            while heard.is_ok() && ended.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                heard = Python::attach(|py| py.check_signals());
            }
            wanted.0.store(heard.is_ok(), Ordering::Relaxed);
            let outcome = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            heard.map(|()| outcome)
        })
    })
}

#[pymodule]
fn _kalmanscope(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<scenario::Scenario>()?;
    module.add_class::<record::Record>()?;
    module.add_class::<results::Results>()?;
    module.add_class::<results::Estimates>()?;
    module.add_class::<online::Online>()?;
    module.add_function(wrap_pyfunction!(results::run, module)?)?;
    module.add_function(wrap_pyfunction!(lab::tune, module)?)?;
    module.add_function(wrap_pyfunction!(lab::sweep, module)?)
}
