//! The claims of the lessons, and of the page for authors, hold in the record that a lesson opens with and, in the share that they
//! state, in others. The built-in records are those of the program that makes them.

use kalmanscope_core::{Scenario, Source};
use kalmanscope_lessons::records::{self, RECORDS, SEED};
use kalmanscope_lessons::{Claim, LESSONS, Lesson, LessonError, verify, verify_all, verify_with};

/// The lessons with the value of `LESSON` in their file names, if it is set: this saves time while writing one.
fn wanted() -> Vec<Lesson> {
    let part = std::env::var("LESSON").unwrap_or_default();
    let chosen = LESSONS.iter().filter(|(name, _)| name.contains(&part));
    chosen.map(|(name, text)| Lesson::from_toml(text).unwrap_or_else(|error| panic!("{name}: {error}"))).collect()
}

fn assert_none<'a>(failed: impl Iterator<Item = &'a Claim>, of: usize) {
    let failed: Vec<String> = failed.map(Claim::to_string).collect();
    assert!(failed.is_empty(), "{} claims of {of} fail:\n{}", failed.len(), failed.join("\n"));
}

/// The example `claims` tries more seeds.
#[test]
fn every_claim_holds_in_the_share_that_it_states() {
    let seeds: Vec<u64> = (1..=10).chain(1000..1030).collect();
    let claims = verify_all(&wanted(), &seeds).unwrap();
    for claim in &claims {
        println!("{claim}");
    }
    assert_none(claims.iter().filter(|claim| !claim.holds()), claims.len());
}

/// It is the record that a student sees.
#[test]
fn claims_about_nearly_all_records_hold_in_the_one_that_opens() {
    let opened = |lesson: &Lesson| verify(lesson, [lesson.first_scenario().unwrap().seed]).unwrap();
    let claims: Vec<Claim> = wanted().iter().flat_map(opened).collect();
    let failed = claims.iter().filter(|claim| claim.is_about_nearly_all() && claim.failures().next().is_some());
    assert_none(failed, claims.len());
}

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
        if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
            std::fs::write(&path, file(SEED)).unwrap();
        }
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert!(file(SEED) == text, "{name}: UPDATE_SNAPSHOTS=1 writes it again");
    }
}

#[test]
fn claims_about_a_measured_record_hold_for_others_of_its_kind() {
    let measured =
        wanted().into_iter().filter(|lesson| lesson.first_scenario().is_ok_and(|scenario| scenario.record.is_some()));
    let mut claims: Vec<Claim> = Vec::new();
    for lesson in measured {
        claims.extend(verify_with(&lesson, SEED + 1..=SEED + 30, &source).unwrap_or_else(|error| panic!("{error}")));
    }
    assert!(!claims.is_empty() || std::env::var_os("LESSON").is_some());
    for claim in &claims {
        println!("{}", claim.summary());
    }
    assert_none(claims.iter().filter(|claim| !claim.holds()), claims.len());
}

const README: &str = include_str!("../README.md");

fn text() -> &'static str {
    let (_, rest) = README.split_once("```toml\n").expect("the page has a lesson");
    rest.split_once("```").expect("the lesson ends").0
}

#[test]
fn the_lesson_can_be_read_and_its_claims_hold() {
    let lesson = Lesson::from_toml(text()).unwrap_or_else(|error| panic!("{error}"));
    assert!(lesson.steps[0].question.is_some() && lesson.steps[1].change.is_some());
    let claims = verify_all(&[lesson], &(1..=20).collect::<Vec<_>>()).expect("its scenarios are possible");
    assert_eq!(claims.len(), 3);
    assert_none(claims.iter().filter(|claim| !claim.holds()), claims.len());
}

/// A message about an unknown key or word lists those that are allowed.
#[test]
fn every_key_and_word_is_on_the_page() {
    for (place, wrong) in [
        ("title = ", "unknown = 1\ntitle = "),
        ("scenario = ", "picture = { show = \"map\", unknown = 1 }\nscenario = "),
        ("scenario = ", "picture = { show = \"unknown\" }\nscenario = "),
        ("look = ", "unknown = 1\nlook = "),
        ("question = { ", "question = { unknown = 1, "),
        ("change = { ", "change = { unknown = 1, "),
        ("{ filter = ", "{ unknown = 1, filter = "),
        ("[\"parameters\", ", "[\"unknown\", "),
        ("measure = \"nis\"", "measure = \"nis\", cells = { unknown = 1 }"),
        ("views = [", "map = { unknown = 1 }\nviews = ["),
        ("from = 20.0", "mode = \"unknown\"\nfrom = 20.0"),
    ] {
        let error = Lesson::from_toml(&text().replacen(place, wrong, 1)).expect_err(wrong).to_string();
        let (_, allowed) = error.split_once("expected").unwrap_or_else(|| panic!("{wrong}: {error}"));
        let allowed: Vec<&str> = allowed.split('`').skip(1).step_by(2).collect();
        assert!(allowed.len() > 2, "{error}");
        for key in allowed {
            assert!(README.contains(&format!("`{key}`")), "`{key}` is not on the page");
        }
    }
}
