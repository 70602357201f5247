//! The result of a filter's run over a record, as plain numbers.

use super::{ChannelScore, Look};
use crate::numbers::diagnostics::accuracy::is_lost;
use crate::numbers::diagnostics::{ErrorSums, Total};
use crate::{Channel, Stop};

/// The result of one filter's run over one record.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The number of samples that the filter has done.
    pub samples: usize,
    /// The sum of the NEES over all samples.
    pub nees: Total,
    /// The sum of the NIS over all samples with a measurement.
    pub nis: Total,
    /// Sum of the log likelihoods of all samples with a measurement.
    pub log_likelihood: f64,
    /// Where and why the filter stopped, if it did.
    pub stop: Option<Stop>,
    /// Whether the filter has stopped or lost the truth ([`Scores::diverged`](super::Scores::diverged)).
    pub diverged: bool,
    /// The accuracy of each channel with a known truth, in the filter's order.
    pub channels: Vec<(Channel, ChannelScore)>,
    /// The last mean of every channel, in its unit; NaN where there is no sample.
    pub mean: Vec<f64>,
    /// The last standard deviation of every channel, in its unit; NaN where there is no sample.
    pub std: Vec<f64>,
    /// The filter at the wanted samples, up to the last one that it reached.
    pub looks: Vec<Look>,
}

/// Limits the error, in standard deviations: above it, and above the truth and the initial uncertainty, the truth is
/// lost.
pub(crate) const LOST: f64 = 10.0;

/// The running sums of one channel of known truth, in its unit.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct ChannelSums {
    /// All errors.
    pub total: ErrorSums,
    /// The first absolute error.
    pub first_error: f64,
    /// The largest absolute truth.
    pub largest_truth: f64,
    /// The sample since which the error has stayed small, or the number of samples.
    pub settled: usize,
    /// The errors' squares and their number in the record's last fifth.
    pub recent: (f64, u32),
    /// The last mean minus the truth, in canonical form.
    pub error: f64,
    /// The last standard deviation.
    pub std: f64,
    /// The first standard deviation.
    pub initial_std: f64,
}

impl ChannelSums {
    /// The accuracy over this many samples. `None` if the truth is not known.
    pub fn score(&self, samples: usize) -> Option<ChannelScore> {
        let Self { total, settled, error, std, .. } = *self;
        (total.known > 0).then(|| ChannelScore {
            error,
            std,
            rmse: total.rmse(),
            coverage: total.coverage(),
            settled: (settled < samples).then_some(settled),
        })
    }

    /// Whether the truth is lost in the record's last fifth.
    pub fn is_lost(&self) -> bool {
        let Self { first_error, largest_truth, recent: (squares, samples), std, initial_std, .. } = *self;
        let rmse = (squares / f64::from(samples)).sqrt();
        is_lost(rmse, std, LOST, largest_truth.max(first_error), initial_std)
    }
}
