//! Scores of a filter that need no history.

pub(crate) mod lane_sums;
pub(crate) mod lanes;

use kalmanscope_filters::engine::level::Baseline;
use kalmanscope_filters::{Channel, Stop};
use kalmanscope_records::Record;

use crate::run::sink::{Sample, Sink};
use crate::statistics::diagnostics::accuracy::is_lost;
use crate::statistics::diagnostics::{ErrorSums, Total};
use crate::{Estimates, Pass, RunError, Scenario};
use lane_sums::ScoreSums;

/// Running sums over the samples of one filter, in constant memory, with the bits of [`Diagnostics`](crate::Diagnostics).
#[derive(Clone, Debug)]
pub struct Scores {
    pub(crate) sums: ScoreSums<f64>,
    own_likelihood: Option<f64>,
    truth: Vec<f64>,
    stop: Option<Stop>,
}

impl Default for Scores {
    fn default() -> Self {
        Self { sums: ScoreSums::new(&[], |_| false, 0, 0), own_likelihood: None, truth: Vec::new(), stop: None }
    }
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
    /// Empty sums, for the samples of a filter with this history over the whole of a record that are not forgotten.
    pub fn new(history: &Estimates, record: &Record) -> Self {
        let is_known = |channel| record.truth(channel).is_some();
        let (all, first) = (record.len(), history.forgotten());
        Self {
            sums: ScoreSums::new(history.channels(), is_known, all, first),
            own_likelihood: history.kind.has_own_likelihood().then_some(0.0),
            ..Self::default()
        }
    }

    /// The sink for samples of this record, which must be the one given to [`Self::new`].
    pub fn against<'a>(&'a mut self, record: &'a Record) -> Scoring<'a> {
        Scoring { scores: self, record, history: None }
    }

    /// All scores at once.
    pub fn outcome(&self) -> Outcome {
        Outcome { log_likelihood: self.log_likelihood(), ..self.sums.outcome(0, self.stop) }
    }

    pub(crate) fn log_likelihood(&self) -> f64 {
        self.own_likelihood.unwrap_or_else(|| self.sums.log_likelihood(0))
    }
}

/// [`Scores`] with their record, as a sink.
pub struct Scoring<'a> {
    scores: &'a mut Scores,
    record: &'a Record,
    history: Option<&'a mut Estimates>,
}

impl Sink for Scoring<'_> {
    fn push(&mut self, sample: &Sample<'_>) {
        if let Some(history) = &mut self.history {
            history.push(sample);
        }
        let Scores { sums, own_likelihood, truth, .. } = &mut *self.scores;
        let Some(k) = sums.samples.checked_sub(self.record.forgotten()) else { return };
        truth.clear();
        truth.extend(sums.tracked.iter().map(|one| self.record.truth(one.channel).map_or(f64::NAN, |truth| truth[k])));
        let readings = sample.readings();
        let of_update = if readings > 0 { [sample.nis, sample.determinant] } else { [0.0, 1.0] };
        sums.take_update(of_update, f64::from(readings), |_| sample.ln_determinant());
        sums.take_belief(Baseline, [sample.mean, sample.cov], truth);
        if let Some(sum) = own_likelihood.as_mut().filter(|_| readings > 0) {
            *sum += sample.log_likelihood;
        }
    }

    fn stop_at(&mut self, stop: Stop) {
        self.scores.stop = Some(stop);
        if let Some(history) = &mut self.history {
            history.stop_at(stop);
        }
    }
}

/// The result of one filter's run over one record.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The number of samples that the filter has done.
    pub samples: usize,
    /// The sum of the NEES over all samples; [`Total::mean`] is the mean.
    pub nees: Total,
    /// The sum of the NIS over all samples with a measurement.
    pub nis: Total,
    /// Sum of the log likelihoods of all samples with a measurement.
    pub log_likelihood: f64,
    /// Where and why the filter stopped, if it did.
    pub stop: Option<Stop>,
    /// Whether it has stopped or lost the truth: in the last fifth an error exceeds 10σ, the truth and the initial σ.
    pub diverged: bool,
    /// The accuracy of each channel with a known truth, in the filter's order.
    pub channels: Vec<(Channel, ChannelScore)>,
    /// The last mean of every channel, in its unit; NaN where there is no sample.
    pub mean: Vec<f64>,
    /// The last standard deviation of every channel, in its unit; NaN where there is no sample.
    pub std: Vec<f64>,
    /// The filter at the wanted samples, up to the last one that it reached.
    pub sample_scores: Vec<SampleScore>,
}

