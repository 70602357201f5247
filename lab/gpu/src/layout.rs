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

#[derive(Clone, Copy, Debug)]
struct ErrorTally {
    squares: f64,
    recent: f64,
    inside: u32,
    settled: u32,
}

#[derive(Clone, Debug)]
pub(crate) struct RunState {
    mean: Vec<f64>,
    variance: Vec<f64>,
    tracked: Vec<ErrorTally>,
    nis: f64,
    nees: f64,
    ln_determinants: f64,
    nees_degrees: u32,
    nees_samples: u32,
    /// The sample at which the filter stopped, 0 if it has not, and why.
    stopped: u32,
    reason: u32,
}

impl RunState {
    pub(crate) fn read(shape: StateShape, words: &[u32]) -> Self {
        let n = shape.size;
        let number = |at: usize| f64::from(f32::from_bits(words[at]));
        let both = |at: usize, other: usize| number(at) + number(other);
        let root = 2 * n;
        let variance = |row: usize| {
            let first = root + row * (row + 1) / 2;
            (first..=first + row).map(|at| number(at) * number(at)).sum()
        };
        let first = root + shape.triangle();
        let tracked = |place: usize| {
            let at = first + TRACKED * place;
            ErrorTally {
                squares: both(at, at + 1),
                recent: both(at + 2, at + 3),
                inside: words[at + 4],
                settled: words[at + 5],
            }
        };
        let sums = first + TRACKED * shape.known.max(1);
        Self {
            mean: (0..n).map(|i| both(i, n + i)).collect(),
            variance: (0..n).map(variance).collect(),
            tracked: (0..shape.known).map(tracked).collect(),
            nis: both(sums, sums + 1),
            nees: both(sums + 2, sums + 3),
            nees_degrees: words[sums + 4],
            nees_samples: words[sums + 5],
            ln_determinants: number(sums + 6).ln() + f64::from(words[sums + 7].cast_signed()) * std::f64::consts::LN_2,
            stopped: words[sums + 8],
            reason: words[sums + 9],
        }
    }
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

pub(crate) fn outcome(setup: &Setup, record: &Record, tape: &RecordTape, state: &RunState) -> Outcome {
    let stop = (state.stopped > 0).then(|| Stop { sample: state.stopped as usize, reason: reason(state.reason) });
    let samples = stop.map_or(record.len(), |stop| stop.sample);
    let [degrees, measured] = tape.measured[samples - 1];
    let sums = channels((setup, record, tape), state, samples);
    Outcome {
        samples,
        nees: Total { sum: state.nees, degrees: state.nees_degrees, samples: state.nees_samples },
        nis: Total { sum: state.nis, degrees, samples: measured },
        log_likelihood: if degrees > 0 { log_likelihood(state.nis, state.ln_determinants, degrees) } else { 0.0 },
        stop,
        diverged: stop.is_some() || sums.iter().any(|(_, sums)| sums.is_lost()),
        channels: sums.iter().filter_map(|(channel, sums)| Some((*channel, sums.score(samples)?))).collect(),
        mean: state.mean.clone(),
        std: state.variance.iter().map(|variance| variance.sqrt()).collect(),
        sample_scores: Vec::new(),
    }
}

fn channels(
    (setup, record, tape): (&Setup, &Record, &RecordTape),
    state: &RunState,
    samples: usize,
) -> Vec<(Channel, ChannelSums)> {
    let known = state.tracked.len();
    let recent = samples.saturating_sub(record.len() * 4 / 5) as u32;
    let frequency = setup.channels.iter().position(|&channel| channel == Channel::NATURAL_FREQUENCY);
    let of = |(place, tracked): (usize, &ErrorTally)| {
        let channel = setup.channels[place];
        let truth = |k: usize| record.truth(channel).map_or(f64::NAN, |truth| truth[k]);
        let error = |mean: &[f64], k: usize| {
            let is_negative = frequency.is_some_and(|place| mean[place] < 0.0);
            let sign = if channel.is_mirrored() && is_negative { -1.0 } else { 1.0 };
            sign * mean[place] - truth(k)
        };
        let sums = ChannelSums {
            total: ErrorSums { squares: tracked.squares, known: samples as u32, inside: tracked.inside },
            first_error: error(&setup.mean, 0).abs(),
            largest_truth: tape.largest_truth[(samples - 1) * known + place],
            settled: tracked.settled as usize,
            recent: (tracked.recent, recent),
            error: error(&state.mean, samples - 1),
            std: state.variance[place].sqrt(),
            initial_std: setup.variance[place].sqrt(),
        };
        (channel, sums)
    };
    state.tracked.iter().enumerate().map(of).collect()
}

/// As `belief.wgsl` numbers them.
fn reason(number: u32) -> FilterError {
    match number {
        2 => FilterError::SingularInnovation,
        _ => FilterError::NotFinite,
    }
}
