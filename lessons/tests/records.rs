//! The built-in records are those of the program that makes them, and the claims about them hold for others of their
//! kind.

use kalmanscope_core::{Scenario, Source};
use kalmanscope_lessons::{Claim, LESSONS, Lesson, LessonError, records, verify_with};
use records::{RECORDS, SEED};

/// The source of a scenario's samples, made with the scenario's seed.
fn source(scenario: &Scenario) -> Result<Source, LessonError> {
    let Some(mapping) = &scenario.record else { return records::source(scenario) };
    let (_, file) = RECORDS
        .iter()
        .find(|(name, _)| *name == mapping.file)
        .ok_or_else(|| LessonError::UnknownRecord(mapping.file.clone()))?;
    records::source_in(scenario, file(scenario.seed).as_bytes())
}

#[test]
fn the_files_are_the_records_bit_by_bit() {
    for (name, file) in RECORDS {
        let path = format!("{}/assets/records/{name}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert!(file(SEED) == text, "{name}: `cargo run -p kalmanscope-lessons --example make_records` makes it again");
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
        claims.extend(verify_with(&lesson, SEED + 1..=SEED + 30, &source).unwrap_or_else(|error| panic!("{error}")));
    }
    assert!(!claims.is_empty() || !part.is_empty());
    for claim in &claims {
        println!("{}", claim.summary());
    }
    let failed: Vec<String> = claims.iter().filter(|claim| !claim.holds()).map(Claim::to_string).collect();
    assert!(failed.is_empty(), "{} claims of {} fail:\n{}", failed.len(), claims.len(), failed.join("\n"));
}
