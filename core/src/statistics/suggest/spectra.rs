//! Spectra of input and measurements over overlapping windows, and the noise of readings at times of their own.

use std::f64::consts::{PI, TAU};

use kalmanscope_filters::fourier::Transform;
use kalmanscope_filters::lists::{median, sort_numbers};
use kalmanscope_records::Record;
use kalmanscope_records::mapping::Mapping;
use kalmanscope_records::record::Timed;

pub(super) const SHORT: usize = 256;
pub(super) const LONG: usize = 8192;
const SHORTEST: usize = 32;
/// The number of windows at least, which overlap by half: with one, every coherence would be 1.
const WINDOWS: usize = 7;
pub(super) const LEAST: usize = SHORTEST * (WINDOWS + 1) / 2;
/// The frequencies of the noise floor, as shares of the Nyquist frequency.
const FLOOR: [f64; 2] = [0.75, 0.96];
/// The same as shares of the highest frequency that a filter of the import lets through, below its slope.
const FLOOR_BELOW: [f64; 2] = [0.6, 0.85];
/// Limits a gap that is filled by a straight line, in samples: a longer one may hide a swing.
const LINE: usize = 3;
const THERE: f64 = 0.75;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GapTreatment {
    /// Take windows between the gaps, shorter ones where need be: the noise at high frequencies is that of the sensor alone.
    Avoid,
    /// Fill short gaps by a line and long ones by the mean, and scale up the rest: a resonance needs long windows.
    Fill,
}

/// Power of the input and of a measurement, and their product, at the frequencies `j / (L dt)`.
pub(super) struct Spectra {
    length: usize,
    pub(super) windows: usize,
    /// Time between the samples that it is made of \[s\].
    pub(super) dt: f64,
    pub(super) input: Vec<f64>,
    pub(super) output: Vec<f64>,
    pub(super) cross: Vec<(f64, f64)>,
}

impl Spectra {
    /// Windows have at most `longest` samples. `None` if too few are measured. Measurements between empty samples keep their own rate.
    /// Source: Welch (1967), The use of fast Fourier transform for the estimation of power spectra; Bendat and Piersol
    /// (2010), *Random Data*, chapter 6.
    pub(super) fn new(record: &Record, measured: &[f64], longest: usize, gaps: GapTreatment) -> Option<Self> {
        let every = stride(measured);
        let input: Vec<f64> = (0..measured.len()).step_by(every).map(|k| record.force(k)).collect();
        let mut output: Vec<f64> = measured.iter().copied().step_by(every).collect();
        if gaps == GapTreatment::Fill {
            bridge(&mut output);
        }
        let lengths = (0..).map(|i| longest >> i).take_while(|length| *length >= SHORTEST);
        let spectra = lengths.filter(|length| length * (WINDOWS + 1) / 2 <= output.len()).find_map(|length| {
            let begins = match gaps {
                GapTreatment::Avoid => between_gaps(&output, length),
                GapTreatment::Fill => (0..=output.len() - length).step_by(length / 2).collect(),
            };
            let is_covered = gaps == GapTreatment::Fill || begins.len() * length >= output.len();
            is_covered.then(|| Self::over(&input, &output, &begins, length, record.dt() * every as f64))?
        });
        if spectra.is_none() && gaps == GapTreatment::Avoid {
            return Self::new(record, measured, longest, GapTreatment::Fill);
        }
        let mut spectra = spectra?;
        if input.iter().all(|value| *value == input[0]) {
            // One transform serves both: without this, rounding of the output would pass for an input.
            spectra.input.fill(0.0);
            spectra.cross.fill((0.0, 0.0));
        }
        Some(spectra)
    }

    fn over(input: &[f64], output: &[f64], begins: &[usize], length: usize, dt: f64) -> Option<Self> {
        let weights = (0..length).map(|k| libm::sin(PI * (k as f64 + 0.5) / length as f64));
        let weights: Vec<f64> = weights.map(|w| w * w).collect();
        let all = weights.iter().map(|w| w * w).sum::<f64>();
        let transform = Transform::new(length);
        let half = length / 2;
        let (powers, cross) = (vec![0.0; half], vec![(0.0, 0.0); half]);
        let mut spectra = Self { length, windows: 0, dt, input: powers.clone(), output: powers, cross };
        let mut buffer = vec![(0.0, 0.0); length];
        for &begin in begins {
            let (input, output) = (&input[begin..begin + length], &output[begin..begin + length]);
            let (mut sum, mut count, mut there) = (0.0, 0_u32, 0.0);
            for (value, weight) in output.iter().zip(&weights).filter(|(value, _)| !value.is_nan()) {
                (sum, count, there) = (sum + value, count + 1, there + weight * weight);
            }
            let share = if count as usize == length { 1.0 } else { there / all };
            if share < THERE {
                continue;
            }
            let (input_mean, output_mean) = (input.iter().sum::<f64>() / length as f64, sum / f64::from(count));
            let filled = |value: f64| if value.is_nan() { 0.0 } else { value - output_mean };
            for (((slot, weight), input), output) in buffer.iter_mut().zip(&weights).zip(input).zip(output) {
                *slot = (weight * (input - input_mean), weight * filled(*output));
            }
            transform.apply(&mut buffer);
            spectra.add(&buffer, 1.0 / all);
        }
        if spectra.windows < WINDOWS / 2 {
            return None;
        }
        let share = 1.0 / spectra.windows as f64;
        spectra.input.iter_mut().chain(&mut spectra.output).for_each(|power| *power *= share);
        spectra.cross.iter_mut().for_each(|(re, im)| (*re, *im) = (*re * share, *im * share));
        Some(spectra)
    }

