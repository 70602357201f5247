//! The built-in records.

mod circuit;
mod earthquake;
mod oscillator;
mod random;
mod staircase;

use std::sync::Arc;

use kalmanscope_core::import::{Mapping, build, hash, read};
use kalmanscope_core::{Scenario, Source};

use crate::LessonError;

/// The text of a file with the random numbers of a seed.
pub type RecordMaker = fn(u64) -> String;

/// Every record that a scenario can name without having its file: the file's name, and the function that makes it.
pub const RECORDS: &[(&str, RecordMaker)] =
    &[("circuit.csv", circuit::file), ("earthquake.csv", earthquake::file), ("staircase.csv", staircase::file)];

/// The seed of the files in `assets/records/`.
pub const SEED: u64 = 1;

/// The bytes of the built-in record that a mapping names. The name must match, and the hash, if the mapping has one.
///
/// They are computed, bit by bit as in `assets/records/`, so that a web page need not load them.
pub fn record(mapping: &Mapping) -> Option<Vec<u8>> {
    let (_, file) = RECORDS.iter().find(|(name, _)| *name == mapping.file)?;
    let bytes = file(SEED).into_bytes();
    // A user's file may have the same name: its hash says that it is another record.
    (mapping.hash.is_empty() || mapping.hash == hash(&bytes)).then_some(bytes)
}

/// The source of a scenario's samples: a simulation, or the built-in record that it names.
///
/// # Errors
/// [`LessonError::UnknownRecord`] where no such record is built in, [`LessonError::Record`] where its columns are not a
/// record.
pub fn source(scenario: &Scenario) -> Result<Source, LessonError> {
    let Some(mapping) = &scenario.record else { return Ok(Source::Simulated) };
    let bytes = record(mapping).ok_or_else(|| LessonError::UnknownRecord(mapping.file.clone()))?;
    source_in(scenario, &bytes)
}

/// As [`source()`], with the bytes of a file in place of the built-in ones.
///
/// # Errors
/// [`LessonError::Record`] where the file's columns are not a record.
pub fn source_in(scenario: &Scenario, bytes: &[u8]) -> Result<Source, LessonError> {
    let Some(mapping) = &scenario.record else { return Ok(Source::Simulated) };
    let table = read(bytes, mapping.dialect);
    let truth = scenario.plant.kind.channels();
    let built = table.and_then(|table| build(&table, mapping, scenario.input, scenario.hold, truth));
    let reason = |error: kalmanscope_core::import::ImportError| error.to_string();
    let imported = built.map_err(|error| LessonError::Record { file: mapping.file.clone(), reason: reason(error) })?;
    Ok(Source::Measured(Arc::new(imported.record)))
}
