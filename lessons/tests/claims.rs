//! The claims of the lessons hold in the record that a lesson opens with and, in the share that they state, in others.

use kalmanscope_lessons::{Claim, LESSONS, Lesson, verify, verify_all};

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
        println!("{} {claim}", if claim.holds() { "holds" } else { "FAILS" });
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
