//! The choice of a search: filter, settings and goal.

use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario};
use kalmanscope_lab::tune::Goal;
use serde::{Deserialize, Serialize};

use crate::laboratory::choice::part_of;
use crate::laboratory::settings::{collide, is_possible, of_filters};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TuneChoice {
    pub filter: u32,
    pub axes: Vec<Axis>,
    pub goal: Goal,
}

impl TuneChoice {
    /// The noise of all sensors and a factor on √Q, of the first filter or of that with an id.
    pub fn usual(scenario: &Scenario, filter: Option<u32>) -> Option<Self> {
        let exists = |id: &u32| scenario.filters.iter().any(|filter| filter.id == *id);
        let filter = filter.filter(exists).or(scenario.filters.first().map(|filter| filter.id))?;
        let part = part_of(scenario, &[filter]);
        let is_usual = |key: &String| key.contains(".sensor_std.") || key == "filters.*.process_std";
        let keys = of_filters(&part).into_iter().filter(is_usual);
        let axis = |key: String| Some(Axis::usual(&Address::parse(&part, &key).ok()?, &part, 2));
        Some(Self { filter, axes: keys.filter_map(axis).collect(), goal: Goal::Likelihood })
    }

    /// Checks that a scenario allows a search of this choice.
    ///
    /// # Errors
    /// A sentence with the reason.
    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let mut scenario = scenario.clone();
        scenario.number_filters();
        if !scenario.filters.iter().any(|filter| filter.id == self.filter) {
            return Err(format!("it is about filter number {}, which the scenario lacks", self.filter));
        }
        let part = part_of(&scenario, &[self.filter]);
        for (place, axis) in self.axes.iter().enumerate() {
            axis.check().map_err(|error| error.to_string())?;
            let setting = Address::parse(&part, &axis.key).map_err(|error| error.to_string())?;
            if !setting.is_of_filters() {
                return Err(format!("`{}` is not a setting of a filter", axis.key));
            }
            if self.axes[..place].iter().any(|other| collide(&other.key, &axis.key, &part)) {
                return Err(format!("`{}` is set twice", axis.key));
            }
        }
        match self.goal {
            Goal::FreeRun(sensor) if !scenario.sensors.iter().any(|other| other.measures == sensor) => {
                Err(format!("no sensor measures the {}", sensor.name()))
            }
            _ => Ok(()),
        }
    }

    /// The choice, reduced to the settings that the scenario has. The usual choice if the scenario lacks the filter;
    /// the goal is the likelihood if it lacks the sensor.
    pub(crate) fn fitted(&self, scenario: &Scenario) -> Option<Self> {
        if !scenario.filters.iter().any(|filter| filter.id == self.filter) {
            return Self::usual(scenario, None);
        }
        let part = part_of(scenario, &[self.filter]);
        // The filter is the only one: its own settings are those of all filters.
        let of_all = |axis: &Axis| {
            let key =
                part.filters_at(&axis.key).map_or_else(|| axis.key.clone(), |(_, key)| format!("filters.*.{key}"));
            Axis { key, ..axis.clone() }
        };
        let axes = self.axes.iter().map(of_all).filter(|axis| is_possible(&part, &axis.key)).collect();
        let is_measured = |goal: &Goal| match goal {
            Goal::FreeRun(sensor) => scenario.sensors.iter().any(|other| other.measures == *sensor),
            Goal::Likelihood | Goal::Consistency => true,
        };
        let goal = Some(self.goal).filter(is_measured).unwrap_or(Goal::Likelihood);
        Some(Self { filter: self.filter, axes, goal })
    }

    /// Ticks a setting, with its usual range, or unticks it. Unticks all others that would set the same number.
    pub(crate) fn toggle(&mut self, key: &str, part: &Scenario) {
        let is_ticked = self.axes.iter().any(|axis| axis.key == key);
        self.axes.retain(|axis| !collide(&axis.key, key, part));
        if let Ok(setting) = Address::parse(part, key)
            && !is_ticked
        {
            self.axes.push(Axis::usual(&setting, part, 2));
        }
    }
}
