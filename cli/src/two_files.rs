//! Two files with clocks of their own, written as one.

use std::path::{Path, PathBuf};

use kalmanscope_core::Quantity;
use kalmanscope_core::import::{self, ClockOffset, Clocked, ImportError, Joined, Table, join};

use crate::args::{ImportArgs, Missing};
use crate::input::InputError;
use crate::meaning::mapping;
use crate::places::{say, write_bytes};

/// Writes the columns of two files into a third one, at the steps of the faster clock. Without an offset, it is the one with which
/// both agree best. Returns the columns of the third file, and its hash.
pub(crate) fn two_files(
    [(file, first), (other, second)]: [(&Path, &Table); 2],
    offset: Option<f64>,
    to: &Path,
    args: &ImportArgs,
) -> Result<(Table, String), InputError> {
    let bad = |error| InputError::Import { file: other.to_owned(), error };
    // A cubic through a number that is no reading would spoil its neighbours.
    let [first, second] = &[first, second].map(|table| with_gaps(table, args.missing));
    let offset = match offset {
        Some(offset) => offset,
        None => estimated([first, second], args, [file, other]).map_err(bad)?,
    };
    let Joined { table, .. } = join(first, second, offset).map_err(bad)?;
    table.remarks.iter().for_each(|remark| say(remark));
    let bytes = text(&table).into_bytes();
    write_bytes(to, &bytes)?;
    let hash = import::hash(&bytes);
    let table = import::read(bytes, None).map_err(|error| InputError::Import { file: PathBuf::from(to), error })?;
    Ok((table, hash))
}

/// A table in which cells that are no readings are empty: those with the number that the user names, else those that the importer
/// would take for missing.
fn with_gaps(table: &Table, missing: Option<Missing>) -> Table {
    let mut with_gaps = table.clone();
    for (place, column) in with_gaps.columns.iter_mut().enumerate() {
        let guessed = || table.sentinel(place).filter(|sentinel| sentinel.is_usual).map(|sentinel| sentinel.value);
        let told = missing.map_or_else(guessed, |Missing(number)| number);
        let Some(number) = told else { continue };
        let cells = column.values.iter_mut().filter(|value| **value == number);
        let count = cells.map(|value| *value = f64::NAN).count();
        if count > 0 {
            say(&format_args!("{number} in {count} cells of `{}` is taken for missing", column.name));
        }
    }
    with_gaps
}

/// The offset of the second file, from the columns that agree best.
fn estimated(tables: [&Table; 2], args: &ImportArgs, files: [&Path; 2]) -> Result<f64, ImportError> {
    // What the columns mean does not depend on their times: begin both at the same one.
    let Joined { table, sources } = join(tables[0], tables[1], import::apart(tables)?)?;
    let (mapping, _, _) = mapping(&table, args);
    let source = |column: &str| {
        let place = table.place(column)?.checked_sub(1)?;
        sources.get(place)
    };
    let told: Vec<(&(bool, String), Option<Quantity>)> = (mapping.input.iter().map(|input| (&input.column, None)))
        .chain(mapping.sensors.iter().map(|(quantity, sensor)| (&sensor.column, Some(*quantity))))
        .filter_map(|(column, measures)| Some((source(column)?, measures)))
        .collect();
    let of =
        |is_second: bool| {
            let table = tables[usize::from(is_second)];
            told.iter()
                .filter(move |((second, _), _)| *second == is_second)
                .map(move |((_, column), measures)| Clocked { table, column, measures: *measures })
        };
    let pairs = of(false).flat_map(|first| of(true).map(move |second| (first, second)));
    let mut best: Option<(ClockOffset, Clocked<'_>, Clocked<'_>)> = None;
    let mut reason =
        ImportError::NoOffset { first: files[0].display().to_string(), second: files[1].display().to_string() };
    for (first, second) in pairs {
        match ClockOffset::between(first, second) {
            Ok(found) if best.is_none_or(|(best, ..)| found.correlation > best.correlation) => {
                best = Some((found, first, second));
            }
            Ok(_) => {}
            Err(error) => reason = error,
        }
    }
    let Some((ClockOffset { seconds, correlation, is_turned }, first, second)) = best else { return Err(reason) };
    let turned = if is_turned { ", with opposite signs: one of them is turned" } else { "" };
    say(&format_args!(
        "{seconds:.4} s are added to the times of {}: then `{}` and `{}` agree best, with a correlation of {correlation:.2}{turned}",
        files[1].display(),
        first.column,
        second.column
    ));
    Ok(seconds)
}

/// A table as CSV, with the units in the names.
fn text(table: &Table) -> String {
    let quoted = |name: &str| {
        if name.contains([',', '"']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
    };
    let names: Vec<String> = table
        .columns
        .iter()
        .map(|column| match column.unit.as_deref() {
            Some(unit) if !unit.is_empty() => quoted(&format!("{} [{unit}]", column.name)),
            _ => quoted(&column.name),
        })
        .collect();
    let mut text = names.join(",") + "\n";
    for row in 0..table.rows() {
        let cell = |value: f64| if value.is_finite() { format!("{value}") } else { String::new() };
        let cells: Vec<String> = table.columns.iter().map(|column| cell(column.values[row])).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}
