//! Scenario files: valid contents, and the messages for invalid ones.

mod refused;
mod types;
mod valid;

use kalmanscope_core::Scenario;

fn parsed(text: &str) -> Scenario {
    Scenario::from_toml(text).unwrap_or_else(|error| panic!("{text}\n{error}"))
}

/// Asserts that a file is refused with exactly this message.
#[track_caller]
fn assert_refused(cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        match Scenario::from_toml(text) {
            Ok(_) => panic!("accepted: {text}"),
            Err(error) => assert_eq!(error.to_string(), *expected, "{text}"),
        }
    }
}
