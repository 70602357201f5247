//! The reasons why a sample is refused.

use thiserror::Error;

use crate::{Quantity, Stop};

/// The reason why a sample has no estimate.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum OnlineError {
    /// The filter has failed, at this sample or before.
    #[error("the filter has stopped at sample {}: {}", .0.sample, .0.reason)]
    Stopped(Stop),
    /// The number of readings is not that of the sensors.
    #[error("the sample has {found} readings, but the scenario has {expected} sensors: a missing reading is NaN")]
    Readings {
        /// The number of readings.
        found: usize,
        /// The number of sensors.
        expected: usize,
    },
    /// A reading is infinite.
    #[error("the reading of {} is infinite, but must be a number or NaN", .0.key())]
    InfiniteReading(Quantity),
    /// The input is not finite.
    #[error("the input is {0}, but must be a finite number")]
    Input(f64),
    /// The time is not finite.
    #[error("the time is {0}, but must be a finite number of seconds")]
    Time(f64),
    /// The time is not after that of the last sample.
    #[error("the time is {time} s, but must be after {last} s, the time of the last sample")]
    NotAfter {
        /// The time \[s\].
        time: f64,
        /// The time of the last sample \[s\].
        last: f64,
    },
    /// The time is not a whole number of steps after that of the last sample.
    #[error(
        "the time is {time} s, {} steps of {dt} s after the last sample at {last} s, but must be a whole number of steps, \
         within {}",
        shown(*.steps),
        OnlineError::TOLERANCE
    )]
    Uneven {
        /// The time \[s\].
        time: f64,
        /// The time of the last sample \[s\].
        last: f64,
        /// The number of steps between them.
        steps: f64,
        /// The length of a step \[s\].
        dt: f64,
    },
    /// More samples are missing than are filled with predictions.
    #[error(
        "the time is {time} s, {steps} steps after the last sample at {last} s, but at most {} are filled with predictions: \
         begin a new filter",
        OnlineError::MOST_STEPS
    )]
    Gap {
        /// The time \[s\].
        time: f64,
        /// The time of the last sample \[s\].
        last: f64,
        /// The number of steps between them.
        steps: f64,
    },
}

impl OnlineError {
    /// Limits the distance of a sample's time from a whole number of steps after the last sample's, in steps.
    pub const TOLERANCE: f64 = 0.01;

    /// Limits the steps of a gap that is filled with predictions.
    pub const MOST_STEPS: usize = 100_000;
}

/// A number of steps with three decimals at most.
fn shown(steps: f64) -> f64 {
    libm::round(steps * 1e3) / 1e3
}
