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
    let built = table.and_then(|table| build(&table, mapping, scenario.input, scenario.hold, &scenario.plant.kind));
    let reason = |error: kalmanscope_core::import::ImportError| error.to_string();
    let imported = built.map_err(|error| LessonError::Record { file: mapping.file.clone(), reason: reason(error) })?;
    Ok(Source::Measured(Arc::new(imported.record)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BUILT_IN;

    #[test]
    fn a_record_is_found_by_its_name_and_not_with_another_hash() {
        let (name, file) = RECORDS[0];
        let bytes = file(SEED).into_bytes();
        let named = Mapping { file: name.to_owned(), ..Mapping::default() };
        assert_eq!(record(&named).as_ref(), Some(&bytes));
        assert_eq!(record(&Mapping { hash: hash(&bytes), ..named.clone() }), Some(bytes));
        assert_eq!(record(&Mapping { hash: hash(b"another"), ..named.clone() }), None);
        assert_eq!(record(&Mapping { file: "mine.csv".to_owned(), ..named }), None);
    }

    #[test]
    fn each_record_is_opened_by_a_scenario_of_the_menu() {
        let scenarios: Vec<Scenario> = BUILT_IN.iter().filter_map(|entry| entry.scenario().ok()).collect();
        let measured: Vec<&Scenario> = scenarios.iter().filter(|scenario| scenario.record.is_some()).collect();
        for (name, file) in RECORDS {
            let of_it = |scenario: &&&Scenario| scenario.record.as_ref().is_some_and(|m| m.file == *name);
            let scenario = measured.iter().find(of_it).unwrap_or_else(|| panic!("{name} is in no scenario"));
            let hash_of_it = scenario.record.as_ref().map(|mapping| mapping.hash.clone());
            assert_eq!(
                hash_of_it,
                Some(hash(file(SEED).as_bytes())),
                "a file of the user with this name is another one: {name}"
            );
            let source = source(scenario).unwrap_or_else(|error| panic!("{name}: {error}"));
            let Source::Measured(record) = source else { panic!("{name} is simulated") };
            assert!(scenario.sensors.iter().all(|sensor| record.sensors().contains(&sensor.measures)), "{name}");
        }
        assert_eq!(measured.len(), RECORDS.len());
    }

    #[test]
    fn errors_name_the_file() {
        let mapping = Mapping { file: "mine.csv".to_owned(), ..Mapping::default() };
        let scenario = Scenario { record: Some(mapping), ..Scenario::default() };
        let message = |result: Result<Source, LessonError>| result.err().map(|error| error.to_string());
        assert_eq!(message(source(&scenario)).as_deref(), Some("the record `mine.csv` does not come along"));
        let bad = message(source_in(&scenario, b""));
        assert_eq!(bad.as_deref(), Some("the record `mine.csv`: the file is empty"));
    }
}
