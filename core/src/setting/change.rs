//! Changes of a scenario, and what was before them.

use crate::document::{self, Document};
use kalmanscope_filters::lists::sort_items;
use kalmanscope_filters::quantity::{ForcedMass, Quantity};

use super::filters::split_id;
use super::{
    Address, Allowed, CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, ChoiceInfo, Edit, FORCE, address, edit, filters, name,
    of_filter,
};
use crate::scenario::{FilterSettings, Scenario, ScenarioError, Sensor};

use crate::PlantKind;

/// Changes of a scenario, in the order in which they are made: settings with their new values, and filters and sensors that come or go.
/// It is made where a user or a program says what to change, and applies to any scenario that has these settings.
///
/// ```
/// use kalmanscope_core::{Scenario, setting::Change};
///
/// let mut scenario = Scenario::default();
/// let mut change = Change::default();
/// change.set(&scenario, "filters.EKF.fading", 1.0);
/// assert_eq!(change.apply(&mut scenario).unwrap(), ["filters#1.fading"]);
/// assert_eq!(scenario.filters[0].fading, 1.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change(Vec<Part>);

#[derive(Clone, Debug, PartialEq)]
enum Part {
    Number(Address, f64),
    /// Null for a setting that is left out; an error is reported where the change is applied.
    Value(String, Result<Document, ScenarioError>),
    Filter(usize, Box<FilterSettings>),
    NoFilter(u32),
    Sensor(Box<Sensor>),
    NoSensor(Quantity),
    Plant(PlantKind),
}

impl Change {
    /// Gives the number at an address of a scenario a value.
    pub fn set(&mut self, scenario: &Scenario, address: &str, value: f64) {
        match Address::parse(scenario, address) {
            Ok(address) => self.set_at(address, value),
            // It is refused where it is applied.
            Err(_) => self.edit(Edit::new(address, value)),
        }
    }

    /// Gives a number a value.
    pub fn set_at(&mut self, address: Address, value: f64) {
        self.0.push(Part::Number(address, value));
    }

    /// Gives a setting a value.
    pub fn edit(&mut self, edit: Edit) {
        let value = edit.document();
        self.0.push(Part::Value(edit.key, value));
    }

    /// Gives the setting at an address a value as a file has it: for none its default, or no place in a table in which it need not be.
    pub fn put(&mut self, address: impl Into<String>, value: &impl serde::Serialize) {
        self.0.push(Part::Value(address.into(), document::of(value).map_err(Into::into)));
    }

    /// Puts a filter in place of the one with its id, or else adds it at a place.
    pub fn put_filter(&mut self, place: usize, filter: FilterSettings) {
        self.0.push(Part::Filter(place, Box::new(filter)));
    }

    /// Takes out the filter with an id.
    pub fn remove_filter(&mut self, id: u32) {
        self.0.push(Part::NoFilter(id));
    }

    /// Puts a sensor in place of that of its quantity, or else adds it.
    pub fn put_sensor(&mut self, sensor: Sensor) {
        self.0.push(Part::Sensor(Box::new(sensor)));
    }

    /// Takes out the sensor of a quantity.
    pub fn remove_sensor(&mut self, quantity: Quantity) {
        self.0.push(Part::NoSensor(quantity));
    }

    /// Makes the truth a plant of this kind.
    pub fn set_plant(&mut self, kind: PlantKind) {
        self.0.push(Part::Plant(kind));
    }