/// The truth is lost above this error in standard deviations, if it is above the truth and the initial σ too.
pub const LOST: f64 = 10.0;

/// The running sums of one channel of known truth, in its unit.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct ChannelSums {
    pub total: ErrorSums,
    pub first_error: f64,
    pub largest_truth: f64,
    /// The sample since which the error has stayed small, or the number of samples.
    pub settled: usize,
    /// The errors' squares and their number in the record's last fifth.
    pub recent: (f64, u32),
    /// The last mean minus the truth, in canonical form.
    pub error: f64,
    pub std: f64,
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

/// One filter at one sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleScore {
    /// NEES; NaN without a known truth.
    pub nees: f64,
    /// NIS; NaN without a measurement.
    pub nis: f64,
    /// Error and standard deviation of every channel in its unit, in the filter's order; NaN without a known truth.
    pub channels: Vec<[f64; 2]>,
}

/// A filter's run over a record, as far as it has come. The outcome does not depend on how the work is divided.
pub struct ScoredPass {
    pass: Pass,
    scores: Scores,
    samples: Vec<usize>,
    sample_scores: Vec<SampleScore>,
    history: Option<Estimates>,
}

impl ScoredPass {
    /// The filter at `place` before the first sample, to be scored after these samples, which are in order.
    ///
    /// # Errors
    /// Those of [`Pass::new`].
    pub fn new(
        scenario: &Scenario,
        place: usize,
        record: &Record,
        samples: &[usize],
        needs_history: bool,
    ) -> Result<Self, RunError> {
        let history = Pass::history(scenario, place)?;
        let scores = Scores::new(&history, record);
        let pass = Pass::new(scenario, place, record)?;
        let history = needs_history.then_some(history);
        Ok(Self { pass, scores, samples: samples.to_vec(), sample_scores: Vec::new(), history })
    }

    /// The number of samples done, counted from the record's beginning.
    pub fn done(&self) -> usize {
        self.pass.done()
    }

    /// Continues until `samples` samples, counted from the record's beginning, are done. Returns whether the end is reached.
    pub fn advance(&mut self, record: &Record, samples: usize) -> bool {
        let Self { pass, scores, samples: asked, sample_scores, history } = self;
        let mut sink = Scoring { scores, record, history: history.as_mut() };
        while let Some(&sample) = asked.get(sample_scores.len()).filter(|sample| **sample < samples) {
            pass.follow(record, sample.saturating_add(1), &mut sink);
            if sink.scores.sums.samples != sample.saturating_add(1) {
                asked.truncate(sample_scores.len());
                break;
            }
            sample_scores.push(sink.scores.sums.sample_score(0));
        }
        pass.follow(record, samples, &mut sink);
        pass.done() >= record.forgotten() + record.len()
    }

    /// The outcome so far, and the history if it is kept.
    pub fn finish(self) -> (Outcome, Option<Estimates>) {
        (Outcome { sample_scores: self.sample_scores, ..self.scores.outcome() }, self.history)
    }
}

impl Outcome {
    /// Runs the filter at `place` of a scenario over the whole of a record, with the scores at each of these samples, which are in order.
    ///
    /// # Errors
    /// Those of [`Pass::new`](crate::Pass::new).
    pub fn at(scenario: &Scenario, place: usize, record: &Record, samples: &[usize]) -> Result<Self, RunError> {
        let mut pass = ScoredPass::new(scenario, place, record, samples, false)?;
        pass.advance(record, usize::MAX);
        Ok(pass.finish().0)
    }
}
