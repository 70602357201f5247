//! The health of imports: whatever the bytes, a record is sound or a sentence says why there is none.

use kalmanscope_core::import::{Mapping, build, load};
use kalmanscope_core::{Hold, Record, Task as _};

/// Imports bytes as a file, in slices of one piece of work; the first byte chooses what is done to the columns.
///
/// # Errors
/// A sentence about what is not as it should be.
pub(crate) fn check_import(bytes: &[u8]) -> Result<(), String> {
    let (choice, file) = bytes.split_first().map_or((0, bytes), |(first, rest)| (*first, rest));
    let sentence = |error: String| {
        let is_one = !error.is_empty() && !error.contains('\n');
        if is_one { Ok(()) } else { Err(format!("no sentence: {error:?}")) }
    };
    let mut loading = load(file.to_vec());
    while !loading.advance(&mut || false) {}
    let table = match loading.finish() {
        Ok(loaded) => loaded.table,
        Err(error) => return sentence(error.to_string()),
    };
    let rows = table.rows();
    if table.columns.iter().any(|column| column.values.len() != rows) {
        return Err("columns have different lengths".to_owned());
    }
    let lines = file.iter().filter(|&&byte| byte == b'\n').count() + 1;
    if (0..rows).any(|row| table.line(row) == 0 || table.line(row) > lines) {
        return Err("a row has no line".to_owned());
    }
    let (mut mapping, kind) = Mapping::guess(&table);
    if mapping.time.column.is_none() {
        mapping.time.rate = Some(100.0);
    }
    mapping.every = 1 + usize::from(choice & 3);
    mapping.interpolate = 1 + usize::from((choice >> 2) & 3);
    if choice & 16 != 0 {
        mapping.band = Some([f64::from(choice & 3), 10.0]);
    }
    if choice & 32 != 0 {
        (mapping.from, mapping.to) = (Some(0.05), Some(20.0));
    }
    match build(&table, &mapping, kind, Hold::First, &[]) {
        Ok(imported) => check_record(&imported.record),
        Err(error) => sentence(error.to_string()),
    }
}

fn check_record(record: &Record) -> Result<(), String> {
    if !(record.dt() > 0.0 && record.dt().is_finite()) {
        return Err(format!("dt = {}", record.dt()));
    }
    if record.len() < 2 || record.input().iter().any(|value| !value.is_finite()) {
        return Err("the input is not whole".to_owned());
    }
    let is_whole = |column: &[f64]| column.len() == record.len() && column.iter().all(|z| !z.is_infinite());
    if !(0..record.sensors().len()).all(|sensor| is_whole(record.measured(sensor))) {
        return Err("a sensor is not whole".to_owned());
    }
    Ok(())
}
