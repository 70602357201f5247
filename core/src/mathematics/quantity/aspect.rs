//! The aspects of a mass that a sensor can measure, as data.

use crate::Channel;
use crate::mathematics::channel::{ChannelInfo, Role, Usual, by_mass, symbols_by_mass};

/// A part of a sensor's reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// A component of the state.
    State(Channel),
    /// The rate of change of a component of the state.
    Rate(Channel),
    /// The acceleration of the ground \[m/s²\], which is zero unless the input is one.
    Ground,
}

/// The data of an aspect.
#[derive(Debug)]
#[non_exhaustive]
pub struct AspectInfo {
    /// Keys in scenario files and columns in CSV files, in the order of the masses; also the names.
    pub keys: &'static [&'static str],
    /// Symbols in formulas, in the order of the masses.
    pub symbols: &'static [&'static str],
    /// The unit.
    pub unit: &'static str,
    /// A usual standard deviation of its noise.
    pub usual_noise: f64,
    /// The reading for a mass, counted from 0, as a sum of weighted terms.
    pub reads: fn(usize) -> Vec<(Term, f64)>,
    /// The number of the first mass's random stream, and the distance to the next mass's. They must never change:
    /// another number gives other noise.
    pub streams: (u64, u64),
    /// The bias of such a sensor.
    pub bias: ChannelInfo,
    /// The gain of such a sensor: its reading over what it measures.
    pub gain: ChannelInfo,
}

/// The measured aspect of a mass, such as its displacement.
#[derive(Clone, Copy)]
pub struct Aspect(&'static AspectInfo);

/// The bias of a sensor, in the sensor's unit.
macro_rules! bias {
    ($key:literal, $name:literal, $symbol:literal, $unit:literal, $noise:literal) => {
        ChannelInfo {
            keys: by_mass!($key, "_"),
            names: by_mass!($name, " "),
            symbols: symbols_by_mass!($symbol, $symbol),
            unit: $unit,
            role: Role::Augmentation,
            rate: None,
            mirrored: false,
            usual: Usual {
                mean: 0.0,
                std: 5.0 * $noise,
                process: 0.0,
                truth: &[0.0],
                slider: (-20.0 * $noise, 20.0 * $noise),
                decimals: 4,
            },
        }
    };
}

/// The gain of a sensor.
macro_rules! gain {
    ($key:literal, $name:literal, $symbol:literal) => {
        ChannelInfo {
            keys: by_mass!($key, "_"),
            names: by_mass!($name, " "),
            symbols: symbols_by_mass!($symbol, $symbol),
            unit: "",
            role: Role::Augmentation,
            rate: None,
            mirrored: false,
            usual: Usual { mean: 1.0, std: 0.2, process: 0.0, truth: &[1.0], slider: (-2.0, 3.0), decimals: 4 },
        }
    };
}

static DISPLACEMENT: AspectInfo = AspectInfo {
    keys: by_mass!("displacement", "_"),
    symbols: symbols_by_mass!("x", "x"),
    unit: "m",
    usual_noise: 0.01,
    reads: |mass| vec![(Term::State(Channel::displacement(mass)), 1.0)],
    streams: (16, 3),
    bias: bias!("bias_displacement", "bias of the displacement", "bˣ", "m", 0.01),
    gain: gain!("sensor_gain_displacement", "sensor gain of the displacement", "gˣ"),
};

static VELOCITY: AspectInfo = AspectInfo {
    keys: by_mass!("velocity", "_"),
    symbols: symbols_by_mass!("v", "v"),
    unit: "m/s",
    usual_noise: 0.06,
    reads: |mass| vec![(Term::State(Channel::velocity(mass)), 1.0)],
    streams: (17, 3),
    bias: bias!("bias_velocity", "bias of the velocity", "bᵛ", "m/s", 0.06),
    gain: gain!("sensor_gain_velocity", "sensor gain of the velocity", "gᵛ"),
};

static ACCELERATION: AspectInfo = AspectInfo {
    keys: by_mass!("acceleration", "_"),
    symbols: symbols_by_mass!("ẍ", "ẍ"),
    unit: "m/s²",
    usual_noise: 0.3,
    reads: |mass| vec![(Term::Rate(Channel::velocity(mass)), 1.0)],
    streams: (18, 3),
    bias: bias!("bias_acceleration", "bias of the acceleration", "bᵃ", "m/s²", 0.3),
    gain: gain!("sensor_gain_acceleration", "sensor gain of the acceleration", "gᵃ"),
};

static TOTAL_ACCELERATION: AspectInfo = AspectInfo {
    keys: by_mass!("total_acceleration", "_"),
    symbols: symbols_by_mass!("ẍᵗ", "ẍᵗ"),
    unit: "m/s²",
    usual_noise: 0.3,
    reads: |mass| vec![(Term::Rate(Channel::velocity(mass)), 1.0), (Term::Ground, 1.0)],
    streams: (1 << 32, 1),
    bias: bias!("bias_total_acceleration", "bias of the total acceleration", "bᵗ", "m/s²", 0.3),
    gain: gain!("sensor_gain_total_acceleration", "sensor gain of the total acceleration", "gᵗ"),
};

static DRIFT: AspectInfo = AspectInfo {
    keys: by_mass!("drift", "_"),
    symbols: symbols_by_mass!("Δx", "Δx"),
    unit: "m",
    usual_noise: 0.01,
    reads: |mass| {
        let above = (Term::State(Channel::displacement(mass)), 1.0);
        let below = mass.checked_sub(1).map(|below| (Term::State(Channel::displacement(below)), -1.0));
        std::iter::once(above).chain(below).collect()
    },
    streams: (2 << 32, 1),
    bias: bias!("bias_drift", "bias of the drift", "bᵈ", "m", 0.01),
    gain: gain!("sensor_gain_drift", "sensor gain of the drift", "gᵈ"),
};

impl Aspect {
    /// The displacement against the base \[m\].
    pub const DISPLACEMENT: Self = Self(&DISPLACEMENT);
    /// The velocity against the base \[m/s\].
    pub const VELOCITY: Self = Self(&VELOCITY);
    /// The acceleration against the base \[m/s²\].
    pub const ACCELERATION: Self = Self(&ACCELERATION);
    /// The absolute acceleration: that against the base plus the ground's \[m/s²\].
    pub const TOTAL_ACCELERATION: Self = Self(&TOTAL_ACCELERATION);
    /// The displacement against the mass below, or the base \[m\].
    pub const DRIFT: Self = Self(&DRIFT);

    /// Every aspect.
    pub const ALL: [Self; 5] =
        [Self::DISPLACEMENT, Self::VELOCITY, Self::ACCELERATION, Self::TOTAL_ACCELERATION, Self::DRIFT];

    /// The data of the aspect.
    pub const fn info(self) -> &'static AspectInfo {
        self.0
    }
}

impl PartialEq for Aspect {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Aspect {}