    fn add(&mut self, buffer: &[(f64, f64)], scale: f64) {
        self.windows += 1;
        for j in 1..self.length / 2 {
            let ((re, im), (mirrored_re, mirrored_im)) = (buffer[j], buffer[self.length - j]);
            let input = (0.5 * (re + mirrored_re), 0.5 * (im - mirrored_im));
            let output = (0.5 * (im + mirrored_im), 0.5 * (mirrored_re - re));
            self.input[j] += scale * (input.0 * input.0 + input.1 * input.1);
            self.output[j] += scale * (output.0 * output.0 + output.1 * output.1);
            self.cross[j].0 += scale * (output.0 * input.0 + output.1 * input.1);
            self.cross[j].1 += scale * (output.1 * input.0 - output.0 * input.1);
        }
    }

    pub(super) fn frequency(&self, place: usize) -> f64 {
        TAU * place as f64 / (self.length as f64 * self.dt)
    }

    /// The 99 % quantile of the coherence of pure noise at a frequency.
    /// Source: Bendat and Piersol (2010), *Random Data*, section 9.2; Carter (1987), Coherence and time delay estimation.
    pub(super) fn coherence_of_chance(&self) -> f64 {
        1.0 - libm::pow(0.01, 1.0 / (self.windows as f64 - 1.0).max(1.0))
    }

    /// The least power of an input that is one: a share of the median power of the frequencies that have nearly all of it.
    pub(super) fn least_input(&self) -> f64 {
        const BAND: f64 = 0.99;
        const LEAST: f64 = 1e-3;
        let mut powers = self.input.clone();
        sort_numbers(&mut powers);
        let most = BAND * powers.iter().sum::<f64>();
        let mut sum = 0.0;
        let within = powers.iter().rev().take_while(|power| {
            let is_within = sum < most;
            sum += **power;
            is_within
        });
        let count = within.count();
        powers.get(powers.len() - count.div_ceil(2).min(powers.len())).map_or(0.0, |median| LEAST * median)
    }

    pub(super) fn len(&self) -> usize {
        self.output.len()
    }

    pub(super) fn coherence(&self, place: usize) -> f64 {
        let (re, im) = self.cross[place];
        let product = self.input[place] * self.output[place];
        if product > 0.0 { ((re * re + im * im) / product).min(1.0) } else { 0.0 }
    }

    /// Standard deviation of the white noise that the input does not explain at the highest frequencies that an import lets through.
    pub(super) fn noise(&self, mapping: Option<&Mapping>) -> Option<f64> {
        let [_, passed] = passed(mapping, self.dt);
        let floor = if passed < 1.0 { FLOOR_BELOW.map(|share| share * passed) } else { FLOOR };
        let [low, high] = floor.map(|share| (share * self.len() as f64) as usize);
        // The coherence of pure noise is one over the number of windows, which would count as explained.
        let left = self.windows as f64 / (self.windows as f64 - 1.0).max(1.0);
        let power = |place: usize| self.output[place] * (1.0 - self.coherence(place)).max(0.0) * left;
        // A mean would count a hum or a mode among these frequencies as noise.
        median((low..high).map(power).collect()).filter(|usual| *usual > 0.0).map(libm::sqrt)
    }
}

fn bridge(values: &mut [f64]) {
    let mut last: Option<usize> = None;
    for k in 0..values.len() {
        if values[k].is_nan() {
            continue;
        }
        if let Some(before) = last.filter(|before| (2..=LINE + 1).contains(&(k - before))) {
            let (from, to, steps) = (values[before], values[k], (k - before) as f64);
            for (i, value) in values[before + 1..k].iter_mut().enumerate() {
                *value = from + (to - from) * (i + 1) as f64 / steps;
            }
        }
        last = Some(k);
    }
}

