//! The result of one filter's run over one record, as numbers.

use kalmanscope_core::free_run::one_step;
use kalmanscope_core::score::{ChannelScore, Outcome, Scoring};
use kalmanscope_core::{
    Channel, Diagnosis, Diagnostics, Estimates, Identified, Pass, Record, RunError, Sample, Scenario, Scores, Sink,
    Stop, VerdictKind,
};

use crate::Measure;

/// Any measures of the filter at `place` of a scenario over a record.
///
/// # Errors
/// [`RunError`] where the scenario is impossible, lacks the filter, or does not fit the record.
pub(crate) fn any(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    measures: &[Measure],
) -> Result<Vec<f64>, RunError> {
    if measures.iter().any(|measure| measure.info().needs_history) {
        return of_history(scenario, place, record, measures);
    }
    let outcome = Outcome::of(scenario, place, record)?;
    Ok(of_sums(scenario, place, record, measures, &outcome))
}

/// The measures of the filter at `place` of a scenario over a record, from all its estimates; NaN where one is not known.
///
/// # Errors
/// [`RunError`] where the scenario is impossible, lacks the filter, or does not fit the record.
fn of_history(scenario: &Scenario, place: usize, record: &Record, measures: &[Measure]) -> Result<Vec<f64>, RunError> {
    let mut pass = HistoryPass::new(scenario, place, record)?;
    pass.advance(record, record.len());
    Ok(pass.measures(scenario, place, record, measures))
}

/// A filter's run over a record, as far as it has come. It keeps all estimates.
pub(crate) struct HistoryPass {
    pass: Pass,
    estimates: Estimates,
    scores: Scores,
}

impl HistoryPass {
    /// The filter at `place` of a scenario before the first sample of a record.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible, lacks the filter, or does not fit the record.
    pub(crate) fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, RunError> {
        let estimates = Pass::history(scenario, place)?;
        let scores = Scores::new(&estimates, record);
        Ok(Self { pass: Pass::new(scenario, place, record)?, estimates, scores })
    }

    /// The number of samples done.
    pub(crate) fn done(&self) -> usize {
        self.pass.done()
    }

    /// Goes on until `samples` samples are done, or to the end of the record. Returns whether the end is reached.
    pub(crate) fn advance(&mut self, record: &Record, samples: usize) -> bool {
        let Self { pass, estimates, scores } = self;
        pass.follow(record, samples, &mut Both(estimates, scores.against(record)));
        pass.done() >= record.len()
    }

    /// The measures of the whole run; NaN where one is not known.
    pub(crate) fn measures(
        &self,
        scenario: &Scenario,
        place: usize,
        record: &Record,
        measures: &[Measure],
    ) -> Vec<f64> {
        let Self { estimates, scores, .. } = self;
        let outcome = scores.outcome();
        let number = |measure: &Measure| match *measure {
            Measure::Verdict => verdict(estimates, record),
            Measure::FreeRun(quantity) => {
                let Some(last) = estimates.len().checked_sub(1) else { return f64::NAN };
                let model = Identified::at(scenario, &scenario.filters[place], estimates, last);
                model.run(record, 0..record.len()).fit(record, quantity).map_or(f64::NAN, |fit| fit.rms)
            }
            Measure::OneStep(quantity) => {
                let sensor = record.sensors().iter().position(|sensor| *sensor == quantity);
                let fit = sensor.and_then(|sensor| one_step(estimates, record, sensor, 0..record.len()));
                fit.map_or(f64::NAN, |fit| fit.rms)
            }
            other => of_sum(other, &outcome, estimates.channels(), record),
        };
        measures.iter().map(number).collect()
    }
}

/// A history and the scores, of one pass.
struct Both<'a>(&'a mut Estimates, Scoring<'a>);

impl Sink for Both<'_> {
    fn push(&mut self, sample: &Sample<'_>) {
        self.0.push(sample);
        self.1.push(sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.0.stop_at(stop);
        self.1.stop_at(stop);
    }
}

/// The measures that follow from sums alone.
pub(crate) fn of_sums(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    measures: &[Measure],
    outcome: &Outcome,
) -> Vec<f64> {
    let model = scenario.filters[place].model(scenario.plant.kind, scenario.input);
    measures.iter().map(|&measure| of_sum(measure, outcome, model.channels(), record)).collect()
}

fn verdict(estimates: &Estimates, record: &Record) -> f64 {
    let diagnostics = Diagnostics::new(estimates, record);
    let diagnosis = Diagnosis::new(&diagnostics, estimates, record, None);
    let kind = diagnosis.and_then(|diagnosis| diagnosis.verdict).map(|verdict| verdict.kind);
    let place = kind.and_then(|kind| VerdictKind::ALL.iter().position(|other| *other == kind));
    place.map_or(f64::NAN, |place| place as f64)
}

fn of_sum(measure: Measure, outcome: &Outcome, channels: &[Channel], record: &Record) -> f64 {
    let flag = |is: bool| if is { 1.0 } else { 0.0 };
    let score = |channel: Channel| outcome.channels.iter().find(|(other, _)| *other == channel).map(|(_, score)| score);
    let of = |channel, number: fn(&ChannelScore) -> f64| score(channel).map_or(f64::NAN, number);
    let place = |channel| channels.iter().position(|other| *other == channel);
    match measure {
        Measure::Nis => outcome.nis.per_degree(),
        Measure::Nees => outcome.nees.per_degree(),
        Measure::Consistency => consistency(outcome),
        Measure::LogLikelihood => outcome.log_likelihood,
        Measure::Diverged => flag(outcome.diverged),
        Measure::Stopped => flag(outcome.stop.is_some()),
        Measure::Error(channel) => of(channel, |score| score.error),
        Measure::Rmse(channel) => of(channel, |score| score.rmse),
        Measure::Coverage(channel) => of(channel, |score| score.coverage),
        Measure::Settled(channel) => score(channel).map_or(f64::NAN, |score| {
            score.settled.filter(|_| outcome.stop.is_none()).map_or(f64::INFINITY, |k| record.time_of(k))
        }),
        Measure::Estimate(channel) => place(channel).map_or(f64::NAN, |place| canonical(outcome, channels, place)),
        Measure::Std(channel) => place(channel).map_or(f64::NAN, |place| outcome.std[place]),
        Measure::Verdict | Measure::FreeRun(_) | Measure::OneStep(_) => f64::NAN,
    }
}

/// The last mean of a channel in the canonical form of the oscillator, with a natural frequency that is not negative.
fn canonical(outcome: &Outcome, channels: &[Channel], place: usize) -> f64 {
    let frequency = channels.iter().position(|channel| *channel == Channel::NATURAL_FREQUENCY);
    let is_mirrored = frequency.is_some_and(|place| outcome.mean[place] < 0.0);
    if is_mirrored && channels[place].is_mirrored() { -outcome.mean[place] } else { outcome.mean[place] }
}

/// The sum of d squares of white normalised innovations has the mean d and the variance 2d.
///
/// Source: Bar-Shalom, Li and Kirubarajan (2001), section 5.4.
fn consistency(outcome: &Outcome) -> f64 {
    let degrees = f64::from(outcome.nis.degrees);
    (outcome.nis.sum - degrees) / libm::sqrt(2.0 * degrees)
}
