//! The faults that are drawn, the verdicts that are right for each, and the causes that may be named.

use kalmanscope_core::diagnosis::VerdictKind::{self, *};

macro_rules! faults {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Fault {
            $($(#[$doc])* $name,)*
        }

        impl Fault {
            pub(crate) const ALL: &[Self] = &[$(Self::$name),*];
        }
    };
}
faults! {
    WellTuned,
    SensorNoiseTooLarge,
    SensorNoiseTooSmall,
    SensorNoiseContrary,
    /// Q a hundredth.
    ProcessNoiseTooSmall,
    /// Q hundredfold.
    ProcessNoiseTooLarge,
    ProcessNoiseTenth,
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
    /// ωₙ swings.
    Swing,
    /// A wave near ωₙ that nobody records.
    UnknownWave,
    DryFriction,
    /// Quadratic damping.
    Drag,
    /// Few distinct values.
    Quantised,
    Clipped,
    /// One reading in a hundred is far off.
    Outliers,
    /// The noise of sensors resembles that before.
    Coloured,
    NoisierLater,
    NoiseSwings,
    /// A line in a sensor.
    Hum,
    NoisyInput,
    Scale,
    /// The input is not recorded in the last quarter.
    DeadInput,
}

impl Fault {
    /// Those that take turns in situations of one fault; the others come with a second one, or alone.
    pub(crate) const IN_TURN: &[Self] = Self::ALL.split_at(24).0;

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

    pub(crate) fn causes(self) -> &'static [&'static str] {
        match self {
            Self::WellTuned | Self::LargeSample | Self::Hum => &[],
            Self::SensorNoiseTooLarge | Self::SensorNoiseTooSmall | Self::SensorNoiseContrary => &["sensor_noise"],
            Self::Quantised => &["coarse"],
            Self::Clipped => &["clipped"],
            Self::Outliers => &["outliers"],
            Self::Coloured => &["coloured_noise"],
            Self::Scale => &["sensor_scale"],
            Self::ProcessNoiseTooSmall
            | Self::ProcessNoiseTooLarge
            | Self::ProcessNoiseTenth
            | Self::ProcessNoiseTenfold => &["process_noise"],
            Self::NoisyInput => &["process_noise", "white_force"],
            Self::HardeningSpring | Self::YieldingSpring => &["spring"],
            Self::MissingMode => &["missing_mode"],
            Self::WindUp => &["wind_up"],
            Self::SuddenChange => &["sudden_change"],
            Self::SlowDrift => &["slow_drift", "sudden_change"],
            Self::Swing => &["slow_drift"],
            Self::InputGain => &["input_gain"],
            Self::InputOffset => &["input_offset", "sensor_bias"],
            Self::InputDelay => &["input_delay", "input_hold"],
            Self::InputHold => &["input_hold", "input_delay"],
            Self::SensorBias => &["sensor_bias"],
            Self::FeltDisturbance => &["felt_disturbance"],
            Self::NoExcitation => &["no_excitation"],
            Self::CollapsedSample => &["collapsed_sample"],
            // One in three of these forces is a wave.
            Self::UnknownForce | Self::UnknownWave => &["unknown_force", "periodic_force"],
            Self::DryFriction => &["dry_friction"],
            Self::Drag => &["drag"],
            Self::NoisierLater | Self::NoiseSwings => &["changing_noise"],
            Self::DeadInput => &["still_input"],
        }
    }
}
