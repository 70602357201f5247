//! Writes a scenario as a file. Leaves out channels that no plant of the scenario has, numbers with their default
//! value, and ids that equal the filters' places.

use crate::{Document, Scenario, ScenarioError, Values};

/// The text of the file.
pub(super) fn text(scenario: &Scenario) -> Result<String, ScenarioError> {
    let mut scenario = scenario.clone();
    let (truth, input) = (scenario.plant.kind, scenario.input);
    let are_in_order = (1..).zip(&scenario.filters).all(|(number, filter)| filter.id == number);
    for filter in &mut scenario.filters {
        if are_in_order {
            filter.id = 0;
        }
        let model = filter.model(truth, input);
        let channels = model.channels();
        filter.initial_mean = filter.initial_mean.written_over(&Values::INITIAL_MEAN, channels);
        filter.initial_std = filter.initial_std.written_over(&Values::INITIAL_STD, channels);
        filter.process_std = filter.process_std.written_over(&Values::PROCESS_STD, channels);
    }
    // The detour over a table puts subtables after plain values.
    Ok(Document::toml(&scenario)?)
}
