//! The meaning of a file's columns, by the guess and the options of the command line.

use kalmanscope_core::InputKind;
use kalmanscope_core::import::{ColumnGuess, MappedColumn, Mapping, Table, Time};

use crate::args::{ImportArgs, Missing};

/// Words for no column.
const NOTHING: [&str; 2] = ["none", "nothing"];

/// The meaning of the columns: the guess, and what the user says.
pub(crate) fn mapping(table: &Table, args: &ImportArgs) -> (Mapping, InputKind, Vec<ColumnGuess>) {
    let ImportArgs { rate, time, time_unit, even, missing, input, no_input, ground, sensor, .. } = args;
    let (mut mapping, mut kind, guesses) = Mapping::guess_with_reasons(table);
    if let Some(rate) = rate {
        mapping.time = Time { rate: Some(*rate), ..Time::default() };
    }
    if let Some(column) = time {
        let unit = MappedColumn::of(table, column).unit;
        mapping.time = Time { column: Some(column.clone()), unit, ..Time::default() };
    }
    if let (Some(unit), Some(_)) = (time_unit, &mapping.time.column) {
        mapping.time.unit.clone_from(unit);
    }
    mapping.time.even |= *even;
    let mapped = |column: &String| MappedColumn::of(table, column);
    let is_nothing = |column: &&String| NOTHING.contains(&column.as_str()) && table.place(column).is_none();
    if *no_input || input.as_ref().is_some_and(|column| is_nothing(&column)) {
        (mapping.input, mapping.no_input) = (None, true);
    } else if let Some(column) = input {
        mapping.input = Some(mapped(column));
        mapping.sensors.retain(|_, sensor| sensor.column != *column);
    }
    if *ground {
        kind = InputKind::GroundAcceleration;
    }
    if !sensor.is_empty() {
        // A user with named sensors knows the columns: no other column is guessed to be the input.
        let is_said = |mapped: &MappedColumn| {
            guesses.iter().any(|guess| guess.column == mapped.column && !guess.is_a_guess())
                && !sensor.iter().any(|(_, column)| *column == mapped.column)
        };
        if input.is_none() && !mapping.input.as_ref().is_some_and(is_said) {
            mapping.input = None;
        }
        mapping.sensors = sensor.iter().map(|(quantity, column)| (*quantity, mapped(column))).collect();
    }
    if let Some(Missing(missing)) = missing {
        let all = mapping.input.iter_mut().chain(mapping.sensors.values_mut());
        all.for_each(|mapped| mapped.missing = *missing);
    }
    (mapping, kind, guesses)
}
