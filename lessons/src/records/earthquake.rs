//! A structure in the El Centro earthquake.

use std::fmt::Write as _;

use super::oscillator::Oscillator;
use super::random::Random;

/// The natural frequency \[rad/s\]: 2 Hz.
pub(crate) const NATURAL_FREQUENCY: f64 = 2.0 * std::f64::consts::TAU;
pub(crate) const DAMPING_RATIO: f64 = 0.03;
/// Standard deviation of the accelerometer's noise \[g\].
const NOISE: f64 = 0.002;
const GRAVITY: f64 = 9.80665;

/// Times \[s\] and ground accelerations \[g\].
fn ground() -> impl Iterator<Item = (&'static str, &'static str)> {
    include_str!("../../assets/records/elcentro.csv").lines().skip(1).filter_map(|line| line.trim().split_once(','))
}

/// The ground's acceleration as recorded, linear between samples, and the structure's total acceleration, both in g.
pub(crate) fn file(seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut structure = Oscillator::new(NATURAL_FREQUENCY, DAMPING_RATIO);
    let mut text = "time,ground (g),structure (g)\n".to_owned();
    let mut before: Option<(f64, f64)> = None;
    for (time, acceleration) in ground() {
        let (Ok(t), Ok(a)) = (time.parse::<f64>(), acceleration.parse::<f64>()) else { continue };
        if let Some((earlier, from)) = before {
            structure.step(-GRAVITY * from, -GRAVITY * a, t - earlier);
        }
        before = Some((t, a));
        // Spring and damper are all that moves the mass: its total acceleration follows from them.
        let total = -structure.restoring() / GRAVITY + NOISE * random.normal();
        // Writing to a string cannot fail.
        // Time and ground as text: the digits of the recording stay as they are.
        let _ = writeln!(text, "{time},{acceleration},{total:.4}");
    }
    text
}
