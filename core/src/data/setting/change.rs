//! The difference between two scenarios, and edits in words, as a button says them.

use crate::mathematics::lists::sort_items;
use toml::Value;

use super::edit::put;
use super::{
    Allowed, CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, ChoiceInfo, Edit, OF_FILTER, SENSOR_DELAY, SENSOR_STD,
    SettingInfo, TableInfo, of_scenario, symbol,
};
use crate::data::document::{self, Document};
use crate::data::scenario::{FilterSettings, Scenario, ScenarioError, address};
use crate::mathematics::plant::PlantKind;
use crate::mathematics::quantity::Quantity;

/// The difference between two scenarios: the settings that changed, by their addresses.
///
/// ```
/// use kalmanscope_core::{Scenario, setting::Change};
///
/// let before = Scenario::default();
/// let mut now = before.clone();
/// now.filters[0].fading = 1.0;
/// let change = Change::between(&before, &now);
/// assert_eq!(change.keys().collect::<Vec<_>>(), ["filters#1.fading"]);
/// assert_eq!(change.apply(&before).unwrap(), now);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Change<'a> {
    before: &'a Scenario,
    now: &'a Scenario,
    settings: Vec<Difference>,
    added: Vec<usize>,
    removed: Vec<usize>,
}

/// A setting with its values; null where none is written and the setting has its default.
#[derive(Clone, Debug, PartialEq)]
struct Difference {
    key: String,
    before: Document,
    now: Document,
}

impl<'a> Change<'a> {
    /// The change from `before` to `now`. Filters are the same where their ids are.
    pub fn between(before: &'a Scenario, now: &'a Scenario) -> Self {
        let (settings, added, removed) = (Vec::new(), Vec::new(), Vec::new());
        let mut change = Self { before, now, settings, added, removed };
        let find = |scenario: &Scenario, id: u32| scenario.filters.iter().position(|filter| filter.id == id);
        let ids = |one: &Scenario, other: &Scenario| -> Vec<u32> {
            one.filters.iter().map(|filter| filter.id).filter(|&id| find(other, id).is_some()).collect()
        };
        // Filters in another order are taken away and put back in their new places.
        let stay = Some(ids(before, now)).filter(|stay| *stay == ids(now, before)).unwrap_or_default();
        for (own, filter) in before.filters.iter().enumerate() {
            match find(now, filter.id).filter(|_| stay.contains(&filter.id)) {
                Some(place) => {
                    let documents = [filter, &now.filters[place]].map(document);
                    change.compare(&documents[0], &documents[1], &address::of_filter(filter.id, ""));
                }
                None => change.removed.push(own),
            }
        }
        let added = now.filters.iter().enumerate().filter(|(_, filter)| !stay.contains(&filter.id));
        change.added = added.map(|(place, _)| place).collect();
        let of_scenario = |scenario: &Scenario| {
            let mut all = document(scenario);
            all["filters"] = Document::Null;
            all
        };
        let [before, now] = [of_scenario(before), of_scenario(now)];
        change.compare(&before, &now, "");
        change
    }

    /// Notes every setting below a path in which the two differ. The path ends with a dot, or is empty.
    fn compare(&mut self, before: &Document, now: &Document, path: &str) {
        match (before, now) {
            _ if before == now => {}
            (Document::Object(one), Document::Object(other)) => {
                let mut keys: Vec<&String> = one.keys().chain(other.keys()).collect();
                sort_items(&mut keys, Ord::cmp);
                keys.dedup();
                // A table with one key that becomes another is another shape: of a force, of a signal.
                let is_reshaped = one.len() == 1 && other.len() == 1 && keys.len() == 2;
                if is_reshaped || keys.iter().any(|key| key.contains('.')) {
                    return self.note(before, now, path);
                }
                for key in keys {
                    let of = |document: &Document| document.get(key).cloned().unwrap_or(Document::Null);
                    self.compare(&of(before), &of(now), &format!("{path}{key}."));
                }
            }
            (Document::Array(one), Document::Array(other)) if one.len() == other.len() => {
                for (i, (one, other)) in one.iter().zip(other).enumerate() {
                    self.compare(one, other, &format!("{path}{i}."));
                }
            }
            _ => self.note(before, now, path),
        }
    }

    fn note(&mut self, before: &Document, now: &Document, path: &str) {
        let key = path.trim_end_matches('.').to_owned();
        self.settings.push(Difference { key, before: before.clone(), now: now.clone() });
    }