fn between_gaps(values: &[f64], length: usize) -> Vec<usize> {
    let (mut begins, mut begin) = (Vec::new(), 0);
    for (k, value) in values.iter().enumerate() {
        if value.is_nan() {
            begin = k + 1;
        } else if k + 1 - begin == length {
            begins.push(begin);
            begin += length / 2;
        }
    }
    begins
}

/// The distance between measurements: one, or more if an interpolation put empty samples between them.
pub(super) fn stride(measured: &[f64]) -> usize {
    let mut there = measured.iter().enumerate().filter(|(_, value)| !value.is_nan()).map(|(k, _)| k);
    let Some(first) = there.next().filter(|&first| first == 0) else { return 1 };
    let stride = there.next().map_or(1, |second| second - first);
    let is_even = measured.iter().enumerate().take(64 * stride).all(|(k, value)| value.is_nan() == (k % stride != 0));
    if is_even { stride.max(1) } else { 1 }
}

/// The readings of a difference: a motion has next to none of order seven, if it is measured some times a swing.
const READINGS: usize = 8;

const FEWEST: usize = 30;

const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// The standard deviation of the noise, by divided differences over the times of readings; `None` if there are too few.
/// ```text
/// d = Σ cᵢ zᵢ / √Σ cᵢ²,  cᵢ = Π 1 / (tᵢ - tⱼ), j ≠ i;  σ = median |d| / 0.674
/// ```
/// Source: Hamming (1973), *Numerical Methods*, chapter 10 (noise in a table of differences).
pub(super) fn noise(Timed { times, values }: &Timed) -> Option<f64> {
    let mut sizes: Vec<f64> = times.windows(READINGS).zip(values.windows(READINGS)).map(|(t, z)| size(t, z)).collect();
    sizes.retain(|size| size.is_finite());
    if sizes.len() < FEWEST { None } else { Some(median(sizes)? / MEDIAN) }
}

fn size(times: &[f64], values: &[f64]) -> f64 {
    // In units of the window, so that no product leaves the range of numbers.
    let span = times[READINGS - 1] - times[0];
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let others = times.iter().enumerate().filter(|(j, _)| *j != i);
        let weight = others.map(|(_, time)| span / (times[i] - time)).product::<f64>();
        sum += weight * value;
        squares += weight * weight;
    }
    (sum / libm::sqrt(squares)).abs()
}

/// The shares of the Nyquist frequency between which an import lets frequencies through.
pub(super) fn passed(mapping: Option<&Mapping>, dt: f64) -> [f64; 2] {
    mapping.map_or([0.0, 1.0], |mapping| mapping.passed(dt))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_filters::random::Normal;
    use kalmanscope_filters::{Hold, InputKind, Quantity};
    use kalmanscope_records::record::Input;

    #[test]
    fn noise_is_what_the_input_does_not_explain_and_nothing_follows_one_that_does_not_change() {
        let mut normal = Normal::from_seed(5);
        for (size, std) in [(1.0, 0.2), (0.0, 1.0)] {
            let values: Vec<f64> = (0..8192).map(|_| size * normal.sample()).collect();
            let measured: Vec<f64> = values.iter().map(|u| 3.0 * u + std * normal.sample()).collect();
            let input = Input { kind: InputKind::Force, hold: Hold::Zero, values };
            let record = Record::new(0.01, input, vec![(Quantity::ACCELERATION, measured.clone())]).unwrap();
            let spectra = Spectra::new(&record, &measured, SHORT, GapTreatment::Avoid).unwrap();
            assert!(size > 0.0 || (0..spectra.len()).all(|place| spectra.coherence(place) == 0.0));
            let noise = spectra.noise(None).unwrap();
            assert!((noise / std - 1.0).abs() < 0.1, "{noise}");
        }
    }

    #[test]
    fn noise_is_separated_from_motion_at_any_times() {
        let mut normal = Normal::from_seed(3);
        let mut time = 0.0;
        let (mut times, mut values) = (Vec::new(), Vec::new());
        for _ in 0..600 {
            time += 0.03 + 0.05 * libm::fabs(normal.sample());
            times.push(time);
            values.push(libm::sin(6.0 * time) + 0.01 * normal.sample());
        }
        let found = noise(&Timed { times: times.clone(), values }).unwrap();
        assert!((found / 0.01 - 1.0).abs() < 0.15, "{found}");
        let still = noise(&Timed { values: vec![0.0; times.len()], times }).unwrap();
        assert_eq!(still, 0.0);
        assert_eq!(noise(&Timed { times: vec![0.0, 1.0], values: vec![1.0, 2.0] }), None);
    }
}
