//! The settings of scenarios and filters, as data: one row each.
//!
//! A row has a setting's key, words, limits and place. Validation, sliders, axes of maps, searches, remedies and lessons read it. An
//! [`Address`] means one number of a scenario, and an [`Edit`] is a setting with its new value.

mod address;
mod allowed;
mod edit;
mod filter;
mod info;
mod place;
mod scenario;
mod table;

pub use address::{Address, UnknownSetting};
pub use allowed::Allowed;
pub use edit::Edit;
pub use filter::{ENSEMBLE_SIZE, ETA, FADING, FORGETTING, GUESSES, JUMP, MEMORY, OF_FILTER, OPTIONS, SMOOTHER};
pub use info::SettingInfo;
pub use scenario::{DISTURBANCE, DT, DURATION, MOTION, OF_SCENARIO, RECORD_GAIN, SEED};
pub use table::{Entry, INITIAL_MEAN, INITIAL_STD, PROCESS_STD, SENSOR_STD, TABLES, TableInfo};