    /// The addresses of the settings that differ, those of filters that are new or gone apart.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.settings.iter().map(|setting| setting.key.as_str())
    }

    /// Whether filters alone differ: both scenarios have the same record.
    pub fn is_of_filters(&self) -> bool {
        self.keys().all(|key| address::split_id(key).is_some())
    }

    /// Whether the results of a filter of both scenarios differ: by a setting but its name and colour, or by the record.
    pub fn concerns(&self, id: u32) -> bool {
        let of_look = |key: &str| matches!(key, "name" | "color");
        let is_own = |key: &str| address::split_id(key).is_some_and(|(of, key)| of == id && !of_look(key));
        !self.is_of_filters() || self.keys().any(is_own)
    }

    /// Another scenario with the same change: each of these settings has its new value, all others stay. The result may be impossible.
    ///
    /// # Errors
    /// [`ScenarioError`] where the scenario has no place for a setting.
    pub fn apply(&self, scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        if scenario == self.before {
            return Ok(self.now.clone());
        }
        let mut document = document::of(scenario)?;
        for Difference { key, now, .. } in &self.settings {
            put(&mut document, scenario, key, now, "")?;
        }
        let mut changed: Scenario = scenario.knowing(|| document::read(&document))?;
        changed.filters.retain(|filter| self.removed.iter().all(|&place| self.before.filters[place].id != filter.id));
        for &place in &self.added {
            changed.filters.insert(place.min(changed.filters.len()), self.now.filters[place].clone());
        }
        Ok(changed)
    }

    /// What was before, setting by setting: `EKF λ = 1`, `with UKF` of a filter that is gone. `number` writes a number.
    pub fn what_was(&self, number: impl Fn(f64) -> String) -> Vec<String> {
        let Self { before: scenario, now, .. } = self;
        let several = scenario.filters.len() > 1;
        let said = |Difference { key, before, .. }: &Difference| {
            let filter = address::split_id(key).and_then(|(id, _)| scenario.filters.iter().find(|own| own.id == id));
            let key = address::split_id(key).map_or(key.as_str(), |(_, key)| key);
            let owner = filter.filter(|_| several).map_or_else(String::new, |filter| format!("{} ", filter.name));
            let rows = || OF_FILTER.into_iter().flatten().copied();
            let said = match filter {
                Some(filter) => chosen(&CHOICES_OF_FILTER, key, filter).or_else(|| set(rows(), key, filter, &number)),
                None => {
                    chosen(&CHOICES_OF_SCENARIO, key, scenario).or_else(|| set(of_scenario(), key, scenario, &number))
                }
            };
            let (name, value) = said.unwrap_or_else(|| (name([scenario, now], key), words(before, &number)));
            format!("{owner}{name} = {value}")
        };
        let (of_filters, of_scenario): (Vec<&Difference>, Vec<&Difference>) =
            self.settings.iter().partition(|setting| address::split_id(&setting.key).is_some());
        let only = |places: &[usize], own: &Scenario, other: &Scenario, word: &str| -> Vec<String> {
            let lacks = |id: u32| other.filters.iter().all(|filter| filter.id != id);
            let filters = places.iter().map(|&place| &own.filters[place]).filter(|filter| lacks(filter.id));
            filters.map(|filter| format!("{word} {}", filter.name)).collect()
        };
        let gone = only(&self.removed, scenario, now, "with");
        let new = only(&self.added, now, scenario, "without");
        of_filters.into_iter().map(said).chain(gone).chain(new).chain(of_scenario.into_iter().map(said)).collect()
    }
}

fn document(of: &impl serde::Serialize) -> Document {
    document::of(of).unwrap_or_default()
}

fn chosen<T>(all: &[&ChoiceInfo<T>], key: &str, of: &T) -> Option<(String, String)> {
    let info = all.iter().find(|info| info.key == key)?;
    Some((info.name.to_owned(), info.chosen(of)?.name.to_owned()))
}

/// The name of the number with a key, and its value in a `T`. A file leaves out a default, so the value comes from the `T`.
fn set<T: 'static>(
    mut rows: impl Iterator<Item = &'static SettingInfo<T>>,
    key: &str,
    of: &T,
    number: &impl Fn(f64) -> String,
) -> Option<(String, String)> {
    let info = rows.find(|info| info.key == key)?;
    let name = if info.symbol.is_empty() { info.name } else { info.symbol };
    let value = (info.get)(of);
    let value =
        if info.allowed == Allowed::Flag { words(&Document::Bool(value != 0.0), number) } else { number(value) };
    Some((name.to_owned(), value))
}

