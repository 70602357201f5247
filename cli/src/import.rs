//! The command `kalmanscope-cli import`.

use std::fs;
use std::path::Path;

use kalmanscope_core::import::{Builder, ColumnGuess, ImportError, MappedColumn, Mapping, Time};
use kalmanscope_core::scenario::shown;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Hold, InputKind};

use crate::args::{ImportArgs, Missing};
use crate::input::{InputError, is_standard_input};
use crate::places::{check, places, say, write_text};
use crate::progress::Progress;
use crate::record::table;

/// Looks at a record and writes a scenario for it.
pub(crate) fn import(args: &ImportArgs) -> Result<(), InputError> {
    let ImportArgs {
        file,
        out,
        rate,
        time,
        time_unit,
        missing,
        input,
        no_input,
        ground,
        sensor,
        from,
        to,
        band,
        every,
        interpolate,
        plant,
    } = args;
    let bad = |error| InputError::Import { file: file.clone(), error };
    check(&places("the record", [file]), &places("--out", out))?;
    // Errors and remarks come once it is cleared.
    let progress = Progress::wait(false, "reading");
    let (table, hash) = table(file)?;
    let (mut mapping, mut kind, guesses) = Mapping::guess_with_reasons(&table);
    mapping.file = path_from(out.as_deref(), file);
    mapping.hash = hash;
    if let Some(rate) = rate {
        mapping.time = Time { rate: Some(*rate), ..Time::default() };
    }
    if let Some(column) = time {
        let unit = MappedColumn::of(&table, column).unit;
        mapping.time = Time { column: Some(column.clone()), unit, rate: None };
    }
    if let (Some(unit), Some(_)) = (time_unit, &mapping.time.column) {
        mapping.time.unit.clone_from(unit);
    }
    let mapped = |column: &String| MappedColumn::of(&table, column);
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
    (mapping.from, mapping.to, mapping.every, mapping.interpolate) = (*from, *to, *every, *interpolate);
    mapping.band = band.as_ref().and_then(|band| band.as_slice().try_into().ok());
    let imported = Builder::new(&table, &mapping, kind, Hold::First).and_then(Builder::finish).map_err(bad)?;
    drop(progress);
    for guess in &guesses {
        eprintln!("{}", shown(&meaning(guess, &mapping, args)));
    }
    imported.remarks.iter().for_each(|remark| say(remark));
    if let Some(sensor) = imported.still {
        return Err(bad(ImportError::Still { sensor: sensor.name() }));
    }
    let mut scenario = scenario_for(&imported.record);
    scenario.set_plant(*plant);
    scenario.record = Some(mapping);
    let progress = Progress::wait(false, "finding start values");
    let suggestion = suggest(&scenario, &imported.record);
    drop(progress);
    // Nothing is written that `run` would refuse.
    let unsound = |error| InputError::StartValues { file: file.clone(), error };
    suggestion.scenario.validate().map_err(unsound)?;
    let toml = suggestion.scenario.to_toml().map_err(|error| InputError::Scenario { file: file.clone(), error })?;
    let mut text = format!("# {}\n", table.form);
    for remark in imported.remarks.iter().chain(&suggestion.reasons) {
        text.push_str(&shown(&format!("# {remark}\n")));
    }
    text.push_str(&toml);
    match out {
        Some(out) => write_text(out, &text),
        None => write_text(Path::new("-"), &text),
    }
}

/// Words for no column.
const NOTHING: [&str; 2] = ["none", "nothing"];

/// The guessed meaning of a column, and the reason, in one line.
fn meaning(guess: &ColumnGuess, mapping: &Mapping, args: &ImportArgs) -> String {
    let name = Some(&guess.column);
    let sensor = mapping.sensors.iter().find(|(_, sensor)| sensor.column == guess.column);
    let (what, is_asked) = if mapping.time.column.as_ref() == name {
        ("the time".to_owned(), args.time.as_ref() == name)
    } else if mapping.input.as_ref().map(|input| &input.column) == name {
        ("the input".to_owned(), args.input.as_ref() == name)
    } else if let Some((quantity, _)) = sensor {
        (quantity.name(), args.sensor.iter().any(|(_, column)| *column == guess.column))
    } else {
        let why = if guess.is_left_out() { guess.why } else { "not asked for" };
        return format!("column `{}`: left out: {why}", guess.column);
    };
    let why = if is_asked { "as asked" } else { guess.why };
    format!("column `{}`: {what}: {why}", guess.column)
}

/// The path of a record as a scenario in `out` names it: relative if both are in one folder, and none for a pipe, which cannot be
/// read again.
pub(crate) fn path_from(out: Option<&Path>, file: &Path) -> String {
    if !file.is_file() || is_standard_input(file) {
        return String::new();
    }
    let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let name = match out {
        Some(out) if folder(out) == folder(file) => file.file_name().map_or(file, Path::new).to_owned(),
        Some(_) => fs::canonicalize(file).unwrap_or_else(|_| file.to_owned()),
        None => file.to_owned(),
    };
    name.to_string_lossy().into_owned()
}
