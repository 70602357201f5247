//! A scenario as a file: what matters to its plants, without what it leaves at its default, and ids only where places do not
//! give them.

use super::Scenario;

/// The text of the file.
pub(super) fn text(scenario: &Scenario) -> Result<String, toml::ser::Error> {
    let mut scenario = scenario.clone();
    let (truth, input) = (scenario.plant.kind, scenario.input);
    let are_in_order = (1..).zip(&scenario.filters).all(|(number, filter)| filter.id == number);
    for filter in &mut scenario.filters {
        if are_in_order {
            filter.id = 0;
        }
        let model = filter.model(truth, input);
        for values in [&mut filter.initial_mean, &mut filter.initial_std, &mut filter.process_std] {
            values.prune(model.channels());
        }
    }
    // By way of a table, which puts tables behind plain values.
    toml::to_string(&toml::Table::try_from(&scenario)?)
}
