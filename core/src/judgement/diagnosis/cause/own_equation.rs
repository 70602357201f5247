//! Remedies whose plant is an equation: the linear oscillator with a term more.

use toml::{Table, Value};

use super::BadFilter;
use crate::data::setting::Edit;
use crate::mathematics::filter::FilterKind;
use crate::{Channel, PlantKind};

/// The linear oscillator of a filter, and how far it moves.
pub(super) struct Oscillator {
    /// ωₙ of the initial mean \[rad/s\].
    pub(super) frequency: f64,
    /// The root mean square of the displacement \[m\].
    pub(super) size: f64,
}

/// A component of the equation that the linear oscillator does not have.
pub(super) struct Component {
    pub(super) key: &'static str,
    /// Its name, unit and sign, if it is a parameter.
    pub(super) parameter: Option<[&'static str; 3]>,
    pub(super) mean: f64,
    pub(super) std: f64,
}

impl Oscillator {
    /// The oscillator of a bad filter, if it is linear and its parameters are estimated.
    pub(super) fn of(bad: &BadFilter<'_>) -> Option<Self> {
        let believed = bad.filter.plant.unwrap_or(bad.scenario.plant.kind);
        let place = bad.case.estimates.place(Channel::NATURAL_FREQUENCY)?;
        let (frequency, size) = (bad.case.estimates.initial_mean(place).abs(), bad.size());
        let is_linear = believed == PlantKind::SDOF && bad.filter.kind != FilterKind::KF;
        (is_linear && size > 0.0 && size.is_finite() && frequency > 0.0).then_some(Self { frequency, size })
    }

    /// The edits that give the filter this equation in place of its plant.
    pub(super) fn edits(&self, bad: &BadFilter<'_>, equation: &str, components: &[Component]) -> Vec<Edit> {
        let text = |text: &str| Value::String(text.to_owned());
        let of_parameter = |one: &Component| {
            let [name, unit, sign] = one.parameter?;
            let entries =
                [("name", name), ("unit", unit), ("sign", sign)].map(|(key, entry)| (key.to_owned(), text(entry)));
            Some((one.key.to_owned(), Value::Table(Table::from_iter(entries))))
        };
        let parameters: Table = components.iter().filter_map(of_parameter).collect();
        let plant = [("equation", text(equation)), ("parameters", Value::Table(parameters))];
        let plant = plant.map(|(key, value)| (key.to_owned(), value));
        let mut edits = vec![bad.edit("plant", Table::from_iter(plant))];
        for Component { key, mean, std, .. } in components {
            edits.push(bad.edit(&format!("initial_mean.{key}"), *mean));
            edits.push(bad.edit(&format!("initial_std.{key}"), *std));
            edits.push(bad.edit(&format!("process_std.{key}"), 0.0));
        }
        edits
    }
}
