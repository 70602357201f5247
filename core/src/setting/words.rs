//! Edits in words, as a button says them.

use kalmanscope_filters::quantity::Quantity;
use toml::Value;

use super::{
    CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, Edit, SENSOR_DELAY, SENSOR_STD, TableInfo, name, of_filter, of_scenario,
};
use crate::PlantKind;
use crate::scenario::{FilterSettings, Scenario, Sensor};

/// A σ that is at least this many times the present one leaves its sensor out.
const LEFT_OUT: f64 = 500.0;

impl Edit {
    /// The edit in words and symbols, without the name of a filter; one without words is the line of a file.
    pub fn in_words(&self, scenario: &Scenario) -> String {
        let filter = scenario.filters_at(&self.key).and_then(|(places, _)| scenario.filters.get(*places.first()?));
        let words = match filter {
            Some(filter) => self.of_filter_in_words(filter, scenario),
            None => self.of_scenario_in_words(),
        };
        words.unwrap_or_else(|| self.toml_line())
    }

    fn of_filter_in_words(&self, filter: &FilterSettings, scenario: &Scenario) -> Option<String> {
        let key = self.inner();
        match (key, &self.value) {
            ("augment", Value::Array(wanted)) => {
                let wanted = wanted.iter().filter_map(|key| scenario.channel(key.as_str()?));
                let new: Vec<String> = wanted
                    .filter(|channel| !filter.augment.contains(channel))
                    .map(|channel| format!("the {}", channel.name()))
                    .collect();
                Some(if new.is_empty() {
                    "estimate nothing more".to_owned()
                } else {
                    format!("estimate {}", new.join(" and "))
                })
            }
            ("plant", Value::String(kind)) => Some(format!("choose the plant: {}", PlantKind::from_key(kind)?.name())),
            ("plant", Value::Table(plant)) => Some(format!("choose the equation {}", plant.get("equation")?.as_str()?)),
            ("sensor_std", Value::Array(stds)) => {
                let is_left_out = |(std, own): (&Value, &f64)| std.as_float().is_some_and(|std| std >= LEFT_OUT * own);
                if let Some(place) = stds.iter().zip(&filter.sensor_std).position(is_left_out) {
                    return Some(format!("leave out the {}", scenario.sensors.get(place)?.measures.name()));
                }
                Some(format!("set {} {}", SENSOR_STD.symbol, of_sensors(scenario, stds, "", |_| true)?))
            }
            ("sensor_delay", Value::Array(delays)) => {
                let before = |place: usize| filter.sensor_delay.get(place).copied().unwrap_or(0.0);
                let changes = |place: usize| delays[place].as_float() != Some(before(place));
                Some(format!("set the {} {}", SENSOR_DELAY.symbol, of_sensors(scenario, delays, " s", changes)?))
            }
            (_, Value::Boolean(on)) => {
                let info = of_filter().find(|info| info.key == key)?;
                let label = (info.label)(filter).unwrap_or(info.name);
                Some(if *on { label.to_owned() } else { format!("no {label}") })
            }
            _ => {
                if let Some(info) = CHOICES_OF_FILTER.into_iter().find(|info| info.key == key) {
                    return Some(format!("{}: {}", info.name, info.name_of(&self.value)?));
                }
                if of_filter().any(|info| info.key == key) {
                    return Some(format!("set {} = {}", name(scenario, key), number(&self.value)?));
                }
                let (table, entry) = TableInfo::entry(key, &|key| scenario.channel(key), &Quantity::from_key)?;
                Some(format!("set {} of {} = {}", table.symbol, entry.symbol(), number(&self.value)?))
            }
        }
    }

    fn of_scenario_in_words(&self) -> Option<String> {
        if let Some(info) = CHOICES_OF_SCENARIO.into_iter().find(|info| info.key == self.key) {
            return Some(format!("{}: {}", info.name, info.name_of(&self.value)?));
        }
        let info = of_scenario().find(|info| info.key == self.key)?;
        Some(format!("set {} = {}", info.name, number(&self.value)?))
    }
}

fn of_sensors(scenario: &Scenario, values: &[Value], unit: &str, counts: impl Fn(usize) -> bool) -> Option<String> {
    let all = scenario.sensors.iter().zip(values).enumerate().filter(|(place, _)| counts(*place));
    let one = |(_, (sensor, value)): (usize, (&Sensor, &Value))| {
        Some(format!("of {} = {}{unit}", sensor.measures.symbol(), number(value)?))
    };
    Some(all.map(one).collect::<Option<Vec<String>>>()?.join(", "))
}

fn number(value: &Value) -> Option<String> {
    let value = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))?;
    let text = format!("{value:.2e}");
    text.parse::<f64>().ok().map(|short| short.to_string())
}
