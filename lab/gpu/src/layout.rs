//! The structures of `shader/layout.wgsl` as words of 32 bits, records for the shader, and outcomes from its sums.

use kalmanscope_core::diagnostics::{ErrorSums, Total};
use kalmanscope_core::internals::engine::Setup;
use kalmanscope_core::internals::{ChannelSums, log_likelihood};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, FilterError, Record, Stop};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StateShape {
    pub(crate) size: usize,
    pub(crate) sensors: usize,
    pub(crate) known: usize,
}

/// The words of a state without its belief and the sums of channels; and the words of a channel's sums.
const SUMS: usize = 10;
const TRACKED: usize = 6;

impl StateShape {
    pub(crate) fn triangle(self) -> usize {
        self.size * (self.size + 1) / 2
    }

    pub(crate) fn sample(self) -> usize {
        2 + self.sensors.max(1) + self.known.max(1)
    }

    pub(crate) fn state(self) -> usize {
        2 * self.size + self.triangle() + TRACKED * self.known.max(1) + SUMS
    }
}

pub(crate) fn put_cell(words: &mut Vec<u32>, setup: &Setup, first: u32) {
    let Setup { mean, variance, process, sensors, fading, white, .. } = setup;
    let root = |&number: &f64| bits(number.sqrt());
    words.extend(mean.iter().copied().map(bits));
    words.extend(variance.iter().chain(process).map(root));
    words.extend(sensors.iter().copied().map(bits));
    words.extend(sensors.is_empty().then_some(0));
    words.extend([root(fading), root(white), first]);
}

pub(crate) fn bits(number: f64) -> u32 {
    (number as f32).to_bits()
}

/// Limits numbers: the squares of greater ones are not single precision any more.
pub(crate) const LARGEST: f64 = 1e15;

pub(crate) struct RecordTape {
    pub(crate) words: Vec<u32>,
    /// The number of measurements, and of samples with one, up to each sample.
    pub(crate) measured: Vec<[u32; 2]>,
    /// The largest absolute truth of each known channel up to each sample, one sample after the other.
    pub(crate) largest_truth: Vec<f64>,
}

/// The number of channels with a truth, which must be the first ones; else `None`.
pub(crate) fn known(channels: &[Channel], record: &Record) -> Option<usize> {
    let knows = |channel: &&Channel| record.truth(**channel).is_some();
    let known = channels.iter().take_while(knows).count();
    (channels.iter().filter(knows).count() == known).then_some(known)
}

impl RecordTape {
    /// With the truth of the first channels. `None` if a number is infinite or too large, or a truth is missing.
    pub(crate) fn new(setup: &Setup, record: &Record, known: usize) -> Option<Self> {
        let truth: Vec<&[f64]> = setup.channels[..known].iter().filter_map(|&channel| record.truth(channel)).collect();
        let columns: Vec<&[f64]> = setup.columns.iter().map(|&column| record.measured(column)).collect();
        let (mut words, mut measured, mut largest_truth) = (Vec::new(), Vec::with_capacity(record.len()), Vec::new());
        let (mut counts, mut most) = ([0; 2], vec![0.0_f64; known]);
        for k in 0..record.len() {
            let of = |columns: &[&[f64]]| -> Vec<f64> { columns.iter().map(|column| column[k]).collect() };
            let (own, numbers, force) = (of(&truth), of(&columns), record.delayed_force(k, setup.delays.input));
            let is_fine = |number: &f64| number.abs() <= LARGEST;
            let is_missing = |number: &f64| number.is_nan() || is_fine(number);
            if !(own.iter().all(is_fine) && is_fine(&force) && numbers.iter().all(is_missing)) {
                return None;
            }
            let is_there = numbers.iter().enumerate().map(|(place, number)| u32::from(!number.is_nan()) << place);
            words.extend([bits(force), is_there.sum()]);
            words.extend(numbers.iter().map(|&number| if number.is_nan() { 0 } else { bits(number) }));
            words.extend(numbers.is_empty().then_some(0));
            words.extend(own.iter().copied().map(bits));
            words.extend(own.is_empty().then_some(0));
            let present = if k == 0 { 0 } else { numbers.iter().filter(|number| !number.is_nan()).count() };
            counts = [counts[0] + present as u32, counts[1] + u32::from(present > 0)];
            measured.push(counts);
            most.iter_mut().zip(&own).for_each(|(most, own)| *most = most.max(own.abs()));
            largest_truth.extend_from_slice(&most);
        }
        Some(Self { words, measured, largest_truth })
    }
}

