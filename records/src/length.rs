//! The unit in which a record measures its motion.

use crate::import::{Dimension, unit};
use crate::mapping::{MappedColumn, Mapping};

/// The unit in which a record measures its motion: a circuit swings in volts, a pendulum in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Length {
    /// Metres.
    #[default]
    Metre,
    /// Volts.
    Volt,
    /// Radians.
    Radian,
}

const LENGTHS: [[&str; 3]; 6] = [
    ["m", "V", "rad"],
    ["m/s", "V/s", "rad/s"],
    ["m/s²", "V/s²", "rad/s²"],
    ["1/(m² s²)", "1/(V² s²)", "1/(rad² s²)"],
    ["1/m", "1/V", "1/rad"],
    ["m/s³", "V/s³", "rad/s³"],
];

impl Length {
    /// The unit of a mapping's sensors.
    pub fn of(mapping: Option<&Mapping>) -> Self {
        let dimension = |column: &MappedColumn| Some(unit(&column.unit)?.0);
        let dimensions = mapping.into_iter().flat_map(|mapping| mapping.sensors.values().filter_map(dimension));
        dimensions.fold(Self::Metre, |found, dimension| match dimension {
            Dimension::Voltage => Self::Volt,
            Dimension::Angle | Dimension::AngularVelocity | Dimension::AngularAcceleration => Self::Radian,
            _ => found,
        })
    }

    /// The unit with this length in place of metres; units without metres stay.
    pub fn in_place_of(self, unit: &'static str) -> &'static str {
        LENGTHS.iter().find(|units| units[0] == unit).map_or(unit, |units| units[self as usize])
    }
}
