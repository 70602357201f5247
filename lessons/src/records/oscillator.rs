//! The exact response of an oscillator to a force that is linear over a step.

/// An oscillator `ẍ + 2ζωₙẋ + ωₙ²x = f` in motion, ζ < 1.
pub(crate) struct Oscillator {
    /// ωₙ \[rad/s\]
    pub(crate) natural_frequency: f64,
    pub(crate) damping_ratio: f64,
    /// x \[m\]
    pub(crate) displacement: f64,
    /// ẋ \[m/s\]
    pub(crate) velocity: f64,
}

impl Oscillator {
    pub(crate) fn new(natural_frequency: f64, damping_ratio: f64) -> Self {
        Self { natural_frequency, damping_ratio, displacement: 0.0, velocity: 0.0 }
    }

    /// `2ζωₙẋ + ωₙ²x`, the force of spring and damper over mass \[m/s²\].
    pub(crate) fn restoring(&self) -> f64 {
        let Self { natural_frequency: wn, damping_ratio: zeta, displacement, velocity } = self;
        2.0 * zeta * wn * velocity + wn * wn * displacement
    }

    /// Moves by a time `h` under a force over mass that goes from `from` to `to` on a line (Nigam and Jennings 1969).
    pub(crate) fn step(&mut self, from: f64, to: f64, h: f64) {
        let Self { natural_frequency: wn, damping_ratio: zeta, displacement, velocity } = self;
        let (decay, damped) = (*zeta * *wn, *wn * libm::sqrt(1.0 - *zeta * *zeta));
        // The particular solution is a line too; a free vibration makes up the rest.
        let slope = (to - from) / h / (*wn * *wn);
        let level = from / (*wn * *wn) - 2.0 * *zeta / *wn * slope;
        let (x, v) = (*displacement - level, *velocity - slope);
        let (shrink, cos, sin) = (libm::exp(-decay * h), libm::cos(damped * h), libm::sin(damped * h));
        *displacement = level + slope * h + shrink * (x * cos + (v + decay * x) / damped * sin);
        *velocity = slope + shrink * (v * cos - (decay * v + *wn * *wn * x) / damped * sin);
    }
}