pub(crate) fn outcome(setup: &Setup, record: &Record, tape: &RecordTape, shape: StateShape, words: &[u32]) -> Outcome {
    let number = |at: usize| f64::from(f32::from_bits(words[at]));
    let both = |at: usize, other: usize| number(at) + number(other);
    let (n, tracked) = (shape.size, 2 * shape.size + shape.triangle());
    let rest = tracked + TRACKED * shape.known.max(1);
    let variance = |row: usize| -> f64 {
        let first = 2 * n + row * (row + 1) / 2;
        (first..=first + row).map(|at| number(at) * number(at)).sum()
    };
    let mean: Vec<f64> = (0..n).map(|i| both(i, n + i)).collect();
    let std: Vec<f64> = (0..n).map(|row| variance(row).sqrt()).collect();
    // The sample at which the filter stopped, 0 if it has not, and why, as `belief.wgsl` numbers it.
    let reason = if words[rest + 9] == 2 { FilterError::SingularInnovation } else { FilterError::NotFinite };
    let stop = (words[rest + 8] > 0).then(|| Stop { sample: words[rest + 8] as usize, reason });
    let samples = stop.map_or(record.len(), |stop| stop.sample);
    let recent = samples.saturating_sub(record.len() * 4 / 5) as u32;
    let frequency = setup.channels.iter().position(|&channel| channel == Channel::NATURAL_FREQUENCY);
    let sums = |place: usize| {
        let (channel, at) = (setup.channels[place], tracked + TRACKED * place);
        let error = |mean: &[f64], k: usize| {
            let is_negative = frequency.is_some_and(|place| mean[place] < 0.0);
            let sign = if channel.is_mirrored() && is_negative { -1.0 } else { 1.0 };
            sign * mean[place] - record.truth(channel).map_or(f64::NAN, |truth| truth[k])
        };
        let sums = ChannelSums {
            total: ErrorSums { squares: both(at, at + 1), known: samples as u32, inside: words[at + 4] },
            first_error: error(&setup.mean, 0).abs(),
            largest_truth: tape.largest_truth[(samples - 1) * shape.known + place],
            settled: words[at + 5] as usize,
            recent: (both(at + 2, at + 3), recent),
            error: error(&mean, samples - 1),
            std: std[place],
            initial_std: setup.variance[place].sqrt(),
        };
        (channel, sums)
    };
    let sums: Vec<(Channel, ChannelSums)> = (0..shape.known).map(sums).collect();
    let [degrees, measured] = tape.measured[samples - 1];
    let (nis, exponent) = (both(rest, rest + 1), words[rest + 7].cast_signed());
    let ln_determinants = number(rest + 6).ln() + f64::from(exponent) * std::f64::consts::LN_2;
    Outcome {
        samples,
        nees: Total { sum: both(rest + 2, rest + 3), degrees: words[rest + 4], samples: words[rest + 5] },
        nis: Total { sum: nis, degrees, samples: measured },
        log_likelihood: if degrees > 0 { log_likelihood(nis, ln_determinants, degrees) } else { 0.0 },
        stop,
        diverged: stop.is_some() || sums.iter().any(|(_, sums)| sums.is_lost()),
        channels: sums.iter().filter_map(|(channel, sums)| Some((*channel, sums.score(samples)?))).collect(),
        mean,
        std,
        sample_scores: Vec::new(),
    }
}
