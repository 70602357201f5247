//! A beam with a support that moves in steps, shaken by an unknown force.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::oscillator::Oscillator;
use super::random::Random;

/// Samples in a second \[Hz\].
pub(crate) const RATE: u32 = 200;
/// The time at each position of the support \[s\].
pub(crate) const DWELL: u32 = 5;
/// The natural frequency at each position \[Hz\].
pub(crate) const FREQUENCIES: [f64; 6] = [18.0, 20.0, 22.0, 25.0, 22.0, 20.0];
pub(crate) const DAMPING_RATIO: f64 = 0.005;
/// Standard deviation of the sensor's noise \[mm\].
pub(crate) const NOISE: f64 = 0.02;
/// The force over mass, held over each fine step \[m/s²\].
const FORCE: f64 = 40.0;
/// The number of steps from one sample to the next.
const FINE: u32 = 8;

/// The natural frequency at a sample \[rad/s\].
pub(crate) fn natural_frequency(sample: u32) -> f64 {
    TAU * FREQUENCIES[((sample / (DWELL * RATE)) as usize).min(FREQUENCIES.len() - 1)]
}

/// The file: times and the deflection of the beam. The force is not measured.
pub(crate) fn file(seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut beam = Oscillator::new(natural_frequency(0), DAMPING_RATIO);
    let mut text = "time (s),deflection (mm)\n".to_owned();
    let h = 1.0 / f64::from(RATE * FINE);
    // It has been shaken for five seconds when the record begins.
    let before = DWELL * RATE;
    for k in 0..before + FREQUENCIES.len() as u32 * DWELL * RATE {
        if let Some(sample) = k.checked_sub(before) {
            beam.natural_frequency = natural_frequency(sample);
            let deflection = 1000.0 * beam.displacement + NOISE * random.normal();
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:.3},{deflection:.2}", f64::from(sample) / f64::from(RATE));
        }
        for _ in 0..FINE {
            let force = FORCE * random.normal();
            beam.step(force, force, h);
        }
    }
    text
}
