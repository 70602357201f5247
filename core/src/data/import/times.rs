//! The times in a column, in seconds.

use std::borrow::Cow;

use super::unit::{Dimension, unit};
use super::{Column, Table};

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// The least step of times without a unit that the user is asked about \[s\].
const SLOW: f64 = 1.0;

/// The times of a column in seconds, up to the last row that has one; those after midnight are of the next day. What is changed is
/// added to the remarks.
pub(super) fn of<'a>(table: &Table, column: &'a Column, text: &str, remarks: &mut Vec<String>) -> Cow<'a, [f64]> {
    let values = &column.values;
    let rows = values.iter().rposition(|time| !time.is_nan()).map_or(0, |last| last + 1);
    let mut times = Cow::Borrowed(&values[..rows]);
    if rows > 0 && rows < values.len() {
        let (line, left) = (table.line(rows - 1), values.len() - rows);
        remarks.push(format!("the times end in line {line}: {left} row(s) below it are left out"));
    }
    let size = match unit(text) {
        Some((Dimension::Time, size)) => size,
        // Times of day and dates are in seconds, even if their header names another unit.
        _ if text.trim().is_empty() || column.is_time_of_day || column.is_dated => 1.0,
        known => {
            remarks.push(format!("`{text}` is no known unit of time: the times are taken for seconds"));
            known.map_or(1.0, |(_, size)| size)
        }
    };
    if size != 1.0 {
        times = times.iter().map(|time| time * size).collect();
    }
    if column.is_time_of_day
        && let Some(row) = times.windows(2).position(|pair| pair[1] < pair[0] - 0.5 * DAY)
    {
        let mut days = 0.0;
        let mut before = times[0];
        let unwrapped = times.iter().map(|&time| {
            days += if time < before - 0.5 * DAY { DAY } else { 0.0 };
            before = time;
            time + days
        });
        times = unwrapped.collect();
        remarks.push(format!("the times pass midnight in line {}", table.line(row + 1)));
    }
    times
}

/// A question about times without a unit, if their step is long for a measured motion.
pub(super) fn question(column: &Column, text: &str, dt: f64) -> Option<String> {
    // Times of day and dates have a known unit.
    let is_told = !text.trim().is_empty() || column.is_time_of_day || column.is_dated;
    (!is_told && dt >= SLOW).then(|| {
        let (name, rate) = (&column.name, 1.0 / dt);
        format!(
            "the times in `{name}` have no unit; in seconds they are {rate} samples a second: are they ms? They count as seconds \
             until their unit is stated"
        )
    })
}
