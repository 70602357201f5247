//! The validation of scenarios.

use std::fmt::Display;

use super::{FilterSettings, Plant, Scenario, ScenarioError};
use crate::channel::{Role, Sign};
use crate::filter::{Adaptation, FilterKind};
use crate::quantity::MAX_SENSORS;
use crate::{Force, PlantKind, Signal, Values};

/// Limits the samples of one record: more than a day at 1 kHz. A run that keeps them all needs tens of gigabytes per
/// filter; one that forgets ([`crate::Run::forget`]) does not.
pub(super) const MAX_SAMPLES: usize = 100_000_000;

/// Limits the filters of one scenario.
pub(super) const MAX_FILTERS: usize = 16;

/// Limits the linearisations in one update of an IEKF.
const MAX_ITERATIONS: usize = 100;

/// Limits the steps into which a prediction is divided.
const MAX_SUBSTEPS: usize = 100;

/// Limits the samples by which the plant can feel the input after or before it is recorded.
const MAX_DELAY: u32 = 100;

/// Limits the members of an ensemble.
const MAX_ENSEMBLE: usize = 100_000;

impl Scenario {
    /// Checks every value.
    ///
    /// # Errors
    /// [`ScenarioError::Value`] for the first impossible one, with its key and what is allowed.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        let Self { seed, dt, duration, plant, force, input: _, hold: _, sensors, filters, record } = self;
        if let Some(record) = record {
            record.validate().map_err(|error| ScenarioError::Syntax(error.to_string()))?;
        }
        require(i64::try_from(*seed).is_ok(), "seed", seed, "a whole number from 0 to 2⁶³ - 1")?;
        positive("dt", *dt)?;
        positive("duration", *duration)?;
        require(
            *duration >= *dt && duration / dt <= (MAX_SAMPLES - 1) as f64,
            "duration",
            duration,
            format_args!("from 1 to {} times dt", MAX_SAMPLES - 1),
        )?;
        plant.validate()?;
        validate_force(force)?;
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
            not_negative(format!("sensors[{i}].noise_std"), sensor.noise_std)?;
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
            filter.validate(&format!("filters[{i}]"), sensors.len(), plant.kind)?;
        }
        Ok(())
    }
}

impl Plant {
    fn validate(&self) -> Result<(), ScenarioError> {
        let own = self.kind.parameters().filter_map(|channel| Some((channel, self.parameter(channel)?)));
        for (channel, parameter) in own.chain(self.signals()) {
            let key = format!("plant.{}", channel.key());
            validate_signal(&key, &parameter)?;
            let low = || format!("{} at its lowest", parameter.minimum());
            match channel.role() {
                Role::Parameter(Sign::Positive) => {
                    require(parameter.minimum() > 0.0, key, low(), "above 0 at all times")?;
                }
                Role::Parameter(Sign::NotNegative) => {
                    require(parameter.minimum() >= 0.0, key, low(), "at least 0 at all times")?;
                }
                Role::Parameter(Sign::Any) | Role::Augmentation | Role::Motion => {}
            }
        }
        finite("plant.initial.displacement", self.initial.displacement)?;
        finite("plant.initial.velocity", self.initial.velocity)?;
        delay("plant.input_delay", self.input_delay)?;
        not_negative("plant.disturbance_std", self.disturbance_std)
    }
}

