//! The meaning of a column by its header.

use super::Column;
use super::unit::{Dimension, unit};
use crate::{InputKind, Quantity};

/// The meaning of a column, from its header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    Input(InputKind),
    Sensor(Quantity),
}

/// Words in names, in the order in which they are looked for. Those of one or two letters must be the whole name.
const WORDS: [(&[&str], Role); 7] = [
    (&["ground_acceleration", "ground", "base", "boden"], Role::Input(InputKind::GroundAcceleration)),
    (&["total_acceleration"], Role::Sensor(Quantity::TOTAL_ACCELERATION)),
    (&["force", "input", "load", "kraft", "excitation", "drive", "f", "u", "in", "v1"], Role::Input(InputKind::Force)),
    (&["time", "zeit", "seconds", "stamp", "temps", "t", "s"], Role::Time),
    (&["acceleration", "accel", "acc", "beschl", "a", "ax", "ay", "az"], Role::Sensor(Quantity::ACCELERATION)),
    (&["velocity", "speed", "geschw", "vel", "v"], Role::Sensor(Quantity::VELOCITY)),
    (
        &[
            "displacement",
            "disp",
            "position",
            "pos",
            "angle",
            "deflection",
            "weg",
            "output",
            "winkel",
            "sound",
            "x",
            "y",
            "v2",
        ],
        Role::Sensor(Quantity::DISPLACEMENT),
    ),
];

/// The reasons, in words that follow the meaning.
const NAMED: &str = "its name says so";
const BY_UNIT: &str = "its unit says so";
const BY_CLOCK: &str = "its cells are times of day";

/// The meaning that name, unit or cells give a column, and the reason.
pub(super) fn role_of(column: &Column) -> Option<(Role, &'static str)> {
    if let Some(quantity) = Quantity::from_key(&column.name) {
        return Some((Role::Sensor(quantity), NAMED));
    }
    if column.is_dated || column.is_time_of_day {
        return Some((Role::Time, BY_CLOCK));
    }
    let named = WORDS.iter().find(|(words, _)| has_word(&column.name, words)).map(|(_, role)| *role);
    let of_unit = || match unit(column.unit.as_deref()?)?.0 {
        Dimension::Time => Some(Role::Time),
        Dimension::Length | Dimension::Angle => Some(Role::Sensor(Quantity::DISPLACEMENT)),
        Dimension::Velocity => Some(Role::Sensor(Quantity::VELOCITY)),
        Dimension::Acceleration => Some(Role::Sensor(Quantity::ACCELERATION)),
        Dimension::Force => Some(Role::Input(InputKind::Force)),
        Dimension::Voltage => None,
    };
    // A unit is more reliable than a word: the A in a channel's name may be a station.
    let agrees = |role: Role| match of_unit() {
        Some(of_unit) if matches!(role, Role::Sensor(_)) => {
            let is_total = role == Role::Sensor(Quantity::TOTAL_ACCELERATION);
            of_unit == role || (is_total && of_unit == Role::Sensor(Quantity::ACCELERATION))
        }
        _ => true,
    };
    let named = named.filter(|role| agrees(*role));
    named.map(|role| (role, NAMED)).or_else(|| of_unit().map(|role| (role, BY_UNIT)))
}

/// Whether a column is one of times, by its cells, its name or its unit.
pub(super) fn is_named_time(column: &Column) -> bool {
    matches!(role_of(column), Some((Role::Time, _)))
}

/// Whether a name has one of some words; those of one or two letters must be whole.
pub(super) fn has_word(name: &str, words: &[&str]) -> bool {
    let name = name.to_lowercase();
    let whole: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    words.iter().any(|word| if word.len() > 2 { name.contains(word) } else { whole.contains(word) })
}