/// The name of a setting: the field's symbols if there are any, else the words of its key. Places count from 1.
fn name(scenarios: [&Scenario; 2], key: &str) -> String {
    let symbol = |part: &str| scenarios.into_iter().find_map(|scenario| symbol(scenario, part));
    let part = |part: &str| match (symbol(part), part.parse::<usize>()) {
        (Some(symbol), _) => symbol.to_owned(),
        (None, Ok(place)) => (place + 1).to_string(),
        (None, Err(_)) => part.replace('_', " "),
    };
    key.split('.').map(part).collect::<Vec<_>>().join(" ")
}

fn words(value: &Document, number: &impl Fn(f64) -> String) -> String {
    match value {
        Document::Null => "none".to_owned(),
        Document::Bool(on) => if *on { "yes" } else { "no" }.to_owned(),
        Document::Number(value) => number(value.as_f64().unwrap_or(f64::NAN)),
        Document::String(text) => text.clone(),
        Document::Array(_) | Document::Object(_) => "other".to_owned(),
    }
}

/// A σ that is at least this many times the present one leaves its sensor out.
const LEFT_OUT: f64 = 500.0;

impl Edit {
    /// The edit of a scenario in words and symbols, without the name of a filter: `estimate the input gain`, `set √Q of ωₙ = 0.0537`.
    /// An edit without words is the line of a file.
    ///
    /// ```
    /// use kalmanscope_core::{Scenario, setting::Edit};
    ///
    /// let scenario = Scenario::default();
    /// let words = |key: &str, value: f64| Edit::of_filter(1, key, value).in_words(&scenario);
    /// assert_eq!(words("fading", 1.02), "set λ = 1.02");
    /// assert_eq!(words("process_std.natural_frequency", 0.0537), "set √Q of ωₙ = 0.0537");
    /// let gain = Edit::of_filter(1, "augment", vec!["input_gain"]);
    /// assert_eq!(gain.in_words(&scenario), "estimate the input gain");
    /// ```
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
            ("plant", Value::String(kind)) => Some(format!("take it for a {}", PlantKind::from_key(kind)?.name())),
            ("plant", Value::Table(plant)) => Some(format!("take the equation {}", plant.get("equation")?.as_str()?)),
            ("sensor_std", Value::Array(stds)) => {
                let is_left_out = |(std, own): (&Value, &f64)| std.as_float().is_some_and(|std| std >= LEFT_OUT * own);
                if let Some(place) = stds.iter().zip(&filter.sensor_std).position(is_left_out) {
                    return Some(format!("leave out the {}", scenario.sensors.get(place)?.measures.name()));
                }
                let of = |(sensor, std): (&crate::Sensor, &Value)| {
                    Some(format!("of {} = {}", sensor.measures.symbol(), number(std)?))
                };
                let all: Option<Vec<String>> = scenario.sensors.iter().zip(stds).map(of).collect();
                Some(format!("set {} {}", SENSOR_STD.symbol, all?.join(", ")))
            }
            ("sensor_delay", Value::Array(delays)) => {
                let before = |place: usize| filter.sensor_delay.get(place).copied().unwrap_or(0.0);
                let of = |(place, sensor): (usize, &crate::Sensor)| {
                    let delay = delays.get(place)?;
                    let changes = delay.as_float() != Some(before(place));
                    changes.then(|| Some(format!("of {} = {} s", sensor.measures.symbol(), number(delay)?)))
                };
                let all: Option<Vec<String>> = scenario.sensors.iter().enumerate().filter_map(of).collect();
                Some(format!("set the {} {}", SENSOR_DELAY.symbol, all?.join(", ")))
            }
            (_, Value::Boolean(on)) => {
                let info = OF_FILTER.into_iter().flatten().find(|info| info.key == key)?;
                let label = (info.label)(filter).unwrap_or(info.name);
                Some(if *on { label.to_owned() } else { format!("no {label}") })
            }
            _ => {
                if let Some(info) = CHOICES_OF_FILTER.into_iter().find(|info| info.key == key) {
                    return Some(format!("{}: {}", info.name, info.name_of(&self.value)?));
                }
                if let Some(info) = OF_FILTER.into_iter().flatten().find(|info| info.key == key) {
                    let name = if info.symbol.is_empty() { info.name } else { info.symbol };
                    return Some(format!("set {name} = {}", number(&self.value)?));
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

/// A number with at most three significant digits.
fn number(value: &Value) -> Option<String> {
    let value = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))?;
    let text = format!("{value:.2e}");
    text.parse::<f64>().ok().map(|short| short.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, FilterKind, Force, Hold, PlantKind, Quantity, Sensor, Signal};

    type Step = fn(&mut Scenario);

    const STEPS: [(&str, Step); 12] = [
        ("λ", |scenario| scenario.filters[1].fading = 1.5),
        ("a guess", |scenario| scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 9.0),
        ("a default", |scenario| scenario.filters[0].eta = 0.0),
        ("a kind", |scenario| scenario.filters[0].kind = FilterKind::CKF),
        ("a signal", |scenario| {
            let sine = crate::signal::Sine { mean: 5.0, amplitude: 1.0, period: 9.0 };
            scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Sine(sine));
        }),
        ("a force", |scenario| scenario.force = Force::Step { amplitude: 1.0, at: 2.0 }),
        ("a hold", |scenario| scenario.hold = Hold::First),
        ("a plant", |scenario| scenario.set_plant(PlantKind::DUFFING)),
        ("a sensor more", |scenario| scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.3))),
        ("no sensor", |scenario| scenario.remove_sensor(Quantity::DISPLACEMENT)),
        ("a filter less", |scenario| _ = scenario.filters.remove(0)),
        ("filters in another order", |scenario| scenario.filters.reverse()),
    ];

    fn scenario() -> Scenario {
        let mut scenario = Scenario::default();
        scenario.draw.insert("plant.natural_frequency".to_owned(), crate::scenario::Law::Normal([6.0, 0.1]));
        scenario.number_filters();
        scenario
    }

    #[test]
    fn a_change_makes_of_one_scenario_the_other() {
        let all = STEPS.map(|(name, step)| {
            let mut changed = scenario();
            step(&mut changed);
            (name, changed)
        });
        for (name, before) in &all {
            for (other, now) in &all {
                let change = Change::between(before, now);
                assert_eq!(change.apply(before).as_ref(), Ok(now), "from {name} to {other}");
                // Another scenario takes the changed settings and keeps all others.
                let elsewhere = Scenario { seed: 77, ..before.clone() };
                let expected = Scenario { seed: 77, ..now.clone() };
                assert_eq!(change.apply(&elsewhere), Ok(expected), "from {name} to {other}, elsewhere");
            }
        }
    }

    #[test]
    fn two_changes_of_one_picture_both_count() {
        let base = scenario();
        let mut together = base.clone();
        for (_, one) in &STEPS[..4] {
            let mut changed = base.clone();
            one(&mut changed);
            together = Change::between(&base, &changed).apply(&together).unwrap();
        }
        let mut expected = base;
        STEPS[..4].iter().for_each(|(_, step)| step(&mut expected));
        assert_eq!(together, expected);
    }

    #[test]
    fn what_was_before_is_said_in_the_words_of_the_settings() {
        let said = |step: Step| {
            let mut changed = scenario();
            step(&mut changed);
            Change::between(&scenario(), &changed).what_was(|number| number.to_string()).join(", ")
        };
        assert_eq!(
            said(|scenario| scenario.force = Force::Step { amplitude: 1.0, at: 2.0 }),
            "force over time = white noise"
        );
        assert_eq!(said(|scenario| scenario.hold = Hold::First), "input between samples = held");
        assert_eq!(said(|scenario| scenario.filters[0].substeps = 4), "EKF steps a sample = 0");
        assert_eq!(said(|scenario| scenario.filters[0].jump = true), "EKF jump at a sudden change = no");
        assert_eq!(said(|scenario| scenario.seed = 9), "seed = 1");
        assert_eq!(said(|scenario| scenario.filters[1].robust = crate::Robust::GATE), "UKF outliers = none");
        assert_eq!(said(|scenario| _ = scenario.filters.pop()), "with UKF");
    }

    #[test]
    fn a_change_tells_whose_results_it_concerns() {
        let concerned = |step: Step| {
            let mut changed = scenario();
            step(&mut changed);
            let before = scenario();
            let change = Change::between(&before, &changed);
            (change.is_of_filters(), [1, 2].map(|id| change.concerns(id)))
        };
        assert_eq!(concerned(|scenario| scenario.filters[0].fading = 1.5), (true, [true, false]));
        assert_eq!(concerned(|scenario| scenario.filters[1].name = "other".to_owned()), (true, [false, false]));
        assert_eq!(concerned(|scenario| scenario.seed = 7), (false, [true, true]));
    }

    #[test]
    fn a_setting_that_is_gone_is_not_changed() {
        let mut changed = scenario();
        changed.filters[0].fading = 1.5;
        let mut without = scenario();
        without.filters.remove(0);
        let error = Change::between(&scenario(), &changed).apply(&without).unwrap_err();
        assert_eq!(error.to_string(), "the scenario has no setting `filters#1.fading`");
    }
}
