//! Complete runs of scenarios, with the results that checks need.

use kalmanscope_core::{Analysis, Diagnostics, Estimates, Run, Scenario, Source, Wanted};

use crate::{LessonError, records};

/// A complete run of a scenario, with its results.
pub struct Outcome {
    scenario: Scenario,
    run: Run,
    analysis: Analysis,
    /// The diagnostics of the smoothed estimates.
    diagnostics: Vec<Diagnostics>,
}

/// One filter of an outcome, with its estimates or the smoothed ones.
#[derive(Clone, Copy)]
pub(crate) struct FilterOutcome<'a> {
    pub(crate) outcome: &'a Outcome,
    /// The filter's place in the scenario.
    pub(crate) place: usize,
    pub(crate) estimates: &'a Estimates,
    pub(crate) diagnostics: &'a Diagnostics,
}

impl Outcome {
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
        Ok(Self { scenario: scenario.clone(), run, analysis, diagnostics })
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The complete run.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// The filter with a name, with its estimates or the smoothed ones.
    pub(crate) fn filter(&self, name: &str, smoothed: bool) -> Option<FilterOutcome<'_>> {
        let place = self.scenario.filters.iter().position(|filter| filter.name == name)?;
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
