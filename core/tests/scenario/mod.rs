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
            // Channels of equations that other tests type follow in lists of channels: such a list is compared as far as it is given.
            Err(error) => match expected.strip_suffix('…') {
                Some(begin) => assert!(error.to_string().starts_with(begin), "{text}: {error}"),
                None => assert_eq!(error.to_string(), *expected, "{text}"),
            },
        }
    }
}