    /// Changes a scenario, and turns off options that then exclude each other. Returns the addresses of all that it has set.
    ///
    /// # Errors
    /// [`ScenarioError`] where the scenario has no place for a setting.
    pub fn apply(&self, scenario: &mut Scenario) -> Result<Vec<String>, ScenarioError> {
        let mut keys = Vec::new();
        for part in &self.0 {
            match part {
                Part::Number(address, value) => {
                    if !address.is_in(scenario) {
                        return Err(edit::no_setting(&address.key, ""));
                    }
                    address.set(scenario, *value);
                    keys.extend(address::keys(scenario, &address.key));
                }
                Part::Value(key, value) => {
                    let mut document = document::of(scenario)?;
                    edit::put(&mut document, scenario, key, value.as_ref().map_err(Clone::clone)?)?;
                    *scenario = scenario.knowing(|| document::read(&document))?;
                    scenario.fill_in();
                    keys.extend(address::keys(scenario, key));
                }
                Part::Filter(place, filter) => {
                    if let Some(own) = scenario.filters.iter_mut().find(|own| own.id == filter.id) {
                        own.clone_from(filter);
                        keys.extend(address::keys_of(scenario, filter));
                    } else {
                        scenario.filters.insert((*place).min(scenario.filters.len()), (**filter).clone());
                        keys.push(filter.address(""));
                    }
                }
                Part::NoFilter(id) => {
                    scenario.filters.retain(|filter| filter.id != *id);
                    keys.push(filters::address(*id, ""));
                }
                Part::Sensor(sensor) => {
                    match scenario.sensor_place(sensor.measures) {
                        Some(place) => scenario.sensors[place] = **sensor,
                        None => scenario.add_sensor(**sensor),
                    }
                    keys.push(of_sensor(sensor.measures));
                }
                Part::NoSensor(quantity) => {
                    scenario.remove_sensor(*quantity);
                    keys.push(of_sensor(*quantity));
                }
                Part::Plant(kind) => {
                    keys.extend(scenario.measured().into_iter().map(of_sensor));
                    scenario.set_plant(kind.clone());
                    keys.push("plant.kind".to_owned());
                }
            }
        }
        let Scenario { plant, filters, .. } = scenario;
        for filter in filters {
            let turned_off = filter.turn_off_excluded(&plant.kind);
            keys.extend(turned_off.into_iter().map(|key| filter.address(key)));
        }
        Ok(keys)
    }
}

const SENSOR: &str = "sensors.";

fn of_sensor(quantity: Quantity) -> String {
    format!("{SENSOR}{}", quantity.key())
}

/// The settings that differ between a scenario from before and that of now, among those that were changed meanwhile.
pub struct Changed<'a> {
    was: &'a Scenario,
    now: &'a Scenario,
    keys: Vec<&'a str>,
}

impl<'a> Changed<'a> {
    /// Those of some addresses, which [`Change::apply`] returns. Filters are the same where their ids are.
    pub fn among(addresses: impl IntoIterator<Item = &'a String>, was: &'a Scenario, now: &'a Scenario) -> Self {
        let is_in_both = |id: u32| [was, now].into_iter().all(|scenario| filter_of(scenario, id).is_some());
        let stays = |key: &str| split_id(key).is_none_or(|(id, inner)| inner.is_empty() || is_in_both(id));
        let differs = |key: &&str| stays(key) && value(was, key) != value(now, key);
        Self { was, now, keys: addresses.into_iter().map(String::as_str).filter(differs).collect() }
    }

    /// Whether filters alone differ: both scenarios have the same record.
    pub fn is_of_filters(&self) -> bool {
        self.keys.iter().all(|key| split_id(key).is_some())
    }

    /// Whether the results of a filter of both scenarios differ: by a setting but its name and colour, or by the record.
    pub fn concerns(&self, id: u32) -> bool {
        let of_look = |key: &str| matches!(key, "name" | "color");
        let is_own = |key: &&str| split_id(key).is_some_and(|(of, key)| of == id && !of_look(key));
        !self.is_of_filters() || self.keys.iter().any(is_own)
    }

    /// What was before, setting by setting: `EKF λ = 1`, `with UKF` of a filter that is gone. `number` writes a number.
    pub fn what_was(&self, number: impl Fn(f64) -> String) -> Vec<String> {
        let Self { was, keys, .. } = self;
        // Those of filters come first, then filters that are gone, and new ones.
        let rank = |key: &str| match split_id(key) {
            Some((id, "")) => 1 + u8::from(filter_of(was, id).is_none()),
            Some(_) => 0,
            None => 3,
        };
        let mut keys = keys.clone();
        sort_items(&mut keys, |one, other| (rank(one), one).cmp(&(rank(other), other)));
        keys.into_iter().map(|key| self.said(key, &number)).collect()
    }

