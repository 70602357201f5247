//! Sentences about the cells and readings of a column.

use super::{MappedColumn, Table};
use crate::Quantity;

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

/// A sentence about a sensor with equal readings.
pub(super) fn stillness(quantity: Quantity) -> String {
    format!("all readings of the {} are the same: there is no motion in them", quantity.name())
}

/// Whether readings do not differ.
pub(super) fn is_still(readings: &[f64]) -> bool {
    let mut there = readings.iter().filter(|reading| !reading.is_nan());
    let first = there.next();
    there.all(|reading| Some(reading) == first)
}

#[cfg(test)]
mod tests {
    use super::super::Imported;
    use super::super::builder::tests::{TEXT, import};
    use super::*;

    #[test]
    fn numbers_and_words_for_missing_readings_are_said() {
        let text = "t,force,x\n0,1,2\n0.1,2,-9999\n0.2,1,2.5\n0.3,OVLD,1.5\n0.4,1,-9999\n";
        let Imported { record, remarks, .. } = import(text, |_| {}).unwrap();
        assert!(record.measured(0)[1].is_nan() && record.measured(0)[4].is_nan());
        let said = remarks.join("\n");
        assert!(said.contains("1 cell(s) of `force` have a word such as `OVLD`, the first in line 5"), "{said}");
        assert!(said.contains("2 cell(s) of `x` are -9999, the first in line 3: they count as missing"), "{said}");
        let as_they_are = import(text, |m| m.sensors.values_mut().for_each(|sensor| sensor.missing = None)).unwrap();
        assert_eq!(as_they_are.record.measured(0)[1], -9999.0);
        assert!(as_they_are.remarks.join("\n").contains("are they missing?"), "{:?}", as_they_are.remarks);
    }

    #[test]
    fn readings_that_stand_still_are_told() {
        let still = import("t,force,x\n0,1,2\n0.1,2,2\n0.2,1,\n0.3,1,2\n", |_| {}).unwrap();
        assert_eq!(still.still, Some(Quantity::DISPLACEMENT));
        assert_eq!(import(TEXT, |_| {}).unwrap().still, None);
    }
}
