//! The free decay of an oscillator, fitted to a record without an input.

use super::moments;
use super::response::is_within;
use crate::Record;
use crate::data::import::Mapping;
use crate::data::sorting::sort_numbers;
use crate::mathematics::fourier::Transform;
use crate::mathematics::least_squares::NormalEquations;

/// An oscillator that nothing moves any more, as one sensor shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decay {
    /// ωₙ \[rad/s\]
    pub(super) natural_frequency: f64,
    /// ζ \[-\]
    pub(super) damping_ratio: f64,
    /// The standard deviation of what it leaves, in the sensor's unit; and those of ωₙ and ζ, if that is white.
    pub(super) rest: f64,
    /// The power of that about the decay's frequency, over its mean power.
    pub(super) nearby: f64,
    pub(super) spread: [f64; 2],
    /// The amplitude of the readings where they are largest, in the sensor's unit.
    pub(super) amplitude: f64,
    /// Whether it leaves only noise, so that there is no force to look for.
    pub(super) is_all: bool,
}

/// Limits the samples that are fitted.
const MOST: usize = 16_384;
/// The least number of samples of a first fit.
const SHORTEST: usize = 64;
/// The largest share of the power in the first time constants that a decay leaves unexplained.
const UNEXPLAINED: f64 = 0.5;
/// The time constants in which a decay is looked at.
const LASTS: f64 = 3.0;
/// The frequencies about that of the decay, relative to it, in which a force would leave its response.
const NEAR: std::ops::Range<f64> = 0.8..1.25;
/// The mean power of noise near the decay's frequency is at most this often the median of all.
const LOUD: f64 = 6.0;
/// The most steps of a descent.
const STEPS: usize = 40;

/// The free response that fits best to the readings from the largest one on, by least squares:
///
/// ```text
/// y = exp(-σt) (a cos ω_d t + b sin ω_d t) + c,  ωₙ² = ω_d² + σ²,  ζ = σ / ωₙ
/// ```
///
/// Displacement, velocity and acceleration have this form alike. The descent begins at the highest frequency of the
/// first 64, 128, … samples, since light damping shows in long parts and strong damping in short ones. `None` if no
/// decay explains the readings, for example because an unknown force goes on.
///
/// Source: Levenberg (1944), A method for the solution of certain non-linear problems in least squares; Ewins (2000), *Modal
/// Testing*, section 4.4 (time domain).
pub(super) fn decay(record: &Record, measured: &[f64], mapping: Option<&Mapping>) -> Option<Decay> {
    let band = mapping.and_then(|mapping| mapping.band);
    let (mean, _) = moments(measured);
    let size = |value: f64| if value.is_nan() { 0.0 } else { (value - mean).abs() };
    let begin = (0..measured.len()).max_by(|&a, &b| size(measured[a]).total_cmp(&size(measured[b])))?;
    let values = &measured[begin..];
    // A largest reading late in the record is no beginning of a decay.
    if 2 * begin > measured.len() || values.len() < SHORTEST {
        return None;
    }
    let readings = Readings { values: &values[..values.len().min(MOST)], dt: record.dt() };
    let lengths = (0..).map(|i| SHORTEST << i).take_while(|length| *length <= readings.values.len());
    let starts = lengths.filter_map(|length| readings.peak(length, mean, band));
    let found = starts.map(|start| readings.descend(start)).filter(|(error, _)| error.is_finite());
    let (_, shape) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let natural_frequency = libm::hypot(shape.frequency, shape.rate);
    let damping_ratio = shape.rate / natural_frequency;
    let is_sound = is_within(band, natural_frequency) && (1e-4..0.7).contains(&damping_ratio);
    let amplitude = libm::hypot(shape.parts[0], shape.parts[1]);
    let explains = readings.unexplained(&shape) < UNEXPLAINED;
    let (is_all, nearby) = readings.leaves_noise(&shape, mapping);
    let (rest, [frequency, rate]) = readings.spread(&shape)?;
    let spread = [frequency, rate / natural_frequency];
    (is_sound && explains).then_some(Decay {
        natural_frequency,
        damping_ratio,
        rest,
        nearby,
        spread,
        amplitude,
        is_all,
    })
}

/// The power of numbers at the frequencies below half their rate. Their count is a power of two.
fn powers(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut buffer: Vec<(f64, f64)> = numbers.map(|number| (number, 0.0)).collect();
    Transform::new(buffer.len()).apply(&mut buffer);
    buffer.iter().take(buffer.len() / 2).map(|(re, im)| re * re + im * im).collect()
}

/// A decay: its frequency and rate \[rad/s, 1/s\], and the parts of cosine, sine and constant.
#[derive(Clone, Copy, Debug)]
struct Shape {
    frequency: f64,
    rate: f64,
    parts: [f64; 3],
}

/// The readings that are fitted.
struct Readings<'a> {
    values: &'a [f64],
    dt: f64,
}

