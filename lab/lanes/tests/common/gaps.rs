//! Records with missing measurements.

use kalmanscope_core::record::Input;
use kalmanscope_core::{Channel, Record};

/// The record where some measurements are missing, with or without its truth. `is_missing` is asked with the sensor's place
/// and the sample.
pub(crate) fn with_gaps(record: &Record, keeps_truth: bool, is_missing: impl Fn(usize, usize) -> bool) -> Record {
    let columns = record.sensors().iter().enumerate().map(|(sensor, &quantity)| {
        let keep = |(k, &value): (usize, &f64)| if is_missing(sensor, k) { f64::NAN } else { value };
        (quantity, record.measured(sensor).iter().enumerate().map(keep).collect())
    });
    let input = Input { kind: record.input_kind(), hold: record.hold(), values: record.input().to_vec() };
    let new = Record::new(record.dt(), input, columns.collect()).unwrap();
    let truth = Channel::all().iter().filter_map(|&channel| Some((channel, record.truth(channel)?.to_vec())));
    if keeps_truth { new.with_truth(truth.collect()).unwrap() } else { new }
}
