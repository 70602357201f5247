//! The rows of the table of estimates, also in further units that a user wants: frequencies in Hz, gains for the column
//! as it was recorded.

use kalmanscope_core::Channel;
use kalmanscope_core::Length;
use kalmanscope_core::import::{Dimension, Mapping, unit};
use kalmanscope_diagnosis::Final;

use crate::number::{deviation, fixed, plain, short, with_spread};

/// Symbol, name, value, 2σ, unit, error, error in standard deviations, root mean square errors of the whole record and
/// of its last third, share inside ±2σ, settling time.
pub(crate) const COLUMNS: usize = 11;

/// The rows of a channel: its own, and the same in another unit if there is one.
pub(crate) fn rows(last: &Final, mapping: Option<&Mapping>) -> Vec<[String; COLUMNS]> {
    let length = Length::of(mapping);
    let mut rows = vec![row(last, length)];
    rows.extend(hertz(last, length).or_else(|| gain(last, length, mapping?)));
    rows
}

fn row(last: &Final, length: Length) -> [String; COLUMNS] {
    let &Final { channel, mean, std, score } = last;
    let (value, spread) = with_spread(mean, std);
    let scored = score.map(|score| {
        let in_stds = if std > 0.0 { format!("({}σ)", fixed(score.error.abs() / std, 1)) } else { String::new() };
        let settled = match score.settled {
            // A known parameter has nothing to settle, and a state keeps moving.
            _ if std == 0.0 || !channel.is_parameter() => String::new(),
            Some(time) => format!("{} s", plain((time * 1e3).round() / 1e3)),
            None => "never".to_owned(),
        };
        let inside = if std > 0.0 { format!("{} %", fixed(100.0 * score.coverage, 1)) } else { String::new() };
        [deviation(score.error, std), in_stds, short(score.rmse), short(score.rmse_last_third), inside, settled]
    });
    let [error, in_stds, rmse, last_third, inside, settled] = scored.unwrap_or_default();
    let [symbol, name, unit] =
        [channel.symbol(), channel.name(), length.in_place_of(channel.unit())].map(str::to_owned);
    [symbol, name, value, spread, unit, error, in_stds, rmse, last_third, inside, settled]
}

fn hertz(last: &Final, length: Length) -> Option<[String; COLUMNS]> {
    let is_frequency = last.channel.is_parameter() && last.channel.unit() == "rad/s";
    is_frequency.then(|| scaled(last, length, 1.0 / std::f64::consts::TAU, ["f", "in Hz", "Hz"]))
}

const OF_COLUMN: &str = "per unit of the column";

/// The gain of the input times that of its column: the acceleration for each unit of the column. For a force it is 1/mass.
fn gain(last: &Final, length: Length, mapping: &Mapping) -> Option<[String; COLUMNS]> {
    let input = mapping.input.as_ref().filter(|_| last.channel == Channel::INPUT_GAIN)?;
    let acceleration = length.in_place_of("m/s²");
    let known = unit(&input.unit).map(|(dimension, _)| dimension);
    let (name, unit) = match known {
        Some(Dimension::Force) if length == Length::Metre => ("1/mass", "1/kg".to_owned()),
        Some(Dimension::Force) => (OF_COLUMN, format!("{acceleration}/N")),
        Some(Dimension::Voltage) => (OF_COLUMN, format!("{acceleration}/V")),
        Some(_) => (OF_COLUMN, String::new()),
        None => (OF_COLUMN, acceleration.to_owned()),
    };
    Some(scaled(last, length, input.gain, ["", name, &unit]))
}

fn scaled(last: &Final, length: Length, factor: f64, [symbol, name, unit]: [&str; 3]) -> [String; COLUMNS] {
    // A column with its sign turned has a negative gain, which a σ must not get.
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
    fn frequencies_have_a_row_in_hertz() {
        let [own, other] = rows(&last(Channel::NATURAL_FREQUENCY, 6.0, 0.01), None).try_into().unwrap();
        assert_eq!([&own[2], &own[4]], ["6.000", "rad/s"]);
        assert_eq!([&other[0], &other[1], &other[2], &other[3], &other[4]], ["f", "in Hz", "0.9549", "0.0032", "Hz"]);
        assert_eq!(rows(&last(Channel::DAMPING_RATIO, 0.05, 0.01), None).len(), 1);
    }

    #[test]
    fn the_gain_of_a_measured_force_is_one_over_the_mass() {
        let column = |unit: &str| MappedColumn { unit: unit.to_owned(), gain: -0.5, ..MappedColumn::new("force") };
        let gain = |unit: &str| {
            let mapping = Mapping { input: Some(column(unit)), ..Mapping::default() };
            let row = rows(&last(Channel::INPUT_GAIN, 0.968, 0.01), Some(&mapping)).remove(1);
            [row[1].clone(), row[2].clone(), row[4].clone()].join(" ")
        };
        assert_eq!(gain("N"), "1/mass -0.484 1/kg");
        assert_eq!(gain("mV"), "per unit of the column -0.484 m/s²/V");
        assert_eq!(gain(""), "per unit of the column -0.484 m/s²");
        assert_eq!(rows(&last(Channel::INPUT_GAIN, 0.968, 0.01), None).len(), 1, "a simulated input has no column");
    }
}
