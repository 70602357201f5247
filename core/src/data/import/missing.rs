//! Cells without a reading: numbers such as -9999 and words that mark them, and sensors that stand still.

use super::{MappedColumn, Table};

/// A number that seems to mark missing readings: it occurs several times, far from all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sentinel {
    /// The number.
    pub value: f64,
    /// The number of cells that have it.
    pub count: usize,
    /// The line of the first one, counted from 1.
    pub line: usize,
    /// Whether loggers write it for a missing reading: nines, the ends of whole numbers of 16 and 32 bits, 1e30 and more.
    pub is_usual: bool,
}

/// The least distance of a sentinel from all other numbers, over their range: of a usual one and of any other number.
const FAR: [f64; 2] = [3.0, 30.0];

const FEWEST: usize = 3;

#[derive(Clone, Copy)]
struct End {
    value: f64,
    count: usize,
    row: usize,
    next: f64,
}

impl Table {
    /// The number that seems to mark missing readings in the column at a place.
    pub fn sentinel(&self, place: usize) -> Option<Sentinel> {
        let values = &self.columns[place].values;
        let (low, high) = (end(values, 1.0)?, end(values, -1.0)?);
        let finite = values.iter().filter(|value| value.is_finite()).count();
        let of = |end: End, other: End| {
            let is_usual = is_usual(end.value);
            let range = (end.next - other.value).abs();
            let far = (end.value - end.next).abs() > FAR[usize::from(!is_usual)] * range;
            let enough = end.count >= if is_usual { 2 } else { FEWEST } && 2 * end.count < finite;
            let End { value, count, row, .. } = end;
            (range > 0.0 && far && enough).then(|| Sentinel { value, count, line: self.line(row), is_usual })
        };
        of(low, high).or_else(|| of(high, low))
    }

    /// The table with empty cells in place of numbers that are no readings, and a remark on each column that had some: of `missing`,
    /// or without it of the numbers that loggers write for a missing reading.
    #[must_use]
    pub fn with_gaps(&self, missing: Option<f64>) -> Self {
        let mut with_gaps = self.clone();
        for (place, column) in with_gaps.columns.iter_mut().enumerate() {
            let guessed = || self.sentinel(place).filter(|sentinel| sentinel.is_usual).map(|sentinel| sentinel.value);
            let Some(number) = missing.or_else(guessed) else { continue };
            let cells = column.values.iter_mut().filter(|value| **value == number);
            let count = cells.map(|value| *value = f64::NAN).count();
            if count > 0 {
                let remark = format!("{number} in {count} cells of `{}` is taken for missing", column.name);
                with_gaps.remarks.push(remark);
            }
        }
        with_gaps
    }
}

fn end(values: &[f64], sign: f64) -> Option<End> {
    let mut end: Option<End> = None;
    for (row, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        match &mut end {
            None => end = Some(End { value, count: 1, row, next: sign * f64::INFINITY }),
            Some(end) if value == end.value => end.count += 1,
            Some(end) if sign * value < sign * end.value => *end = End { value, count: 1, row, next: end.value },
            Some(end) if sign * value < sign * end.next => end.next = value,
            Some(_) => {}
        }
    }
    end.filter(|end| end.next.is_finite())
}

fn is_usual(value: f64) -> bool {
    let size = value.abs();
    let nines = [999.0, 9999.0, 99_999.0, 999_999.0, 9_999_999.0, 999.25, 999.9, 9999.9];
    let ends = [32_767.0, 32_768.0, 65_535.0, 2_147_483_647.0, 2_147_483_648.0, 8888.0, 7999.0, 6999.0];
    nines.contains(&size) || ends.contains(&size) || size >= 1e30
}

/// Sentences about the cells of a column that have no reading, or seem to have none.
pub(super) fn cells_without_readings(table: &Table, place: usize, mapped: &MappedColumn) -> Vec<String> {
    let column = &table.columns[place];
    let name = &column.name;
    let word = column.word.as_ref().map(|word| {
        let (count, line) = (column.words, word.line);
        format!(
            "{count} cell(s) of `{name}` have a word such as `{}`, the first in line {line}: they count as missing",
            word.text
        )
    });
    let number = match mapped.missing {
        Some(missing) => {
            let rows = || column.values.iter().enumerate().filter(|(_, value)| **value == missing);
            rows().next().map(|(row, _)| {
                let (count, line) = (rows().count(), table.line(row));
                format!("{count} cell(s) of `{name}` are {missing}, the first in line {line}: they count as missing")
            })
        }
        None => table.sentinel(place).map(|found| {
            let (value, count, line) = (found.value, found.count, found.line);
            format!(
                "{count} cells of `{name}` are {value}, far from all others, the first in line {line}: are they missing? They \
                 count as readings until `missing = {value}` is stated"
            )
        }),
    };
    word.into_iter().chain(number).collect()
}

pub(super) fn is_still(readings: &[f64]) -> bool {
    let mut there = readings.iter().filter(|reading| !reading.is_nan());
    let first = there.next();
    there.all(|reading| Some(reading) == first)
}
