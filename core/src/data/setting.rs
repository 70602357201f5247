//! The settings of scenarios and filters, as data: one row each.
//!
//! A row has a setting's key, words, limits and place. Validation, sliders, axes of maps, searches, remedies and lessons read it. An
//! [`Address`] means one number of a scenario, and an [`Edit`] is a setting with its new value.

mod address;
mod change;
mod choice;
mod edit;
mod filter;
pub(super) mod info;
mod place;
mod scenario;
mod table;

use crate::data::scenario::Scenario;
use crate::mathematics::channel::Channel;

pub use address::{Address, UnknownSetting, addresses, words_of};
pub use change::{Change, Changed};
pub use choice::{CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, Choice, ChoiceInfo, ROBUST, other_choices};
pub use edit::Edit;
pub use filter::{
    CHANGES, ENSEMBLE_SIZE, ETA, FADING, FORGETTING, GUESSES, JUMP, MEMORY, PROCESS_SCALES, SMOOTHER, WALK, of_filter,
    options,
};
pub(crate) use info::by_key;
pub use info::{Allowed, SettingInfo};
pub use scenario::{DISTURBANCE, DT, DURATION, FORCE, MOTION, RECORD_GAIN, SEED, of_scenario};
pub use table::{
    CORRELATION_TIME, Entry, INITIAL_MEAN, INITIAL_STD, PROCESS_STD, SENSOR_DELAY, SENSOR_STD, TABLES, TableInfo,
};

/// The symbol of a setting, a table or a channel of a scenario with a key, if it has one.
pub fn symbol(scenario: &Scenario, key: &str) -> Option<&'static str> {
    let filters = of_filter().map(|info| (info.key, info.symbol));
    let of_scenario = of_scenario().map(|info| (info.key, info.symbol));
    let tables = TABLES.into_iter().map(|table| (table.key, table.symbol));
    let mut all = filters.chain(of_scenario).chain(tables).filter(|(_, symbol)| !symbol.is_empty());
    let found = all.find(|(known, _)| *known == key).map(|(_, symbol)| symbol);
    found.or_else(|| scenario.channel(key).map(Channel::symbol))
}
