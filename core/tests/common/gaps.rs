//! Records with missing measurements.

use kalmanscope_core::Record;
use kalmanscope_core::record::Input;

/// The record without its truth and without some measurements. `is_missing` is asked with the sensor's place and the sample.
pub(crate) fn with_gaps(record: &Record, is_missing: impl Fn(usize, usize) -> bool) -> Record {
    let columns = record.sensors().iter().enumerate().map(|(sensor, &quantity)| {
        let keep = |(k, &value): (usize, &f64)| if is_missing(sensor, k) { f64::NAN } else { value };
        (quantity, record.measured(sensor).iter().enumerate().map(keep).collect())
    });
    let input = Input { kind: record.input_kind(), hold: record.hold(), values: record.input().to_vec() };
    Record::new(record.dt(), input, columns.collect()).expect("the record had these columns")
}
