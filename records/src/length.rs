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

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_filters::{Channel, Quantity};

    #[test]
    fn circuits_swing_in_volts() {
        let mut mapping = Mapping::default();
        let column = MappedColumn { unit: "mV".to_owned(), ..MappedColumn::new("V2") };
        mapping.sensors.insert(Quantity::DISPLACEMENT, column);
        let length = Length::of(Some(&mapping));
        assert_eq!(length.in_place_of(Quantity::VELOCITY.unit()), "V/s");
        assert_eq!(length.in_place_of(Channel::CUBIC_STIFFNESS.unit()), "1/(V² s²)");
        assert_eq!(length.in_place_of(Channel::NATURAL_FREQUENCY.unit()), "rad/s");
        assert_eq!(Length::of(None).in_place_of("m"), "m");
    }
}
