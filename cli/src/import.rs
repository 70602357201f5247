//! The command `kalmanscope-cli import`.

use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use kalmanscope_core::import::{Builder, MappedColumn, Mapping, Time, hash};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Hold, InputKind};

use crate::args::ImportArgs;
use crate::input::InputError;
use crate::record::table;

/// Looks at a record and writes a scenario for it.
pub(crate) fn import(args: &ImportArgs) -> Result<(), InputError> {
    let ImportArgs { file, out, rate, time, input, ground, sensor, from, to, band, every, interpolate, plant } = args;
    let bad = |error| InputError::Import { file: file.clone(), error };
    let unread = |error| InputError::Read { file: file.clone(), error };
    let table = table(file, &Mapping::default())?;
    let (mut mapping, mut kind) = Mapping::guess(&table);
    mapping.file = path_from(out.as_deref(), file);
    mapping.hash = hash(&fs::read(file).map_err(unread)?);
    if let Some(rate) = rate {
        mapping.time = Time { rate: Some(*rate), ..Time::default() };
    }
    if let Some(column) = time {
        let unit = unit_of(&table, column);
        mapping.time = Time { column: Some(column.clone()), unit, rate: None };
    }
    let mapped = |column: &String| MappedColumn { unit: unit_of(&table, column), ..MappedColumn::new(column.clone()) };
    if let Some(column) = input {
        mapping.input = Some(mapped(column));
        mapping.sensors.retain(|_, sensor| sensor.column != *column);
    }
    if *ground {
        kind = InputKind::GroundAcceleration;
    }
    if !sensor.is_empty() {
        mapping.sensors = sensor.iter().map(|(quantity, column)| (*quantity, mapped(column))).collect();
    }
    (mapping.from, mapping.to, mapping.every, mapping.interpolate) = (*from, *to, *every, *interpolate);
    mapping.band = band.as_ref().and_then(|band| band.as_slice().try_into().ok());
    let imported = Builder::new(&table, &mapping, kind, Hold::First).and_then(Builder::finish).map_err(bad)?;
    let mut scenario = scenario_for(&imported.record);
    scenario.set_plant(*plant);
    scenario.record = Some(mapping);
    let suggestion = suggest(&scenario, &imported.record);
    let toml = suggestion.scenario.to_toml().map_err(|error| InputError::Scenario { file: file.clone(), error })?;
    let mut text = format!("# {}\n", table.dialect);
    for remark in imported.remarks.iter().chain(&suggestion.reasons) {
        text.push_str(&format!("# {remark}\n"));
    }
    text.push_str(&toml);
    match out {
        Some(out) => fs::write(out, text).map_err(|error| InputError::Read { file: out.clone(), error }),
        // A closed pipe needs no message.
        None => {
            let _ = io::stdout().write_all(text.as_bytes());
            Ok(())
        }
    }
}

fn unit_of(table: &kalmanscope_core::import::Table, column: &str) -> String {
    table.place(column).and_then(|place| table.columns[place].unit.clone()).unwrap_or_default()
}

/// The path of a record as a scenario in `out` names it: relative if both are in one folder.
fn path_from(out: Option<&Path>, file: &Path) -> String {
    let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let name = match out {
        Some(out) if folder(out) == folder(file) => file.file_name().map_or(file, Path::new).to_owned(),
        Some(_) => fs::canonicalize(file).unwrap_or_else(|_| file.to_owned()),
        None => file.to_owned(),
    };
    name.to_string_lossy().into_owned()
}
