//! The validation of scenarios.

use std::fmt::{Arguments, Display};

use super::{FilterSettings, Plant, Scenario, ScenarioError};
use crate::data::record::Delays;
use crate::data::scenario::cost::largest_ensemble;
use crate::data::setting::{Allowed, GUESSES, JUMP, OF_FILTER, PROCESS_SCALES, SettingInfo, TABLES, WALK, of_scenario};
use crate::mathematics::channel::{Role, Sign};
use crate::mathematics::quantity::MAX_SENSORS;
use crate::{Channel, InputKind, PlantKind, Signal};

/// Limits the samples of one record: more than a day at 1 kHz. A run that keeps them all needs tens of gigabytes per
/// filter; one that forgets ([`crate::Run::forget`]) does not.
pub(super) const MAX_SAMPLES: usize = 100_000_000;

pub(super) const MAX_FILTERS: usize = 16;

impl Scenario {
    /// Checks every value.
    ///
    /// # Errors
    /// [`ScenarioError::Value`] for the first impossible one, with its key and what is allowed.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        let Self { seed, dt, duration, plant, force: _, input: _, hold: _, sensors, filters, record, draw } = self;
        if let Some(record) = record {
            record.validate().map_err(|error| ScenarioError::Syntax(error.to_string()))?;
        }
        require(i64::try_from(*seed).is_ok(), "seed", seed, "a whole number from 0 to 2⁶³ - 1")?;
        for info in of_scenario().filter(|info| (info.serves)(self, plant.kind)) {
            check(format_args!(""), info, self)?;
        }
        require(
            *duration >= *dt && duration / dt <= (MAX_SAMPLES - 1) as f64,
            "duration",
            duration,
            format_args!("from 1 to {} times dt", MAX_SAMPLES - 1),
        )?;
        plant.validate()?;
        require(
            sensors.len() <= MAX_SENSORS,
            "sensors",
            format_args!("a list of {}", sensors.len()),
            format_args!("at most {MAX_SENSORS}"),
        )?;
        for (i, sensor) in sensors.iter().enumerate() {
            require(
                plant.kind.has(sensor.measures),
                format_args!("sensors[{i}].measures"),
                format_args!("\"{}\"", sensor.measures.key()),
                format_args!("something that a {} has", plant.kind.name()),
            )?;
            number(format_args!("sensors[{i}].noise_std"), sensor.noise_std, Allowed::AtLeast(0.0))?;
            for fault in sensor.faults.families() {
                let numbers = sensor.faults.numbers(fault).unwrap_or_default();
                for (info, &value) in fault.info().numbers.iter().zip(numbers) {
                    let key = format_args!("sensors[{i}].faults.{}.{}", fault.info().key, info.key);
                    number(key, value, info.allowed)?;
                }
            }
            require(
                sensors[..i].iter().all(|s| s.measures != sensor.measures),
                format_args!("sensors[{i}].measures"),
                format_args!("\"{}\" again", sensor.measures.key()),
                "a quantity that no other sensor measures",
            )?;
        }
        require(
            filters.len() <= MAX_FILTERS,
            "filters",
            format_args!("a list of {}", filters.len()),
            format_args!("at most {MAX_FILTERS}"),
        )?;
        for (i, filter) in filters.iter().enumerate() {
            filter.validate(format_args!("filters[{i}]"), sensors.len(), *dt, plant.kind)?;
        }
        for (key, law) in draw {
            if let Some(allowed) = law.problem() {
                let [a, b] = law.numbers();
                require(false, format_args!("draw.\"{key}\".{}", law.info().key), format_args!("[{a}, {b}]"), allowed)?;
            }
        }
        Ok(())
    }
}

fn own_key(is_impostor: bool, path: impl Display, key: &str) -> Result<(), ScenarioError> {
    require(!is_impostor, path, format_args!("\"{key}\" of your own"), "a key that no built-in kind has")
}