impl FilterSettings {
    fn validate(&self, path: &str, sensors: usize, truth: PlantKind) -> Result<(), ScenarioError> {
        let Self {
            id: _,
            name: _,
            kind,
            color: _,
            plant,
            augment,
            input_delay,
            log_parameters,
            propagation: _,
            substeps,
            iterations,
            ensemble_size,
            adaptation: Adaptation { sensor_noise: _, process_noise: _, forgetting },
            jump,
            smoother,
            fading,
            eta,
            sensor_std,
            initial_mean,
            initial_std,
            process_std,
        } = self;
        require(
            (1..=MAX_SUBSTEPS).contains(substeps),
            format_args!("{path}.substeps"),
            substeps,
            format_args!("from 1 to {MAX_SUBSTEPS}"),
        )?;
        require(
            (1..=MAX_ITERATIONS).contains(iterations),
            format_args!("{path}.iterations"),
            iterations,
            format_args!("from 1 to {MAX_ITERATIONS}"),
        )?;
        require(
            (2..=MAX_ENSEMBLE).contains(ensemble_size),
            format_args!("{path}.ensemble_size"),
            ensemble_size,
            format_args!("from 2 to {MAX_ENSEMBLE}"),
        )?;
        require(
            *forgetting > 0.0 && *forgetting < 1.0,
            format_args!("{path}.adaptation.forgetting"),
            forgetting,
            "between 0 and 1",
        )?;
        require(
            !*jump || *kind != FilterKind::KF || !augment.is_empty(),
            format_args!("{path}.jump"),
            jump,
            "false for a KF, which takes its parameters for known and has none to widen",
        )?;
        require(
            !(*smoother && kind.is_sampled()),
            format_args!("{path}.smoother"),
            smoother,
            format_args!("false for a {}, which has no smoother here", kind.name()),
        )?;
        for (i, channel) in augment.iter().enumerate() {
            require(
                channel.is_augmentation() && !augment[..i].contains(channel),
                format_args!("{path}.augment[{i}]"),
                format_args!("\"{}\"", channel.key()),
                "an augmentation, each once: input_gain, input_offset, unknown_force, or bias_ and a sensor",
            )?;
        }
        delay(format_args!("{path}.input_delay"), *input_delay)?;
        if *log_parameters {
            for channel in plant.unwrap_or(truth).parameters().filter(|c| c.is_positive()) {
                positive(format!("{path}.initial_mean.{}", channel.key()), initial_mean[channel])?;
            }
        }
        require(
            fading.is_finite() && *fading >= 1.0,
            format_args!("{path}.fading"),
            fading,
            "a finite number, at least 1 (1 forgets nothing)",
        )?;
        not_negative(format!("{path}.eta"), *eta)?;
        require(
            sensor_std.len() == sensors,
            format_args!("{path}.sensor_std"),
            format_args!("a list of {}", sensor_std.len()),
            format_args!("a list of {sensors}, one for each sensor"),
        )?;
        for (i, std) in sensor_std.iter().enumerate() {
            positive(format!("{path}.sensor_std[{i}]"), *std)?;
        }
        each(&format!("{path}.initial_mean"), initial_mean, finite)?;
        each(&format!("{path}.initial_std"), initial_std, not_negative)?;
        each(&format!("{path}.process_std"), process_std, not_negative)
    }
}

fn each(
    path: &str,
    values: &Values,
    check: impl Fn(String, f64) -> Result<(), ScenarioError>,
) -> Result<(), ScenarioError> {
    values.iter().try_for_each(|(channel, value)| check(format!("{path}.{}", channel.key()), value))
}

fn validate_force(force: &Force) -> Result<(), ScenarioError> {
    match *force {
        Force::None => Ok(()),
        Force::WhiteNoise { std } => not_negative("force.white_noise.std", std),
        Force::Sine { amplitude, frequency } => {
            finite("force.sine.amplitude", amplitude)?;
            finite("force.sine.frequency", frequency)
        }
        Force::Chirp { amplitude, from, to, sweep } => {
            finite("force.chirp.amplitude", amplitude)?;
            finite("force.chirp.from", from)?;
            finite("force.chirp.to", to)?;
            positive("force.chirp.sweep", sweep)
        }
        Force::ImpulseTrain { impulse, period } => {
            finite("force.impulse_train.impulse", impulse)?;
            positive("force.impulse_train.period", period)
        }
        Force::Step { amplitude, at } => {
            finite("force.step.amplitude", amplitude)?;
            finite("force.step.at", at)
        }
    }
}

fn validate_signal(path: &str, signal: &Signal) -> Result<(), ScenarioError> {
    for (name, value) in signal.numbers() {
        finite(format!("{path}{name}"), value)?;
    }
    match signal {
        Signal::Ramp(ramp) => require(
            ramp.end >= ramp.start,
            format_args!("{path}.ramp.end"),
            ramp.end,
            format_args!("at least ramp.start = {}", ramp.start),
        ),
        Signal::Sine(sine) => positive(format!("{path}.sine.period"), sine.period),
        Signal::Constant(_) | Signal::Step(_) => Ok(()),
    }
}

fn delay(key: impl Display, samples: i32) -> Result<(), ScenarioError> {
    let allowed = format_args!("from -{MAX_DELAY} to {MAX_DELAY} samples");
    require(samples.unsigned_abs() <= MAX_DELAY, key, samples, allowed)
}

fn finite(key: impl Display, value: f64) -> Result<(), ScenarioError> {
    require(value.is_finite(), key, value, "a finite number")
}

fn positive(key: impl Display, value: f64) -> Result<(), ScenarioError> {
    require(value.is_finite() && value > 0.0, key, value, "a finite number above 0")
}

fn not_negative(key: impl Display, value: f64) -> Result<(), ScenarioError> {
    require(value.is_finite() && value >= 0.0, key, value, "a finite number, at least 0")
}

fn require(holds: bool, key: impl Display, value: impl Display, allowed: impl Display) -> Result<(), ScenarioError> {
    if holds {
        return Ok(());
    }
    Err(ScenarioError::Value { key: key.to_string(), value: value.to_string(), allowed: allowed.to_string() })
}
