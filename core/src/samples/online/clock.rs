//! The times of samples that come in one by one.

use super::error::OnlineError;

/// Counts steps of `dt` from each sample to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    dt: f64,
    /// The time of the last sample \[s\].
    last: Option<f64>,
}

impl Clock {
    /// A clock before the first sample, with `dt` \[s\] between samples.
    pub(super) fn new(dt: f64) -> Self {
        Self { dt, last: None }
    }

    /// Moves on to the time of the next sample \[s\]. Returns the number of steps since the last one; 1 for the first sample.
    ///
    /// # Errors
    /// [`OnlineError`] if no sample can have this time; the clock then stays unchanged.
    pub(super) fn advance(&mut self, time: f64) -> Result<usize, OnlineError> {
        let Self { dt, last } = *self;
        if !time.is_finite() {
            return Err(OnlineError::Time(time));
        }
        let steps = match last {
            None => 1.0,
            Some(last) if time <= last => return Err(OnlineError::NotAfter { time, last }),
            Some(last) => {
                let steps = (time - last) / dt;
                let whole = libm::round(steps);
                if whole < 1.0 || (steps - whole).abs() > OnlineError::TOLERANCE {
                    return Err(OnlineError::Uneven { time, last, steps, dt });
                }
                if whole > OnlineError::MOST_STEPS as f64 {
                    return Err(OnlineError::Gap { time, last, steps: whole });
                }
                whole
            }
        };
        self.last = Some(time);
        Ok(steps as usize)
    }
}
