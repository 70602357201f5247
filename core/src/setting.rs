//! The settings of scenarios and filters, as data: one row each.

mod address;
mod change;
mod choice;
mod document;
mod edit;
mod filters;
mod place;
mod words;

use kalmanscope_filters::channel::Channel;

use crate::scenario::Scenario;

pub use crate::scenario::filter::{
    CHANGES, ENSEMBLE_SIZE, ETA, FADING, FORGETTING, GUESSES, JUMP, MEMORY, PROCESS_SCALES, SMOOTHER, WALK, of_filter,
    options,
};
pub use crate::scenario::numbers::{DISTURBANCE, DT, DURATION, FORCE, MOTION, RECORD_GAIN, SEED, of_scenario};
pub use crate::scenario::row::{Allowed, SettingInfo};
pub use crate::scenario::table::{
    CORRELATION_TIME, Entry, INITIAL_MEAN, INITIAL_STD, PROCESS_STD, SENSOR_DELAY, SENSOR_STD, TABLES, TableInfo,
};
pub use address::{Address, UnknownSetting, addresses, words_of};
pub use change::{Change, Changed};
pub use choice::{CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, Choice, ChoiceInfo, ROBUST, other_choices};
pub use edit::Edit;

/// The symbol of a setting, a table or a channel of a scenario with a key, if it has one.
pub fn symbol(scenario: &Scenario, key: &str) -> Option<&'static str> {
    let filters = of_filter().map(|info| (info.key, info.symbol));
    let of_scenario = of_scenario().map(|info| (info.key, info.symbol));
    let tables = TABLES.into_iter().map(|table| (table.key, table.symbol));
    let mut all = filters.chain(of_scenario).chain(tables).filter(|(_, symbol)| !symbol.is_empty());
    let found = all.find(|(known, _)| *known == key).map(|(_, symbol)| symbol);
    found.or_else(|| scenario.channel(key).map(Channel::symbol))
}

fn name(scenario: &Scenario, key: &str) -> String {
    let choices = CHOICES_OF_FILTER.map(|info| (info.key, info.name)).into_iter();
    let choices = choices.chain(CHOICES_OF_SCENARIO.map(|info| (info.key, info.name)));
    let rows = of_filter().map(|row| (row.key, row.name)).chain(of_scenario().map(|row| (row.key, row.name)));
    let part = |part: &str| match (symbol(scenario, part), part.parse::<usize>()) {
        (Some(symbol), _) => symbol.to_owned(),
        (None, Ok(place)) => (place + 1).to_string(),
        (None, Err(_)) => part.replace('_', " "),
    };
    let named = || choices.chain(rows).find(|(own, _)| *own == key).map(|(_, name)| name);
    let whole = symbol(scenario, key).or_else(named);
    whole.map_or_else(|| key.split('.').map(part).collect::<Vec<_>>().join(" "), str::to_owned)
}
