//! A part of a record, which a trial runs on.

use std::ops::Range;

use crate::record::Input;
use crate::{Channel, Quantity, Record};

/// Some samples of a record as a record of their own.
pub(super) fn window(record: &Record, samples: Range<usize>) -> Record {
    let input =
        Input { kind: record.input_kind(), hold: record.hold(), values: record.input()[samples.clone()].to_vec() };
    let measured: Vec<(Quantity, Vec<f64>)> =
        record.sensors().iter().enumerate().map(|(i, &q)| (q, record.measured(i)[samples.clone()].to_vec())).collect();
    let known = Channel::all().iter().filter_map(|&c| Some((c, record.truth(c)?[samples.clone()].to_vec())));
    let truth: Vec<(Channel, Vec<f64>)> = known.collect();
    // A part of a valid record is one.
    let copy = Record::new(record.dt(), input, measured).and_then(|copy| copy.with_truth(truth));
    copy.map_or_else(|_| record.clone(), |copy| copy.starting_at(record.time(samples.start)))
}
