//! An electronic circuit that behaves like an oscillator.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::oscillator::Oscillator;
use super::random::Random;

/// Samples in a second \[Hz\].
pub(crate) const RATE: f64 = 500.0;
/// The natural frequency \[rad/s\]: 0.7 times the rate, so that a period has nine samples.
pub(crate) const NATURAL_FREQUENCY: f64 = 350.0;
pub(crate) const DAMPING_RATIO: f64 = 0.05;
/// The gain of the input \[1/s²\].
pub(crate) const GAIN: f64 = 1.2e5;
/// The offset of the generator's voltage \[V\].
pub(crate) const OFFSET: f64 = 0.02;
/// Standard deviation of the noise of the voltmeter at the output \[V\].
pub(crate) const NOISE: f64 = 1e-3;
const ROWS: usize = 2500;
/// The number of steps from one sample to the next: the input changes between samples.
const FINE: usize = 16;
/// The number of sines in the input, up to 0.36 times the rate.
const LINES: u32 = 60;

/// The file: two columns of volts and no times. The input is a sum of sines below the Nyquist frequency.
pub(crate) fn file(seed: u64) -> String {
    let mut random = Random::new(seed);
    let h = 1.0 / (RATE * FINE as f64);
    let mut sines: Vec<SineGenerator> = (0..LINES)
        .map(|line| SineGenerator::new(TAU * 3.0 * (f64::from(line) + random.uniform()) * h, TAU * random.uniform()))
        .collect();
    let mut input = || 0.008 * sines.iter_mut().map(SineGenerator::next).sum::<f64>();
    let mut circuit = Oscillator::new(NATURAL_FREQUENCY, DAMPING_RATIO);
    let mut text = "\"V1\",\"V2\"\n".to_owned();
    let mut now = input();
    for k in 0..ROWS * FINE {
        if k.is_multiple_of(FINE) {
            let output = circuit.displacement + NOISE * random.normal();
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:.4},{output:.4}", now + OFFSET);
        }
        let next = input();
        circuit.step(GAIN * now, GAIN * next, h);
        now = next;
    }
    text
}

/// A sine of an angle that grows by equal steps: four products a step, less time than computing a sine.
struct SineGenerator {
    now: [f64; 2],
    step: [f64; 2],
}

impl SineGenerator {
    fn new(step: f64, phase: f64) -> Self {
        // By `libm`, since a scenario knows the file by its hash, which must be the same on every platform.
        let both = |angle: f64| [libm::sin(angle), libm::cos(angle)];
        Self { now: both(phase), step: both(step) }
    }

    fn next(&mut self) -> f64 {
        let ([sin, cos], [sin_step, cos_step]) = (self.now, self.step);
        self.now = [sin * cos_step + cos * sin_step, cos * cos_step - sin * sin_step];
        sin
    }
}
