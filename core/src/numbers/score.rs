//! Scores of a filter that need no history.

mod lane_sums;
pub(crate) mod lanes;
mod log_products;
mod look;
pub(crate) mod outcome;
mod scored_pass;

use crate::mathematics::engine::level::Baseline;
use crate::mathematics::gaussian_likelihood::ln_determinant;
use crate::numbers::diagnostics::Total;
use crate::samples::sink::{Sample, Sink};
use crate::{Channel, Estimates, Record, Stop};

pub use look::Look;
pub use outcome::Outcome;
pub use scored_pass::ScoredPass;

/// Running sums over the samples of one filter, in constant memory, for maps of thousands of runs. The numbers are
/// bit-identical to those of [`Diagnostics`](crate::Diagnostics).
///
/// ```
/// use kalmanscope_core::{Channel, Pass, Run, Scenario, Scores};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario { duration: 20.0, ..Scenario::default() };
/// let mut run = Run::new(&Scenario { filters: vec![], ..scenario.clone() })?;
/// run.finish();
/// let mut scores = Scores::new(&Pass::history(&scenario, 0)?, run.record());
/// Pass::new(&scenario, 0, run.record())?.follow(run.record(), run.samples(), &mut scores.against(run.record()));
/// assert!(scores.channel(Channel::NATURAL_FREQUENCY).unwrap().rmse < 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Scores {
    sums: lane_sums::Scores<f64>,
    sensors: usize,
    /// The sum of the log likelihoods of a filter that has its own.
    own_likelihood: Option<f64>,
    /// The truth of each channel that has one.
    truth: Vec<f64>,
    channels: Vec<Channel>,
    stop: Option<Stop>,
}

/// The accuracy of one channel, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelScore {
    /// The last mean minus the truth.
    pub error: f64,
    /// The last standard deviation.
    pub std: f64,
    /// Root mean square error over all samples.
    pub rmse: f64,
    /// The share of samples with the truth inside ±2σ.
    pub coverage: f64,
    /// The sample since which the estimate has stayed within 5 % of the truth, if it is.
    pub settled: Option<usize>,
}

impl Scores {
    /// Empty sums, for a filter with this empty history over the whole of a record.
    pub fn new(history: &Estimates, record: &Record) -> Self {
        let channels: Vec<Channel> = history.channels().to_vec();
        let is_known = |channel| record.truth(channel).is_some();
        Self {
            sums: lane_sums::Scores::new(&channels, is_known, record.len()),
            sensors: history.sensors().len(),
            own_likelihood: history.kind().has_own_likelihood().then_some(0.0),
            channels: channels.into_iter().filter(|channel| is_known(*channel)).collect(),
            truth: Vec::new(),
            stop: None,
        }
    }

    /// The sink for samples of this record, which must be the one given to [`Self::new`].
    pub fn against<'a>(&'a mut self, record: &'a Record) -> Scoring<'a> {
        Scoring { scores: self, record }
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The sum of the NEES over all samples; [`Total::mean`] is the mean.
    pub fn nees(&self) -> Total {
        self.outcome().nees
    }

    /// The sum of the NIS over all samples with a measurement.
    pub fn nis(&self) -> Total {
        self.outcome().nis
    }

    /// The filter at the last sample.
    pub fn look(&self) -> Look {
        self.sums.look(0)
    }

    /// Sum of the log likelihoods of all samples with a measurement.
    pub fn log_likelihood(&self) -> f64 {
        self.outcome().log_likelihood
    }

    /// The accuracy of a channel. `None` if the truth is not known.
    pub fn channel(&self, channel: Channel) -> Option<ChannelScore> {
        self.outcome().channels.into_iter().find(|(other, _)| *other == channel).map(|(_, score)| score)
    }

    /// Where and why the filter stopped, if it did.
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Whether the filter has stopped or lost the truth: in the last fifth of the record a channel's error exceeds 10σ,
    /// the largest truth and the initial uncertainty.
    pub fn diverged(&self) -> bool {
        self.outcome().diverged
    }

    /// All scores at once.
    pub fn outcome(&self) -> Outcome {
        let outcome = self.sums.outcome(0, self.stop);
        Outcome { log_likelihood: self.own_likelihood.unwrap_or(outcome.log_likelihood), ..outcome }
    }
}

/// [`Scores`] with their record, as a sink.
pub struct Scoring<'a> {
    scores: &'a mut Scores,
    record: &'a Record,
}

impl Sink for Scoring<'_> {
    fn push(&mut self, sample: &Sample<'_>) {
        let Scores { sums, sensors, own_likelihood, truth, channels, .. } = &mut *self.scores;
        let Some(k) = sums.len().checked_sub(self.record.forgotten()) else { return };
        truth.clear();
        truth.extend(channels.iter().map(|channel| self.record.truth(*channel).map_or(f64::NAN, |truth| truth[k])));
        let readings = sample.readings();
        let of_update = if readings > 0 { [sample.nis, sample.determinant] } else { [0.0, 1.0] };
        sums.take_update(of_update, f64::from(readings), |_| {
            ln_determinant(sample.determinant, sample.innovation_cov, *sensors)
        });
        sums.take_belief(Baseline, [sample.mean, sample.cov], truth);
        if let Some(sum) = own_likelihood.as_mut().filter(|_| readings > 0) {
            *sum += sample.log_likelihood;
        }
    }

    fn stop_at(&mut self, stop: Stop) {
        self.scores.stop = Some(stop);
    }
}
