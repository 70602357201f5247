//! Whether a filter deserves trust: its diagnosis with tests, causes and remedies; scores and story of a run, and the job of the next.

mod analysis;
mod case;
mod cause;
mod checks;
mod diagnosis;
mod measure;
mod periodogram;
mod remedy;
mod search;
mod story;
mod study;
mod summary;
mod sums;
mod trial;
mod words;

pub use analysis::{Analysis, Bound, Hindsight, Wanted};
pub use case::VerdictKind;
pub use cause::{CAUSES, Cause, LikelyCause};
pub use checks::{Evidence, Subject, TESTS, Test};
pub use diagnosis::{Diagnosis, Verdict};
pub use measure::{
    Best, FirstCause, Measure, MeasureInfo, MeasureKind, Observed, Times, UnknownMeasure, Value, ValueKind, Whole,
};
pub use remedy::{Remedy, in_percent};
pub use search::Search;
pub use story::{Adjustable, Phrase, Story};
pub use study::{Job, Progress, Study};
pub use summary::{Final, Score, Summary};
pub use words::with_band;

/// Parts that the tests take from inside. They are not the library: any of them may change or go at any time.
#[doc(hidden)]
pub mod internals {
    pub use crate::cause::{Agreement, Readings, change_point, still_part};
    pub use crate::periodogram::Periodogram;
    pub use crate::words::{percent, percent_to_a_tenth, plain, seconds, short};
}
