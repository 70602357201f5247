//! The reasons why a reading is refused.

use thiserror::Error;

use crate::{FilterError, Quantity};

/// The reason why an [`EventFilter`](crate::EventFilter) does not take in what came.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EventError {
    /// The filter has failed, then or before.
    #[error("the filter has stopped at {time} s: {reason}")]
    Stopped {
        /// The time that it could not reach \[s\].
        time: f64,
        /// The reason.
        reason: FilterError,
    },
    /// The number of readings is not that of the sensors.
    #[error("there are {found} readings, but the scenario has {expected} sensors: a missing reading is NaN")]
    Readings {
        /// The number of readings.
        found: usize,
        /// The number of sensors.
        expected: usize,
    },
    /// A reading is infinite.
    #[error("the reading of {} is infinite, but must be a number or NaN", .0.key())]
    InfiniteReading(Quantity),
    /// The input is infinite.
    #[error("the input is {0}, but must be a finite number, or NaN where nothing is known of it")]
    Input(f64),
    /// The time is not finite.
    #[error("the time is {0}, but must be a finite number of seconds")]
    Time(f64),
    /// It comes later than the filter keeps its beliefs.
    #[error("the time is {time} s, but what was before {oldest} s is no longer kept: it comes too late")]
    TooLate {
        /// The time \[s\].
        time: f64,
        /// The time of the oldest belief \[s\].
        oldest: f64,
    },
    /// The time since what came before is too long to be bridged.
    #[error(
        "the time is {} s, {} steps after {before} s, but at most {} are bridged: begin a new filter",
        legible(*.time),
        legible(*.steps),
        EventError::MOST_STEPS
    )]
    Gap {
        /// The time \[s\].
        time: f64,
        /// The time before it \[s\].
        before: f64,
        /// The steps of dt between them.
        steps: f64,
    },
}

impl EventError {
    /// Limits the steps of dt between two events.
    pub const MOST_STEPS: usize = 100_000;
}

/// A number, with an exponent if it has too many digits.
fn legible(number: f64) -> String {
    if number.abs() < 1e9 { number.to_string() } else { format!("{number:e}") }
}

/// A filter that cannot follow events.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EventSetupError {
    /// The scenario is impossible, or has no such filter.
    #[error(transparent)]
    Run(#[from] crate::RunError),
    /// The filter has a setting that counts in samples.
    #[error("a filter with {0} follows samples at equal times only")]
    Setting(&'static str),
    /// The filter cannot begin.
    #[error(transparent)]
    Filter(#[from] FilterError),
}
