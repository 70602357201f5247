//! A scenario as a file: what matters to its plants, without what it leaves at its default, and ids only where places do not
//! give them.

use toml::{Table, Value};

use super::Scenario;
use crate::{Channel, FilterSettings, Plant, PlantKind};

/// The text of the file.
pub(super) fn text(scenario: &Scenario) -> Result<String, toml::ser::Error> {
    let mut file = Table::try_from(scenario)?;
    if let Some(plant) = file.get_mut("plant").and_then(Value::as_table_mut) {
        prune(plant, &Table::try_from(Plant::default())?, scenario.plant.kind);
    }
    let are_in_order = (1..).zip(&scenario.filters).all(|(number, filter)| filter.id == number);
    let usual = Table::try_from(FilterSettings::default())?;
    let filters = file.get_mut("filters").and_then(Value::as_array_mut).into_iter().flatten();
    for (filter, settings) in filters.filter_map(Value::as_table_mut).zip(&scenario.filters) {
        if are_in_order {
            filter.remove("id");
        }
        let kind = settings.plant.unwrap_or(scenario.plant.kind);
        for key in ["initial_mean", "initial_std", "process_std"] {
            if let (Some(values), Some(usual)) = (filter.get_mut(key), usual.get(key))
                && let (Some(values), Some(usual)) = (values.as_table_mut(), usual.as_table())
            {
                prune(values, usual, kind);
            }
        }
    }
    toml::to_string(&file)
}

/// Drops the channels that a plant does not have, where they have their default.
fn prune(values: &mut Table, usual: &Table, kind: PlantKind) {
    for channel in Channel::ALL.into_iter().filter(|c| !kind.channels().contains(c)) {
        let key = channel.key();
        if values.get(key) == usual.get(key) {
            values.remove(key);
        }
    }
}
