//! The validation of scenarios.

use std::fmt::{Arguments, Display};

use crate::document::{self, Document, DocumentError};
use kalmanscope_filters::channel::{Role, Sign};
use kalmanscope_filters::quantity::MAX_SENSORS;
use kalmanscope_filters::{Channel, InputKind};
use kalmanscope_records::record::Delays;
use thiserror::Error;

use super::cost::largest_ensemble;
use super::filter::of_filter;
use super::numbers::{FORCE, of_scenario};
use super::row::{Allowed, SettingInfo};
use super::table::TABLES;
use super::{FilterSettings, Plant, Scenario};
use crate::signal::Ramp;
use crate::{PlantKind, Signal};

/// The reason why a scenario cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ScenarioError {
    /// The text is not a scenario: the message has the line, the key and the reason.
    #[error("{0}")]
    Syntax(String),
    /// A value is impossible.
    #[error("`{key}` is {value}, but must be {allowed}")]
    Value {
        /// The key's path in the file.
        key: String,
        /// The value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
}

impl From<DocumentError> for ScenarioError {
    fn from(error: DocumentError) -> Self {
        Self::Syntax(error.to_string())
    }
}

/// Limits the samples of one record: more than a day at 1 kHz, and tens of gigabytes per filter in a run that keeps them all.
const MAX_SAMPLES: usize = 100_000_000;

const MAX_FILTERS: usize = 16;

impl Scenario {
    /// Checks every value.
    ///
    /// # Errors
    /// [`ScenarioError::Value`] for the first impossible one, with its key and what is allowed.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        let Self { seed, dt, duration, plant, force: _, forces, input: _, hold: _, sensors, filters, record, draw } =
            self;
        if let Some(record) = record {
            record.validate().map_err(|error| ScenarioError::Syntax(error.to_string()))?;
        }
        i64::try_from(*seed).map_err(|_| impossible("seed", seed, "a whole number from 0 to 2⁶³ - 1"))?;
        for info in of_scenario().filter(|info| (info.serves)(self, &plant.kind)) {
            check(format_args!(""), info, self)?;
        }
        for &mass in forces.keys() {
            let key = format_args!("forces.{}", mass.key());
            let (count, own) = (plant.kind.masses(), self.with_force_of(mass).unwrap_or_default());
            if mass.mass() >= count {
                return Err(impossible(key, "set", format_args!("on one of the {count} mass(es) of the plant")));
            }
            for info in FORCE.iter().filter(|info| (info.serves)(&own, &plant.kind)) {
                let own_key = info.key.strip_prefix("force").unwrap_or(info.key);
                number(format_args!("{key}{own_key}"), (info.get)(&own), info.allowed)?;
            }
        }
        let most = MAX_SAMPLES - 1;
        let is_of_samples = *duration >= *dt && duration / dt <= most as f64;
        require(is_of_samples, "duration", duration, format_args!("from 1 to {most} times dt"))?;
        plant.validate()?;
        length(sensors.len() <= MAX_SENSORS, "sensors", sensors.len(), format_args!("at most {MAX_SENSORS}"))?;
        for (i, sensor) in sensors.iter().enumerate() {
            let (key, quantity, plants) =
                (format_args!("sensors[{i}].measures"), sensor.measures.key(), plant.kind.name());
            let allowed = format_args!("something that a {plants} has");
            require(plant.kind.has(sensor.measures), key, format_args!("\"{quantity}\""), allowed)?;
            number(format_args!("sensors[{i}].noise_std"), sensor.noise_std, Allowed::AtLeast(0.0))?;
            for fault in sensor.faults.families() {
                let numbers = sensor.faults.numbers(fault).unwrap_or_default();
                for (info, &value) in fault.info().numbers.iter().zip(numbers) {
                    number(format_args!("sensors[{i}].faults.{}.{}", fault.info().key, info.key), value, info.allowed)?;
                }
            }
            let is_new = sensors[..i].iter().all(|s| s.measures != sensor.measures);
            require(is_new, key, format_args!("\"{quantity}\" again"), "a quantity that no other sensor measures")?;
        }
        length(filters.len() <= MAX_FILTERS, "filters", filters.len(), format_args!("at most {MAX_FILTERS}"))?;
        for (i, filter) in filters.iter().enumerate() {
            filter.validate(format_args!("filters[{i}]"), sensors.len(), *dt, &plant.kind)?;
        }
        for (key, law) in draw {
            if let Some(allowed) = law.problem() {
                let [a, b] = law.numbers();
                let key = format_args!("draw.\"{key}\".{}", law.info().key);
                return Err(impossible(key, format_args!("[{a}, {b}]"), allowed));
            }
        }
        Ok(())
    }
}

