//! The result of one filter's run over one record, as numbers.

use kalmanscope_core::score::{Outcome, Scoring};
use kalmanscope_core::{
    Estimates, FirstCause, Measure, Observed, Pass, Record, RunError, Sample, Scenario, Scores, Sink, Stop, Task,
    Times, Value, Whole,
};

pub(crate) fn any(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    measures: &[Measure],
) -> Result<Vec<f64>, RunError> {
    if measures.iter().any(|measure| measure.info().needs_history()) {
        return of_history(scenario, place, record, measures);
    }
    let outcome = Outcome::of(scenario, place, record)?;
    Ok(of_sums(scenario, place, record, measures, &outcome))
}

/// From all estimates; NaN where one is not known.
fn of_history(scenario: &Scenario, place: usize, record: &Record, measures: &[Measure]) -> Result<Vec<f64>, RunError> {
    let mut pass = HistoryPass::new(scenario, place, record)?;
    pass.advance(record, record.len());
    Ok(pass.measures(scenario, place, record, measures))
}

pub(crate) fn place_of_cause(measures: &[Measure]) -> Option<usize> {
    measures.iter().position(|measure| *measure == Measure::CAUSE)
}

pub(crate) fn number_of(search: FirstCause) -> f64 {
    Value::Cause(search.finish()).number()
}

/// A filter's run over a record, as far as it has come. It keeps all estimates.
pub(crate) struct HistoryPass {
    pass: Pass,
    estimates: Estimates,
    scores: Scores,
}

impl HistoryPass {
    pub(crate) fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, RunError> {
        let estimates = Pass::history(scenario, place)?;
        let scores = Scores::new(&estimates, record);
        Ok(Self { pass: Pass::new(scenario, place, record)?, estimates, scores })
    }

    pub(crate) fn done(&self) -> usize {
        self.pass.done()
    }

    /// Continues until `samples` samples are done, or to the end of the record. Returns whether the end is reached.
    pub(crate) fn advance(&mut self, record: &Record, samples: usize) -> bool {
        let Self { pass, estimates, scores } = self;
        pass.follow(record, samples, &mut Both(estimates, scores.against(record)));
        pass.done() >= record.len()
    }

    pub(crate) fn first_cause(&self, scenario: &Scenario, place: usize, record: &Record) -> FirstCause {
        FirstCause::new(scenario, place, &self.estimates, record)
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
        let whole = Whole::new(record, &outcome, estimates.channels());
        let observed = Observed::new(scenario, place, record, estimates);
        let number = |measure: &Measure| match measure.info().needs_history() {
            true => measure.of(&observed, Times::default()).number(),
            false => measure.of_whole(&whole),
        };
        measures.iter().map(number).collect()
    }
}

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

pub(crate) fn of_sums(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    measures: &[Measure],
    outcome: &Outcome,
) -> Vec<f64> {
    let model = scenario.filters[place].model(scenario.plant.kind, scenario.input);
    let whole = Whole::new(record, outcome, model.channels());
    measures.iter().map(|measure| measure.of_whole(&whole)).collect()
}

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
