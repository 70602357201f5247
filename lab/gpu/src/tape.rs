//! Records as the shader reads them.

use kalmanscope_core::kernel::abreast::OscillatorFilter;
use kalmanscope_core::kernel::model::Output;
use kalmanscope_core::{Channel, Record};

use crate::layout::Sample;

/// Limits numbers: the squares of greater ones are not single precision any more.
pub(crate) const LARGEST: f64 = 1e15;

/// The filter's state.
pub(crate) const CHANNELS: [Channel; 4] =
    [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

/// The samples of a record, with what filters see of them, and what sums of the whole record need.
pub(crate) struct Tape {
    pub(crate) words: Vec<u32>,
    /// The number of measurements, and of samples with one, up to each sample.
    pub(crate) measured: Vec<[u32; 2]>,
    /// The largest absolute truth up to each sample; empty where the truth is not known.
    pub(crate) largest_truth: Vec<[f64; 4]>,
}

/// Whether the truth of the filter's channels is known.
pub(crate) fn knows_truth(record: &Record) -> bool {
    CHANNELS.iter().all(|&channel| record.truth(channel).is_some())
}

/// The place of a sensor among displacement, velocity, acceleration.
pub(crate) fn place_of(output: Output) -> Option<usize> {
    match output {
        Output::State(place @ (0 | 1)) => Some(place),
        Output::Rate(1) => Some(2),
        _ => None,
    }
}

impl Tape {
    /// The tape of a filter's record; none where a number is infinite, too large, or a truth that is not known.
    pub(crate) fn new(filter: &OscillatorFilter, record: &Record) -> Option<Self> {
        let truth: Option<Vec<&[f64]>> = CHANNELS.iter().map(|&channel| record.truth(channel)).collect();
        let mut columns: [&[f64]; 3] = [&[]; 3];
        for (output, &column) in filter.outputs.iter().zip(&filter.columns) {
            if let Some(place) = output.and_then(place_of) {
                columns[place] = record.measured(column);
            }
        }
        let mut words = Vec::with_capacity(record.len() * Sample::WORDS);
        let (mut measured, mut largest) = (Vec::with_capacity(record.len()), Vec::new());
        let (mut counts, mut most) = ([0; 2], [0.0; 4]);
        for k in 0..record.len() {
            let sample = Sample {
                truth: truth.as_ref().map_or([0.0; 4], |truth| [0, 1, 2, 3].map(|i| truth[i][k])),
                measured: columns.map(|column| column.get(k).copied().unwrap_or(f64::NAN)),
                force: record.delayed_force(k, filter.input_delay),
            };
            let is_fine = |number: &f64| number.abs() <= LARGEST;
            let is_missing = |number: &f64| number.is_nan() || is_fine(number);
            if !(sample.truth.iter().all(is_fine) && is_fine(&sample.force) && sample.measured.iter().all(is_missing)) {
                return None;
            }
            words.extend(sample.words());
            // Nothing is measured at the first sample.
            let present = if k == 0 { 0 } else { sample.measured.iter().filter(|number| !number.is_nan()).count() };
            counts = [counts[0] + present as u32, counts[1] + u32::from(present > 0)];
            measured.push(counts);
            if truth.is_some() {
                most = [0, 1, 2, 3].map(|i| sample.truth[i].abs().max(most[i]));
                largest.push(most);
            }
        }
        Some(Self { words, measured, largest_truth: largest })
    }
}
