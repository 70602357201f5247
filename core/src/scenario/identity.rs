//! The ids and the names of filters: each is unique, so that keys, buttons and tables mean one filter. Names from files, links and
//! messages are checked here.

use kalmanscope_filters::lists::mapped;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::Scenario;
use super::address::ALL;

impl Scenario {
    /// Gives every filter a unique id and a unique name. A filter without an id, or with that of an earlier one, gets the number
    /// of its place, counted from 1, or else the first free number. A filter with the name of an earlier one, or of its smoother,
    /// gets the first free number behind it.
    pub fn number_filters(&mut self) {
        let mut taken = self.filter_ids();
        let mut seen = vec![0];
        for (number, filter) in (1..).zip(&mut self.filters) {
            if seen.contains(&filter.id) {
                filter.id = if taken.contains(&number) { free(&taken) } else { number };
                taken.push(filter.id);
            }
            seen.push(filter.id);
        }
        self.part_names();
    }

    /// The smallest id that no filter has.
    pub fn free_filter_id(&self) -> u32 {
        free(&self.filter_ids())
    }

    /// This name, or the same with the first number behind it that makes it one that no filter has, nor the smoother of one.
    pub fn free_filter_name(&self, name: &str) -> String {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
        let numbered = (2_u32..).map(|number| format!("{stem} {number}"));
        let is_taken = |name: &str| name == ALL || self.filters.iter().any(|filter| clash(&filter.name, name));
        std::iter::once(name.to_owned()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
    }

    /// Gives filters with a name that another filter has one of their own. Returns a sentence for each.
    pub(super) fn part_names(&mut self) -> Vec<String> {
        let mut sentences = Vec::new();
        for place in 0..self.filters.len() {
            let (before, rest) = self.filters.split_at(place);
            let name = &rest[0].name;
            let other = before.iter().find(|other| clash(&other.name, name));
            if name.is_empty() || (other.is_none() && name != ALL) {
                continue;
            }
            let new = self.free_filter_name(name);
            let reason =
                if name == ALL { "this name stands for all filters" } else { "an earlier filter has this name" };
            sentences.push(format!("filter {} is called `{new}` in place of `{name}`: {reason}", place + 1));
            self.filters[place].name = new;
        }
        sentences
    }

    pub(super) fn name_filters(&mut self) {
        for place in 0..self.filters.len() {
            if self.filters[place].name.is_empty() {
                self.filters[place].name = self.free_filter_name(self.filters[place].kind.name());
            }
        }
    }

    fn filter_ids(&self) -> Vec<u32> {
        mapped(&self.filters, &|filter| filter.id)
    }
}

/// Whether two filters cannot both have their name: it is the same, or one is that of the other's smoother.
pub(crate) fn clash(a: &str, b: &str) -> bool {
    let of_smoother = |a: &str, b: &str| a.strip_suffix(SMOOTHED).is_some_and(|of| of == b);
    a == b || of_smoother(a, b) || of_smoother(b, a)
}

pub(crate) const SMOOTHED: &str = ", smoothed";

fn free(taken: &[u32]) -> u32 {
    (1..).find(|id| !taken.contains(id)).unwrap_or_default()
}

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
    use crate::{FilterSettings, Scenario};

    fn numbered(ids: &[u32]) -> Vec<u32> {
        let filters = ids.iter().map(|&id| FilterSettings { id, ..FilterSettings::default() }).collect();
        let mut scenario = Scenario { filters, ..Scenario::default() };
        scenario.number_filters();
        scenario.filters.iter().map(|filter| filter.id).collect()
    }

    #[test]
    fn every_filter_has_an_id_of_its_own() {
        assert_eq!(numbered(&[0, 0, 0]), [1, 2, 3]);
        assert_eq!(numbered(&[7, 2, 5]), [7, 2, 5]);
        assert_eq!(numbered(&[2, 0, 2, 0]), [2, 1, 3, 4]);
        assert!(numbered(&[]).is_empty());
        assert_eq!(Scenario::default().free_filter_id(), 3);
    }

    fn named(filters: &[&str]) -> (Vec<String>, Vec<String>) {
        let mut text = String::new();
        for filter in filters {
            let (kind, name) = filter.split_once('=').unwrap_or((filter, ""));
            text.push_str(&format!("[[filters]]\nkind = \"{kind}\"\nname = \"{name}\"\n"));
        }
        let (scenario, remarks) = Scenario::from_toml_with_remarks(&text).unwrap();
        scenario.validate().unwrap();
        assert_eq!(Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap(), scenario);
        (scenario.filters.into_iter().map(|filter| filter.name).collect(), remarks)
    }

    #[test]
    fn every_filter_has_a_name_of_its_own() {
        for (filters, expected, remarks) in [
            (&["ekf", "ekf", "ukf", "ekf"][..], &["EKF", "EKF 2", "UKF", "EKF 3"][..], 0),
            (&["ekf", "ukf=EKF"], &["EKF 2", "EKF"], 0),
            (&["ekf=a", "ukf=a", "pf=a 2"], &["a", "a 3", "a 2"], 1),
            (&["ekf=*", "ekf=EKF, smoothed", "ekf"], &["* 2", "EKF, smoothed", "EKF 2"], 1),
            (&["ekf=a", "ekf=a, smoothed"], &["a", "a, smoothed 2"], 1),
        ] {
            let (names, sentences) = named(filters);
            assert_eq!(names, expected, "{filters:?}");
            assert_eq!(sentences.len(), remarks, "{sentences:?}");
        }
        let (_, sentences) = named(&["ekf=a", "ukf=a"]);
        assert_eq!(sentences, ["filter 2 is called `a 2` in place of `a`: an earlier filter has this name"]);
    }

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
