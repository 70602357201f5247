//! The end of a run.

/// The last error of a channel in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LastError {
    /// Estimate minus truth, in the channel's unit.
    pub error: f64,
    /// The truth.
    pub truth: f64,
    /// The standard deviation that the filter states.
    pub std: f64,
}

impl LastError {
    /// Whether the estimate is within this share of the truth.
    pub fn is_within(&self, share: f64) -> bool {
        self.error.abs() <= share * self.truth.abs()
    }

    /// Whether the truth is within ±2σ.
    pub fn is_covered(&self) -> bool {
        self.error.abs() <= 2.0 * self.std
    }
}