fn own_key(is_impostor: bool, path: impl Display, key: &str) -> Result<(), ScenarioError> {
    let error = || impossible(path, format_args!("\"{key}\" of your own"), "a key that no built-in kind has");
    if is_impostor { Err(error()) } else { Ok(()) }
}

impl Plant {
    fn validate(&self) -> Result<(), ScenarioError> {
        own_key(self.kind.is_impostor(), "plant.kind", self.kind.key())?;
        let own = self.kind.parameters().filter_map(|channel| Some((channel, self.parameter(channel)?)));
        for (channel, parameter) in own.chain(self.signals.iter().copied()) {
            let (minimum, key) = (parameter.minimum(), format_args!("plant.{}", channel.key()));
            for (name, value) in parameter.numbers() {
                number(format_args!("{key}{name}"), value, Allowed::Finite)?;
            }
            match parameter {
                Signal::Ramp(Ramp { start, end, .. }) => {
                    let allowed = format_args!("at least ramp.start = {start}");
                    require(end >= start, format_args!("{key}.ramp.end"), end, allowed)?;
                }
                Signal::Sine(sine) => number(format_args!("{key}.sine.period"), sine.period, Allowed::Above(0.0))?,
                Signal::Constant(_) | Signal::Step(_) => {}
            }
            let (holds, allowed) = match channel.role() {
                Role::Parameter(Sign::Positive) => (minimum > 0.0, "above 0 at all times"),
                Role::Parameter(Sign::NotNegative) => (minimum >= 0.0, "at least 0 at all times"),
                _ => (channel != Channel::WHITE_FORCE, "left out: the truth's white force is its disturbance_std"),
            };
            require(holds, key, format_args!("{minimum} at its lowest"), allowed)?;
        }
        Ok(())
    }
}

const MOST_PLUCKS: usize = 1000;

