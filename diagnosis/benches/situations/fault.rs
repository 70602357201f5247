//! The faults that are drawn, the verdicts that are right for each, and the causes that may be named.

use kalmanscope_diagnosis::VerdictKind::{self, *};

macro_rules! faults {
    ($($(#[$doc:meta])* $name:ident: [$($cause:literal),*],)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Fault {
            $($(#[$doc])* $name,)*
        }

        impl Fault {
            pub(crate) const ALL: &[Self] = &[$(Self::$name),*];

            pub(crate) fn causes(self) -> &'static [&'static str] {
                match self {
                    $(Self::$name => &[$($cause),*],)*
                }
            }
        }
    };
}
faults! {
    WellTuned: [],
    SensorNoiseTooLarge: ["sensor_noise"],
    SensorNoiseTooSmall: ["sensor_noise"],
    SensorNoiseContrary: ["sensor_noise"],
    ProcessNoiseTooSmall: ["process_noise"],
    ProcessNoiseTooLarge: ["process_noise"],
    ProcessNoiseTenth: ["process_noise"],
    ProcessNoiseTenfold: ["process_noise"],
    HardeningSpring: ["spring"],
    YieldingSpring: ["spring"],
    MissingMode: ["missing_mode"],
    WindUp: ["wind_up"],
    SuddenChange: ["sudden_change"],
    SlowDrift: ["slow_drift", "sudden_change"],
    InputGain: ["input_gain"],
    InputOffset: ["input_offset", "sensor_bias"],
    InputDelay: ["input_delay", "input_hold"],
    InputHold: ["input_hold", "input_delay"],
    SensorBias: ["sensor_bias"],
    FeltDisturbance: ["felt_disturbance"],
    NoExcitation: ["no_excitation"],
    CollapsedSample: ["collapsed_sample"],
    LargeSample: [],
    /// A slow force that nobody records; one in three is a wave.
    UnknownForce: ["unknown_force", "periodic_force"],
}

impl Fault {
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
}
