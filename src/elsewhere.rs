//! Long work outside the frames: in workers of a page, in threads of the desktop.

use std::time::Duration;

use kalmanscope_core::import::Loaded;
use kalmanscope_core::suggest::Suggestion;
use kalmanscope_core::{Record, Scenario, Tape};

/// The time between two frames that only show the progress of such work.
pub(crate) const BETWEEN: Duration = Duration::from_millis(100);

/// A filter under way. It sends samples.
pub type FilterWork = Box<dyn Work<Tape>>;

/// A file that is read. It sends its share that is done, then its columns or the reason why it cannot be read.
pub type LoadingWork = Box<dyn Work<Report<Result<Loaded, String>>>>;

/// Start values under way. They send their share that is done, then the settings.
pub type SuggestWork = Box<dyn Work<Report<Suggestion>>>;

/// Does long work outside the frames. Each method returns `None` if it cannot.
pub trait Elsewhere {
    /// Begins to run the filter at a place of a scenario over all of a record.
    fn filter(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<FilterWork>;

    /// Begins to read the file with these bytes.
    fn loading(&self, bytes: &[u8]) -> Option<LoadingWork>;

    /// Begins to make start values for a scenario on a record.
    fn suggest(&self, scenario: &Scenario, record: &Record) -> Option<SuggestWork>;
}

/// Work in a worker or a thread. It ends when it is dropped.
pub trait Work<T> {
    /// Takes the next message of the work, if one has come.
    ///
    /// # Errors
    /// [`Lost`] if no more will come.
    fn next(&mut self) -> Result<Option<T>, Lost>;
}

/// The work has failed; its messages so far must be dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost;

/// A message of work that has an outcome.
#[derive(Clone, Debug, PartialEq)]
pub enum Report<T> {
    /// The share that is done, from 0 to 1.
    Share(f64),
    /// The outcome.
    Done(T),
}
