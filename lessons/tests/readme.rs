//! The page for authors is right: its lesson can be read and its claims hold, and it has every key.

use kalmanscope_lessons::{Lesson, verify_all};

const README: &str = include_str!("../README.md");

/// The lesson on the page.
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
    for claim in &claims {
        assert!(claim.holds(), "{claim}");
    }
}

/// A message about an unknown key or word lists those that are allowed.
#[test]
fn every_key_and_word_is_on_the_page() {
    for (place, wrong) in [
        ("title = ", "unknown = 1\ntitle = "),
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
