//! Records as the shader reads them.

use kalmanscope_core::internals::engine::Setup;
use kalmanscope_core::{Channel, Record};

use crate::layout::put_sample;

/// Limits numbers: the squares of greater ones are not single precision any more.
pub(crate) const LARGEST: f64 = 1e15;

/// The samples of a record as filters read them, and the numbers that sums over the whole record need.
pub(crate) struct Tape {
    pub(crate) words: Vec<u32>,
    /// The number of measurements, and of samples with one, up to each sample.
    pub(crate) measured: Vec<[u32; 2]>,
    /// The largest absolute truth of each known channel up to each sample, one sample after the other.
    pub(crate) largest_truth: Vec<f64>,
}

/// The number of channels with a truth in the record, which must be the first ones. `None` if the record has the truth
/// of a later channel and lacks an earlier one.
pub(crate) fn known(channels: &[Channel], record: &Record) -> Option<usize> {
    let knows = |channel: &&Channel| record.truth(**channel).is_some();
    let known = channels.iter().take_while(knows).count();
    (channels.iter().filter(knows).count() == known).then_some(known)
}

impl Tape {
    /// The tape of a filter's record with the truth of its first channels. `None` if a number is infinite or too large,
    /// or a truth is missing.
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
            put_sample(&mut words, force, &numbers, &own);
            // Nothing is measured at the first sample.
            let present = if k == 0 { 0 } else { numbers.iter().filter(|number| !number.is_nan()).count() };
            counts = [counts[0] + present as u32, counts[1] + u32::from(present > 0)];
            measured.push(counts);
            most.iter_mut().zip(&own).for_each(|(most, own)| *most = most.max(own.abs()));
            largest_truth.extend_from_slice(&most);
        }
        Some(Self { words, measured, largest_truth })
    }
}
