//! The settings of a scenario besides its filters that are one number each: its own, and those of the force's shape.

use super::Scenario;
use super::filter::MAX_DELAY;
use super::row::{Allowed, Field, SettingInfo, row};
use crate::signal::Force;

type Row = SettingInfo<Scenario>;

/// The seed of every random number.
pub static SEED: Row = row! { seed, "seed",
    allowed: Allowed::Whole(0, i64::MAX),
    hint: "The same seed gives the same noise, on every machine",
    is_varied: true,
};

/// Δt: the time between samples.
pub static DT: Row = row! { dt, "sampling time",
    symbol: "Δt",
    label: |_| Some("Δt sampling"),
    unit: "s",
    allowed: Allowed::Above(0.0),
    slider: (0.002, 0.1),
    is_logarithmic: true,
    hint: "Time between samples",
};

/// The length of the record.
pub static DURATION: Row = row! { duration, "duration",
    unit: "s",
    allowed: Allowed::Above(0.0),
    slider: (5.0, 120.0),
    hint: "Length of the record, up to a day; a long one is shown live only, and its beginning is forgotten",
};

static DISPLACEMENT: Row = row! { plant.initial.displacement, "initial displacement",
    label: |_| Some("x at start"),
    unit: "m",
    slider: (-1.0, 1.0),
    hint: "At the start of the record",
};

static VELOCITY: Row = row! { plant.initial.velocity, "initial velocity",
    label: |_| Some("v at start"),
    unit: "m/s",
    slider: (-5.0, 5.0),
    hint: "At the start of the record",
};

/// The unmeasured force.
pub static DISTURBANCE: Row = row! { plant.disturbance_std, "disturbance",
    unit: "m/s²",
    allowed: Allowed::AtLeast(0.0),
    slider: (0.0, 10.0),
    hint: "Standard deviation of an unmeasured force",
    is_varied: true,
};

static INPUT_DELAY: Row = row! { plant.input_delay, "delay of the input",
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

macro_rules! of_shape {
    ($key:literal, $shape:ident.$field:ident, $label:literal for $name:literal in $unit:literal, $($data:tt)*) => {
        SettingInfo {
            name: $name,
            label: |_| Some($label),
            unit: $unit,
            serves: |scenario, _| matches!(scenario.force, Force::$shape { .. }),
            hint: "The filters know the force exactly",
            $($data)*
            ..SettingInfo::new(
                $key,
                |scenario| if let Force::$shape { $field, .. } = scenario.force { $field } else { f64::NAN },
                |scenario, value| {
                    if let Force::$shape { $field, .. } = &mut scenario.force {
                        *$field = value;
                    }
                },
            )
        }
    };
}

/// All numbers of all shapes.
pub static FORCE: [Row; 11] = [
    of_shape! { "force.white_noise.std", WhiteNoise.std, "± σ" for "std of the force" in "m/s²",
        allowed: Allowed::AtLeast(0.0),
        slider: (0.0, 50.0),
        is_varied: true,
    },
    of_shape! { "force.sine.amplitude", Sine.amplitude, "amplitude" for "amplitude of the force" in "m/s²",
        slider: (0.0, 50.0),
        is_varied: true,
    },
    of_shape! { "force.sine.frequency", Sine.frequency, "frequency" for "frequency of the force" in "rad/s",
        slider: (0.1, 30.0),
        is_varied: true,
    },
    of_shape! { "force.chirp.amplitude", Chirp.amplitude, "amplitude" for "amplitude of the force" in "m/s²",
        slider: (0.0, 50.0),
        is_varied: true,
    },
    of_shape! { "force.chirp.from", Chirp.from, "from" for "first frequency of the force" in "rad/s",
        slider: (0.1, 30.0),
    },
    of_shape! { "force.chirp.to", Chirp.to, "to" for "last frequency of the force" in "rad/s",
        slider: (0.1, 30.0),
    },
    of_shape! { "force.chirp.sweep", Chirp.sweep, "sweep time" for "time of a sweep" in "s",
        allowed: Allowed::Above(0.0),
        slider: (1.0, 60.0),
    },
    of_shape! { "force.impulse_train.impulse", ImpulseTrain.impulse, "impulse" for "impulse of a blow" in "m/s",
        slider: (0.0, 5.0),
        is_varied: true,
    },
    of_shape! { "force.impulse_train.period", ImpulseTrain.period, "every" for "time between blows" in "s",
        allowed: Allowed::Above(0.0),
        slider: (0.5, 30.0),
        is_varied: true,
    },
    of_shape! { "force.step.amplitude", Step.amplitude, "amplitude" for "amplitude of the force" in "m/s²",
        slider: (-50.0, 50.0),
        is_varied: true,
    },
    of_shape! { "force.step.at", Step.at, "at" for "time of the force's step" in "s",
        slider: (0.0, 60.0),
    },
];
