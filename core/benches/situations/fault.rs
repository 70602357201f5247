//! The faults that are drawn, the verdicts that are right for each, and the causes that may be named.

use kalmanscope_core::diagnosis::VerdictKind::{self, *};

/// A fault of a filter, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fault {
    WellTuned,
    SensorNoiseTooLarge,
    SensorNoiseTooSmall,
    SensorNoiseContrary,
    ProcessNoiseTooSmall,
    ProcessNoiseTooLarge,
    HardeningSpring,
    YieldingSpring,
    MissingMode,
    WindUp,
    SuddenChange,
    SlowDrift,
    InputGain,
    InputOffset,
    InputDelay,
    InputHold,
    SensorBias,
    FeltDisturbance,
    NoExcitation,
    CollapsedSample,
}

impl Fault {
    pub(crate) const ALL: [Self; 20] = [
        Self::WellTuned,
        Self::SensorNoiseTooLarge,
        Self::SensorNoiseTooSmall,
        Self::SensorNoiseContrary,
        Self::ProcessNoiseTooSmall,
        Self::ProcessNoiseTooLarge,
        Self::HardeningSpring,
        Self::YieldingSpring,
        Self::MissingMode,
        Self::WindUp,
        Self::SuddenChange,
        Self::SlowDrift,
        Self::InputGain,
        Self::InputOffset,
        Self::InputDelay,
        Self::InputHold,
        Self::SensorBias,
        Self::FeltDisturbance,
        Self::NoExcitation,
        Self::CollapsedSample,
    ];

    /// The verdicts that are the contrary of what is true.
    pub(crate) fn contrary(self) -> &'static [VerdictKind] {
        match self {
            Self::SensorNoiseTooLarge | Self::ProcessNoiseTooLarge => &[Overconfident, Diverged, Lost],
            Self::SensorNoiseTooSmall | Self::ProcessNoiseTooSmall | Self::SuddenChange | Self::SlowDrift => {
                &[Underconfident]
            }
            _ => &[],
        }
    }

    /// The keys of the causes that are right.
    pub(crate) fn causes(self) -> &'static [&'static str] {
        match self {
            Self::WellTuned => &[],
            Self::SensorNoiseTooLarge | Self::SensorNoiseTooSmall | Self::SensorNoiseContrary => &["sensor_noise"],
            Self::ProcessNoiseTooSmall | Self::ProcessNoiseTooLarge => &["process_noise"],
            Self::HardeningSpring => &["spring"],
            Self::YieldingSpring => &["spring"],
            Self::MissingMode => &["missing_mode"],
            Self::WindUp => &["wind_up"],
            Self::SuddenChange => &["sudden_change"],
            Self::SlowDrift => &["slow_drift", "sudden_change"],
            Self::InputGain => &["input_gain"],
            Self::InputOffset => &["input_offset", "sensor_bias"],
            Self::InputDelay => &["input_delay", "input_hold"],
            Self::InputHold => &["input_hold", "input_delay"],
            Self::SensorBias => &["sensor_bias"],
            Self::FeltDisturbance => &["felt_disturbance"],
            Self::NoExcitation => &["no_excitation"],
            Self::CollapsedSample => &["collapsed_sample"],
        }
    }
}
