use kalmanscope_core::import::{Mapping, hash};
use kalmanscope_core::{Scenario, Source};
use kalmanscope_lessons::records::{RECORDS, SEED, record, source, source_in};
use kalmanscope_lessons::{BUILT_IN, LessonError};

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
