//! The settings of a scenario besides its filters that are one number each.

use super::filter::MAX_DELAY;
use super::info::{Field, SettingInfo, row};
use super::{Allowed, FORCE};
use crate::data::scenario::Scenario;

type Row = SettingInfo<Scenario>;

/// The seed of every random number.
pub static SEED: Row = row! { "seed", seed,
    name: "seed",
    allowed: Allowed::Whole(0, i64::MAX),
    hint: "The same seed gives the same noise, on every machine",
    is_varied: true,
};

/// Δt: the time between samples.
pub static DT: Row = row! { "dt", dt,
    symbol: "Δt",
    name: "sampling time",
    label: |_| Some("Δt sampling"),
    unit: "s",
    allowed: Allowed::Above(0.0),
    slider: (0.002, 0.1),
    is_logarithmic: true,
    hint: "Time between samples",
};

/// The length of the record.
pub static DURATION: Row = row! { "duration", duration,
    name: "duration",
    unit: "s",
    allowed: Allowed::Above(0.0),
    slider: (5.0, 120.0),
    hint: "Length of the record, up to a day; a long one is shown live only, and its beginning is forgotten",
};

/// The displacement at the start.
static DISPLACEMENT: Row = row! { "plant.initial.displacement", plant.initial.displacement,
    name: "initial displacement",
    label: |_| Some("x at start"),
    unit: "m",
    slider: (-1.0, 1.0),
    hint: "At the start of the record",
};

/// The velocity at the start.
static VELOCITY: Row = row! { "plant.initial.velocity", plant.initial.velocity,
    name: "initial velocity",
    label: |_| Some("v at start"),
    unit: "m/s",
    slider: (-5.0, 5.0),
    hint: "At the start of the record",
};

/// The unmeasured force.
pub static DISTURBANCE: Row = row! { "plant.disturbance_std", plant.disturbance_std,
    name: "disturbance",
    unit: "m/s²",
    allowed: Allowed::AtLeast(0.0),
    slider: (0.0, 10.0),
    hint: "Standard deviation of an unmeasured force",
    is_varied: true,
};

static INPUT_DELAY: Row = row! { "plant.input_delay", plant.input_delay,
    name: "delay of the input",
    unit: "samples",
    allowed: Allowed::Whole(-MAX_DELAY, MAX_DELAY),
};

/// The gain of a measured record's input, if the scenario names one with an input.
pub static RECORD_GAIN: Row = SettingInfo {
    name: "gain of the input",
    serves: |scenario, _| !(RECORD_GAIN.get)(scenario).is_nan(),
    ..SettingInfo::new(
        "record.input.gain",
        |scenario| {
            let input = scenario.record.as_ref().and_then(|record| record.input.as_ref());
            input.map_or(f64::NAN, |input| input.gain)
        },
        |scenario, gain| {
            if let Some(input) = scenario.record.as_mut().and_then(|record| record.input.as_mut()) {
                input.gain = gain;
            }
        },
    )
};

/// The settings of the motion at the start and of the force that filters are not told.
pub static MOTION: [&Row; 3] = [&DISPLACEMENT, &VELOCITY, &DISTURBANCE];

static OWN: [&Row; 8] = [&SEED, &DT, &DURATION, &DISPLACEMENT, &VELOCITY, &DISTURBANCE, &INPUT_DELAY, &RECORD_GAIN];

/// All settings of a scenario besides its filters that are one number each.
pub fn of_scenario() -> impl Iterator<Item = &'static Row> {
    OWN.into_iter().chain(&FORCE)
}