impl Readings<'_> {
    /// The highest frequency of the first samples, with a decay over their length.
    fn peak(&self, length: usize, mean: f64, band: Option<[f64; 2]>) -> Option<Shape> {
        let first = self.values[..length].iter().map(|value| if value.is_nan() { 0.0 } else { value - mean });
        let powers = powers(first);
        let span = length as f64 * self.dt;
        let frequency = |place: usize| std::f64::consts::TAU * place as f64 / span;
        let within = (1..powers.len()).filter(|place| is_within(band, frequency(*place)));
        let peak = within.max_by(|&a, &b| powers[a].total_cmp(&powers[b]))?;
        Some(Shape { frequency: frequency(peak), rate: 2.0 / span, parts: [0.0; 3] })
    }

    /// Whether a decay leaves no more power about its own frequency than elsewhere, where an import lets anything through; and
    /// the mean power there over that elsewhere.
    fn leaves_noise(&self, shape: &Shape, mapping: Option<&Mapping>) -> (bool, f64) {
        let [a, b, c] = shape.parts;
        let mut rests = Vec::with_capacity(self.values.len());
        self.each(shape, |_, [re, im], value| rests.push(value - a * re - b * im - c));
        rests.truncate(1 << rests.len().max(2).ilog2());
        let line = std::f64::consts::TAU / (rests.len() as f64 * self.dt);
        let mut powers = powers(rests.into_iter());
        let last = powers.len();
        let [low, high] = [NEAR.start, NEAR.end].map(|edge| ((edge * shape.frequency / line) as usize).clamp(1, last));
        let near = &powers[low..(high + 1).min(last)];
        let mean = near.iter().sum::<f64>() / near.len().max(1) as f64;
        let passed = mapping.map_or([0.0, 1.0], |mapping| mapping.passed(self.dt));
        let [low, high] = passed.map(|share| ((share * last as f64) as usize).min(last));
        let passed = &mut powers[low.min(high.saturating_sub(1))..high.max(1)];
        let all = passed.iter().sum::<f64>() / passed.len() as f64;
        sort_numbers(passed);
        (mean < LOUD * passed[passed.len() / 2], if all > 0.0 { mean / all } else { 1.0 })
    }

    /// Calls with each reading: its time, cosine and sine of the decay, and the reading.
    fn each(&self, shape: &Shape, mut call: impl FnMut(f64, [f64; 2], f64)) {
        let (sin, cos) = libm::sincos(shape.frequency * self.dt);
        let decay = libm::exp(-shape.rate * self.dt);
        let (turn_re, turn_im) = (decay * cos, decay * sin);
        let (mut re, mut im) = (1.0, 0.0);
        for (k, value) in self.values.iter().enumerate() {
            if !value.is_nan() {
                call(k as f64 * self.dt, [re, im], *value);
            }
            (re, im) = (re * turn_re - im * turn_im, re * turn_im + im * turn_re);
        }
    }

    /// The squared error of a decay, with the normal equations of a step.
    fn normal(&self, shape: &Shape) -> (f64, NormalEquations<5>) {
        let [a, b, c] = shape.parts;
        let (mut error, mut equations) = (0.0, NormalEquations::new());
        self.each(shape, |time, [re, im], value| {
            let rest = value - a * re - b * im - c;
            error += rest * rest;
            equations.add([re, im, 1.0, time * (b * re - a * im), -time * (a * re + b * im)], rest, 1.0);
        });
        (error, equations)
    }

    /// The standard deviation of what a decay leaves, and those of frequency and rate \[rad/s, 1/s\].
    fn spread(&self, shape: &Shape) -> Option<(f64, [f64; 2])> {
        let (error, equations) = self.normal(shape);
        let [.., frequency, rate] = equations.variances()?;
        let there = self.values.iter().filter(|value| !value.is_nan()).count();
        let variance = error / there.saturating_sub(5).max(1) as f64;
        Some((libm::sqrt(variance), [frequency, rate].map(|own| libm::sqrt(variance * own.max(0.0)))))
    }

    /// The parts that fit best to frequency and rate.
    fn with_parts(&self, shape: Shape) -> Option<Shape> {
        let mut equations = NormalEquations::new();
        self.each(&shape, |_, [re, im], value| equations.add([re, im, 1.0], value, 1.0));
        Some(Shape { parts: equations.solution()?, ..shape })
    }

    /// The least error that steps of Levenberg reach from frequency and rate, and the decay there.
    fn descend(&self, start: Shape) -> (f64, Shape) {
        let Some(mut shape) = self.with_parts(start) else { return (f64::INFINITY, start) };
        let (mut error, mut equations) = self.normal(&shape);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let Some([.., frequency, rate]) = equations.damped(damping, 0.0).solution() else { break };
            let next = Shape {
                frequency: (shape.frequency + frequency).clamp(0.5 * shape.frequency, 2.0 * shape.frequency),
                rate: (shape.rate + rate).clamp(0.25 * shape.rate, 4.0 * shape.rate),
                ..shape
            };
            let Some(next) = self.with_parts(next) else { break };
            let (next_error, next_equations) = self.normal(&next);
            if next_error < error {
                let gain = error - next_error;
                (shape, error, equations) = (next, next_error, next_equations);
                damping *= 0.1;
                if gain < 1e-9 * error {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e9 {
                    break;
                }
            }
        }
        (error, shape)
    }

    /// The share of the power in the first time constants that a decay leaves unexplained.
    fn unexplained(&self, shape: &Shape) -> f64 {
        let [a, b, c] = shape.parts;
        let (mut left, mut all) = (0.0, 0.0);
        self.each(shape, |time, [re, im], value| {
            if time * shape.rate < LASTS {
                let rest = value - a * re - b * im - c;
                left += rest * rest;
                all += (value - c) * (value - c);
            }
        });
        left / all.max(f64::MIN_POSITIVE)
    }
}
