//! The records that come along are those of the program that makes them, and the claims about them hold for others of their
//! kind.

#[path = "../examples/make_records/circuit.rs"]
mod circuit;
#[path = "../examples/make_records/earthquake.rs"]
mod earthquake;
#[path = "../examples/make_records/oscillator.rs"]
mod oscillator;
#[path = "../examples/make_records/random.rs"]
mod random;
#[path = "../examples/make_records/staircase.rs"]
mod staircase;

use kalmanscope_core::{Scenario, Source};
use kalmanscope_lessons::{Claim, LESSONS, Lesson, LessonError, records, verify_with};

/// The seed of the records that come along.
const OWN: u64 = 1;

/// The record of this name with a seed of its own.
fn file(name: &str, seed: u64) -> Option<String> {
    match name {
        "circuit.csv" => Some(circuit::file(seed)),
        "earthquake.csv" => Some(earthquake::file(seed)),
        "staircase.csv" => Some(staircase::file(seed)),
        _ => None,
    }
}

/// The source of a scenario's samples, made with the scenario's seed.
fn source(scenario: &Scenario) -> Result<Source, LessonError> {
    let Some(mapping) = &scenario.record else { return records::source(scenario) };
    let text = file(&mapping.file, scenario.seed).ok_or_else(|| LessonError::UnknownRecord(mapping.file.clone()))?;
    records::source_in(scenario, text.as_bytes())
}

#[test]
fn the_records_can_be_made_again_bit_by_bit() {
    for (name, bytes) in records::RECORDS {
        let text = file(name, OWN).unwrap_or_else(|| panic!("nothing makes {name}"));
        assert!(
            text.as_bytes() == *bytes,
            "{name}: `cargo run -p kalmanscope-lessons --example make_records` makes it again"
        );
    }
}

#[test]
fn claims_about_a_measured_record_hold_for_others_of_its_kind() {
    let part = std::env::var("LESSON").unwrap_or_default();
    let lessons = LESSONS.iter().filter(|(name, _)| name.contains(&part));
    let lessons = lessons.map(|(_, text)| Lesson::from_toml(text).unwrap_or_else(|error| panic!("{error}")));
    let measured = lessons.filter(|lesson| lesson.first_scenario().is_ok_and(|scenario| scenario.record.is_some()));
    let mut claims: Vec<Claim> = Vec::new();
    for lesson in measured {
        claims.extend(verify_with(&lesson, OWN + 1..=OWN + 30, &source).unwrap_or_else(|error| panic!("{error}")));
    }
    assert!(!claims.is_empty() || !part.is_empty());
    for claim in &claims {
        println!("{}", claim.summary());
    }
    let failed: Vec<String> = claims.iter().filter(|claim| !claim.holds()).map(Claim::to_string).collect();
    assert!(failed.is_empty(), "{} claims of {} fail:\n{}", failed.len(), claims.len(), failed.join("\n"));
}