impl FilterSettings {
    fn validate(&self, path: Arguments<'_>, sensors: usize, dt: f64, truth: &PlantKind) -> Result<(), ScenarioError> {
        let Self { kind, plant, ensemble_size, sensor_std, sensor_delay, plucks, initial_mean, .. } = self;
        own_key(kind.is_impostor(), format_args!("{path}.kind"), kind.key())?;
        if let Some(plant) = plant {
            own_key(plant.is_impostor(), format_args!("{path}.plant"), plant.key())?;
        }
        for info in of_filter() {
            check(format_args!("{path}."), info, self)?;
        }
        let (holds, key) = (self.guesses == 1 || self.has_frequency(truth), format_args!("{path}.guesses"));
        require(holds, key, self.guesses, "1 for a filter without a natural frequency above 0 to estimate")?;
        if let Some((other, first, reason)) = self.excluded() {
            let value = document::of(self).map_or(Document::Null, |own| own[other.key].clone());
            let allowed = format_args!("left out for a filter that {}: {reason}", first.words);
            return Err(impossible(format_args!("{path}.{}", other.key), value, allowed));
        }
        if kind.is_sampled() {
            let components = self.model(truth, InputKind::default()).size();
            let steps = self.substeps.max(1);
            let most = largest_ensemble(components, steps);
            if *ensemble_size > most.max(2) {
                let allowed =
                    format_args!("at most {most} for {components} components that move by {steps} step(s) a sample");
                return Err(impossible(format_args!("{path}.ensemble_size"), ensemble_size, allowed));
            }
        }
        let is_considerable = |channel: Channel| self.considerable(truth).any(|known| known == channel);
        each_once(
            format_args!("{path}.augment"),
            &self.augment,
            &Channel::is_augmentation,
            "an augmentation, each once: input_gain, input_offset, unknown_force, white_force, or bias_ or sensor_gain_ and a sensor",
        )?;
        each_once(
            format_args!("{path}.consider"),
            &self.consider,
            &is_considerable,
            "a parameter that the filter does not know, or one of its augmentations but the white force, each once",
        )?;
        for (channel, between) in self.bounds.iter() {
            let key = format_args!("{path}.bounds.{}", channel.key());
            let [least, most] = between.ends();
            let allowed = "left out: it is no parameter that the filter does not know, and none of its augmentations but the white force";
            require(is_considerable(channel), key, "set", allowed)?;
            let is_rising = least < most && between.least.into_iter().chain(between.most).all(f64::is_finite);
            require(is_rising, key, format_args!("from {least} to {most}"), "from a number to a larger one")?;
            let (key, mean) = (format_args!("{path}.initial_mean.{}", channel.key()), initial_mean[channel]);
            if !(least..=most).contains(&mean) {
                return Err(impossible(key, mean, format_args!("between its bounds, {least} and {most}")));
            }
        }
        if self.log_parameters {
            for channel in plant.as_ref().unwrap_or(truth).parameters().filter(|c| c.is_positive()) {
                let key = format_args!("{path}.initial_mean.{}", channel.key());
                number(key, initial_mean[channel], Allowed::Above(0.0))?;
            }
        }
        let words = format_args!("a list of {sensors}, one for each sensor");
        length(sensor_std.len() == sensors, format_args!("{path}.sensor_std"), sensor_std.len(), words)?;
        let (is_full, key) = (sensor_delay.len() == sensors, format_args!("{path}.sensor_delay"));
        length(is_full || sensor_delay.is_empty(), key, sensor_delay.len(), format_args!("[], or {words}"))?;
        let is_rising = plucks.windows(2).all(|pair| pair[0] < pair[1]) && plucks.iter().all(|time| time.is_finite());
        let words = format_args!("at most {MOST_PLUCKS} finite times, each after the one before");
        length(is_rising && plucks.len() <= MOST_PLUCKS, format_args!("{path}.plucks"), plucks.len(), words)?;
        for (place, late) in sensor_delay.iter().enumerate() {
            let allowed = format_args!("within {} steps of {dt} s", Delays::MOST);
            require(late.abs() <= Delays::MOST * dt, format_args!("{path}.sensor_delay[{place}]"), late, allowed)?;
        }
        for (channel, time) in self.correlation_time.iter() {
            let key = format_args!("{path}.correlation_time.{}", channel.key());
            let allowed = "0 for all but the bias of a sensor, the input offset and the unknown force";
            require(time == 0.0 || channel.can_be_forgotten(), key, time, allowed)?;
        }
        for table in TABLES {
            if let Some((entry, value)) = table.first_refused(self) {
                number(format_args!("{path}.{}{entry}", table.key), value, table.allowed)?;
            }
        }
        Ok(())
    }
}

fn check<T>(path: Arguments<'_>, info: &SettingInfo<T>, of: &T) -> Result<(), ScenarioError> {
    let SettingInfo { key, unit, allowed, note, .. } = *info;
    let value = (info.get)(of);
    if allowed.admits(value) {
        return Ok(());
    }
    let unit = if allowed.is_whole() && !unit.is_empty() { format!(" {unit}") } else { String::new() };
    let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
    Err(impossible(format_args!("{path}{key}"), value, format_args!("{allowed}{unit}{note}")))
}

fn length(holds: bool, key: impl Display, count: usize, allowed: impl Display) -> Result<(), ScenarioError> {
    require(holds, key, format_args!("a list of {count}"), allowed)
}

fn each_once(
    path: Arguments<'_>,
    channels: &[Channel],
    is_one: &dyn Fn(Channel) -> bool,
    allowed: &str,
) -> Result<(), ScenarioError> {
    for (i, &channel) in channels.iter().enumerate() {
        let holds = is_one(channel) && !channels[..i].contains(&channel);
        require(holds, format_args!("{path}[{i}]"), format_args!("\"{}\"", channel.key()), allowed)?;
    }
    Ok(())
}

fn number(key: impl Display, value: f64, allowed: Allowed) -> Result<(), ScenarioError> {
    require(allowed.admits(value), key, value, allowed)
}

fn require(holds: bool, key: impl Display, value: impl Display, allowed: impl Display) -> Result<(), ScenarioError> {
    if holds { Ok(()) } else { Err(impossible(key, value, allowed)) }
}

fn impossible(key: impl Display, value: impl Display, allowed: impl Display) -> ScenarioError {
    ScenarioError::Value { key: key.to_string(), value: value.to_string(), allowed: allowed.to_string() }
}
