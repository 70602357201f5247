//! The user's choices in the laboratory, of a map, as plain data.

use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Channel, Record, Scenario};
use kalmanscope_diagnosis::Measure;
use serde::{Deserialize, Serialize};

use super::settings::{candidates, collide, is_possible, offered};
use crate::team::Precision;

/// Limits the values on an axis of a map.
pub const MOST: usize = 256;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapChoice {
    /// The settings across and up. Those of filters have `*` for the filter's name: all filters of the map get the value.
    pub axes: [Axis; 2],
    pub measure: Measure,
    pub filter: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second: Option<u32>,
    #[serde(default, skip_serializing_if = "Precision::is_usual")]
    pub precision: Precision,
}

impl MapChoice {
    /// The usual map: the guess of the first parameter and the factor on Q. `None` without a filter or these settings.
    pub fn usual(scenario: &Scenario, record: &Record, is_measured: bool, count: usize) -> Option<Self> {
        let filter = scenario.filters.first()?.id;
        let part = part_of(scenario, &[filter]);
        let axes = usual_axes(&part, is_measured, [None, None], count)?;
        Some(Self {
            axes,
            measure: usual_measure(&part, record),
            filter,
            second: None,
            precision: Precision::default(),
        })
    }

    pub(crate) fn fitted(&self, scenario: &Scenario, record: &Record, is_measured: bool) -> Option<Self> {
        let exists = |id: u32| scenario.filters.iter().any(|filter| filter.id == id);
        let filter = if exists(self.filter) { self.filter } else { scenario.filters.first()?.id };
        let second = self.second.filter(|second| *second != filter && exists(*second));
        let part = part_of(scenario, &[Some(filter), second].into_iter().flatten().collect::<Vec<_>>());
        // Keys address filters by id, so that a renamed filter is still found.
        let axes = self.axes.each_ref().map(|axis| Axis { key: part.address_by_id(&axis.key), ..axis.clone() });
        let is_free =
            |key: &str| !is_measured || Address::parse(&part, key).is_ok_and(|setting| setting.suits_given_record());
        let kept = axes.each_ref().map(|axis| Some(axis).filter(|a| is_possible(&part, &a.key) && is_free(&a.key)));
        let count = self.axes[0].count;
        let axes = match kept {
            [Some(x), Some(y)] if !collide(&x.key, &y.key, &part) => [x.clone(), y.clone()],
            kept => usual_axes(&part, is_measured, kept, count)?,
        };
        let is_offered = offered(&part, record).contains(&self.measure);
        let measure = if is_offered { self.measure } else { usual_measure(&part, record) };
        Some(Self { axes, measure, filter, second, precision: self.precision })
    }

    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let mut scenario = scenario.clone();
        scenario.number_filters();
        for id in self.filters() {
            if !scenario.filters.iter().any(|filter| filter.id == id) {
                return Err(format!("the map is of filter number {id}, which the scenario does not have"));
            }
        }
        let part = part_of(&scenario, &self.filters());
        for axis in &self.axes {
            axis.check().map_err(|error| error.to_string())?;
            if axis.count > MOST {
                return Err(format!("an axis of the map has {} values, and may have {MOST}", axis.count));
            }
            Address::parse(&part, &axis.key).map_err(|error| error.to_string())?;
        }
        let [x, y] = self.axes.each_ref().map(|axis| part.address_by_id(&axis.key));
        if collide(&x, &y, &part) {
            return Err(format!("both axes of the map set `{}`", part.address_by_name(&x)));
        }
        Ok(())
    }

    pub fn filters(&self) -> Vec<u32> {
        [Some(self.filter), self.second].into_iter().flatten().collect()
    }
}

pub(crate) fn part_of(scenario: &Scenario, filters: &[u32]) -> Scenario {
    let filter = |id: &u32| scenario.filters.iter().find(|filter| filter.id == *id).cloned();
    let mut filters: Vec<_> = filters.iter().filter_map(filter).collect();
    // A colour changes no score, so another one must not begin the map again.
    filters.iter_mut().for_each(|filter| filter.color = None);
    let mut part = Scenario { filters, ..scenario.clone() };
    part.keep_draws();
    part
}

pub(crate) fn is_same_but_for_names(a: &Scenario, b: &Scenario) -> bool {
    let mut a = a.clone();
    a.filters.iter_mut().zip(&b.filters).for_each(|(one, other)| one.name.clone_from(&other.name));
    a == *b
}

fn usual_axes(part: &Scenario, is_measured: bool, kept: [Option<&Axis>; 2], count: usize) -> Option<[Axis; 2]> {
    const WISHES: [[&str; 2]; 2] = [
        ["filters.*.initial_mean.natural_frequency", "filters.*.fading"],
        ["filters.*.process_std", "filters.*.sensor_std"],
    ];
    let candidates = candidates(part, is_measured);
    let choose = |wishes: [&str; 2], other: Option<&str>| -> Option<Axis> {
        let wished = wishes.into_iter().filter(|wish| candidates.iter().any(|key| key == wish));
        let keys = wished.chain(candidates.iter().map(String::as_str));
        let key = keys.into_iter().find(|key| other.is_none_or(|other| !collide(key, other, part)))?;
        let setting = Address::parse(part, key).ok()?;
        Some(Axis::usual(&setting, part, count))
    };
    let [x, y] = kept.map(Option::<&Axis>::cloned);
    let first = x.map_or_else(|| choose(WISHES[0], y.as_ref().map(|y| y.key.as_str())), Some)?;
    let free = y.filter(|y| !collide(&y.key, &first.key, part));
    let second = free.map_or_else(|| choose(WISHES[1], Some(&first.key)), Some)?;
    Some([first, second])
}

fn usual_measure(part: &Scenario, record: &Record) -> Measure {
    let wish = Measure::rmse(Channel::NATURAL_FREQUENCY);
    let offered = offered(part, record);
    let is_error = |measure: &&Measure| {
        measure.channel().is_some_and(|channel| channel.is_parameter() && **measure == Measure::rmse(channel))
    };
    if offered.contains(&wish) { wish } else { offered.iter().find(is_error).copied().unwrap_or(Measure::NIS) }
}
