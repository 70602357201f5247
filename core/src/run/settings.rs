//! What a run keeps of its scenario.

use crate::estimator::FilterContext;
use crate::{Estimates, FilterSettings, Model, Quantity, Scenario};

/// What of the scenario is needed once more.
pub(super) struct Settings {
    /// All but the filters.
    truth: Scenario,
    quantities: Vec<Quantity>,
    pub(super) filters: Vec<FilterSettings>,
}

impl Settings {
    pub(super) fn new(scenario: &Scenario, quantities: Vec<Quantity>) -> Self {
        let truth = Scenario { filters: Vec::new(), ..scenario.clone() };
        Self { truth, quantities, filters: scenario.filters.clone() }
    }

    /// Whether these are the settings of a scenario with the same truth, seen by the same sensors.
    pub(super) fn have_the_truth_of(&self, scenario: &Scenario) -> bool {
        Scenario { filters: Vec::new(), ..scenario.clone() } == self.truth
    }

    pub(super) fn context(&self, dt: f64, place: usize) -> FilterContext<'_> {
        FilterContext {
            plant: self.truth.plant.kind,
            input: self.truth.input,
            hold: self.truth.hold,
            sensors: &self.quantities,
            dt,
            seed: self.truth.seed,
            place,
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
        let named = FilterSettings { name: format!("{}, smoothed", filter.name), ..filter.clone() };
        Estimates::new(&named, &self.model(filter), Vec::new())
    }
}
