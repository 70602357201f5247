//! Estimates in the units that a user wants besides those of the filters: frequencies in Hz, gains for the column as it was recorded.

use kalmanscope_core::Channel;
use kalmanscope_core::diagnostics::Final;
use kalmanscope_core::import::{Dimension, Length, Mapping, unit};

use crate::table::{COLUMNS, row};

/// The rows of a channel: its own, and the same in another unit where there is one.
pub(crate) fn rows(last: &Final, mapping: Option<&Mapping>) -> Vec<[String; COLUMNS]> {
    let length = Length::of(mapping);
    let mut rows = vec![row(last, length)];
    rows.extend(hertz(last, length).or_else(|| gain(last, length, mapping?)));
    rows
}

/// A frequency in Hz.
fn hertz(last: &Final, length: Length) -> Option<[String; COLUMNS]> {
    let is_frequency = last.channel.is_parameter() && last.channel.unit() == "rad/s";
    is_frequency.then(|| scaled(last, length, 1.0 / std::f64::consts::TAU, ["f", "in Hz", "Hz"]))
}

/// The gain of the input times that of its column: the acceleration for each unit of the column. For a force it is 1/mass.
fn gain(last: &Final, length: Length, mapping: &Mapping) -> Option<[String; COLUMNS]> {
    let input = mapping.input.as_ref().filter(|_| last.channel == Channel::INPUT_GAIN)?;
    let acceleration = length.in_place_of("m/s²");
    let known = unit(&input.unit).map(|(dimension, _)| dimension);
    let (name, unit) = match known {
        Some(Dimension::Force) if length == Length::Metre => ("1/mass", "1/kg".to_owned()),
        Some(Dimension::Force) => ("with the column's gain", format!("{acceleration}/N")),
        Some(Dimension::Voltage) => ("with the column's gain", format!("{acceleration}/V")),
        Some(_) => ("with the column's gain", String::new()),
        None => ("with the column's gain", format!("{acceleration} for 1")),
    };
    Some(scaled(last, length, input.gain, ["", name, &unit]))
}

/// A row with another unit, whose symbol, name and unit are given.
fn scaled(last: &Final, length: Length, factor: f64, [symbol, name, unit]: [&str; 3]) -> [String; COLUMNS] {
    let other = Final { mean: factor * last.mean, std: factor.abs() * last.std, score: None, ..*last };
    let mut row = row(&other, length);
    [row[0], row[1], row[4]] = [symbol, name, unit].map(str::to_owned);
    row
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::import::MappedColumn;

    use super::*;

    fn last(channel: Channel, mean: f64, std: f64) -> Final {
        Final { channel, mean, std, score: None }
    }

    #[test]
    fn frequencies_are_told_in_hertz_too() {
        let [own, other] = rows(&last(Channel::NATURAL_FREQUENCY, 6.0, 0.01), None).try_into().unwrap();
        assert_eq!([&own[2], &own[4]], ["6.000", "rad/s"]);
        assert_eq!([&other[0], &other[1], &other[2], &other[3], &other[4]], ["f", "in Hz", "0.9549", "0.0032", "Hz"]);
        assert_eq!(rows(&last(Channel::DAMPING_RATIO, 0.05, 0.01), None).len(), 1);
    }

    #[test]
    fn the_gain_of_a_measured_force_is_one_over_the_mass() {
        let column = |unit: &str| MappedColumn { unit: unit.to_owned(), gain: -0.5, ..MappedColumn::new("force") };
        let told = |unit: &str| {
            let mapping = Mapping { input: Some(column(unit)), ..Mapping::default() };
            let row = rows(&last(Channel::INPUT_GAIN, 0.968, 0.01), Some(&mapping)).remove(1);
            [row[1].clone(), row[2].clone(), row[4].clone()].join(" ")
        };
        assert_eq!(told("N"), "1/mass -0.484 1/kg");
        assert_eq!(told("mV"), "with the column's gain -0.484 m/s²/V");
        assert_eq!(told(""), "with the column's gain -0.484 m/s² for 1");
        assert_eq!(rows(&last(Channel::INPUT_GAIN, 0.968, 0.01), None).len(), 1, "a simulated input has no column");
    }
}
