//! The faults that are drawn, the verdicts that are right for each, and the causes that may be named.

use kalmanscope_core::diagnosis::VerdictKind::{self, *};

/// A fault of a filter, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fault {
    WellTuned,
    SensorNoiseTooLarge,
    SensorNoiseTooSmall,
    SensorNoiseContrary,
    /// Q a hundredth.
    ProcessNoiseTooSmall,
    /// Q hundredfold.
    ProcessNoiseTooLarge,
    /// Q a tenth.
    ProcessNoiseTenth,
    /// Q tenfold.
    ProcessNoiseTenfold,
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
    /// A particle filter with too few particles.
    CollapsedSample,
    /// A particle filter with many particles, which are enough or not.
    LargeSample,
    /// A slow force that nobody records.
    UnknownForce,
}

impl Fault {
    pub(crate) const ALL: [Self; 24] = [
        Self::WellTuned,
        Self::SensorNoiseTooLarge,
        Self::SensorNoiseTooSmall,
        Self::SensorNoiseContrary,
        Self::ProcessNoiseTooSmall,
        Self::ProcessNoiseTooLarge,
        Self::ProcessNoiseTenth,
        Self::ProcessNoiseTenfold,
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
        Self::LargeSample,
        Self::UnknownForce,
    ];

    /// The verdicts that are the contrary of what is true.
    pub(crate) fn contrary(self) -> &'static [VerdictKind] {
        match self {
            Self::SensorNoiseTooLarge | Self::ProcessNoiseTooLarge | Self::ProcessNoiseTenfold => {
                &[Overconfident, Diverged, Lost]
            }
            Self::SensorNoiseTooSmall
            | Self::ProcessNoiseTooSmall
            | Self::ProcessNoiseTenth
            | Self::SuddenChange
            | Self::SlowDrift => &[Underconfident],
            _ => &[],
        }
    }

    /// The keys of the causes that are right.
    pub(crate) fn causes(self) -> &'static [&'static str] {
        match self {
            Self::WellTuned | Self::LargeSample => &[],
            Self::SensorNoiseTooLarge | Self::SensorNoiseTooSmall | Self::SensorNoiseContrary => &["sensor_noise"],
            Self::ProcessNoiseTooSmall
            | Self::ProcessNoiseTooLarge
            | Self::ProcessNoiseTenth
            | Self::ProcessNoiseTenfold => &["process_noise"],
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
            Self::UnknownForce => &["unknown_force"],
        }
    }
}