impl Plant {
    fn validate(&self) -> Result<(), ScenarioError> {
        own_key(self.kind.is_impostor(), "plant.kind", self.kind.key())?;
        let own = self.kind.parameters().filter_map(|channel| Some((channel, self.parameter(channel)?)));
        for (channel, parameter) in own.chain(self.signals()) {
            let minimum = parameter.minimum();
            let key = format_args!("plant.{}", channel.key());
            validate_signal(key, &parameter)?;
            let low = format_args!("{minimum} at its lowest");
            require(
                channel != Channel::WHITE_FORCE,
                key,
                "set",
                "left out: the truth's white force is its disturbance_std",
            )?;
            match channel.role() {
                Role::Parameter(Sign::Positive) => {
                    require(minimum > 0.0, key, low, "above 0 at all times")?;
                }
                Role::Parameter(Sign::NotNegative) => {
                    require(minimum >= 0.0, key, low, "at least 0 at all times")?;
                }
                Role::Parameter(Sign::Any) | Role::Augmentation | Role::Motion => {}
            }
        }
        Ok(())
    }
}

const MOST_PLUCKS: usize = 1000;

impl FilterSettings {
    fn validate(&self, path: Arguments<'_>, sensors: usize, dt: f64, truth: PlantKind) -> Result<(), ScenarioError> {
        let Self {
            kind,
            plant,
            augment,
            consider,
            bounds,
            log_parameters,
            substeps,
            guesses,
            process_scales,
            ensemble_size,
            jump,
            walk,
            robust,
            smoother,
            sensor_std,
            sensor_delay,
            plucks,
            initial_mean,
            ..
        } = self;
        own_key(kind.is_impostor(), format_args!("{path}.kind"), kind.key())?;
        if let Some(plant) = plant {
            own_key(plant.is_impostor(), format_args!("{path}.plant"), plant.key())?;
        }
        for info in OF_FILTER.into_iter().flatten() {
            check(format_args!("{path}."), info, self)?;
        }
        require(
            *guesses == 1 || (GUESSES.serves)(self, truth),
            format_args!("{path}.guesses"),
            guesses,
            "1 for a filter with a smoother, or scales of Q, or without a natural frequency above 0 to estimate",
        )?;
        require(
            *process_scales == 1 || (PROCESS_SCALES.serves)(self, truth),
            format_args!("{path}.process_scales"),
            process_scales,
            "1 for a filter that samples its belief, jumps, weighs readings, learns Q, considers channels, has a smoother, several guesses \
             or a walk",
        )?;
        if kind.is_sampled() {
            let components = self.model(truth, InputKind::default()).size();
            let most = largest_ensemble(components, (*substeps).max(1));
            require(
                *ensemble_size <= most.max(2),
                format_args!("{path}.ensemble_size"),
                ensemble_size,
                format_args!(
                    "at most {most} for {components} components that move by {} step(s) a sample",
                    (*substeps).max(1)
                ),
            )?;
        }
        require(
            !*jump || (JUMP.serves)(self, truth),
            format_args!("{path}.jump"),
            jump,
            "false for a KF, which takes its parameters for known and has none to widen",
        )?;
        require(
            *walk == 0.0 || (WALK.serves)(self, truth),
            format_args!("{path}.walk"),
            walk,
            "0 for a filter that samples its belief, jumps, weighs readings, learns noise, has a smoother, or has no parameter to estimate",
        )?;
        require(
            !robust.is_on() || self.can_weigh(),
            format_args!("{path}.robust"),
            format_args!("\"{}\"", robust.info().key),
            "\"none\" for a filter that samples its belief or learns R",
        )?;
        require(
            !*smoother || kind.is_gaussian(),
            format_args!("{path}.smoother"),
            smoother,
            format_args!("false for a {}, which has no smoother here", kind.name()),
        )?;
        for (i, channel) in augment.iter().enumerate() {
            require(
                channel.is_augmentation() && !augment[..i].contains(channel),
                format_args!("{path}.augment[{i}]"),
                format_args!("\"{}\"", channel.key()),
                "an augmentation, each once: input_gain, input_offset, unknown_force, white_force, or bias_ or sensor_gain_ and a sensor",
            )?;
        }
        require(
            consider.is_empty() || self.can_consider(),
            format_args!("{path}.consider"),
            format_args!("a list of {}", consider.len()),
            "[] for a filter that samples its belief, jumps, learns noise, has a smoother, several guesses or a walk",
        )?;
        for (i, channel) in consider.iter().enumerate() {
            require(
                self.considerable(truth).any(|known| known == *channel) && !consider[..i].contains(channel),
                format_args!("{path}.consider[{i}]"),
                format_args!("\"{}\"", channel.key()),
                "a parameter that the filter does not know, or one of its augmentations but the white force, each once",
            )?;
        }
        require(
            bounds.is_empty() || self.can_be_bounded(),
            format_args!("{path}.bounds"),
            "set",
            "left out for a filter that samples its belief or has logarithms",
        )?;
        for (channel, between) in bounds.iter() {
            let key = format_args!("{path}.bounds.{}", channel.key());
            let [least, most] = between.ends();
            require(
                self.considerable(truth).any(|known| known == channel),
                key,
                "set",
                "left out: it is no parameter that the filter does not know, and none of its augmentations but the white force",
            )?;
            let is_finite = between.least.into_iter().chain(between.most).all(f64::is_finite);
            require(
                is_finite && least < most,
                key,
                format_args!("from {least} to {most}"),
                "from a number to a larger one",
            )?;
            require(
                (least..=most).contains(&initial_mean[channel]),
                format_args!("{path}.initial_mean.{}", channel.key()),
                initial_mean[channel],
                format_args!("between its bounds, {least} and {most}"),
            )?;
        }
        if *log_parameters {
            for channel in plant.unwrap_or(truth).parameters().filter(|c| c.is_positive()) {
                let key = format_args!("{path}.initial_mean.{}", channel.key());
                number(key, initial_mean[channel], Allowed::Above(0.0))?;
            }
        }
        require(
            sensor_std.len() == sensors,
            format_args!("{path}.sensor_std"),
            format_args!("a list of {}", sensor_std.len()),
            format_args!("a list of {sensors}, one for each sensor"),
        )?;
        require(
            sensor_delay.is_empty() || sensor_delay.len() == sensors,
            format_args!("{path}.sensor_delay"),
            format_args!("a list of {}", sensor_delay.len()),
            format_args!("[], or a list of {sensors}, one for each sensor"),
        )?;
        require(
            plucks.is_empty() || self.can_be_plucked(),
            format_args!("{path}.plucks"),
            format_args!("a list of {}", plucks.len()),
            "[] for a filter that samples its belief, or has a walk",
        )?;
        let is_rising = plucks.windows(2).all(|pair| pair[0] < pair[1]) && plucks.iter().all(|time| time.is_finite());
        require(
            is_rising && plucks.len() <= MOST_PLUCKS,
            format_args!("{path}.plucks"),
            format_args!("a list of {}", plucks.len()),
            format_args!("at most {MOST_PLUCKS} finite times, each after the one before"),
        )?;
        if let Some(place) = sensor_delay.iter().position(|late| late.abs() > Delays::MOST * dt) {
            require(
                false,
                format_args!("{path}.sensor_delay[{place}]"),
                sensor_delay[place],
                format_args!("within {} steps of {dt} s", Delays::MOST),
            )?;
        }
        for (channel, time) in self.correlation_time.iter() {
            require(
                time == 0.0 || channel.can_be_forgotten(),
                format_args!("{path}.correlation_time.{}", channel.key()),
                time,
                "0 for all but the bias of a sensor, the input offset and the unknown force",
            )?;
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
    require(false, format_args!("{path}{key}"), value, format_args!("{allowed}{unit}{note}"))
}

fn number(key: impl Display, value: f64, allowed: Allowed) -> Result<(), ScenarioError> {
    require(allowed.admits(value), key, value, allowed)
}

fn validate_signal(path: Arguments<'_>, signal: &Signal) -> Result<(), ScenarioError> {
    for (name, value) in signal.numbers() {
        number(format_args!("{path}{name}"), value, Allowed::Finite)?;
    }
    match signal {
        Signal::Ramp(ramp) => require(
            ramp.end >= ramp.start,
            format_args!("{path}.ramp.end"),
            ramp.end,
            format_args!("at least ramp.start = {}", ramp.start),
        ),
        Signal::Sine(sine) => number(format_args!("{path}.sine.period"), sine.period, Allowed::Above(0.0)),
        Signal::Constant(_) | Signal::Step(_) => Ok(()),
    }
}

fn require(holds: bool, key: impl Display, value: impl Display, allowed: impl Display) -> Result<(), ScenarioError> {
    if holds {
        return Ok(());
    }
    Err(ScenarioError::Value { key: key.to_string(), value: value.to_string(), allowed: allowed.to_string() })
}
