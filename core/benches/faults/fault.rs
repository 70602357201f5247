//! The faults that are drawn, and the causes that are right for each.

/// A fault of a record or of a filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fault {
    /// The input has another gain.
    Gain,
    /// A constant force that is not recorded.
    Offset,
    /// The input is late or early.
    Delay,
    /// A sensor has a bias.
    Bias,
    /// R is too small.
    SmallR,
    /// R is too large.
    LargeR,
    /// Q of the motion is too small.
    SmallQ,
    /// ωₙ changes at once, late.
    Step,
    /// ωₙ drifts.
    Drift,
    /// ωₙ swings.
    Swing,
    /// The spring hardens.
    Hardening,
    /// A wave acts that is not recorded.
    Sine,
    /// Dry friction.
    Friction,
    /// Quadratic damping.
    Drag,
    /// Few distinct values.
    Quantised,
    /// A sensor's range ends.
    Clipped,
    /// One reading in a hundred is far off.
    Outliers,
    /// The noise of sensors resembles that before.
    Coloured,
    /// A sensor is noisier from a time on.
    NoisierLater,
    /// A sensor's noise swings.
    NoiseSwings,
    /// A line in a sensor.
    Hum,
    /// The input is recorded with noise.
    NoisyInput,
    /// A sensor has another scale.
    Scale,
    /// The input is not recorded in the last quarter.
    DeadInput,
}

use Fault::{
    Bias, Clipped, Coloured, DeadInput, Delay, Drag, Drift, Friction, Gain, Hardening, Hum, LargeR, NoiseSwings,
    NoisierLater, NoisyInput, Offset, Outliers, Quantised, Scale, Sine, SmallQ, SmallR, Step, Swing,
};

impl Fault {
    /// The keys of the causes that name it, if there are any.
    pub(crate) fn causes(self) -> &'static [&'static str] {
        match self {
            Gain => &["input_gain"],
            Offset => &["input_offset"],
            Delay => &["input_delay"],
            Bias => &["sensor_bias"],
            SmallR | LargeR | Quantised | Outliers => &["sensor_noise"],
            SmallQ | NoisyInput => &["process_noise"],
            Step => &["sudden_change"],
            Drift | Swing => &["slow_drift"],
            Hardening => &["spring"],
            Sine | Friction | Drag => &["unknown_force"],
            NoisierLater | NoiseSwings => &["changing_noise"],
            DeadInput => &["still_input"],
            Clipped | Coloured | Hum | Scale => &[],
        }
    }
}

/// Situations on some of whose seeds limits may be set.
pub(crate) const FOR_LIMITS: &[&[Fault]] = &[
    &[Gain],
    &[Bias],
    &[Delay],
    &[Step],
    &[Sine],
    &[Friction],
    &[Quantised],
    &[Outliers],
    &[NoisierLater],
    &[Gain, SmallR],
    &[Bias, Delay],
    &[Offset, Step],
];

/// Situations that are only reported.
pub(crate) const UNTOUCHED: &[&[Fault]] = &[
    &[Offset],
    &[SmallR],
    &[SmallQ],
    &[Drift],
    &[Swing],
    &[Hardening],
    &[Drag],
    &[Clipped],
    &[Coloured],
    &[NoiseSwings],
    &[Hum],
    &[NoisyInput],
    &[Scale],
    &[DeadInput],
    &[Gain, Bias],
    &[Gain, LargeR],
    &[Gain, Outliers],
    &[Gain, Hardening],
    &[Bias, SmallQ],
    &[Delay, SmallR],
    &[Step, Quantised],
    &[Drift, LargeR],
    &[Sine, Gain],
    &[Friction, Gain],
];

/// Situations that were written down after the last limit had been set.
pub(crate) const FRESH: &[&[Fault]] = &[
    &[Bias, Hardening],
    &[Bias, LargeR],
    &[Offset, SmallR],
    &[Offset, Gain],
    &[Swing, Gain],
    &[Swing, SmallQ],
    &[Step, Bias],
    &[Step, LargeR],
    &[Delay, SmallQ],
    &[Delay, Outliers],
    &[Hardening, SmallR],
    &[NoisierLater, Gain],
];
