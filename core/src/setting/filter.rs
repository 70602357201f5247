//! The settings of a filter that are one number each, or a yes or no, in the order in which people meet them.

use std::sync::LazyLock;

use super::info::SettingInfo;
use crate::scenario::FilterSettings;
use crate::scenario::filter::{ITERATIONS, LEARNS_Q, LEARNS_R, LOG_PARAMETERS, LOOK_AHEAD, ROWS, SUBSTEPS, TRAINING};

pub use crate::scenario::filter::{
    ENSEMBLE_SIZE, ETA, FADING, FORGETTING, GUESSES, JUMP, PROCESS_SCALES, SMOOTHER, WALK,
};

type Row = SettingInfo<FilterSettings>;

/// The settings that are shown first: how long the filter remembers.
pub static MEMORY: [&Row; 2] = [&FADING, &ETA];

/// The ways in which parameters may change that stay as they are otherwise, one of which a filter has: in words, and the value that
/// turns it on.
pub static CHANGES: [(&Row, &str, f64); 3] =
    [(&WALK, "walk", 0.1), (&JUMP, "jump", 1.0), (&PROCESS_SCALES, "Q of unknown size", 17.0)];

static ORDER: [&Row; 15] = [
    &FADING,
    &ETA,
    &JUMP,
    &WALK,
    &PROCESS_SCALES,
    &GUESSES,
    &SUBSTEPS,
    &ITERATIONS,
    &ENSEMBLE_SIZE,
    &LOG_PARAMETERS,
    &SMOOTHER,
    &LOOK_AHEAD,
    &LEARNS_R,
    &LEARNS_Q,
    &TRAINING,
];

static ALL: LazyLock<Vec<&Row>> =
    LazyLock::new(|| ORDER.into_iter().chain(ROWS.iter().copied().filter(|row| !ORDER.contains(row))).collect());

/// All settings of a filter that are one number each, or a yes or no.
pub fn of_filter() -> impl Iterator<Item = &'static Row> {
    ALL.iter().copied()
}

/// The less common settings. One without a hint is set in files alone.
pub fn options() -> impl Iterator<Item = &'static Row> {
    let is_elsewhere = |row: &Row| MEMORY.contains(&row) || CHANGES.iter().any(|(other, ..)| *other == row);
    of_filter().filter(move |row| !row.hint.is_empty() && !is_elsewhere(row))
}