    fn said(&self, key: &str, number: &impl Fn(f64) -> String) -> String {
        let Self { was, now, .. } = *self;
        let come_or_gone = |is_gone: bool, name: &str| format!("{} {name}", if is_gone { "with" } else { "without" });
        let filter =
            split_id(key).and_then(|(id, inner)| Some((filter_of(was, id).or_else(|| filter_of(now, id))?, inner)));
        if let Some((own, "")) = filter {
            return come_or_gone(filter_of(was, own.id).is_some(), &own.name);
        }
        if let Some(mass) = key.strip_prefix("forces.").and_then(ForcedMass::from_key) {
            return format!("{} = {}", mass.name(), force_words(was, mass, number));
        }
        let old = words(&value(was, key), number);
        if let Some(quantity) = sensor(key) {
            let sensor = format!("the {} sensor", quantity.key());
            return match [was, now].map(|scenario| scenario.sensor_place(quantity)) {
                [Some(_), Some(_)] => format!("faults of {sensor} = {old}"),
                [own, _] => come_or_gone(own.is_some(), &sensor),
            };
        }
        let owner =
            filter.filter(|_| was.filters.len() > 1).map_or_else(String::new, |(own, _)| format!("{} ", own.name));
        format!("{owner}{} = {old}", name(was, filter.map_or(key, |(_, inner)| inner)))
    }
}

fn filter_of(scenario: &Scenario, id: u32) -> Option<&FilterSettings> {
    scenario.filters.iter().find(|filter| filter.id == id)
}

fn sensor(key: &str) -> Option<Quantity> {
    key.strip_prefix(SENSOR).and_then(Quantity::from_key)
}

/// The value of a setting; of a filter whether it exists, of a parameter that moves the shape of its signal; null where there is none.
fn value(scenario: &Scenario, key: &str) -> Document {
    if let Some(quantity) = sensor(key) {
        let sensor = scenario.sensors.iter().find(|sensor| sensor.measures == quantity);
        let faults = |sensor: &Sensor| sensor.faults.families().map(|fault| fault.info().name).collect::<Vec<_>>();
        return sensor.map_or(Document::Null, |sensor| faults(sensor).join(", ").into());
    }
    let number = || {
        let address = Address::parse(scenario, key).ok()?;
        Some(address.shape(scenario).map_or_else(|| address.get(scenario).into(), Document::from))
    };
    let Some((id, inner)) = split_id(key) else {
        return match chosen(&CHOICES_OF_SCENARIO, key, scenario).or_else(number) {
            Some(value) => value,
            None if key == "plant.kind" => document::of(&scenario.plant.kind).unwrap_or_default(),
            None => written(scenario, key),
        };
    };
    let Some(filter) = filter_of(scenario, id) else { return Document::Null };
    if inner.is_empty() {
        return true.into();
    }
    match of_filter().find(|row| row.key == inner && row.allowed == Allowed::Flag) {
        Some(flag) => ((flag.get)(filter) != 0.0).into(),
        None => chosen(&CHOICES_OF_FILTER, inner, filter).or_else(number).unwrap_or_else(|| written(filter, inner)),
    }
}

fn written(of: &impl serde::Serialize, key: &str) -> Document {
    let document = document::of(of).unwrap_or_default();
    document.pointer(&format!("/{}", key.replace('.', "/"))).cloned().unwrap_or_default()
}

fn chosen<T>(all: &[&ChoiceInfo<T>], key: &str, of: &T) -> Option<Document> {
    Some(all.iter().find(|info| info.key == key)?.chosen(of)?.name.into())
}

/// The shape of a force on one mass, and its numbers.
fn force_words(scenario: &Scenario, mass: ForcedMass, number: &impl Fn(f64) -> String) -> String {
    let Some(own) = scenario.with_force_of(mass) else { return "none".to_owned() };
    let shape = chosen(&CHOICES_OF_SCENARIO, "force", &own).unwrap_or_default();
    let rows = FORCE.iter().filter(|info| (info.serves)(&own, &own.plant.kind));
    let numbers = rows.map(|info| format!(" {} {}", (info.label)(&own).unwrap_or(info.name), number((info.get)(&own))));
    std::iter::once(words(&shape, number)).chain(numbers).collect()
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
