//! A scenario that has run to its end, with everything that a check may ask.

use std::cell::OnceCell;

use kalmanscope_core::{CramerRao, Diagnostics, Estimates, FilterSettings, Record, Run, Scenario};

use crate::LessonError;

/// What came of a scenario.
pub struct Outcome {
    scenario: Scenario,
    run: Run,
    smoothed: Vec<Estimates>,
    /// Of the filters, then of the smoothed estimates.
    diagnostics: Vec<Diagnostics>,
    bounds: Vec<OnceCell<Option<CramerRao>>>,
}

/// One filter of an outcome, with its estimates or what its smoother made of them.
#[derive(Clone, Copy)]
pub(crate) struct FilterOutcome<'a> {
    pub(crate) outcome: &'a Outcome,
    /// The filter's place in the scenario.
    pub(crate) place: usize,
    pub(crate) estimates: &'a Estimates,
    pub(crate) diagnostics: &'a Diagnostics,
}

impl Outcome {
    /// Runs a scenario to its end.
    ///
    /// # Errors
    /// [`LessonError::Run`] where the scenario is impossible.
    pub fn of(scenario: &Scenario) -> Result<Self, LessonError> {
        let mut run = Run::new(scenario)?;
        run.finish();
        let smoothed = run.smoothed();
        let all = run.estimates().iter().chain(&smoothed);
        let diagnostics = all.map(|estimates| Diagnostics::new(estimates, run.record())).collect();
        let bounds = scenario.filters.iter().map(|_| OnceCell::new()).collect();
        Ok(Self { scenario: scenario.clone(), run, smoothed, diagnostics, bounds })
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
        let mut all = self.run.estimates().iter().chain(&self.smoothed).zip(&self.diagnostics);
        let (estimates, diagnostics) = all.find(|(of, _)| of.id() == id && of.is_smoothed() == smoothed)?;
        Some(FilterOutcome { outcome: self, place, estimates, diagnostics })
    }

    /// The Cramér-Rao bound of the filter at a place, worked out when it is first asked for.
    pub(crate) fn bound(&self, place: usize) -> Option<&CramerRao> {
        let follow = || {
            let mut bound = CramerRao::new(&self.scenario, place, self.scenario.dt)?;
            bound.follow(self.run.record());
            Some(bound)
        };
        self.bounds.get(place)?.get_or_init(follow).as_ref()
    }
}

impl FilterOutcome<'_> {
    pub(crate) fn settings(&self) -> &FilterSettings {
        &self.outcome.scenario.filters[self.place]
    }

    pub(crate) fn record(&self) -> &Record {
        self.outcome.run.record()
    }
}
