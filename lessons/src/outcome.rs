//! Complete runs of scenarios, with the results that checks need, and the value of a check in them.

use kalmanscope_core::{Diagnostics, Estimates, Run, Scenario, Source};
use kalmanscope_diagnosis::{Analysis, Measure, Observed, Times, Value, Wanted};

use crate::check::Check;
use crate::{LessonError, records};

/// A complete run of a scenario, with its results.
pub struct AnalysedRun {
    /// The complete run.
    pub run: Run,
    analysis: Analysis,
    /// The diagnostics of the smoothed estimates.
    diagnostics: Vec<Diagnostics>,
}

#[derive(Clone, Copy)]
pub(crate) struct FilterOutcome<'a> {
    pub(crate) outcome: &'a AnalysedRun,
    pub(crate) place: usize,
    pub(crate) estimates: &'a Estimates,
    pub(crate) diagnostics: &'a Diagnostics,
}

impl AnalysedRun {
    /// Runs a scenario over its whole record: a simulated one, or the built-in one that it names.
    ///
    /// # Errors
    /// [`LessonError`] where the scenario is impossible, or its record is not built in.
    pub fn of(scenario: &Scenario) -> Result<Self, LessonError> {
        Self::on(scenario, records::source(scenario)?)
    }

    /// Runs a scenario over the whole record of a source.
    ///
    /// # Errors
    /// [`LessonError::Run`] where the scenario is impossible, or the source does not fit it.
    pub fn on(scenario: &Scenario, source: Source) -> Result<Self, LessonError> {
        let mut run = Run::from_source(scenario, source)?;
        run.finish();
        let analysis = Analysis::new(&run, Wanted::default());
        let of = |smoothed: &Estimates| Diagnostics::new(smoothed, run.record());
        let diagnostics = analysis.smoothed().iter().map(of).collect();
        Ok(Self { run, analysis, diagnostics })
    }

    pub(crate) fn filter(&self, name: &str, smoothed: bool) -> Option<FilterOutcome<'_>> {
        let place = self.run.scenario().filters.iter().position(|filter| filter.name == name)?;
        let id = self.run.estimates().get(place)?.id();
        let (all, of_all) = if smoothed {
            (self.analysis.smoothed(), self.diagnostics.as_slice())
        } else {
            (self.run.estimates(), self.analysis.diagnostics())
        };
        let (estimates, diagnostics) = all.iter().zip(of_all).find(|(of, _)| of.id() == id)?;
        Some(FilterOutcome { outcome: self, place, estimates, diagnostics })
    }
}

impl Check {
    /// The value of the check's measure in an outcome, divided by the reference value if the check compares. `before`
    /// is the outcome before the step's change. A number that does not exist is NaN, so that no check holds.
    ///
    /// # Errors
    /// [`LessonError::UnknownFilter`] where an outcome does not have the filter.
    pub fn value(&self, outcome: &AnalysedRun, before: &AnalysedRun) -> Result<Value, LessonError> {
        let find = |outcome: &'_ AnalysedRun, (name, smoothed): (&str, bool), times: Times| {
            let filter = outcome.filter(name, smoothed).ok_or_else(|| LessonError::UnknownFilter(name.to_owned()))?;
            Ok::<_, LessonError>(self.measured(filter, times))
        };
        let value = find(outcome, (&self.filter, self.smoothed), self.times())?;
        let Value::Number(number) = value else { return Ok(value) };
        if !self.is_relative() {
            return Ok(value);
        }
        let reference = if self.before { before } else { outcome };
        match find(reference, self.reference_filter(), self.reference_times())? {
            Value::Number(other) => Ok(Value::Number(number / other)),
            _ => Ok(Value::Number(f64::NAN)),
        }
    }

    /// Whether the measure keeps within the limits of a cell in its outcome.
    pub(crate) fn holds_in(&self, cell: &AnalysedRun) -> Result<bool, LessonError> {
        let value = self.value(cell, cell)?;
        Ok(self.cells.as_ref().is_some_and(|cells| cells.hold(&value)))
    }

    fn measured(&self, filter: FilterOutcome<'_>, times: Times) -> Value {
        let FilterOutcome { outcome, place, estimates, diagnostics } = filter;
        let run = Observed::new(outcome.run.scenario(), place, outcome.run.record(), estimates);
        let run = run.with(diagnostics).among(outcome.run.estimates());
        // None if the measure needs a channel or a sensor that the check does not give.
        let measure = Measure::new(self.measure, self.channel, self.sensor);
        measure.map_or(Value::Number(f64::NAN), |measure| measure.of(&run, times))
    }
}
