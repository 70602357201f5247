//! What a run keeps of its scenario.

use crate::estimator::FilterContext;
use crate::{Estimates, FilterSettings, Model, Quantity, Scenario};

/// What of the scenario is needed once more.
pub(super) struct Settings {
    /// All but the filters.
    truth: Scenario,
    quantities: Vec<Quantity>,
    /// Each with an id of its own.
    pub(super) filters: Vec<FilterSettings>,
}

impl Settings {
    pub(super) fn new(scenario: &Scenario, quantities: Vec<Quantity>) -> Self {
        let truth = Scenario { filters: Vec::new(), ..scenario.clone() };
        Self { truth, quantities, filters: numbered(scenario) }
    }

    /// Takes over other filters. Returns those before.
    pub(super) fn replace_filters(&mut self, scenario: &Scenario) -> Vec<FilterSettings> {
        std::mem::replace(&mut self.filters, numbered(scenario))
    }

    /// Whether these are the settings of a scenario with the same truth, seen by the same sensors.
    pub(super) fn have_the_truth_of(&self, scenario: &Scenario) -> bool {
        Scenario { filters: Vec::new(), ..scenario.clone() } == self.truth
    }

    pub(super) fn context(&self, dt: f64, filter: &FilterSettings) -> FilterContext<'_> {
        FilterContext {
            plant: self.truth.plant.kind,
            input: self.truth.input,
            hold: self.truth.hold,
            sensors: &self.quantities,
            dt,
            seed: self.truth.seed,
            stream: filter.id.saturating_sub(1) as usize,
        }
    }

    fn model(&self, filter: &FilterSettings) -> Model {
        filter.model(self.truth.plant.kind, self.truth.input)
    }

    /// Empty estimates for a filter.
    pub(super) fn estimates(&self, filter: &FilterSettings) -> Estimates {
        Estimates::new(filter, &self.model(filter), self.quantities.clone())
    }

    /// Empty estimates for what a filter's smoother knows. Sensors have told it nothing that they had not told the filter.
    pub(super) fn smoothed(&self, filter: &FilterSettings) -> Estimates {
        Estimates::new(filter, &self.model(filter), Vec::new()).of_smoother()
    }
}

/// The filters of a scenario, each with an id of its own.
fn numbered(scenario: &Scenario) -> Vec<FilterSettings> {
    let mut numbered = scenario.clone();
    numbered.number_filters();
    numbered.filters
}
