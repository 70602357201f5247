//! Kalmanscope for Python: scenarios, records, runs, filters that follow samples as they come, tuning and sweeps.

mod arrays;
mod lab;
mod online;
mod record;
mod results;
mod scenario;

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use kalmanscope_core::Task;
use pyo3::create_exception;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;

create_exception!(kalmanscope, Error, PyValueError, "What is wrong with a scenario, record or call.");

fn error(reason: impl ToString) -> PyErr {
    Error::new_err(reason.to_string())
}

/// A key that there is not, and those that there are.
fn no_key(key: &str, known: &[impl AsRef<str>]) -> PyErr {
    let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
    PyKeyError::new_err(format!("there is no `{key}`, but {}", known.join(", ")))
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

/// The time between two looks for Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(20);

/// Works in a thread of its own without the GIL, and looks for Ctrl-C meanwhile: Python's signals come to its main thread alone,
/// which would hear them only after the work. After Ctrl-C the call does not wait for the thread, which ends with its portion of work.
fn interruptible<T: Send + 'static>(py: Python<'_>, work: impl FnOnce(&Wanted) -> T + Send + 'static) -> PyResult<T> {
    py.detach(|| {
        let wanted = Arc::new(Wanted(AtomicBool::new(true)));
        let (sender, outcome) = channel();
        let of_worker = Arc::clone(&wanted);
        let worker = std::thread::spawn(move || sender.send(work(&of_worker)));
        loop {
            match outcome.recv_timeout(PATIENCE) {
                Ok(outcome) => return Ok(outcome),
                Err(RecvTimeoutError::Timeout) => {
                    Python::attach(|py| py.check_signals()).inspect_err(|_| wanted.0.store(false, Ordering::Relaxed))?
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(worker
                        .join()
                        .map_or_else(|panic| resume_unwind(panic), |_| error("the work was lost")));
                }
            }
        }
    })
}

#[pymodule]
fn _kalmanscope(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<scenario::Scenario>()?;
    module.add_class::<record::Record>()?;
    module.add_class::<results::Whole>()?;
    module.add_class::<results::Estimates>()?;
    module.add_class::<online::Online>()?;
    module.add_function(wrap_pyfunction!(results::run, module)?)?;
    module.add_function(wrap_pyfunction!(lab::tune, module)?)?;
    module.add_function(wrap_pyfunction!(lab::sweep, module)?)
}
