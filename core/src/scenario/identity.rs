//! The ids and the names of filters, of which each is unique, and checks of names from files, links and messages.

use kalmanscope_filters::lists::mapped;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::Scenario;

/// The name that stands for all filters in keys; no filter has it.
pub(crate) const ALL: &str = "*";

impl Scenario {
    /// Gives every filter a unique id, that of its place if it is free, and a unique name, if need be with a number behind it.
    pub fn number_filters(&mut self) {
        let mut taken = mapped(&self.filters, &|filter| filter.id);
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
        free(&mapped(&self.filters, &|filter| filter.id))
    }

    /// This name, or the same with the first number behind it that makes it one that no filter has, nor the smoother of one.
    pub fn free_filter_name(&self, name: &str) -> String {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
        let numbered = (2_u32..).map(|number| format!("{stem} {number}"));
        let is_taken = |name: &str| name == ALL || self.filters.iter().any(|filter| clash(&filter.name, name));
        std::iter::once(name.to_owned()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
    }

    /// Gives filters with a name that another filter has one of their own. Returns a sentence for each.
    pub(crate) fn part_names(&mut self) -> Vec<String> {
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

/// Whether a character is text: no control character, and no mark that turns the direction of writing.
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
