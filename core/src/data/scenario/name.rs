//! Names from files, links and messages.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// Whether a character is text: no control character, and no mark that turns the direction of writing, with which a name
/// can look like another.
pub fn is_text(letter: char) -> bool {
    !(letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'))
}

/// Text on one terminal: with a space in place of each character that is no text, apart from the ends of lines.
pub fn shown(text: &str) -> String {
    text.chars().map(|letter| if letter == '\n' || is_text(letter) { letter } else { ' ' }).collect()
}

/// Reads a name, and refuses one that [`is_text`] does not allow.
pub(super) fn name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let name = String::deserialize(deserializer)?;
    match name.chars().find(|letter| !is_text(*letter)) {
        None => Ok(name),
        Some(letter) => Err(D::Error::custom(format_args!(
            "a name cannot have the character U+{:04X}, which steers a terminal or the direction of writing",
            u32::from(letter)
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;

    #[test]
    fn names_that_steer_a_terminal_are_refused_with_their_place() {
        for (letter, code) in [("\\u001B", "U+001B"), ("\\u202E", "U+202E"), ("\\n", "U+000A"), ("\\u2066", "U+2066")] {
            let error = Scenario::from_toml(&format!("[[filters]]\nname = \"a{letter}b\"")).unwrap_err().to_string();
            assert!(error.contains("filters[0].name") && error.contains(code), "{error}");
        }
        let scenario = Scenario::from_toml("[[filters]]\nname = \"ωₙ – \u{5d0}, größer\"").unwrap();
        assert_eq!(scenario.filters[0].name, "ωₙ – \u{5d0}, größer");
    }

    #[test]
    fn shown_text_keeps_its_lines() {
        assert_eq!(shown("a\u{1b}]0;b\n\u{202e}c\td"), "a ]0;b\n c d");
    }
}
