//! The reasons why a reading is refused.

use thiserror::Error;

use super::LiveRecord;

/// The reason why a [`LiveRecord`] does not take in what came.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LiveError {
    /// The number of readings is not that of the sensors.
    #[error("there are {found} readings, but the record has {expected} sensors: a missing reading is NaN")]
    Readings {
        /// The number of readings.
        found: usize,
        /// The number of sensors.
        expected: usize,
    },
    /// A number is infinite, or the time is NaN.
    #[error("a reading, the input or the time is no finite number")]
    Infinite,
    /// Its sample is complete.
    #[error("the time is {time} s, but what was until {complete} s is complete: it comes too late")]
    TooLate {
        /// The time \[s\].
        time: f64,
        /// The time of the last complete sample \[s\].
        complete: f64,
    },
    /// The clock stands still, or is far too slow, while readings come.
    #[error("{} readings of a sensor wait for their samples: the clock hardly goes on", LiveRecord::MOST_WAITING)]
    Burst,
    /// Nothing came for too long.
    #[error(
        "the time is {time} s, but before it was {before} s: at most {} steps may be empty",
        LiveRecord::LONGEST_GAP
    )]
    Gap {
        /// The time \[s\].
        time: f64,
        /// The newest time before it \[s\].
        before: f64,
    },
    /// There are as many samples, or readings of a sensor, as a record may have.
    #[error(
        "the record is full: it has at most {} samples and {} readings of a sensor",
        LiveRecord::MOST,
        LiveRecord::MOST_READINGS
    )]
    Full,
}
